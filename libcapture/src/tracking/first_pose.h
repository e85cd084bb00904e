#pragma once

#include "doublet/capture/pose_optimizer.h"
#include "doublet/core/image.h"

namespace doublet {

/// The scan pose, moved and turned about the vertical.
struct PlacedPose {
  Eigen::VectorXd dofs; ///< (D) zero but for the root
  double overlap = 0;   ///< of its silhouettes with the measured ones, mean over the cameras that show the actor
};

/// The joint with 6 degrees of freedom. Throws Error if there is none.
const Joint &root_joint(const Skeleton &skeleton);

/// Where the actor stands in the first frame: the scan pose, moved and turned about the vertical so that its silhouettes cover
/// the measured ones. Translation so that the centroids of rendering and mask meet, rays intersected in least squares; of 24
/// headings the one with the best overlap. Front and back look alike: one of the half away from the scan's must be clearly
/// better. With fewer than two masks there is no place to find, and the scan's own is returned, with no overlap.
PlacedPose first_pose(const RiggedMesh &actor, const CameraRig &rig, const std::vector<Image> &masks, const Context &context);

/// The same, a tenth as long: fewer headings and pixels, less exact.
PlacedPose rough_first_pose(const RiggedMesh &actor, const CameraRig &rig, const std::vector<Image> &masks,
                            const Context &context);

/// The scan pose moved to the masks at each of `headings`, the scan's own first; none with fewer than two masks.
std::vector<PlacedPose> placed_all_around(const RiggedMesh &actor, const CameraRig &rig, const std::vector<Image> &masks,
                                          int headings, const Context &context);

} // namespace doublet
