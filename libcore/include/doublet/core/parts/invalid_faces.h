#pragma once
// Invalid faces: those of the surfaces that close holes of a scan.

#include "doublet/core/mesh.h"

#include <cstdint>
#include <vector>

namespace doublet {

/// (F) face_valid, with 0 also for faces that share a corner with a closing surface and whose normal is within 53 degrees of its
/// mean normal. Where a garment touches a limb, the marked surface that closes the hem is often too small, and the unmarked rest
/// connects the limb with the garment. Empty stays empty (all valid).
Mask extend_invalid_faces(const Mesh &mesh, const Mask &face_valid);

} // namespace doublet
