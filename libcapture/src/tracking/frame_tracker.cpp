#include "frame_tracker.h"

#include <algorithm>
#include <utility>

namespace doublet::detail {
namespace {

void say_lost(const TrackingJob &job, const LostLimb &lost) {
  job.say("frame %d, limb '%s' lost (%.1f cm off), %s (%.1f cm)", lost.frame, lost.limb.c_str(), 100 * lost.before,
          lost.recovered ? "found again" : "not found", 100 * lost.after);
}

} // namespace

FrameTracker::FrameTracker(const TrackingJob &job, const TrackingOrder &order, const TakeMeasurements &measured,
                           const SurfaceMemory &memory, const KeypointPlaces &places, SurfaceTracks &tracks,
                           CaptureResult &result)
    : job_(job), order_(order), measured_(measured), memory_(memory), places_(places), tracks_(tracks), result_(result),
      limbs_(find_limbs(job.actor.skeleton)), forwards_(forwards_only(job.actor)) {
  forget_limbs();
}

void FrameTracker::forget_limbs() {
  const std::vector<int> none(limbs_.size(), 0);
  record_ = {none, none, std::vector<int>(job_.actor.skeleton.dof_count(), 0)};
}

void FrameTracker::track(int t, const ViewTiming &timing, TrackedFrame &found) {
  find_pose(t, timing, found);
  refine(t, timing, found);
}

void FrameTracker::find_pose(int t, const ViewTiming &timing, TrackedFrame &found) {
  PoseProblem problem;
  problem.actor = &job_.actor;
  problem.rig = &job_.rig;
  problem.outlines = &measured_.outlines();
  problem.offset = memory_.expected();
  problem.reliability = memory_.reliability();
  problem.timing = timing;
  problem.first = t == order_.start && !order_.again;
  problem.predicted = problem.first ? start_pose_ : predict(t);
  problem.start = problem.predicted;
  tracks_.lift(t);
  problem.tracks = tracks_.find(problem.predicted, memory_.expected(), t);
  PoseEstimate estimate;
  {
    const Stopwatch watch(result_.summary.pose_seconds);
    estimate = optimize(problem, t);
    problem.points = places_.points(measured_.joints());
    estimate = by_keypoints(problem, std::move(estimate), t);
  }
  found.limbs = record_;
  if (job_.options.find_lost_limbs)
    recover_limbs(problem, estimate, t, found);
  found.dofs = estimate.dofs;
  found.rim_px = estimate.rim_px;
  found.sift_px = estimate.sift_px;
}

/// Where keypoints show joints elsewhere, the pose is sought again from there, and taken if it is clearly better: silhouettes
/// decide where they tell a limb, for keypoints may be wrong by one; keypoints where they do not, as before the trunk.
PoseEstimate FrameTracker::by_keypoints(const PoseProblem &problem, PoseEstimate estimate, int t) {
  constexpr double kClearly = 0.003; // of the actor's pixels
  const Transforms world_from_rest = forward_kinematics(job_.actor.skeleton, estimate.dofs);
  const auto elsewhere = [&](const SeenPoint &point) { return point.beyond(world_from_rest[point.joint] * point.rest) > 0; };
  if (std::none_of(problem.points.begin(), problem.points.end(), elsewhere))
    return estimate;
  const LimbProblem limbs = limb_problem(problem);
  const auto energy = [&](const PoseEstimate &of) { return overlap_energy(limbs, of.dofs, job_.options.limbs, job_.context); };
  const std::vector<Outline> nothing(job_.rig.size());
  PoseProblem there = problem, again = problem;
  there.outlines = &nothing;
  there.tracks.clear();
  again.start = again.predicted = optimize(there, t).dofs;
  again.tracks = tracks_.find(again.start, memory_.expected(), t);
  const PoseEstimate other = optimize(again, t);
  return energy(other) < energy(estimate) - kClearly ? other : estimate;
}

LimbProblem FrameTracker::limb_problem(const PoseProblem &problem) const {
  return {&job_.actor, &job_.rig, &measured_.masks(), memory_.expected(), problem.reliability, problem.predicted, problem.points};
}

PoseEstimate FrameTracker::optimize(const PoseProblem &problem, int t) {
  PoseEstimate estimate = job_.parts.pose->optimize(problem, job_.context);
  require_pose(estimate.dofs, "pose optimizer", t);
  return estimate;
}

void FrameTracker::require_pose(const Eigen::VectorXd &dofs, const std::string &piece, int t) const {
  if (dofs.size() != job_.actor.skeleton.dof_count() || !dofs.allFinite())
    throw Error("capture: the " + piece + " returned " + std::to_string(dofs.size()) + " values at frame " +
                std::to_string(job_.frame(t)) + ", expected " + std::to_string(job_.actor.skeleton.dof_count()) + " finite ones");
}

/// Limbs with too large an error are sought globally and optimised again, and so are those that bend backwards: an arm whose
/// elbow went to the wrong side of a straight one overlaps nearly as well for a while, and then its surface passes for loose.
/// What is sought bends forwards; the pose that overlaps better is kept. A limb that was not found is sought again after a wait
/// that grows with every miss: a mask may hold something that is no limb.
void FrameTracker::recover_limbs(const PoseProblem &problem, PoseEstimate &estimate, int t, TrackedFrame &found) {
  constexpr int kLongestWait = 10; // frames
  const Stopwatch watch(result_.summary.limb_seconds);
  auto &[misses, next_search, steady_since] = found.limbs;
  const LimbProblem limbs = limb_problem(problem);
  const Eigen::VectorXd before = limb_errors(limbs, estimate.dofs, limbs_, job_.options.limbs, job_.context);
  const auto doubtful = [&](size_t l, const Eigen::VectorXd &errors) {
    return errors[l] > job_.options.limbs.lost_error || bends_backwards(job_.actor.skeleton, limbs_[l], estimate.dofs);
  };
  std::vector<Limb> sought;
  for (size_t l = 0; l < limbs_.size(); ++l)
    if (doubtful(l, before) && order_.age(t) >= next_search[l])
      sought.push_back(limbs_[l]);
  Eigen::VectorXd after = before;
  if (!sought.empty()) {
    PoseProblem again = problem;
    LimbProblem there = limbs;
    again.actor = there.actor = &forwards_;
    there.predicted = there.predicted.cwiseMax(forwards_.skeleton.lower);
    again.start = job_.parts.limbs->search(there, estimate.dofs, sought, job_.context);
    require_pose(again.start, "limb search", t);
    for (const Limb &limb : sought)
      again.predicted(limb.dofs) = again.start(limb.dofs);
    again.tracks = tracks_.find(again.start, memory_.expected(), t);
    const PoseEstimate other = optimize(again, t);
    if (overlap_energy(limbs, other.dofs, job_.options.limbs, job_.context) <
        overlap_energy(limbs, estimate.dofs, job_.options.limbs, job_.context)) {
      estimate = other;
      after = limb_errors(limbs, estimate.dofs, limbs_, job_.options.limbs, job_.context);
      for (const Limb &limb : sought)
        for (int d : limb.dofs)
          steady_since[d] = order_.age(t);
    }
  }
  for (size_t l = 0; l < limbs_.size(); ++l) {
    const bool lost = after[l] > job_.options.limbs.lost_error, searched = order_.age(t) >= next_search[l];
    if (!doubtful(l, after))
      misses[l] = 0;
    else if (searched)
      next_search[l] = order_.age(t) + std::min(++misses[l], kLongestWait);
    if (before[l] > job_.options.limbs.lost_error) {
      found.lost.push_back({job_.frame(t), limbs_[l].name, before[l], after[l], !lost});
      if (searched)
        say_lost(job_, found.lost.back());
    }
  }
}

/// From the last three frames: damped velocity and a share of its change; both only since the limb was last found again.
Eigen::VectorXd FrameTracker::predict(int t) const {
  const MatrixRM &x = result_.performance.dofs;
  const int a = t == order_.start ? t : order_.before(t, 1), b = order_.before(t, 2), c = order_.before(t, 3);
  Eigen::VectorXd prediction = x.row(a);
  for (int d = 0; d < prediction.size(); ++d) {
    if (order_.age(t) - 2 >= record_.steady_since[d])
      prediction[d] += job_.options.velocity_damping * (x(a, d) - x(b, d));
    if (order_.age(t) - 3 >= record_.steady_since[d])
      prediction[d] += job_.options.acceleration * (x(a, d) - 2 * x(b, d) + x(c, d));
  }
  return prediction.cwiseMax(job_.actor.skeleton.lower).cwiseMin(job_.actor.skeleton.upper);
}

void FrameTracker::refine(int t, const ViewTiming &timing, TrackedFrame &found) {
  SurfaceProblem problem;
  problem.actor = &job_.actor;
  problem.rig = &job_.rig;
  problem.outlines = &measured_.outlines();
  problem.tracks = tracks_.find(found.dofs, memory_.expected(), t);
  track_count_ = static_cast<int>(problem.tracks.size());
  if (!order_.again)
    found.mapped = tracks_.mapped(problem.tracks);
  const Stopwatch watch(result_.summary.surface_seconds);
  problem.base = pose_surface(job_.actor, found.dofs, memory_.expected()).vertices;
  problem.skinned = pose_surface(job_.actor, found.dofs, {}).vertices;
  problem.reliability = memory_.reliability();
  problem.timing = timing;
  found.surface = job_.parts.surface->refine(problem, job_.context).vertices;
  if (found.surface.rows() != problem.skinned.rows() || !found.surface.allFinite())
    throw Error("capture: the surface refiner returned " + std::to_string(found.surface.rows()) + " vertices at frame " +
                std::to_string(job_.frame(t)) + ", expected " + std::to_string(problem.skinned.rows()) + " finite ones");
}

} // namespace doublet::detail
