#pragma once
// Where a surface passes through itself.

#include "doublet/core/context.h"
#include "doublet/core/mesh.h"

#include <cstdint>
#include <vector>

namespace doublet {

/// (F) 1 for the faces that pass through another face of the mesh: an edge of one crosses the inside of the other, and they share
/// no corner of that edge. Faces that merely touch, or lie in one plane, do not count. In parallel; the result does not depend on
/// the number of threads. Throws Error if the mesh is not usable.
std::vector<std::uint8_t> self_intersecting_faces(const Mesh &mesh, const Context &context = {});

} // namespace doublet
