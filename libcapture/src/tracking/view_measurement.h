#pragma once
// One camera at one frame: image -> mask, outline, features; and features lifted onto a surface.

#include "doublet/capture/performance_capture.h"

namespace doublet {

struct ViewMeasurement {
  Image mask; ///< 255 = actor; empty = the view takes no part
  Outline outline;
  Features features;
  bool has_image = false;
  int height = 0;                  ///< px; of the actor's bounding box
  std::vector<Keypoint> keypoints; ///< kKeypoints, or none
  std::uint64_t fingerprint = 0;   ///< of image, mask and keypoints
};

ViewMeasurement measure_view(FrameSource &frames, int view, int frame, const Camera &camera, const SilhouetteExtractor *extractor,
                             const FeatureTracker *tracker);

/// Matches whose previous point lies on a valid face, not seen edge-on, of the surface at t-1. `visible` = rasterize() of it in
/// the camera.
std::vector<SurfaceTrack> lift_matches(const std::vector<FeatureMatch> &matches, int view, const Vertices &surface,
                                       const RiggedMesh &actor, const Camera &camera, const FaceBuffer &visible);

} // namespace doublet
