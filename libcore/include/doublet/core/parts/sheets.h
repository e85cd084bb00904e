#pragma once
// The sheets that close a scan where nobody saw it: invalid faces.

#include "doublet/core/mesh.h"

#include <cstdint>
#include <vector>

namespace doublet {

/// (F) face_valid, without what its sheets still have of valid faces: those that hang together with a sheet by a corner and face
/// the same way, within 53 degrees of its mean normal. Where a garment touches a limb, the sheet that closes its hem is easily
/// marked too small, and what is left of it welds the limb to the garment. Empty stays empty (all valid).
std::vector<std::uint8_t> extend_sheets(const Mesh &mesh, const std::vector<std::uint8_t> &face_valid);

} // namespace doublet
