#pragma once
// One frame: its pose, the limbs that were lost in it, its surface.

#include "backward_hinges.h"
#include "cloth_deviation.h"
#include "surface_tracks.h"

#include <string>
#include <vector>

namespace doublet::detail {

class FrameTracker {
public:
  /// `result`: poses of the frames before, and seconds.
  FrameTracker(const TrackingJob &job, const TrackingOrder &order, const TakeMeasurements &measured, const SurfaceMemory &memory,
               const KeypointPlaces &places, SurfaceTracks &tracks, CaptureResult &result);
  /// The pose that the search at the start begins with.
  void begin_with(Eigen::VectorXd dofs) { start_pose_ = std::move(dofs); }
  /// Pose, limbs, residuals, surface and mapped features of frame index t.
  void track(int t, const ViewTiming &timing, TrackedFrame &found);
  /// Where the limbs stand after a frame; of those after it depends when they are sought again.
  void take(const LimbRecord &limbs) { record_ = limbs; }
  /// Nothing is known of limbs, as at the start.
  void forget_limbs();
  const std::vector<Limb> &limbs() const { return limbs_; }
  int track_count() const { return track_count_; } ///< features that the surface at hand was refined by

private:
  void find_pose(int t, const ViewTiming &timing, TrackedFrame &found);
  void refine(int t, const ViewTiming &timing, TrackedFrame &found);
  PoseEstimate optimize(const PoseProblem &problem, int t);
  PoseEstimate by_keypoints(const PoseProblem &problem, PoseEstimate estimate, int t);
  void require_pose(const Eigen::VectorXd &dofs, const std::string &piece, int t) const;
  void recover_limbs(const PoseProblem &problem, PoseEstimate &estimate, int t, TrackedFrame &found);
  LimbProblem limb_problem(const PoseProblem &problem) const;
  Eigen::VectorXd predict(int t) const;

  const TrackingJob &job_;
  const TrackingOrder &order_;
  const TakeMeasurements &measured_;
  const SurfaceMemory &memory_;
  const KeypointPlaces &places_;
  SurfaceTracks &tracks_;
  CaptureResult &result_;
  std::vector<Limb> limbs_;
  RiggedMesh forwards_; // the actor, with elbows and knees that bend forwards only
  LimbRecord record_;
  Eigen::VectorXd start_pose_;
  int track_count_ = 0;
};

} // namespace doublet::detail
