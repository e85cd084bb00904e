#pragma once
// Corrections of a segmentation by hand.

#include "doublet/core/stage_values.h"

#include <cstdint>
#include <utility>
#include <vector>

namespace doublet {

/// A correction of one vertex.
enum class CorrectionLabel {
  None = -1, ///< as it was found
  Skin = 0,
  Cloth = 1,
  Border = 2, ///< as it was found, but regions do not connect through it: here one garment ends and another begins
};

/// `found` with the corrections `painted` (V, a CorrectionLabel each): clothness 0 and 1 where skin and cloth were painted, and
/// the regions that follow. Cloth under a border goes with the region nearest along the cloth. pose: the first frame, as it was
/// segmented. Throws std::invalid_argument if lengths disagree or a value is no CorrectionLabel, Error on an unusable mesh.
Segmentation apply_corrections(const Mesh &pose, const Mask &face_valid, const Segmentation &found,
                               const Eigen::VectorXi &painted);

// Deprecated names.
template <class... A> [[deprecated("use apply_corrections")]] decltype(auto) corrected_segmentation(A &&...a) {
  return apply_corrections(std::forward<A>(a)...);
}
using Paint [[deprecated("use CorrectionLabel")]] = CorrectionLabel;

} // namespace doublet
