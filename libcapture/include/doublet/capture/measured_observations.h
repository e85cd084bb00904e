#pragma once
// The 2D observations of a take without tracking it, for trackers that replace the whole capture: the material fit needs them.

#include "doublet/capture/feature_tracker.h"
#include "doublet/capture/session.h"
#include "doublet/capture/silhouette_extractor.h"
#include "doublet/core/context.h"

namespace doublet {

/// The outlines of the frames `numbers` (ascending; empty = all frames), and the feature matches of each with the previous frame
/// in the list, as PerformanceCapture::capture measures them. `extractor`: trained, for frames without a ready mask. `tracker`:
/// null = only outlines are measured. Throws Error if an image does not have its camera's size, has neither mask nor extractor,
/// or no camera shows the actor in a frame; std::invalid_argument if frames and rig do not fit together; Cancelled.
Observations measure_observations(const CameraRig &rig, FrameSource &frames, const SilhouetteExtractor *extractor,
                                  std::vector<int> numbers, const FeatureTracker *tracker,
                                  const FeatureTrackerOptions &options = {}, const Context &context = {});

} // namespace doublet
