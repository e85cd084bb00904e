#include "tracking.h"

#include "doublet/capture/parts/smoothing.h"
#include "joint_visibility.h"
#include "start_pose.h"

#include <algorithm>
#include <tuple>
#include <utility>

namespace doublet::detail {

Tracking::Tracking(const TrackingJob &job, const Studio &studio, CaptureCheckpoint &checkpoint)
    : job_(job), studio_(studio), checkpoint_(checkpoint), order_{job.count}, measured_(job_, order_, result_),
      memory_(job.actor, job.options.cloth_deviation_scale, job.options.offset_decay, job.count),
      places_(job.actor.skeleton, job.options.keypoint_tolerance), tracks_(job_, order_, measured_, result_.summary),
      tracker_(job_, order_, measured_, memory_, places_, tracks_, result_), began_(now()) {
  make_room();
}

void Tracking::make_room() {
  const ViewObservation nothing;
  const std::vector<ViewObservation> of_all_views(job_.rig.size(), nothing);
  result_.performance.surface.faces = job_.actor.mesh.faces;
  result_.performance.dofs.resize(job_.count, job_.actor.skeleton.dof_count());
  result_.observations.cameras = job_.rig;
  result_.observations.views.assign(job_.count, of_all_views);
  for (int t = 0; t < job_.count; ++t)
    result_.performance.frames.push_back(job_.frame(t));
  result_.observations.frames = result_.performance.frames;
  CaptureSummary &summary = result_.summary;
  for (std::vector<double> *of_frames : {&summary.rim_px, &summary.sift_px, &summary.keypoint_distance, &summary.silhouette_iou})
    of_frames->assign(job_.count, 0);
  summary.views.assign(job_.count, 0);
  summary.cameras = studio_.found;
  for (const Joint &joint : job_.actor.skeleton.joints)
    if (joint.dof_count > 0)
      summary.joints.push_back({joint.name});
}

void Tracking::go_on_after(const std::array<double, 6> &seconds, double progress, double reached) {
  set_seconds(seconds);
  progress_before_ = progress;
  reached_ = reached;
}

CaptureResult Tracking::run(std::vector<TrackedFrame> known) {
  if (!job_.options.use_sift)
    job_.context.log_line("capture: silhouettes alone, no texture features");
  done_ = static_cast<int>(known.size());
  try {
    report_progress();
    begin(known);
    go_through(std::move(known));
    std::stable_sort(result_.summary.lost_limbs.begin(), result_.summary.lost_limbs.end(),
                     [](const LostLimb &a, const LostLimb &b) { return a.frame < b.frame; });
    say_what_was_hidden(result_.summary.joints, job_.context);
    smooth(job_.options, job_.actor, memory_.offsets(), result_);
    result_.summary.seconds_per_frame = seconds().back() / job_.count;
    job_.context.report_progress("capture", 1);
  } catch (const OtherCapture &) {
    throw;
  } catch (const CamerasMoved &) {
    throw;
  } catch (...) {
    if (checkpoint_.used())
      job_.context.log_line("capture: stopped; " + checkpoint_.path().string() + " goes on " + place());
    throw;
  }
  return std::move(result_);
}

double Tracking::progress(int done) const {
  return progress_before_ + (1 - progress_before_) * std::min(1.0, static_cast<double>(done) / steps());
}

/// Never less than before, though frames out of a checkpoint may be of runs to come.
void Tracking::report_progress() {
  reached_ = std::max(reached_, progress(done_));
  job_.context.report_progress("capture", reached_);
}

/// Where a run goes on, in words.
std::string Tracking::place() const {
  if (done_ >= steps())
    return "after the last frame";
  return "at frame " + std::to_string(job_.frame(order_.at(done_))) + (done_ < job_.count ? "" : " of the second pass");
}

void Tracking::say_where_it_goes_on() const {
  job_.context.log_line("capture: " + checkpoint_.path().string() + " goes on " + place());
}

/// Where the checkpoint began, or where the take is best begun.
void Tracking::begin(const std::vector<TrackedFrame> &known) {
  if (!known.empty()) {
    if (known.front().frame < 0 || known.front().frame >= job_.count)
      throw OtherCapture("is damaged");
    order_.start = known.front().frame;
    searched_ = known.front().searched;
  } else {
    StartPose start = find_start_pose(job_, measured_, memory_.reliability(), places_, result_.summary.pose_seconds);
    order_.start = start.t;
    searched_ = start.searched;
    measured_.have_start(std::move(start.views));
    tracker_.begin_with(std::move(start.dofs));
  }
  result_.summary.start_frame = job_.frame(order_.start);
}

void Tracking::go_through(std::vector<TrackedFrame> known) {
  const int known_count = std::min(done_, steps());
  for (int step = 0; step < steps(); ++step) {
    const int t = order_.at(step);
    if (step == job_.count)
      start_again();
    if (t == order_.start - 1)
      turn_back();
    if (step == known_count && known_count > 0)
      say_where_it_goes_on();
    if (step < known_count)
      go_over(t, std::exchange(known[step], {}), step + 1 == known_count);
    else
      go_on(t);
    if (step == 0 || step + 1 == job_.count)
      look_at_cameras(step, known);
  }
  if (known_count == steps())
    say_where_it_goes_on();
}

/// After the first frame, if it is in the scan's pose, by that; after the first pass by frames of the whole take. Throws
/// CamerasMoved if the given cameras are clearly off: nothing that was found by them is kept.
void Tracking::look_at_cameras(int step, std::vector<TrackedFrame> &known) {
  const bool by_start = step == 0 && job_.count > 1;
  if (!job_.options.refine_cameras || studio_.refined >= kMostMoves || (by_start && (searched_ || studio_.by_take)))
    return;
  const CameraEvidence evidence{job_, order_, studio_, measured_, memory_, result_.performance.dofs, searched_};
  const CalibrationEstimate found = by_start ? cameras_by_start(evidence) : cameras_by_take(evidence);
  result_.summary.cameras = found.cameras;
  for (size_t v = 0; v < job_.rig.size(); ++v) {
    result_.summary.cameras[v].late += studio_.delays[v];
    result_.summary.cameras[v].delay = studio_.delays[v];
  }
  job_.say(by_start ? "cameras by the first frame: %.2f mm off on the actor, sure to %.2f mm, outlines %.2f px before, %.2f after"
                    : "cameras by the take: %.2f mm off on the actor, sure to %.2f mm, outlines %.2f px before, %.2f after",
           1000 * found.change, 1000 * found.sure, found.before_px, found.after_px);
  const bool late = delayed(found) || (!by_start && timed_otherwise(found, studio_));
  if (!late && !clearly_off(found, studio_, job_.options.calibration.min_change))
    return;
  const size_t of_this_run = std::min(known.size(), static_cast<size_t>(step) + 1);
  known.erase(known.begin(), known.begin() + static_cast<long>(of_this_run));
  throw CamerasMoved{found, late, !by_start, std::move(known), seconds(), progress(step + 1), reached_};
}

/// A frame that was tracked before. Its features are detected only where they are still needed: in the start for the map and for
/// the way back, in the `latest` one for the matches of the next.
void Tracking::go_over(int t, const TrackedFrame &found, bool latest) {
  job_.context.throw_if_cancelled();
  if (found.frame != t || !fits(found, job_.actor, job_.rig.size(), tracker_.limbs().size(), !order_.again))
    throw OtherCapture("is damaged");
  if (order_.again)
    measured_.recall(t);
  else
    measured_.measure_again(t, found, t == order_.start || latest);
  timing_ = timing_at(t);
  take(t, found);
  set_seconds(found.seconds);
}

void Tracking::go_on(int t) {
  report_progress();
  TrackedFrame found;
  found.frame = t;
  found.searched = t == order_.start && searched_;
  if (order_.again)
    measured_.recall(t);
  else
    measured_.measure(t, found);
  timing_ = timing_at(t);
  tracker_.track(t, timing_, found);
  take(t, found);
  found.seconds = seconds();
  checkpoint_.append(found);
  ++done_;
  if (t % 20 == 0 || t + 1 == job_.count)
    log(t, seconds().back() / done_);
}

/// How the surface moves: in the second pass from the frame before to the one after, as either pass has it; in the first from the
/// last frame but one to the last.
ViewTiming Tracking::timing_at(int t) const {
  if (studio_.parts.size() == 0)
    return {};
  int from = order_.again ? std::max(t - 1, 0) : order_.before(t, 2),
      to = order_.again ? std::min(t + 1, job_.count - 1) : order_.before(t, 1);
  if (!order_.again && order_.age(t) < 2)
    from = to = order_.start;
  const auto surface_at = [&](int s) -> Vertices {
    return pose_surface(job_.actor, result_.performance.dofs.row(s), memory_.offsets()[s]).vertices;
  };
  if (from == to)
    return {studio_.parts, Vertices::Zero(job_.actor.mesh.vertices.rows(), 3)};
  return {studio_.parts, (surface_at(to) - surface_at(from)) / (to - from)};
}

/// Learns from a frame what the later ones depend on.
void Tracking::take(int t, const TrackedFrame &found) {
  CaptureSummary &summary = result_.summary;
  const Stopwatch watch(summary.surface_seconds);
  result_.performance.dofs.row(t) = found.dofs;
  summary.rim_px[t] = found.rim_px;
  summary.sift_px[t] = found.sift_px;
  summary.keypoint_distance[t] = places_.distance(measured_.joints(), found.dofs);
  summary.lost_limbs.insert(summary.lost_limbs.end(), found.lost.begin(), found.lost.end());
  tracker_.take(found.limbs);
  if (!order_.again) {
    tracks_.remember(t, found.mapped);
    places_.learn(measured_.joints(), found.dofs);
  }
  const PosedSurface skinned = pose_surface(job_.actor, found.dofs, {});
  memory_.learn(t, found.surface, skinned);
  summary.silhouette_iou[t] = tracks_.take(found.surface, timing_);
  if (t == order_.start && order_.start > 0)
    at_start_ = {measured_.latest(), tracks_.surface(), tracks_.visible(), memory_.expected()};
  if (t == order_.start && !order_.again && job_.options.use_sift && job_.options.use_feature_map)
    tracks_.map(skinned.blend);
  if (order_.again || passes(job_.options) == 1)
    count_joints_at(t);
}

void Tracking::count_joints_at(int t) {
  std::vector<std::string> lost;
  for (const LostLimb &limb : result_.summary.lost_limbs)
    if (limb.frame == result_.performance.frames[t] && !limb.recovered)
      lost.push_back(limb.limb);
  count_joints(job_.actor, tracks_.visible(), memory_.reliability(), tracker_.limbs(), lost, result_.summary.joints);
}

/// Everything is tracked a second time, from the start on and with the measurements at hand, knowing what is loose: until a
/// garment has been seen to swing it passes for skin, and drags the limbs under it along.
void Tracking::start_again() {
  constexpr int kAway = 6; // frames: there the surface has come from that of the scan to where it hangs
  job_.context.log_line("capture: second pass, now that loose cloth is known");
  order_.again = true;
  const int start = order_.start, near = start + kAway < job_.count ? start + kAway : std::max(0, start - kAway);
  memory_.start_again(searched_ ? near : -1);
  tracker_.forget_limbs();
  result_.summary.lost_limbs.clear();
}

/// The way to the last frame is done; the one from the start to the first begins with what was known at the start. What is loose
/// is known better by now, and stays.
void Tracking::turn_back() {
  job_.context.log_line("capture: backwards from frame " + std::to_string(job_.frame(order_.start)) + " to frame " +
                        std::to_string(job_.frame(0)));
  measured_.go_back_to(std::move(at_start_.views));
  tracks_.go_back_to(std::move(at_start_.surface), std::move(at_start_.visible));
  memory_.expect(std::move(at_start_.offset));
  tracker_.forget_limbs();
}

/// As TrackedFrame::seconds.
std::array<double, 6> Tracking::seconds() const {
  const CaptureSummary &s = result_.summary;
  return {s.measure_seconds, s.map_seconds, s.pose_seconds, s.limb_seconds, s.surface_seconds, now() - began_};
}

void Tracking::set_seconds(const std::array<double, 6> &seconds) {
  CaptureSummary &s = result_.summary;
  double all = 0;
  std::tie(s.measure_seconds, s.map_seconds, s.pose_seconds, s.limb_seconds, s.surface_seconds, all) = std::tuple_cat(seconds);
  began_ = now() - all;
}

void Tracking::log(int t, double seconds_per_frame) const {
  const CaptureSummary &s = result_.summary;
  job_.say("frame %d, %d cameras, outline %.2f px, features %.2f px (%d), overlap %.3f, %.2f s a frame",
           result_.performance.frames[t], s.views[t], s.rim_px[t], s.sift_px[t], tracker_.track_count(), s.silhouette_iou[t],
           seconds_per_frame);
}

void smooth(const CaptureOptions &options, const RiggedMesh &actor, const std::vector<Vertices> &offsets, CaptureResult &result) {
  ReferencePerformance &performance = result.performance;
  CaptureSummary &summary = result.summary;
  const int frames = static_cast<int>(offsets.size()), vertices = static_cast<int>(actor.mesh.vertices.rows());
  const int angles = actor.skeleton.dof_count() - 3; // all but the root's translation, which comes first
  summary.jitter_before = mean_second_difference(performance.dofs, 3, angles);
  const int window = frames < options.smooth_window ? 1 : options.smooth_window;
  const int order = std::min(options.smooth_order, window - 1);
  performance.dofs = savitzky_golay(performance.dofs, window, order);
  summary.jitter_after = mean_second_difference(performance.dofs, 3, angles);
  const MatrixRM weights = savitzky_golay_weights(window, order);
  performance.surface.frames.resize(frames);
  performance.joints.resize(frames);
  for (int t = 0; t < frames; ++t) {
    const int start = std::clamp(t - window / 2, 0, frames - window);
    Vertices offset = Vertices::Zero(vertices, 3);
    for (int k = 0; k < window; ++k)
      offset += weights(t - start, k) * offsets[start + k];
    performance.surface.frames[t] = pose_surface(actor, performance.dofs.row(t), offset).vertices;
    performance.joints[t] = joint_positions(actor.skeleton, forward_kinematics(actor.skeleton, performance.dofs.row(t)));
  }
}

} // namespace doublet::detail
