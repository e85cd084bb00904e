#pragma once
// Adjacent faces.

#include "doublet/core/mesh.h"

#include <vector>

namespace doublet {

/// [F] the faces that share an edge with each.
std::vector<std::vector<int>> face_neighbours(const Faces &faces);

} // namespace doublet
