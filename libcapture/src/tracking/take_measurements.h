#pragma once
// What the images show, frame by frame: masks, outlines, keypoints, features and their matches.

#include "packed_mask.h"
#include "seen_joints.h"
#include "tracked_frame.h"
#include "tracking_job.h"
#include "view_measurement.h"

#include <future>
#include <vector>

namespace doublet::detail {

std::vector<Image> masks_of(const std::vector<ViewMeasurement> &views);

/// Of all cameras at the frame at hand, and what is kept of those before for the second pass. Writes Observations.
class TakeMeasurements {
public:
  TakeMeasurements(const TrackingJob &job, const TrackingOrder &order, CaptureResult &result);

  /// All cameras at frame index t; nothing is kept.
  std::vector<ViewMeasurement> look(int t, const FeatureTracker *tracker);
  /// What look() has shown of the start, which is then not measured again.
  void have_start(std::vector<ViewMeasurement> views) { start_views_ = std::move(views); }
  void measure(int t, TrackedFrame &found);
  /// Of a frame that was tracked before. Its features are detected only if asked for. Throws OtherCapture if its images were
  /// others.
  void measure_again(int t, const TrackedFrame &found, bool with_features);
  /// What was measured at a frame is at hand again, but for its features.
  void recall(int t);
  /// Features at hand are those of `views`.
  void go_back_to(std::vector<ViewMeasurement> views) { latest_ = std::move(views); }

  const std::vector<Outline> &outlines() const { return outlines_; }
  const std::vector<Image> &masks() const { return masks_; }
  const SeenJoints &joints() const { return joints_; }
  const std::vector<ViewMeasurement> &latest() const { return latest_; }
  std::vector<Outline> outlines_at(int t) const;
  /// Of the frame before, tracked before, that is, with this one.
  std::vector<FeatureMatch> matches_at(int t, int view) const;

private:
  std::vector<Outline> traced(const std::vector<Image> &masks) const;
  std::vector<ViewMeasurement> all_views(int t, const FeatureTracker *tracker) const;
  void look_ahead(int t, const FeatureTracker *tracker);
  std::vector<ViewMeasurement> measure_next(int t, const FeatureTracker *tracker);
  std::vector<std::vector<FeatureMatch>> match(int t, const std::vector<ViewMeasurement> &current);
  void keep(int t, std::vector<ViewMeasurement> current, const std::vector<std::vector<FeatureMatch>> &matches);
  void observe(int t, int view, const std::vector<FeatureMatch> &matches);

  const TrackingJob &job_;
  const TrackingOrder &order_;
  CaptureResult &result_;
  std::vector<ViewMeasurement> start_views_;
  std::future<std::vector<ViewMeasurement>> ahead_; // of the frame after the latest, beside whose tracking it is measured
  int ahead_t_ = -1;
  const FeatureTracker *ahead_tracker_ = nullptr;
  std::vector<std::vector<ViewMeasurement>> stretch_; // frames read ahead on the way back; the next is the last
  const FeatureTracker *stretch_tracker_ = nullptr;
  std::vector<ViewMeasurement> latest_; // features of the latest frame
  std::vector<Outline> outlines_;
  std::vector<Image> masks_;
  SeenJoints joints_;
  std::vector<std::vector<PackedMask>> kept_; // [frames][cameras] masks: an outline has ten times the bytes and is traced again
  std::vector<SeenJoints> kept_joints_;       // [frames]
};

} // namespace doublet::detail
