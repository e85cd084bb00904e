#pragma once
// Boundary loops of a surface.

#include "doublet/core/mesh.h"

namespace doublet {

/// The boundary as loops of vertices, each in the direction of its faces. A vertex that the boundary passes twice may end a loop
/// early.
std::vector<std::vector<int>> boundary_loops(const Faces &faces);

} // namespace doublet
