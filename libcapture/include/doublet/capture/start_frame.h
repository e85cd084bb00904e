#pragma once
// The frame in which a take is most similar to the scan: tracking begins there.

#include "doublet/capture/session.h"
#include "doublet/capture/silhouette_extractor.h"
#include "doublet/core/context.h"
#include "doublet/core/mesh.h"

namespace doublet {

/// Overlaps (IoU) of the silhouettes of the scan, moved and turned about the vertical, with the measured ones from which a frame
/// counts as in the scan's pose, and as near it: scans reach 0.9 and more in their own pose, 0.5 to 0.6 in others. Below the
/// second, the pose of a frame is not searched.
inline constexpr double kScanPoseOverlap = 0.8, kNearScanPose = 0.4;

struct StartFrame {
  int frame = 0;      ///< of the frame source
  double overlap = 0; ///< IoU of the silhouettes with those of the scan placed there, mean over the cameras that show the actor
  double first_overlap = 0; ///< the same in frame 0
  bool in_scan_pose() const { return overlap >= kScanPoseOverlap; }
  bool near_scan_pose() const { return overlap >= kNearScanPose; }
  Eigen::Isometry3d world_from_scan = Eigen::Isometry3d::Identity(); ///< where the scan is placed: moved, and turned about +Y
};

/// Frame 0 if it is in the scan's pose, otherwise the frame that comes nearest. PerformanceCapture chooses in the same way, with
/// the template. `scan` in metres, standing along +Y; holes do not matter. The overlap is 0 where fewer than two cameras show the
/// actor. Throws Error if the scan is not a usable mesh (see MeshReport), std::invalid_argument if frames and rig do not fit
/// together.
StartFrame find_start_frame(const Mesh &scan, const CameraRig &rig, FrameSource &frames, const SilhouetteExtractor *extractor,
                            const Context &context);

} // namespace doublet
