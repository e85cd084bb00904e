#pragma once

#include "doublet/capture/parts/pose_optimizer.h"
#include "doublet/core/image.h"

namespace doublet {

/// Where the actor stands in the first frame: the scan pose, moved and turned about the vertical so that its silhouettes cover
/// the measured ones. Translation so that the centroids of rendering and mask meet, rays intersected in least squares; of 24
/// headings the one with the best overlap. Front and back look alike: one of the half away from the scan's must be clearly
/// better. With fewer than two masks there is no place to find, and the scan's own is returned.
Eigen::VectorXd first_pose(const RiggedMesh &actor, const CameraRig &rig, const std::vector<Image> &masks,
                           const Context &context);

} // namespace doublet
