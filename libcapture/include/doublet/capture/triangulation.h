#pragma once
// Where a point is that several cameras see, some of them wrongly.

#include "doublet/capture/calibration_file.h"
#include "doublet/capture/keypoints.h"

#include <optional>
#include <vector>

namespace doublet {

/// The point (m) that the most cameras agree on to 2 % of their image's larger side, in least squares of pixels over these; none
/// if no two agree. Left and right are easily exchanged in a view from behind, so that no mean over all would do. `seen`: one of
/// each camera, in its image as it was filmed. Throws std::invalid_argument for another number, Error for an invalid camera.
std::optional<Eigen::Vector3d> triangulate(const std::vector<CalibratedCamera> &cameras, const std::vector<Keypoint> &seen);

} // namespace doublet
