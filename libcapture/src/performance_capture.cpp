#include "doublet/capture/performance_capture.h"

#include "camera_choice.h"
#include "doublet/capture/parts/smoothing.h"
#include "feature_map.h"
#include "first_pose.h"
#include "packed_mask.h"
#include "tracked_actor.h"
#include "view_measurement.h"

#include "doublet/core/error.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <stdexcept>

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

/// Everything one run knows while it goes through the frames.
class Tracking {
public:
  Tracking(const CaptureOptions &options, const CaptureParts &parts, const RiggedMesh &actor, const CameraRig &rig,
           FrameSource &frames, const SilhouetteExtractor *extractor, const Context &context)
      : options_(options), parts_(parts), actor_(actor), rig_(rig), frames_(frames), extractor_(extractor), context_(context),
        looseness_(actor, options.loose), offset_(Vertices::Zero(actor.mesh.vertices.rows(), 3)),
        limbs_(find_limbs(actor.skeleton)), misses_(limbs_.size(), 0), next_search_(limbs_.size(), 0),
        steady_since_(actor.skeleton.dof_count(), 0) {
    for (const Joint &joint : actor.skeleton.joints)
      if (joint.dof_count > 0)
        result_.summary.joints.push_back({joint.name});
  }

  CaptureResult run(int first, int count) {
    const double start = now();
    if (!options_.use_sift)
      context_.say("capture: silhouettes alone, no texture features");
    result_.performance.surface.faces = actor_.mesh.faces;
    result_.performance.dofs.resize(count, actor_.skeleton.dof_count());
    result_.observations.cameras = rig_;
    const int passes = options_.second_pass ? 2 : 1;
    for (int pass = 0; pass < passes; ++pass) {
      if (pass > 0)
        start_again();
      for (int t = 0; t < count; ++t) {
        context_.report("capture", (static_cast<double>(t) / count + pass) / passes);
        if (pass == 0)
          measure(first + t, t);
        else
          recall(t);
        track(t);
        if (pass + 1 == passes)
          watch_joints(t);
        if (t % 20 == 0 || t + 1 == count)
          log(t, (now() - start) / (pass * count + t + 1));
      }
    }
    say_what_was_hidden();
    smooth();
    result_.summary.seconds_per_frame = (now() - start) / count;
    context_.report("capture", 1);
    return std::move(result_);
  }

private:
  void track(int t) {
    const Eigen::VectorXd dofs = find_pose(t);
    result_.performance.dofs.row(t) = dofs;
    refine(dofs, t);
  }

  void measure(int frame, int t) {
    const Stopwatch watch(result_.summary.measure_seconds);
    const int views = static_cast<int>(rig_.size());
    std::vector<ViewMeasurement> current(views);
    std::vector<ViewObservation> observed(views);
    const FeatureTracker *tracker = options_.use_sift ? parts_.features.get() : nullptr;
    parallel_for(context_, views, [&](int v) {
      current[v] = measure_view(frames_, v, frame, rig_[v], extractor_, tracker);
      observed[v].contour = current[v].outline.points;
      if (tracker && t > 0)
        for (const auto &[i, j] : checked_match(*tracker, last_[v].features, current[v].features,
                                                options_.features.max_displacement * current[v].height))
          observed[v].matches.push_back({last_[v].features.points[i], current[v].features.points[j]});
    });
    int present = 0;
    outlines_.resize(views);
    masks_.resize(views);
    const auto has_image = [](const ViewMeasurement &view) { return view.has_image; };
    if (t == 0 && tracker && std::none_of(current.begin(), current.end(), has_image))
      context_.say("capture: masks without images: silhouettes alone, no texture features");
    for (int v = 0; v < views; ++v) {
      present += !current[v].outline.empty();
      outlines_[v] = std::move(current[v].outline);
      masks_[v] = std::move(current[v].mask);
    }
    if (present == 0)
      throw Error("capture: no camera shows the actor at frame " + std::to_string(frame));
    last_ = std::move(current);
    result_.summary.views.push_back(present);
    result_.performance.frames.push_back(frame);
    result_.observations.frames.push_back(frame);
    result_.observations.views.push_back(std::move(observed));
    kept_.push_back({outlines_, pack(masks_), {}});
  }

  /// Everything is tracked a second time, from the first frame on and with the measurements at hand, knowing what is loose: until
  /// a garment has been seen to swing it passes for skin, and drags the limbs under it along.
  void start_again() {
    context_.say("capture: again, knowing what is loose");
    again_ = true;
    looseness_.settle(offsets_);
    offsets_.clear();
    offset_.setZero();
    std::fill(misses_.begin(), misses_.end(), 0);
    std::fill(next_search_.begin(), next_search_.end(), 0);
    std::fill(steady_since_.begin(), steady_since_.end(), 0);
    result_.summary.rim_px.clear();
    result_.summary.sift_px.clear();
    result_.summary.silhouette_iou.clear();
    result_.summary.lost_limbs.clear();
  }

  /// What was measured at a frame.
  void recall(int t) {
    outlines_ = kept_[t].outlines;
    masks_ = unpack(kept_[t].masks);
  }

  /// Features seen at t-1, lifted onto the refined surface there.
  std::vector<SurfaceTrack> lift_tracks(int t) {
    const Stopwatch watch(result_.summary.map_seconds);
    const int views = static_cast<int>(rig_.size());
    std::vector<std::vector<SurfaceTrack>> tracks(views);
    if (t > 0)
      parallel_for(context_, views, [&](int v) {
        tracks[v] = lift_matches(result_.observations.views[t].at(v).matches, v, last_surface_, actor_, rig_[v], visible_[v]);
      });
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
      found[v] =
          map_.find(last_[v].features, *parts_.features, actor_, expected, v, rig_[v], options_.map_reach * last_[v].height);
    });
    for (const auto &part : found)
      all.insert(all.end(), part.begin(), part.end());
    return all;
  }

  Eigen::VectorXd find_pose(int t) {
    PoseProblem problem;
    problem.actor = &actor_;
    problem.rig = &rig_;
    problem.outlines = &outlines_;

    problem.offset = offset_;
    problem.reliability = looseness_.reliability();
    problem.first = t == 0 && !again_;
    problem.predicted = problem.first ? first_pose(actor_, rig_, masks_, context_) : predict(t);
    problem.start = problem.predicted;
    lifted_ = lift_tracks(t);
    problem.tracks = find_tracks(problem.predicted, t);
    PoseEstimate estimate;
    {
      const Stopwatch watch(result_.summary.pose_seconds);
      estimate = optimize(problem, t);
    }
    if (options_.find_lost_limbs)
      recover_limbs(problem, estimate, t);
    result_.summary.rim_px.push_back(estimate.rim_px);
    result_.summary.sift_px.push_back(estimate.sift_px);
    return estimate.dofs;
  }

  PoseEstimate optimize(const PoseProblem &problem, int t) {
    PoseEstimate estimate = parts_.pose->optimize(problem, context_);
    require_pose(estimate.dofs, "pose optimizer", t);
    return estimate;
  }

  void require_pose(const Eigen::VectorXd &dofs, const std::string &piece, int t) const {
    if (dofs.size() != actor_.skeleton.dof_count() || !dofs.allFinite())
      throw Error("capture: the " + piece + " returned " + std::to_string(dofs.size()) + " values at frame " +
                  std::to_string(result_.performance.frames[t]) + ", expected " + std::to_string(actor_.skeleton.dof_count()) +
                  " finite ones");
  }

  /// Limbs with too large an error are sought globally and optimised again; the pose that overlaps better is kept. A limb that
  /// was not found is sought again after a wait that grows with every miss: a mask may hold something that is no limb.
  void recover_limbs(const PoseProblem &problem, PoseEstimate &estimate, int t) {
    constexpr int kLongestWait = 10; // frames
    const Stopwatch watch(result_.summary.limb_seconds);
    const LimbProblem limbs{&actor_, &rig_, &masks_, offset_, problem.reliability, problem.predicted};
    const Eigen::VectorXd before = limb_errors(limbs, estimate.dofs, limbs_, options_.limbs, context_);
    std::vector<Limb> sought;
    for (size_t l = 0; l < limbs_.size(); ++l)
      if (before[l] > options_.limbs.lost && t >= next_search_[l])
        sought.push_back(limbs_[l]);
    Eigen::VectorXd after = before;
    if (!sought.empty()) {
      PoseProblem again = problem;
      again.start = parts_.limbs->search(limbs, estimate.dofs, sought, context_);
      require_pose(again.start, "limb search", t);
      for (const Limb &limb : sought)
        again.predicted(limb.dofs) = again.start(limb.dofs);
      again.tracks = find_tracks(again.start, t);
      const PoseEstimate found = optimize(again, t);
      if (overlap_energy(limbs, found.dofs, options_.limbs, context_) <
          overlap_energy(limbs, estimate.dofs, options_.limbs, context_)) {
        estimate = found;
        after = limb_errors(limbs, estimate.dofs, limbs_, options_.limbs, context_);
        for (const Limb &limb : sought)
          for (int d : limb.dofs)
            steady_since_[d] = t;
      }
    }
    for (size_t l = 0; l < limbs_.size(); ++l) {
      const bool lost = after[l] > options_.limbs.lost, searched = t >= next_search_[l];
      if (!lost)
        misses_[l] = 0;
      else if (searched)
        next_search_[l] = t + std::min(++misses_[l], kLongestWait);
      if (before[l] > options_.limbs.lost)
        note_lost({result_.performance.frames[t], limbs_[l].name, before[l], after[l], !lost}, searched);
    }
  }

  void note_lost(const LostLimb &lost, bool searched) {
    result_.summary.lost_limbs.push_back(lost);
    char line[200];
    std::snprintf(line, sizeof line, "capture: frame %d, limb '%s' lost (%.1f cm off), %s (%.1f cm)", lost.frame,
                  lost.limb.c_str(), 100 * lost.before, lost.recovered ? "found again" : "not found", 100 * lost.after);
    if (searched)
      context_.say(line);
  }

  /// From the last three frames: damped velocity and a share of its change; both only since the limb was last found again.
  Eigen::VectorXd predict(int t) const {
    const MatrixRM &x = result_.performance.dofs;
    Eigen::VectorXd prediction = x.row(std::max(t - 1, 0));
    for (int d = 0; d < prediction.size(); ++d) {
      if (t - 2 >= steady_since_[d])
        prediction[d] += options_.velocity_damping * (x(t - 1, d) - x(t - 2, d));
      if (t - 3 >= steady_since_[d])
        prediction[d] += options_.acceleration * (x(t - 1, d) - 2 * x(t - 2, d) + x(t - 3, d));
    }
    return prediction.cwiseMax(actor_.skeleton.lower).cwiseMin(actor_.skeleton.upper);
  }

  void refine(const Eigen::VectorXd &dofs, int t) {
    const PosedSurface expected = pose_surface(actor_, dofs, offset_);
    const PosedSurface skinned = pose_surface(actor_, dofs, {});
    SurfaceProblem problem;
    problem.actor = &actor_;
    problem.rig = &rig_;
    problem.outlines = &outlines_;
    problem.tracks = tracks_ = find_tracks(dofs, t);
    if (!again_)
      kept_[t].mapped.assign(tracks_.begin() + static_cast<long>(lifted_.size()), tracks_.end());
    const Stopwatch watch(result_.summary.surface_seconds);
    problem.base = expected.vertices;
    problem.skinned = skinned.vertices;
    problem.reliability = looseness_.reliability();
    last_surface_ = parts_.surface->refine(problem, context_).vertices;
    if (last_surface_.rows() != skinned.vertices.rows() || !last_surface_.allFinite())
      throw Error("capture: the surface refiner returned " + std::to_string(last_surface_.rows()) + " vertices at frame " +
                  std::to_string(result_.performance.frames[t]) + ", expected " + std::to_string(skinned.vertices.rows()) +
                  " finite ones");
    looseness_.learn(last_surface_, skinned.vertices);
    offsets_.push_back(rest_offset(actor_, skinned.blend, last_surface_));
    const Eigen::VectorXd loose = 1 - looseness_.reliability().array();
    offset_ = options_.offset_decay * (loose.asDiagonal() * offsets_.back());
    look();
    if (t == 0 && !again_ && options_.use_sift && options_.use_feature_map)
      for (size_t v = 0; v < rig_.size(); ++v)
        map_.add(last_[v].features, actor_, {skinned.blend, last_surface_}, rig_[v], visible_[v]);
  }

  /// What each camera sees of the refined surface: for lifting the next frame's tracks, and for the overlap with the measured
  /// masks.
  void look() {
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
    result_.summary.silhouette_iou.push_back(sum / count);
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

  /// Which joints the frame shows: see JointSight.
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
    for (JointSight &sight : result_.summary.joints) {
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
    for (const JointSight &sight : result_.summary.joints)
      if (sight.inferred + sight.lost > 0)
        context_.say("capture: joint '" + sight.joint + "': seen in " + std::to_string(sight.seen) + " frames, inferred in " +
                     std::to_string(sight.inferred) + ", lost in " + std::to_string(sight.lost));
  }

  void log(int t, double seconds_per_frame) const {
    char line[200];
    const CaptureSummary &s = result_.summary;
    std::snprintf(line, sizeof line,
                  "capture: frame %d, %d cameras, outline %.2f px, features %.2f px (%zu), overlap %.3f, %.2f s a frame",
                  result_.performance.frames[t], s.views[t], s.rim_px[t], s.sift_px[t], tracks_.size(), s.silhouette_iou[t],
                  seconds_per_frame);
    context_.say(line);
  }

  const CaptureOptions &options_;
  const CaptureParts &parts_;
  const RiggedMesh &actor_;
  const CameraRig &rig_;
  FrameSource &frames_;
  const SilhouetteExtractor *extractor_;
  const Context &context_;
  CaptureResult result_;
  Looseness looseness_;
  Vertices offset_;                   // expected non-rigid offset, rest pose
  std::vector<Vertices> offsets_;     // T x (V, 3), refined, rest pose
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
  std::vector<int> misses_, next_search_; // by limb: searches in a row that failed, frame index of the next one
  std::vector<int> steady_since_;         // by dof: frame index from which it has moved without a jump
  Vertices last_surface_;
  std::vector<FaceBuffer> visible_;
};

class TrackingCapture : public PerformanceCapture {
public:
  TrackingCapture(const CaptureOptions &options, const CaptureParts &parts) : options_(options), parts_(parts) {
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
    const CameraChoice chosen(options_.cameras, rig, frames, extractor);
    const TrackedActor tracked = track_actor(actor, options_.ends_turn);
    CaptureResult result = Tracking(options_, parts_, tracked.actor, chosen.rig(), chosen.frames(), chosen.extractor(), context)
                               .run(options_.first_frame, count);
    result.performance.dofs = MatrixRM(result.performance.dofs(Eigen::all, tracked.kept));
    return result;
  }

private:
  CaptureOptions options_;
  CaptureParts parts_;
};

} // namespace

void CaptureOptions::validate() const {
  options::check(*this);
  if (frame_count == 0)
    options::refuse("CaptureOptions: frame_count", "a number of frames, or -1 for all", "0");
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
