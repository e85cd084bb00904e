#pragma once
// Invalid faces: those of the surfaces that close a scan where nobody saw it.

#include "doublet/core/mesh.h"

#include <cstdint>
#include <vector>

namespace doublet {

/// (F) face_valid, with 0 also for faces that share a corner with a closing surface and have a similar normal, within 53 degrees
/// of its mean. Where a garment touches a limb, the surface that closes its hem is easily marked too small, and what is left of
/// it welds the limb to the garment. Empty stays empty (all valid).
Mask extend_invalid_faces(const Mesh &mesh, const Mask &face_valid);

} // namespace doublet
