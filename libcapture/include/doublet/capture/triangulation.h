#pragma once
// Robust triangulation of a point that several cameras see, some of them wrongly.

#include "doublet/capture/calibration_file.h"
#include "doublet/capture/keypoints.h"

#include <optional>
#include <vector>

namespace doublet {

/// The point (m) on which the largest set of cameras agrees to within 2 % of the larger image side, by least squares of pixels
/// over these cameras; none if no two agree. Detectors easily swap left and right in a view from behind, so that a mean over all
/// cameras would be wrong. `seen`: one per camera, in its original (distorted) image. Throws std::invalid_argument for another
/// number of points, Error for an invalid camera.
std::optional<Eigen::Vector3d> triangulate(const std::vector<CalibratedCamera> &cameras, const std::vector<Keypoint> &seen);

} // namespace doublet
