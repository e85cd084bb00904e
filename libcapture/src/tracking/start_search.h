#pragma once
// Where tracking begins when the take does not begin in the scan's pose.

#include "first_pose.h"

#include "doublet/capture/performance_capture.h"

namespace doublet {

/// A frame, and the scan pose placed in it.
struct LikelyStart {
  int frame = 0; ///< of the frame source
  PlacedPose placed;
};

/// The frames that look most like the scan, moved and turned about the vertical, best first: `most` at most, and no two that
/// stand for the same moment. Of `first` to `first` + `count` - 1, in order and coarsely, then around the best ones. None where
/// fewer than two cameras show the actor.
std::vector<LikelyStart> frames_like_the_scan(const RiggedMesh &actor, const CameraRig &rig, FrameSource &frames,
                                              const SilhouetteExtractor *extractor, int first, int count, int most,
                                              const Context &context);

/// A pose that was found without knowing one before it.
struct FoundPose {
  Eigen::VectorXd dofs; ///< (D)
  double wrong = 1;     ///< overlap_energy(): wrong pixels against those of the actor
  double rival = 1;     ///< the same of the best pose found that faces the other way
};

/// One frame, nothing else being known. Arrays over views as in PoseProblem and LimbProblem.
struct StartProblem {
  const RiggedMesh *actor = nullptr;
  const CameraRig *rig = nullptr;
  const std::vector<Outline> *outlines = nullptr;
  const std::vector<Image> *masks = nullptr;
  Eigen::VectorXd reliability; ///< (V)
  std::vector<SeenPoint> points = {};
};

/// The scan pose at headings all around, each optimised, its lost limbs sought (Gall et al. 2009) and optimised again: the one
/// whose silhouettes are wrong in the fewest pixels. Throws std::invalid_argument with fewer than two masks.
FoundPose search_pose(const StartProblem &problem, PoseOptimizer &optimizer, LimbSearch &search, const LimbSearchOptions &options,
                      const Context &context);

} // namespace doublet
