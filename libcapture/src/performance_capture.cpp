#include "doublet/capture/performance_capture.h"

#include "camera_choice.h"
#include "capture_checkpoint.h"
#include "delayed_frames.h"
#include "doublet/capture/parts/smoothing.h"
#include "doublet/capture/start_frame.h"
#include "feature_map.h"
#include "first_pose.h"
#include "packed_mask.h"
#include "start_search.h"
#include "tracked_actor.h"
#include "view_measurement.h"

#include "doublet/core/error.h"
#include "doublet/core/parts/fingerprint.h"
#include "doublet/version.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <tuple>
#include <utility>

namespace doublet {
namespace {

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Adds the seconds of its life to a sum.
class Stopwatch {
public:
  explicit Stopwatch(double &sum) : sum_(sum), start_(now()) {}
  ~Stopwatch() { sum_ += now() - start_; }
  Stopwatch(const Stopwatch &) = delete;
  Stopwatch &operator=(const Stopwatch &) = delete;

private:
  double &sum_, start_;
};

/// How far each vertex usually lies from its skinned position, learnt as the frames come: the mean square of all frames so far,
/// or of the last ten if that is larger, spread over neighbours.
class Looseness {
public:
  explicit Looseness(const RiggedMesh &actor, double loose)
      : edges_(scanned_edges(actor)), loose_(loose), all_(expected_deviation(actor).cwiseAbs2()), recent_(all_) {}

  void learn(const Vertices &refined, const Vertices &skinned) {
    const Eigen::VectorXd squared = (refined - skinned).rowwise().squaredNorm();
    all_ += (squared - all_) / ++frames_;
    recent_ += 0.1 * (squared - recent_);
  }

  /// Starts again from what all frames together say: the median, so that a limb that was lost for a while does not pass for
  /// cloth.
  void settle(const std::vector<Vertices> &offsets) {
    const size_t middle = offsets.size() / 2;
    std::vector<double> squared(offsets.size());
    for (int i = 0; i < all_.size(); ++i) {
      for (size_t t = 0; t < offsets.size(); ++t)
        squared[t] = offsets[t].row(i).squaredNorm();
      std::nth_element(squared.begin(), squared.begin() + middle, squared.end());
      all_[i] = squared[middle];
    }
    recent_ = all_;
    frames_ = static_cast<int>(offsets.size());
  }

  /// (V) in (0, 1]: 1 / (1 + (d / loose)^2).
  Eigen::VectorXd reliability() const {
    Eigen::VectorXd d = all_.cwiseMax(recent_);
    for (int round = 0; round < 3; ++round)
      d = spread(d);
    return (1 + d.array() / (loose_ * loose_)).inverse();
  }

private:
  /// (V) m, before anything is known: what skinning leaves on a body, and more where the surface is farther from the bone of a
  /// limb than flesh reaches. That is clothing, and what a wide garment does must not be taken for the limb's motion.
  static Eigen::VectorXd expected_deviation(const RiggedMesh &actor) {
    constexpr double kSkin = 0.005, kFlesh = 0.2, kSwing = 1.0; // m; of the bone's length; of what lies beyond it
    Eigen::VectorXd expected = Eigen::VectorXd::Constant(actor.mesh.vertices.rows(), kSkin);
    const std::vector<Joint> &joints = actor.skeleton.joints;
    const std::vector<int> ends = limb_bones(actor.skeleton);
    for (int i = 0; i < expected.size(); ++i) {
      Eigen::Index owner;
      actor.weights.row(i).maxCoeff(&owner);
      if (ends[owner] < 0)
        continue;
      const Eigen::Vector3d x = actor.mesh.vertices.row(i).transpose() - joints[owner].rest;
      const Eigen::Vector3d bone = joints[ends[owner]].rest - joints[owner].rest;
      const double along = std::clamp(x.dot(bone) / bone.squaredNorm(), 0.0, 1.0);
      expected[i] += kSwing * std::max(0.0, (x - along * bone).norm() - kFlesh * bone.norm());
    }
    return expected;
  }

  /// Of the valid faces: what a garment does says nothing about the legs below its hem.
  static std::vector<std::pair<int, int>> scanned_edges(const RiggedMesh &actor) {
    std::vector<std::pair<int, int>> edges;
    for (int f = 0; f < actor.mesh.faces.rows(); ++f)
      for (int c = 0; actor.face_valid[f] && c < 3; ++c)
        edges.emplace_back(std::minmax(actor.mesh.faces(f, c), actor.mesh.faces(f, (c + 1) % 3)));
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    return edges;
  }

  /// The mean of a vertex and its neighbourhood.
  Eigen::VectorXd spread(const Eigen::VectorXd &d) const {
    Eigen::VectorXd sum = d, count = Eigen::VectorXd::Ones(d.size());
    for (const auto &[a, b] : edges_) {
      sum[a] += d[b];
      sum[b] += d[a];
      count[a] += 1;
      count[b] += 1;
    }
    return sum.cwiseQuotient(count);
  }

  std::vector<std::pair<int, int>> edges_;
  double loose_;
  Eigen::VectorXd all_, recent_;
  int frames_ = 5; // the expectation counts as five frames
};

Vertices rest_offset(const RiggedMesh &actor, const Transforms &blend, const Vertices &surface) {
  Vertices offset(surface.rows(), 3);
  for (int i = 0; i < surface.rows(); ++i)
    offset.row(i) = (blend[i].inverse() * Eigen::Vector3d(surface.row(i))).transpose() - actor.mesh.vertices.row(i);
  return offset;
}

/// Whatever the tracked frames depend on but the images: of a piece of one's own it is only known that it is one.
std::uint64_t fingerprint(const CaptureOptions &options, const std::string &own_parts, const RiggedMesh &actor,
                          const CameraRig &rig, int count) {
  Fingerprint print;
  print.add(std::string(DOUBLET_VERSION)).add(options).add(own_parts).add(std::to_string(count));
  print.add(actor.mesh.vertices).add(actor.mesh.faces).add(actor.face_valid).add(actor.weights);
  print.add(actor.skeleton.lower).add(actor.skeleton.upper);
  for (const Joint &joint : actor.skeleton.joints)
    print.add(joint.name)
        .add(joint.rest)
        .add(joint.axes)
        .add(Eigen::Vector4i(joint.parent, static_cast<int>(joint.kind), joint.first_dof, joint.dof_count));
  for (const Camera &camera : rig)
    print.add(camera.name)
        .add(camera.K)
        .add(camera.distortion)
        .add(camera.R)
        .add(camera.t)
        .add(Eigen::Vector2i(camera.width, camera.height));
  return print.value();
}

/// Of the images and masks of all cameras.
std::uint64_t fingerprint(const std::vector<ViewMeasurement> &views) {
  Fingerprint print;
  for (const ViewMeasurement &view : views)
    print.bytes(&view.fingerprint, sizeof view.fingerprint);
  return print.value();
}

int passes(const CaptureOptions &options) {
  return options.second_pass ? 2 : 1;
}

/// The frames of a checkpoint are not those of this capture.
struct OtherCapture : Error {
  using Error::Error;
};

constexpr int kMostMoves = 4; // of the cameras, each of which begins all again

/// The cameras that a run goes by.
struct Studio {
  CameraRig given, rig;
  std::vector<int> delays;          ///< whole frames, which the frames have made good
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

/// Everything one run knows while it goes through the frames.
///
/// A frame is measured, tracked (`track`) and taken in (`take`). What is known at a frame is what was measured at those before
/// and what was taken in, nothing else: a run goes on from a checkpoint by measuring its frames again and taking them in.
///
/// Tracking goes from the start to the last frame, then from the start back to the first: "before" is one frame nearer to the
/// start. A take that begins in the scan's pose starts at its first frame.
class Tracking {
public:
  Tracking(const CaptureOptions &options, const CaptureParts &parts, const RiggedMesh &actor, const Studio &studio,
           FrameSource &frames, const SilhouetteExtractor *extractor, int count, CaptureCheckpoint &checkpoint,
           const Context &context)
      : options_(options), parts_(parts), actor_(actor), studio_(studio), rig_(studio.rig), frames_(frames),
        extractor_(extractor), count_(count), checkpoint_(checkpoint), context_(context),
        looseness_(actor, options.cloth_deviation_scale), offset_(Vertices::Zero(actor.mesh.vertices.rows(), 3)),
        limbs_(find_limbs(actor.skeleton)), limb_record_(no_record()) {
    for (const Joint &joint : actor.skeleton.joints)
      if (joint.dof_count > 0)
        result_.summary.joints.push_back({joint.name});
    make_room();
  }

  /// What runs before this one have used.
  void go_on_after(const std::array<double, 6> &seconds, double progress, double reached) {
    set_seconds(seconds);
    progress_before_ = progress;
    reached_ = reached;
  }

  /// `known`: the first frames, out of the checkpoint. Throws OtherCapture if they are not of this capture, CamerasMoved if it is
  /// to be tracked again.
  CaptureResult run(std::vector<TrackedFrame> known) {
    if (!options_.use_sift)
      context_.log_line("capture: silhouettes alone, no texture features");
    done_ = static_cast<int>(known.size());
    try {
      report_progress();
      if (known.empty())
        find_start();
      else
        go_on_from(known.front());
      result_.summary.start_frame = frame(start_);
      go_through(std::move(known));
      std::stable_sort(result_.summary.lost_limbs.begin(), result_.summary.lost_limbs.end(),
                       [](const LostLimb &a, const LostLimb &b) { return a.frame < b.frame; });
      say_what_was_hidden();
      smooth();
      result_.summary.seconds_per_frame = seconds().back() / count_;
      context_.report_progress("capture", 1);
    } catch (const OtherCapture &) {
      throw;
    } catch (const CamerasMoved &) {
      throw;
    } catch (...) {
      if (checkpoint_.used())
        context_.log_line("capture: stopped; " + checkpoint_.path().string() + " goes on " + place());
      throw;
    }
    return std::move(result_);
  }

private:
  int frame(int t) const { return options_.first_frame + t; }
  int steps() const { return passes(options_) * count_; }
  double progress(int done) const {
    return progress_before_ + (1 - progress_before_) * std::min(1.0, static_cast<double>(done) / steps());
  }
  /// Never less than before, though frames out of a checkpoint may be of runs to come.
  void report_progress() {
    reached_ = std::max(reached_, progress(done_));
    context_.report_progress("capture", reached_);
  }

  /// The frame index that a step is about.
  int at(int step) const {
    const int k = step % count_;
    return k < count_ - start_ ? start_ + k : count_ - 1 - k;
  }
  /// How many frames lie between this one and the start.
  int age(int t) const { return std::abs(t - start_); }
  /// `n` frames nearer to the start.
  int before(int t, int n) const { return t < start_ ? t + n : t - n; }

  void make_room() {
    const ViewObservation nothing;
    const std::vector<ViewObservation> of_all_views(rig_.size(), nothing);
    result_.performance.surface.faces = actor_.mesh.faces;
    result_.performance.dofs.resize(count_, actor_.skeleton.dof_count());
    result_.observations.cameras = rig_;
    result_.observations.views.assign(count_, of_all_views);
    for (int t = 0; t < count_; ++t)
      result_.performance.frames.push_back(frame(t));
    result_.observations.frames = result_.performance.frames;
    CaptureSummary &summary = result_.summary;
    for (std::vector<double> *of_frames : {&summary.rim_px, &summary.sift_px, &summary.silhouette_iou})
      of_frames->assign(count_, 0);
    summary.views.assign(count_, 0);
    summary.cameras = studio_.found;
    offsets_.resize(count_);
    kept_.resize(count_);
  }

  /// Where a run goes on, in words.
  std::string place() const {
    if (done_ >= steps())
      return "after the last frame";
    return "at frame " + std::to_string(frame(at(done_))) + (done_ < count_ ? "" : " of the second pass");
  }

  void go_on_from(const TrackedFrame &first) {
    if (first.frame < 0 || first.frame >= count_)
      throw OtherCapture("is damaged");
    start_ = first.frame;
    searched_ = first.searched;
  }

  void go_through(std::vector<TrackedFrame> known) {
    const int known_count = std::min(done_, steps());
    for (int step = 0; step < steps(); ++step) {
      const int t = at(step);
      if (step == count_)
        start_again();
      if (t == start_ - 1)
        turn_back();
      if (step == known_count && known_count > 0)
        say_where_it_goes_on();
      if (step < known_count)
        go_over(t, std::exchange(known[step], {}), step + 1 == known_count);
      else
        go_on(t);
      if (step == 0 || step + 1 == count_)
        look_at_cameras(step, known);
    }
    if (known_count == steps())
      say_where_it_goes_on();
  }

  void say_where_it_goes_on() const { context_.log_line("capture: " + checkpoint_.path().string() + " goes on " + place()); }

  /// After the first frame, if it is in the scan's pose, by that; after the first pass by frames of the whole take. Throws
  /// CamerasMoved if the given cameras are clearly off: nothing that was found by them is kept.
  void look_at_cameras(int step, std::vector<TrackedFrame> &known) {
    const bool by_start = step == 0 && count_ > 1;
    if (!options_.refine_cameras || studio_.refined >= kMostMoves || (by_start && (searched_ || studio_.by_take)))
      return;
    const CalibrationEstimate found = by_start ? refine_by_start() : refine_by_take();
    result_.summary.cameras = found.cameras;
    for (size_t v = 0; v < rig_.size(); ++v) {
      result_.summary.cameras[v].late += studio_.delays[v];
      result_.summary.cameras[v].delay = studio_.delays[v];
    }
    say(by_start ? "cameras by the first frame: %.2f mm off on the actor, sure to %.2f mm, outlines %.2f px before, %.2f after"
                 : "cameras by the take: %.2f mm off on the actor, sure to %.2f mm, outlines %.2f px before, %.2f after",
        1000 * found.change, 1000 * found.sure, found.before_px, found.after_px);
    const bool delayed = std::any_of(found.cameras.begin(), found.cameras.end(),
                                     [](const RefinedCamera &camera) { return std::abs(camera.late) > 0.5; });
    if (!delayed && !clearly_off(found))
      return;
    const size_t of_this_run = std::min(known.size(), static_cast<size_t>(step) + 1);
    known.erase(known.begin(), known.begin() + static_cast<long>(of_this_run));
    throw CamerasMoved{found, delayed, !by_start, std::move(known), seconds(), progress(step + 1), reached_};
  }

  /// A calibration that was mended once is not taken at its word any more: a smaller move will do.
  bool clearly_off(const CalibrationEstimate &found) const {
    constexpr double kClearly = 2; // standard deviations
    const auto seen = [](const RefinedCamera &camera) { return camera.seen; };
    const double least = options_.calibration.min_change;
    return std::count_if(found.cameras.begin(), found.cameras.end(), seen) >= 3 && found.after_px < found.before_px &&
           (studio_.moved ? found.change > least / 2 : found.change > std::max(least, kClearly * found.sure));
  }

  CalibrationProblem calibration_problem(const Eigen::VectorXd &reliability) const {
    CalibrationProblem problem;
    problem.actor = &actor_;
    problem.given = studio_.given;
    problem.rig = rig_;
    problem.reliability = reliability;
    return problem;
  }

  CalibrationEstimate refine_by_start() const {
    CalibrationProblem problem = calibration_problem(looseness_.reliability());
    problem.poses = result_.performance.dofs.row(start_);
    problem.timed = false;
    problem.moments = {{0, &kept_[start_].outlines, Vertices(0, 3), where_the_scan_is(start_)}};
    return refine_calibration(problem, options_.calibration, context_);
  }

  /// Delays first: while cameras show different times, what is loose is not known, and skin is taken for as firm as before
  /// anything was seen. Only then what is off besides.
  CalibrationEstimate refine_by_take() const {
    Looseness settled = looseness_;
    settled.settle(offsets_);
    const Eigen::VectorXd learnt = settled.reliability(),
                          expected = Looseness(actor_, options_.cloth_deviation_scale).reliability();
    CalibrationEstimate timed;
    if (options_.calibration.late > 0)
      timed = refine_by_take(learnt.cwiseMax(expected));
    for (const RefinedCamera &camera : timed.cameras)
      if (std::abs(camera.late) > 0.5)
        return timed;
    CalibrationEstimate found = refine_by_take(learnt);
    for (size_t v = 0; v < timed.cameras.size(); ++v) {
      found.cameras[v].late = timed.cameras[v].late;
      found.cameras[v].late_sure = timed.cameras[v].late_sure;
    }
    return found;
  }

  CalibrationEstimate refine_by_take(const Eigen::VectorXd &reliability) const {
    CalibrationProblem problem = calibration_problem(reliability);
    problem.poses = result_.performance.dofs;
    const Eigen::VectorXd loose = 1 - reliability.array();
    const int moments = std::min(options_.calibration.moments, count_);
    for (int k = 0; k < moments; ++k) {
      const int t = static_cast<int>((2 * k + 1) * static_cast<long>(count_) / (2 * moments));
      problem.moments.push_back({t, &kept_[t].outlines, loose.asDiagonal() * offsets_[t], false});
    }
    if (!searched_)
      problem.moments.push_back({start_, &kept_[start_].outlines, Vertices(0, 3), where_the_scan_is(start_)});
    return refine_calibration(problem, options_.calibration, context_);
  }

  /// Does the actor stand where the scan was made, as far as the given cameras tell?
  bool where_the_scan_is(int t) const {
    constexpr double kNear = 0.05, kNearlyTurned = 0.1; // m, rad
    const int root = root_joint(actor_.skeleton).first_dof;
    const Eigen::VectorXd pose = result_.performance.dofs.row(t);
    return pose.segment<3>(root).norm() < kNear && pose.segment<3>(root + 3).norm() < kNearlyTurned;
  }

  /// A frame that was tracked before. Its features are detected only where they are still needed: in the start for the map and
  /// for the way back, in the `latest` one for the matches of the next.
  void go_over(int t, const TrackedFrame &found, bool latest) {
    context_.throw_if_cancelled();
    if (found.frame != t || !fits(found, actor_, rig_.size(), limbs_.size(), !again_))
      throw OtherCapture("is damaged");
    if (again_) {
      recall(t);
    } else {
      std::vector<ViewMeasurement> current = measure_next(t, t == start_ || latest ? tracker() : nullptr);
      if (fingerprint(current) != found.images)
        throw OtherCapture("was made from other images");
      keep(t, std::move(current), found.matches);
    }
    take(t, found);
    set_seconds(found.seconds);
  }

  void go_on(int t) {
    report_progress();
    TrackedFrame found;
    found.frame = t;
    found.searched = t == start_ && searched_;
    if (again_)
      recall(t);
    else
      measure(t, found);
    track(t, found);
    take(t, found);
    found.seconds = seconds();
    checkpoint_.append(found);
    ++done_;
    if (t % 20 == 0 || t + 1 == count_)
      log(t, seconds().back() / done_);
  }

  void track(int t, TrackedFrame &found) {
    find_pose(t, found);
    refine(t, found);
  }

  /// As TrackedFrame::seconds.
  std::array<double, 6> seconds() const {
    const CaptureSummary &s = result_.summary;
    return {s.measure_seconds, s.map_seconds, s.pose_seconds, s.limb_seconds, s.surface_seconds, now() - began_};
  }

  void set_seconds(const std::array<double, 6> &seconds) {
    CaptureSummary &s = result_.summary;
    double all = 0;
    std::tie(s.measure_seconds, s.map_seconds, s.pose_seconds, s.limb_seconds, s.surface_seconds, all) = std::tuple_cat(seconds);
    began_ = now() - all;
  }

  LimbRecord no_record() const {
    const std::vector<int> none(limbs_.size(), 0);
    return {none, none, std::vector<int>(actor_.skeleton.dof_count(), 0)};
  }

  const FeatureTracker *tracker() const { return options_.use_sift ? parts_.features.get() : nullptr; }

  std::vector<ViewMeasurement> measure_views(int t, const FeatureTracker *tracker) {
    const Stopwatch watch(result_.summary.measure_seconds);
    std::vector<ViewMeasurement> current(rig_.size());
    parallel_for(context_, static_cast<int>(rig_.size()),
                 [&](int v) { current[v] = measure_view(frames_, v, frame(t), rig_[v], extractor_, tracker); });
    return current;
  }

  void measure(int t, TrackedFrame &found) {
    std::vector<ViewMeasurement> current = measure_next(t, tracker());
    const auto has_image = [](const ViewMeasurement &view) { return view.has_image; };
    if (t == start_ && tracker() && std::none_of(current.begin(), current.end(), has_image))
      context_.log_line("capture: masks without images: silhouettes alone, no texture features");
    found.images = fingerprint(current);
    found.matches = match(t, current);
    keep(t, std::move(current), found.matches);
  }

  /// As measure_views. On the way back a stretch of frames is read at once, forwards: to go back in a video by one frame may be
  /// to decode hundreds.
  std::vector<ViewMeasurement> measure_next(int t, const FeatureTracker *tracker) {
    constexpr int kStretch = 16; // frames
    if (t == start_ && !start_views_.empty())
      return std::exchange(start_views_, {});
    if (t >= start_)
      return measure_views(t, tracker);
    if (stretch_.empty() || stretch_tracker_ != tracker) {
      stretch_.clear();
      stretch_tracker_ = tracker;
      for (int s = std::max(0, t + 1 - kStretch); s <= t; ++s) {
        context_.throw_if_cancelled();
        stretch_.push_back(measure_views(s, tracker));
      }
    }
    std::vector<ViewMeasurement> views = std::move(stretch_.back());
    stretch_.pop_back();
    return views;
  }

  /// [cameras] features of the frame before in this one.
  std::vector<std::vector<FeatureMatch>> match(int t, const std::vector<ViewMeasurement> &current) {
    const Stopwatch watch(result_.summary.measure_seconds);
    std::vector<std::vector<FeatureMatch>> matches(rig_.size());
    if (tracker() && t != start_)
      parallel_for(context_, static_cast<int>(rig_.size()), [&](int v) {
        const Features &before = last_[v].features, &here = current[v].features;
        for (const auto &[i, j] : checked_match(*tracker(), before, here, options_.features.max_displacement * current[v].height))
          matches[v].push_back({before.points[i], here.points[j]});
      });
    return matches;
  }

  /// What was measured becomes the latest frame, and is kept for the second pass.
  void keep(int t, std::vector<ViewMeasurement> current, const std::vector<std::vector<FeatureMatch>> &matches) {
    const int views = static_cast<int>(rig_.size());
    int present = 0;
    outlines_.resize(views);
    masks_.resize(views);
    for (int v = 0; v < views; ++v) {
      present += !current[v].outline.empty();
      result_.observations.views[t][v].contour = current[v].outline.points;
      observe(t, v, matches[v]);
      outlines_[v] = std::move(current[v].outline);
      masks_[v] = std::move(current[v].mask);
    }
    if (present == 0)
      throw Error("capture: no camera shows the actor at frame " + std::to_string(frame(t)));
    last_ = std::move(current);
    result_.summary.views[t] = present;
    kept_[t] = {outlines_, pack(masks_), {}};
  }

  /// Observations are matches of a frame with the one that was filmed before it, whichever was tracked first.
  void observe(int t, int view, const std::vector<FeatureMatch> &matches) {
    if (t >= start_)
      result_.observations.views[t][view].matches = matches;
    else
      result_.observations.views[t + 1][view].matches = swapped(matches);
  }

  /// Of the frame before, tracked before, that is, with this one.
  std::vector<FeatureMatch> matches_at(int t, int view) const {
    return t >= start_ ? result_.observations.views[t][view].matches : swapped(result_.observations.views[t + 1][view].matches);
  }

  static std::vector<FeatureMatch> swapped(std::vector<FeatureMatch> matches) {
    for (FeatureMatch &match : matches)
      std::swap(match.previous, match.current);
    return matches;
  }

  /// Everything is tracked a second time, from the start on and with the measurements at hand, knowing what is loose: until
  /// a garment has been seen to swing it passes for skin, and drags the limbs under it along.
  void start_again() {
    context_.log_line("capture: again, knowing what is loose");
    again_ = true;
    looseness_.settle(offsets_);
    offset_.setZero();
    if (searched_)
      offset_ = hanging_near_start();
    limb_record_ = no_record();
    result_.summary.lost_limbs.clear();
  }

  /// The loose part of the offset a few frames from the start: there the surface has come from that of the scan to where it
  /// hangs.
  Vertices hanging_near_start() const {
    constexpr int kAway = 6; // frames
    const int t = start_ + kAway < count_ ? start_ + kAway : std::max(0, start_ - kAway);
    const Eigen::VectorXd loose = 1 - looseness_.reliability().array();
    return loose.asDiagonal() * offsets_[t];
  }

  /// The way to the last frame is done; the one from the start to the first begins with what was known at the start. What is
  /// loose is known better by now, and stays.
  void turn_back() {
    context_.log_line("capture: back from frame " + std::to_string(frame(start_)) + " to frame " + std::to_string(frame(0)));
    last_ = std::move(at_start_.views);
    last_surface_ = std::move(at_start_.surface);
    visible_ = std::move(at_start_.visible);
    offset_ = std::move(at_start_.offset);
    limb_record_ = no_record();
  }

  /// What was measured at a frame.
  void recall(int t) {
    outlines_ = kept_[t].outlines;
    masks_ = unpack(kept_[t].masks);
  }

  /// Features seen at the frame before, lifted onto the refined surface there.
  std::vector<SurfaceTrack> lift_tracks(int t) {
    const Stopwatch watch(result_.summary.map_seconds);
    const int views = static_cast<int>(rig_.size());
    std::vector<std::vector<SurfaceTrack>> tracks(views);
    if (t != start_)
      parallel_for(context_, views,
                   [&](int v) { tracks[v] = lift_matches(matches_at(t, v), v, last_surface_, actor_, rig_[v], visible_[v]); });
    std::vector<SurfaceTrack> all;
    for (const auto &part : tracks)
      all.insert(all.end(), part.begin(), part.end());
    return all;
  }

  /// The lifted tracks, and the mapped features around where `dofs` would put them.
  std::vector<SurfaceTrack> find_tracks(const Eigen::VectorXd &dofs, int t) {
    const Stopwatch watch(result_.summary.map_seconds);
    std::vector<SurfaceTrack> all = lifted_;
    if (again_)
      all.insert(all.end(), kept_[t].mapped.begin(), kept_[t].mapped.end());
    if (again_ || map_.size() == 0)
      return all;
    const PosedSurface expected = pose_surface(actor_, dofs, offset_);
    const int views = static_cast<int>(rig_.size());
    std::vector<std::vector<SurfaceTrack>> found(views);
    parallel_for(context_, views, [&](int v) {
      found[v] = map_.find(last_[v].features, *parts_.features, actor_, expected, v, rig_[v],
                           options_.map_search_radius * last_[v].height);
    });
    for (const auto &part : found)
      all.insert(all.end(), part.begin(), part.end());
    return all;
  }

  /// The first frame, or the one asked for, if the scan pose fits there; otherwise the frame of the take where it fits best.
  /// Where it fits nowhere, the pose is searched in the frames that come nearest.
  void find_start() {
    constexpr int kTries = 3;
    const bool given = options_.start_frame >= 0;
    start_ = given ? options_.start_frame - options_.first_frame : 0;
    start_views_ = measure_views(start_, tracker());
    const Stopwatch watch(result_.summary.pose_seconds);
    const PlacedPose placed = first_pose(actor_, rig_, masks_of(start_views_), context_);
    start_pose_ = placed.dofs;
    if (placed.overlap >= kScanPoseOverlap)
      return;
    std::vector<LikelyStart> likely{{frame(start_), placed}};
    if (!given)
      likely = frames_like_the_scan(actor_, rig_, frames_, extractor_, options_.first_frame, count_, kTries, context_);
    if (likely.empty() || likely.front().placed.overlap == 0)
      return; // fewer than two cameras: nothing tells one place from another
    const double best = likely.front().placed.overlap;
    say("frame %d is not in the scan's pose (overlap %.2f, expected %.1f)", frame(start_), placed.overlap, kScanPoseOverlap);
    if (best < kNearScanPose && !given)
      refuse_to_start("at best frame " + std::to_string(likely.front().frame) + " overlaps the scan by " +
                      options::to_text(best, 2) + ", expected " + options::to_text(kNearScanPose, 2));
    if (best >= kScanPoseOverlap) {
      begin_at(likely.front().frame, likely.front().placed.dofs);
      say("frame %d is (overlap %.2f); it goes on from there, and back", frame(start_), best);
    } else {
      search_start(likely);
    }
  }

  void begin_at(int video_frame, const Eigen::VectorXd &dofs) {
    if (video_frame != frame(start_))
      start_views_.clear();
    start_ = video_frame - options_.first_frame;
    start_pose_ = dofs;
  }

  /// The pose in the first of the frames where it is beyond doubt which way the actor faces, or in the one that leaves the least.
  /// What a garment hides is where the scan has it, so that the most alike comes first.
  void search_start(const std::vector<LikelyStart> &likely) {
    constexpr double kUsable = 0.35; // wrong pixels against those of the actor: a wide skirt that flies has 0.2
    constexpr double kDoubt = 0.85;  // wrong against rival; 0.3 to 0.7 where the actor faces the right way
    FoundPose best;
    double doubt = 2, least_wrong = 1;
    for (const LikelyStart &start : likely) {
      const FoundPose found = pose_in(start.frame);
      least_wrong = std::min(least_wrong, found.wrong);
      if (found.wrong > kUsable || found.wrong / found.rival >= doubt)
        continue;
      best = found;
      doubt = found.wrong / found.rival;
      begin_at(start.frame, found.dofs);
      searched_ = true;
      if (doubt < kDoubt)
        break;
    }
    if (doubt > 1)
      refuse_to_start("with the best one " + options::to_text(std::round(100 * least_wrong), 3) +
                      " % of the silhouettes are wrong");
    say("the pose was found in frame %d, where %.0f %% of the silhouettes are wrong; it goes on from there, and back",
        frame(start_), 100 * best.wrong);
    if (doubt >= kDoubt)
      say("which way the actor faces is in doubt: turned round, %.0f %% are wrong", 100 * best.rival);
  }

  [[noreturn]] static void refuse_to_start(const std::string &found) {
    throw Error("capture: expected a frame in the scan's pose, or one in which the pose can be found, found none (" + found +
                "); do scan, calibration and videos belong together? start_frame names a frame that is near the scan's pose");
  }

  FoundPose pose_in(int video_frame) {
    const std::vector<ViewMeasurement> views = measure_views(video_frame - options_.first_frame, nullptr);
    const std::vector<Image> masks = masks_of(views);
    std::vector<Outline> outlines;
    for (const ViewMeasurement &view : views)
      outlines.push_back(view.outline);
    const StartProblem problem{&actor_, &rig_, &outlines, &masks, looseness_.reliability()};
    return search_pose(problem, *parts_.pose, *parts_.limbs, options_.limbs, context_);
  }

  template <class... Numbers> void say(const char *format, Numbers... numbers) const {
    char line[200];
    std::snprintf(line, sizeof line, format, numbers...);
    context_.log_line(std::string("capture: ") + line);
  }

  static std::vector<Image> masks_of(const std::vector<ViewMeasurement> &views) {
    std::vector<Image> masks;
    for (const ViewMeasurement &view : views)
      masks.push_back(view.mask);
    return masks;
  }
  void find_pose(int t, TrackedFrame &found) {
    PoseProblem problem;
    problem.actor = &actor_;
    problem.rig = &rig_;
    problem.outlines = &outlines_;
    problem.offset = offset_;
    problem.reliability = looseness_.reliability();
    problem.first = t == start_ && !again_;
    problem.predicted = problem.first ? start_pose_ : predict(t);
    problem.start = problem.predicted;
    lifted_ = lift_tracks(t);
    problem.tracks = find_tracks(problem.predicted, t);
    PoseEstimate estimate;
    {
      const Stopwatch watch(result_.summary.pose_seconds);
      estimate = optimize(problem, t);
    }
    found.limbs = limb_record_;
    if (options_.find_lost_limbs)
      recover_limbs(problem, estimate, t, found);
    found.dofs = estimate.dofs;
    found.rim_px = estimate.rim_px;
    found.sift_px = estimate.sift_px;
  }

  PoseEstimate optimize(const PoseProblem &problem, int t) {
    PoseEstimate estimate = parts_.pose->optimize(problem, context_);
    require_pose(estimate.dofs, "pose optimizer", t);
    return estimate;
  }

  void require_pose(const Eigen::VectorXd &dofs, const std::string &piece, int t) const {
    if (dofs.size() != actor_.skeleton.dof_count() || !dofs.allFinite())
      throw Error("capture: the " + piece + " returned " + std::to_string(dofs.size()) + " values at frame " +
                  std::to_string(frame(t)) + ", expected " + std::to_string(actor_.skeleton.dof_count()) + " finite ones");
  }

  /// Limbs with too large an error are sought globally and optimised again; the pose that overlaps better is kept. A limb that
  /// was not found is sought again after a wait that grows with every miss: a mask may hold something that is no limb.
  void recover_limbs(const PoseProblem &problem, PoseEstimate &estimate, int t, TrackedFrame &found) {
    constexpr int kLongestWait = 10; // frames
    const Stopwatch watch(result_.summary.limb_seconds);
    auto &[misses, next_search, steady_since] = found.limbs;
    const LimbProblem limbs{&actor_, &rig_, &masks_, offset_, problem.reliability, problem.predicted};
    const Eigen::VectorXd before = limb_errors(limbs, estimate.dofs, limbs_, options_.limbs, context_);
    std::vector<Limb> sought;
    for (size_t l = 0; l < limbs_.size(); ++l)
      if (before[l] > options_.limbs.lost_error && age(t) >= next_search[l])
        sought.push_back(limbs_[l]);
    Eigen::VectorXd after = before;
    if (!sought.empty()) {
      PoseProblem again = problem;
      again.start = parts_.limbs->search(limbs, estimate.dofs, sought, context_);
      require_pose(again.start, "limb search", t);
      for (const Limb &limb : sought)
        again.predicted(limb.dofs) = again.start(limb.dofs);
      again.tracks = find_tracks(again.start, t);
      const PoseEstimate other = optimize(again, t);
      if (overlap_energy(limbs, other.dofs, options_.limbs, context_) <
          overlap_energy(limbs, estimate.dofs, options_.limbs, context_)) {
        estimate = other;
        after = limb_errors(limbs, estimate.dofs, limbs_, options_.limbs, context_);
        for (const Limb &limb : sought)
          for (int d : limb.dofs)
            steady_since[d] = age(t);
      }
    }
    for (size_t l = 0; l < limbs_.size(); ++l) {
      const bool lost = after[l] > options_.limbs.lost_error, searched = age(t) >= next_search[l];
      if (!lost)
        misses[l] = 0;
      else if (searched)
        next_search[l] = age(t) + std::min(++misses[l], kLongestWait);
      if (before[l] > options_.limbs.lost_error) {
        found.lost.push_back({frame(t), limbs_[l].name, before[l], after[l], !lost});
        if (searched)
          say_lost(found.lost.back());
      }
    }
  }

  void say_lost(const LostLimb &lost) const {
    char line[200];
    std::snprintf(line, sizeof line, "capture: frame %d, limb '%s' lost (%.1f cm off), %s (%.1f cm)", lost.frame,
                  lost.limb.c_str(), 100 * lost.before, lost.recovered ? "found again" : "not found", 100 * lost.after);
    context_.log_line(line);
  }

  /// From the last three frames: damped velocity and a share of its change; both only since the limb was last found again.
  Eigen::VectorXd predict(int t) const {
    const MatrixRM &x = result_.performance.dofs;
    const int a = t == start_ ? t : before(t, 1), b = before(t, 2), c = before(t, 3);
    Eigen::VectorXd prediction = x.row(a);
    for (int d = 0; d < prediction.size(); ++d) {
      if (age(t) - 2 >= limb_record_.steady_since[d])
        prediction[d] += options_.velocity_damping * (x(a, d) - x(b, d));
      if (age(t) - 3 >= limb_record_.steady_since[d])
        prediction[d] += options_.acceleration * (x(a, d) - 2 * x(b, d) + x(c, d));
    }
    return prediction.cwiseMax(actor_.skeleton.lower).cwiseMin(actor_.skeleton.upper);
  }

  void refine(int t, TrackedFrame &found) {
    SurfaceProblem problem;
    problem.actor = &actor_;
    problem.rig = &rig_;
    problem.outlines = &outlines_;
    problem.tracks = tracks_ = find_tracks(found.dofs, t);
    if (!again_)
      found.mapped.assign(tracks_.begin() + static_cast<long>(lifted_.size()), tracks_.end());
    const Stopwatch watch(result_.summary.surface_seconds);
    problem.base = pose_surface(actor_, found.dofs, offset_).vertices;
    problem.skinned = pose_surface(actor_, found.dofs, {}).vertices;
    problem.reliability = looseness_.reliability();
    found.surface = parts_.surface->refine(problem, context_).vertices;
    if (found.surface.rows() != problem.skinned.rows() || !found.surface.allFinite())
      throw Error("capture: the surface refiner returned " + std::to_string(found.surface.rows()) + " vertices at frame " +
                  std::to_string(frame(t)) + ", expected " + std::to_string(problem.skinned.rows()) + " finite ones");
  }

  /// Learns from a frame what the later ones depend on.
  void take(int t, const TrackedFrame &found) {
    const Stopwatch watch(result_.summary.surface_seconds);
    result_.performance.dofs.row(t) = found.dofs;
    result_.summary.rim_px[t] = found.rim_px;
    result_.summary.sift_px[t] = found.sift_px;
    result_.summary.lost_limbs.insert(result_.summary.lost_limbs.end(), found.lost.begin(), found.lost.end());
    limb_record_ = found.limbs;
    if (!again_)
      kept_[t].mapped = found.mapped;
    last_surface_ = found.surface;
    const PosedSurface skinned = pose_surface(actor_, found.dofs, {});
    looseness_.learn(last_surface_, skinned.vertices);
    offsets_[t] = rest_offset(actor_, skinned.blend, last_surface_);
    const Eigen::VectorXd loose = 1 - looseness_.reliability().array();
    offset_ = options_.offset_decay * (loose.asDiagonal() * offsets_[t]);
    look(t);
    if (t == start_ && start_ > 0)
      at_start_ = {last_, last_surface_, visible_, offset_};
    if (t == start_ && !again_ && options_.use_sift && options_.use_feature_map)
      for (size_t v = 0; v < rig_.size(); ++v)
        map_.add(last_[v].features, actor_, {skinned.blend, last_surface_}, rig_[v], visible_[v]);
    if (again_ || passes(options_) == 1)
      watch_joints(t);
  }

  /// What each camera sees of the refined surface: for lifting the next frame's tracks, and for the overlap with the measured
  /// masks.
  void look(int t) {
    const int views = static_cast<int>(rig_.size());
    visible_.resize(views);
    std::vector<double> overlap(views, -1);
    parallel_for(context_, views, [&](int v) {
      visible_[v] = rasterize(last_surface_, actor_.mesh.faces, rig_[v]);
      if (!outlines_[v].empty())
        overlap[v] = mask_iou(silhouette(visible_[v]), masks_[v]);
    });
    double sum = 0, count = 0;
    for (double o : overlap)
      if (o >= 0) {
        sum += o;
        count += 1;
      }
    result_.summary.silhouette_iou[t] = sum / count;
  }

  /// Smooths poses and rest-pose offsets over time and builds the final surfaces from both.
  void smooth() {
    ReferencePerformance &performance = result_.performance;
    CaptureSummary &summary = result_.summary;
    const int frames = static_cast<int>(offsets_.size()), vertices = static_cast<int>(actor_.mesh.vertices.rows());
    const int angles = actor_.skeleton.dof_count() - 3; // all but the root's translation, which comes first
    summary.jitter_before = mean_second_difference(performance.dofs, 3, angles);
    const int window = frames < options_.smooth_window ? 1 : options_.smooth_window;
    const int order = std::min(options_.smooth_order, window - 1);
    performance.dofs = savitzky_golay(performance.dofs, window, order);
    summary.jitter_after = mean_second_difference(performance.dofs, 3, angles);
    const MatrixRM weights = savitzky_golay_weights(window, order);
    performance.surface.frames.resize(frames);
    performance.joints.resize(frames);
    for (int t = 0; t < frames; ++t) {
      const int start = std::clamp(t - window / 2, 0, frames - window);
      Vertices offset = Vertices::Zero(vertices, 3);
      for (int k = 0; k < window; ++k)
        offset += weights(t - start, k) * offsets_[start + k];
      performance.surface.frames[t] = pose_surface(actor_, performance.dofs.row(t), offset).vertices;
      performance.joints[t] = joint_positions(actor_.skeleton, forward_kinematics(actor_.skeleton, performance.dofs.row(t)));
    }
  }

  /// Which joints the frame shows: see JointVisibility.
  void watch_joints(int t) {
    constexpr double kSeen = 0.08;    // m^2 for each m^2 of the bone's length: a fifth of a bare shank
    constexpr double kReliable = 0.5; // moves with the skeleton
    const Skeleton &skeleton = actor_.skeleton;
    std::vector<char> shown(actor_.mesh.faces.rows(), 0);
    for (const FaceBuffer &view : visible_)
      for (const int face : view.face)
        if (face >= 0)
          shown[face] = actor_.face_valid[face];
    const Eigen::VectorXd reliability = looseness_.reliability(), areas = face_areas(actor_.mesh.vertices, actor_.mesh.faces);
    Eigen::VectorXd seen = Eigen::VectorXd::Zero(skeleton.joint_count());
    for (int f = 0; f < actor_.mesh.faces.rows(); ++f)
      for (int c = 0; shown[f] && c < 3; ++c)
        if (const int i = actor_.mesh.faces(f, c); reliability[i] >= kReliable)
          seen += areas[f] / 3 * actor_.weights.row(i).transpose();
    std::vector<char> lost(skeleton.joint_count(), 0);
    for (const LostLimb &limb : result_.summary.lost_limbs)
      for (size_t l = 0; limb.frame == result_.performance.frames[t] && !limb.recovered && l < limbs_.size(); ++l)
        for (int j : limbs_[l].joints)
          lost[j] = lost[j] || limbs_[l].name == limb.limb;
    for (JointVisibility &sight : result_.summary.joints) {
      const int j = skeleton.find(sight.joint);
      const double length = bone_length(j);
      ++(lost[j] ? sight.lost : seen[j] >= kSeen * length * length ? sight.seen : sight.inferred);
    }
  }

  /// m; to the farthest joint that hangs on this one directly.
  double bone_length(int joint) const {
    double length = 0;
    for (const Joint &child : actor_.skeleton.joints)
      if (child.parent == joint)
        length = std::max(length, (child.rest - actor_.skeleton.joints[joint].rest).norm());
    return length;
  }

  void say_what_was_hidden() const {
    for (const JointVisibility &sight : result_.summary.joints)
      if (sight.inferred + sight.lost > 0)
        context_.log_line("capture: joint '" + sight.joint + "': seen in " + std::to_string(sight.seen) +
                          " frames, inferred in " + std::to_string(sight.inferred) + ", lost in " + std::to_string(sight.lost));
  }

  void log(int t, double seconds_per_frame) const {
    char line[200];
    const CaptureSummary &s = result_.summary;
    std::snprintf(line, sizeof line,
                  "capture: frame %d, %d cameras, outline %.2f px, features %.2f px (%zu), overlap %.3f, %.2f s a frame",
                  result_.performance.frames[t], s.views[t], s.rim_px[t], s.sift_px[t], tracks_.size(), s.silhouette_iou[t],
                  seconds_per_frame);
    context_.log_line(line);
  }

  const CaptureOptions &options_;
  const CaptureParts &parts_;
  const RiggedMesh &actor_;
  const Studio &studio_;
  const CameraRig &rig_;
  FrameSource &frames_;
  const SilhouetteExtractor *extractor_;
  const int count_;
  CaptureCheckpoint &checkpoint_;
  const Context &context_;
  CaptureResult result_;
  double began_ = now(); // earlier runs included
  double progress_before_ = 0, reached_ = 0;
  int done_ = 0;          // frames that are in the checkpoint, of all passes
  int start_ = 0;         // frame index at which tracking begins
  bool searched_ = false; // its pose was, as it is not the scan's
  Eigen::VectorXd start_pose_;
  std::vector<ViewMeasurement> start_views_; // measured while the start was sought
  struct AtStart {
    std::vector<ViewMeasurement> views;
    Vertices surface;
    std::vector<FaceBuffer> visible;
    Vertices offset;
  };
  AtStart at_start_;                                  // what the way back begins with
  std::vector<std::vector<ViewMeasurement>> stretch_; // frames read ahead on the way back; the next is the last
  const FeatureTracker *stretch_tracker_ = nullptr;
  Looseness looseness_;
  Vertices offset_;                   // expected non-rigid offset, rest pose
  std::vector<Vertices> offsets_;     // T x (V, 3), refined, rest pose; empty until the frame is tracked
  std::vector<ViewMeasurement> last_; // features of the latest frame
  std::vector<Outline> outlines_;
  std::vector<Image> masks_;
  FeatureMap map_;
  struct Measured {
    std::vector<Outline> outlines;
    std::vector<PackedMask> masks;
    std::vector<SurfaceTrack> mapped; ///< features that the map has found
  };
  std::vector<Measured> kept_; // by frame index
  bool again_ = false;         // in the second pass
  std::vector<SurfaceTrack> lifted_, tracks_;
  std::vector<Limb> limbs_;
  LimbRecord limb_record_;
  Vertices last_surface_;
  std::vector<FaceBuffer> visible_;
};

class TrackingCapture : public PerformanceCapture {
public:
  TrackingCapture(const CaptureOptions &options, const CaptureParts &parts)
      : options_(options), parts_(parts), own_parts_(own_parts(parts)) {
    if (!parts_.features)
      parts_.features = FeatureTracker::create(options.features);
    if (!parts_.pose)
      parts_.pose = PoseOptimizer::create(options.pose);
    if (!parts_.limbs)
      parts_.limbs = LimbSearch::create(options.limbs);
    if (!parts_.surface)
      parts_.surface = SurfaceRefiner::create(options.surface);
  }

  CaptureResult capture(const RiggedMesh &actor, const CameraRig &rig, FrameSource &frames, const SilhouetteExtractor *extractor,
                        const Context &context) override {
    require_usable(actor.mesh, "capture: the actor's mesh");
    if (actor.weights.rows() != actor.mesh.vertices.rows() || actor.weights.cols() != actor.skeleton.joint_count())
      throw std::invalid_argument("capture: the actor's weights must be (" + std::to_string(actor.mesh.vertices.rows()) + ", " +
                                  std::to_string(actor.skeleton.joint_count()) + "), got (" +
                                  std::to_string(actor.weights.rows()) + ", " + std::to_string(actor.weights.cols()) + ")");
    if (static_cast<int>(actor.face_valid.size()) != actor.mesh.faces.rows())
      throw std::invalid_argument("capture: the actor's face_valid must have one entry a face, " +
                                  std::to_string(actor.mesh.faces.rows()) + ", got " + std::to_string(actor.face_valid.size()));
    if (rig.empty() || frames.camera_count() != static_cast<int>(rig.size()))
      throw std::invalid_argument("capture: the rig has " + std::to_string(rig.size()) + " cameras, the frames have " +
                                  std::to_string(frames.camera_count()));
    const int left = frames.frame_count() - options_.first_frame;
    const int count = options_.frame_count < 0 ? left : options_.frame_count;
    if (count < 1 || count > left)
      throw std::invalid_argument("capture: frames " + std::to_string(options_.first_frame) + " to " +
                                  std::to_string(options_.first_frame + count - 1) + " were asked for, there are " +
                                  std::to_string(frames.frame_count()));
    if (options_.start_frame >= 0 &&
        (options_.start_frame < options_.first_frame || options_.start_frame >= options_.first_frame + count))
      throw std::invalid_argument("capture: start_frame: expected one of the frames " + std::to_string(options_.first_frame) +
                                  " to " + std::to_string(options_.first_frame + count - 1) + ", found " +
                                  std::to_string(options_.start_frame));
    const CameraChoice chosen(options_.cameras, rig, frames, extractor);
    const TrackedActor tracked = track_actor(actor, options_.extra_twist_range);
    CaptureCheckpoint checkpoint(options_.checkpoint, fingerprint(options_, own_parts_, tracked.actor, chosen.rig(), count));
    const auto track = [&](std::vector<TrackedFrame> known) {
      return track_until_cameras_stay(tracked.actor, chosen, count, checkpoint, std::move(known), context);
    };
    CaptureResult result;
    try {
      const int most = (passes(options_) + (options_.refine_cameras ? kMostMoves : 0)) * count;
      result = track(checkpoint.read(static_cast<std::size_t>(most), context));
    } catch (const OtherCapture &why) {
      context.log_line("capture: " + checkpoint.path().string() + " " + why.what() + "; starting over");
      checkpoint.start_over();
      result = track({});
    }
    result.performance.dofs = MatrixRM(result.performance.dofs(Eigen::all, tracked.kept));
    return result;
  }

private:
  /// Tracks from the beginning each time that the cameras turn out to be others.
  CaptureResult track_until_cameras_stay(const RiggedMesh &actor, const CameraChoice &chosen, int count,
                                         CaptureCheckpoint &checkpoint, std::vector<TrackedFrame> known, const Context &context) {
    Studio studio{chosen.rig(), chosen.rig(), std::vector<int>(chosen.rig().size(), 0), 0, false, false, {}};
    std::array<double, 6> seconds{};
    double progress = 0, reached = 0;
    for (;;) {
      DelayedFrames frames(chosen.frames(), studio.delays);
      Tracking run(options_, parts_, actor, studio, frames, chosen.extractor(), count, checkpoint, context);
      run.go_on_after(seconds, progress, reached);
      try {
        CaptureResult result = run.run(std::move(known));
        result.summary.cameras_refined = studio.refined > 0;
        return result;
      } catch (CamerasMoved &moved) {
        move_cameras(studio, moved, context);
        known = std::move(moved.known);
        seconds = moved.seconds;
        progress = moved.progress;
        reached = moved.reached;
      }
    }
  }

  static void move_cameras(Studio &studio, const CamerasMoved &moved, const Context &context) {
    const CalibrationEstimate &found = moved.found;
    if (!moved.late_alone) {
      studio.rig = found.rig;
      studio.moved = true;
    }
    ++studio.refined;
    studio.by_take = studio.by_take || moved.by_take;
    studio.found = found.cameras;
    std::string late;
    for (size_t v = 0; v < studio.rig.size(); ++v) {
      studio.delays[v] += static_cast<int>(std::lround(found.cameras[v].late));
      if (studio.delays[v] != 0)
        late += (late.empty() ? "" : ", ") + studio.rig[v].name + " by " + std::to_string(studio.delays[v]);
      studio.found[v].late = studio.found[v].delay = studio.delays[v];
    }
    char line[160];
    std::snprintf(line, sizeof line, "the calibration is %.1f mm off on the actor (outlines %.2f px, %.2f when refined)",
                  1000 * found.change, found.before_px, found.after_px);
    const std::string cameras = moved.late_alone ? "the calibration stays as it is" : line;
    context.log_line("capture: " + cameras + (late.empty() ? "" : "; frames late: " + late) + "; it begins again");
  }

  /// A letter for each piece that is not made from the options.
  static std::string own_parts(const CaptureParts &parts) {
    return std::string(parts.features ? "f" : "") + (parts.pose ? "p" : "") + (parts.limbs ? "l" : "") +
           (parts.surface ? "s" : "");
  }

  CaptureOptions options_;
  CaptureParts parts_;
  std::string own_parts_;
};

} // namespace

Session filmed(Session session, const CaptureResult &captured) {
  for (size_t c = 0; c < session.cameras.size(); ++c) {
    const std::string &name = session.cameras[c].name;
    for (const Camera &camera : captured.observations.cameras)
      if (camera.name == name)
        session.rig.at(c) = camera;
    for (const RefinedCamera &camera : captured.summary.cameras)
      if (camera.camera == name)
        session.cameras[c].late += camera.delay;
  }
  return session;
}

void CaptureOptions::validate() const {
  options::check(*this);
  if (frame_count == 0)
    options::throw_invalid("CaptureOptions: frame_count", "a number of frames, or -1 for all", "0");
  savitzky_golay_weights(smooth_window, std::min(smooth_order, smooth_window - 1));
}

std::unique_ptr<PerformanceCapture> PerformanceCapture::create(const CaptureOptions &options) {
  return create(options, {});
}

std::unique_ptr<PerformanceCapture> PerformanceCapture::create(const CaptureOptions &options, const CaptureParts &parts) {
  options.validate();
  return std::make_unique<TrackingCapture>(options, parts);
}

} // namespace doublet
