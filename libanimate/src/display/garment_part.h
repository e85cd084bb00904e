#pragma once
// The garment's part of M and of M_high.

#include "doublet/animate/character.h"
#include "loop_subdivision.h"

namespace doublet::detail {

/// The garment of an actor, if it has a mesh of its own (`clothness` has a rest shape); else nothing.
struct Worn {
  std::vector<int> faces, vertices; ///< of M
  Mesh mesh;
};
Worn worn_garment(const RiggedMesh &actor, const Segmentation &segmentation);

/// M_high of a character in such a garment: the skin first, then the garment's mesh, subdivided.
struct GarmentPart {
  Worn garment;
  Subdivision fine;
  Eigen::Index skin_vertices = 0, skin_faces = 0;
};
/// Throws Error if M_high does not end in the garment as often subdivided as the character says.
GarmentPart garment_part(const Character &character);

/// Both, the second's vertices behind the first's.
Mesh joined(const Mesh &first, const Mesh &second);

} // namespace doublet::detail
