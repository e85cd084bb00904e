#pragma once
#include "doublet/core/mesh.h"

#include <cstdint>
#include <vector>

namespace doublet {

/// Cotangent Laplacian (positive semi-definite) in which invented triangles hardly count: a sheet under a hem must not join the
/// legs with the garment. face_valid (F), empty = all valid.
std::vector<Triplet> scanned_laplacian(const Mesh &mesh, const std::vector<std::uint8_t> &face_valid);

} // namespace doublet
