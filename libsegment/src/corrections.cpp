#include "doublet/segment/corrections.h"

#include "surface_patches.h"

#include <stdexcept>
#include <string>

namespace doublet {

Segmentation apply_corrections(const Mesh &pose, const std::vector<std::uint8_t> &face_valid, const Segmentation &found,
                               const Eigen::VectorXi &painted) {
  require_usable(pose, "apply_corrections: first frame of the mesh sequence");
  const Eigen::Index n = pose.vertices.rows();
  require_segmentation(found, n, "apply_corrections");
  if (painted.size() != n)
    throw std::invalid_argument("apply_corrections: painted: expected " + std::to_string(n) + " entries, one per vertex, found " +
                                std::to_string(painted.size()));
  const detail::Surface surface = detail::surface_of(pose, face_valid);
  Segmentation result = found;
  std::vector<char> parting = detail::borders_of_regions(surface, found);
  for (Eigen::Index i = 0; i < n; ++i)
    switch (static_cast<CorrectionLabel>(painted[i])) {
    case CorrectionLabel::None:
      break;
    case CorrectionLabel::Skin:
    case CorrectionLabel::Cloth:
      result.clothness[i] = painted[i];
      if (result.probability.size() > 0)
        result.probability[i] = painted[i]; // who paints knows
      parting[i] = 0;                       // cloth that is painted over a seam joins what it parted
      break;
    case CorrectionLabel::Border:
      parting[i] = 1;
      break;
    default:
      throw std::invalid_argument(
          "apply_corrections: painted: expected -1 (as found), 0 (skin), 1 (cloth) or 2 (border), found " +
          std::to_string(painted[i]));
    }
  detail::label_regions(surface, parting, result);
  return result;
}

} // namespace doublet
