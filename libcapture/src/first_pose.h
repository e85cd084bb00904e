#pragma once

#include "doublet/capture/pose_optimizer.h"

namespace doublet {

/// Where the actor stands in the first frame: the scan pose, moved and turned about the vertical so that its silhouettes cover
/// the measured ones. Translation from the masks' centroids, rays intersected in least squares; of 12 headings the one with the
/// best overlap, the scan's own unless another is clearly better.
Eigen::VectorXd first_pose(const RiggedMesh &actor, const CameraRig &rig, const std::vector<Outline> &outlines,
                           const std::vector<Image> &masks, const Context &context);

} // namespace doublet
