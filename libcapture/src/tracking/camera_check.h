#pragma once
// Do the given cameras fit what was tracked with them?

#include "cloth_deviation.h"
#include "take_measurements.h"

#include <array>
#include <vector>

namespace doublet::detail {

constexpr int kMostMoves = 4; // of the cameras, each of which begins all again

/// The cameras that a run goes by.
struct Studio {
  CameraRig given, rig;
  std::vector<int> delays;          ///< whole frames, which the frames have made good
  Eigen::VectorXd parts;            ///< (views) of a frame by which cameras are late besides; empty if none is
  int refined = 0;                  ///< how often
  bool moved = false;               ///< in one of these times, not only waited for
  bool by_take = false;             ///< one of these times by the whole take, which knows more than its first frame
  std::vector<RefinedCamera> found; ///< the last look at them
};

/// The cameras turned out to be others: all is to be tracked again, with them.
struct CamerasMoved {
  CalibrationEstimate found;
  bool late_alone;                 ///< they stay where they are
  bool by_take;                    ///< not by the first frame
  std::vector<TrackedFrame> known; ///< out of the checkpoint, of the run to come
  std::array<double, 6> seconds;   ///< so far, as TrackedFrame::seconds
  double progress, reached;        ///< that of the frames that led to this; what has been reported
};

/// What the cameras are estimated by. Looked at during a call.
struct CameraEvidence {
  const TrackingJob &job;
  const TrackingOrder &order;
  const Studio &studio;
  const TakeMeasurements &measured;
  const SurfaceMemory &memory;
  const MatrixRM &poses; ///< (T, D)
  bool start_searched;   ///< the start is not in the scan's pose
};

/// By the first frame, which is in the scan's pose.
CalibrationEstimate cameras_by_start(const CameraEvidence &evidence);
/// By frames of the whole take. Delays first: while cameras show different times, what is loose is not known, and skin is taken
/// for as firm as before anything was seen. Only then what is off besides.
CalibrationEstimate cameras_by_take(const CameraEvidence &evidence);
/// Is one of them late by half a frame or more?
bool delayed(const CalibrationEstimate &found);
/// (views) what is left of the delays beside whole frames, where that is beyond doubt; empty if it is nowhere.
Eigen::VectorXd parts_of_a_frame(const CalibrationEstimate &found);
/// Are these others than those that all was tracked with?
bool timed_otherwise(const CalibrationEstimate &found, const Studio &studio);
/// A calibration that was mended once is not taken at its word any more: a smaller move will do.
bool clearly_off(const CalibrationEstimate &found, const Studio &studio, double min_change);
/// The cameras as they turned out to be, with what the log says of it.
void move_cameras(Studio &studio, const CamerasMoved &moved, const Context &context);

} // namespace doublet::detail
