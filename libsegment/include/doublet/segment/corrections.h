#pragma once
// What a person says against what was found.

#include "doublet/core/stage_values.h"

namespace doublet {

/// What a vertex was painted with.
enum class Paint {
  None = -1, ///< as it was found
  Skin = 0,
  Cloth = 1,
  Seam = 2, ///< as it was found, but regions do not connect through it: here one garment ends and another begins
};

/// `found` with the corrections `painted` (V, a Paint each): clothness 0 and 1 where skin and cloth were painted, and the regions
/// that follow. Cloth under a seam goes with the region nearest along the cloth. The fullness is left empty: it is to be estimated
/// again. Throws std::invalid_argument if lengths disagree or a value is no Paint.
Segmentation corrected_segmentation(const RiggedMesh &actor, const Segmentation &found, const Eigen::VectorXi &painted);

} // namespace doublet
