#pragma once
// One run through the frames of a take.

#include "camera_check.h"
#include "capture_checkpoint.h"
#include "frame_tracker.h"

#include <array>
#include <string>
#include <vector>

namespace doublet::detail {

inline int passes(const CaptureOptions &options) {
  return options.second_pass ? 2 : 1;
}

/// A frame is measured, tracked and taken in. What is known at a frame is what was measured at those before and what was taken
/// in, nothing else: a run goes on from a checkpoint by measuring its frames again and taking them in.
class Tracking {
public:
  Tracking(const TrackingJob &job, const Studio &studio, CaptureCheckpoint &checkpoint);
  /// What runs before this one have used.
  void go_on_after(const std::array<double, 6> &seconds, double progress, double reached);
  /// `known`: the first frames, out of the checkpoint. Throws OtherCapture if they are not of this capture, CamerasMoved if it is
  /// to be tracked again.
  CaptureResult run(std::vector<TrackedFrame> known);

private:
  int steps() const { return passes(job_.options) * job_.count; }
  double progress(int done) const;
  void report_progress();
  void make_room();
  std::string place() const;
  void begin(const std::vector<TrackedFrame> &known);
  void go_through(std::vector<TrackedFrame> known);
  void say_where_it_goes_on() const;
  ViewTiming timing_at(int t) const;
  void look_at_cameras(int step, std::vector<TrackedFrame> &known);
  void go_over(int t, const TrackedFrame &found, bool latest);
  void go_on(int t);
  void take(int t, const TrackedFrame &found);
  void count_joints_at(int t);
  void start_again();
  void turn_back();
  std::array<double, 6> seconds() const;
  void set_seconds(const std::array<double, 6> &seconds);
  void log(int t, double seconds_per_frame) const;

  TrackingJob job_;
  const Studio &studio_;
  CaptureCheckpoint &checkpoint_;
  CaptureResult result_;
  TrackingOrder order_;
  TakeMeasurements measured_;
  SurfaceMemory memory_;
  KeypointPlaces places_;
  SurfaceTracks tracks_;
  FrameTracker tracker_;
  ViewTiming timing_;     // of the frame at hand
  bool searched_ = false; // the pose of the start, as it is not the scan's
  struct AtStart {
    std::vector<ViewMeasurement> views;
    Vertices surface;
    std::vector<FaceBuffer> visible;
    Vertices offset;
  };
  AtStart at_start_; // what the way back begins with
  double began_;     // earlier runs included
  double progress_before_ = 0, reached_ = 0;
  int done_ = 0; // frames that are in the checkpoint, of all passes
};

/// Smooths poses and rest-pose offsets, T x (V, 3), over time and builds the final surfaces from both.
void smooth(const CaptureOptions &options, const RiggedMesh &actor, const std::vector<Vertices> &offsets, CaptureResult &result);

} // namespace doublet::detail
