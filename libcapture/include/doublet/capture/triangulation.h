#pragma once
// Where a point is that several cameras see, some of them wrongly.

#include "doublet/capture/calibration_file.h"

#include <optional>
#include <vector>

namespace doublet {

/// A point of the person as a program finds it in an image, such as a joint.
struct Keypoint {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero(); ///< in the image as it was filmed
  double confidence = 0;                           ///< in [0, 1]
  bool counts() const { return confidence >= 0.3 && pixel.allFinite(); }
};

/// The point (m) that the most cameras agree on to 2 % of their image's larger side, in least squares of pixels over these; none
/// if no two agree. Left and right are easily exchanged in a view from behind, so that no mean over all would do. `seen`: one of
/// each camera. Throws std::invalid_argument for another number, Error for an invalid camera.
std::optional<Eigen::Vector3d> triangulate(const std::vector<CalibratedCamera> &cameras, const std::vector<Keypoint> &seen);

} // namespace doublet
