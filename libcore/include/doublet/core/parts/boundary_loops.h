#pragma once
// Where a surface ends.

#include "doublet/core/mesh.h"

namespace doublet {

/// The boundary as loops of vertices, each in the order of its faces. A vertex that boundaries pass twice may end a loop early.
std::vector<std::vector<int>> boundary_loops(const Faces &faces);

} // namespace doublet
