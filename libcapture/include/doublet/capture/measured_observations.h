#pragma once
// The 2D observations of a take without tracking it: what a tracker of one's own, which replaces the whole capture, owes the fit.

#include "doublet/capture/feature_tracker.h"
#include "doublet/capture/session.h"
#include "doublet/capture/silhouette_extractor.h"
#include "doublet/core/context.h"

namespace doublet {

/// The outlines of the frames `numbers`, rising, and the features of each matched with the frame of the list before it, as
/// PerformanceCapture::capture measures them. No numbers: the whole film. `extractor`, trained, is for frames without a ready
/// mask; `tracker` null: none but outlines are measured. Throws Error if an image does not have its camera's size, has neither
/// mask nor extractor, or a frame shows the actor in no camera; std::invalid_argument if frames and rig do not go together;
/// Cancelled.
Observations measure_observations(const CameraRig &rig, FrameSource &frames, const SilhouetteExtractor *extractor,
                                  std::vector<int> numbers, const FeatureTracker *tracker,
                                  const FeatureTrackerOptions &options = {}, const Context &context = {});

} // namespace doublet
