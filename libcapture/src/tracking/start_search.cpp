#include "start_search.h"

#include "doublet/capture/start_frame.h"
#include "doublet/core/error.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <stdexcept>

namespace doublet {
namespace {

/// The masks of all cameras at a frame.
std::vector<Image> masks_at(const CameraRig &rig, FrameSource &frames, const SilhouetteExtractor *extractor, int frame,
                            const Context &context) {
  std::vector<Image> masks(rig.size());
  parallel_for(context, static_cast<int>(rig.size()), [&](int v) { masks[v] = read_view(frames, v, frame, extractor).mask; });
  return masks;
}

bool more_alike(const LikelyStart &a, const LikelyStart &b) {
  return a.placed.overlap > b.placed.overlap;
}

/// The best of those that are at least `apart` frames from every better one that was taken.
std::vector<LikelyStart> peaks(std::vector<LikelyStart> tried, int apart, int most) {
  std::stable_sort(tried.begin(), tried.end(), more_alike);
  std::vector<LikelyStart> taken;
  for (const LikelyStart &start : tried)
    if (static_cast<int>(taken.size()) < most && start.placed.overlap > 0 &&
        std::all_of(taken.begin(), taken.end(), [&](const LikelyStart &t) { return std::abs(t.frame - start.frame) >= apart; }))
      taken.push_back(start);
  return taken;
}

/// The mesh with one vertex for all in a cell of a grid, their mean; what falls together is gone. For silhouettes a few pixels
/// wide.
Mesh thinned(const Mesh &mesh, double cell) {
  std::map<std::array<double, 3>, int> place;
  std::vector<int> of_vertex(mesh.vertices.rows()), count;
  std::vector<Eigen::RowVector3d> sum;
  for (int i = 0; i < mesh.vertices.rows(); ++i) {
    const Eigen::RowVector3d x = mesh.vertices.row(i);
    const std::array<double, 3> key{std::floor(x[0] / cell), std::floor(x[1] / cell), std::floor(x[2] / cell)};
    const auto [at, is_new] = place.try_emplace(key, static_cast<int>(sum.size()));
    if (is_new) {
      sum.emplace_back(Eigen::RowVector3d::Zero());
      count.push_back(0);
    }
    of_vertex[i] = at->second;
    sum[at->second] += x;
    ++count[at->second];
  }
  std::vector<Eigen::RowVector3i> faces;
  for (int f = 0; f < mesh.faces.rows(); ++f) {
    const Eigen::RowVector3i own(of_vertex[mesh.faces(f, 0)], of_vertex[mesh.faces(f, 1)], of_vertex[mesh.faces(f, 2)]);
    if (own[0] != own[1] && own[1] != own[2] && own[2] != own[0])
      faces.push_back(own);
  }
  Mesh thin{Vertices(sum.size(), 3), Faces(faces.size(), 3)};
  for (size_t i = 0; i < sum.size(); ++i)
    thin.vertices.row(i) = sum[i] / count[i];
  for (size_t f = 0; f < faces.size(); ++f)
    thin.faces.row(f) = faces[f];
  return thin;
}

/// A scan as an actor that moves as a whole.
RiggedMesh rigid_actor(const Mesh &scan) {
  constexpr double kCell = 0.015; // m; a pixel of the small views, when a person fills them
  RiggedMesh actor;
  actor.mesh = thinned(scan, kCell);
  actor.face_valid.assign(actor.mesh.faces.rows(), 1);
  actor.weights = MatrixRM::Ones(actor.mesh.vertices.rows(), 1);
  actor.skeleton = make_skeleton({{"scan", "", actor.mesh.vertices.colwise().mean().transpose(), 6}});
  return actor;
}

} // namespace

StartFrame find_start_frame(const Mesh &scan, const CameraRig &rig, FrameSource &frames, const SilhouetteExtractor *extractor,
                            const Context &context) {
  require_usable(scan, "find_start_frame: scan");
  if (frames.frame_count() < 1 || frames.camera_count() != static_cast<int>(rig.size()))
    throw std::invalid_argument("find_start_frame: expected frames of the rig's " + std::to_string(rig.size()) +
                                " cameras, found " + std::to_string(frames.frame_count()) + " of " +
                                std::to_string(frames.camera_count()));
  const RiggedMesh actor = rigid_actor(scan);
  LikelyStart best{0, first_pose(actor, rig, masks_at(rig, frames, extractor, 0, context), context)};
  const double first = best.placed.overlap;
  if (first < kScanPoseOverlap)
    for (const LikelyStart &other : frames_like_the_scan(actor, rig, frames, extractor, 0, frames.frame_count(), 3, context))
      if (more_alike(other, best))
        best = other;
  return {best.frame, best.placed.overlap, first, forward_kinematics(actor.skeleton, best.placed.dofs)[0]};
}

std::vector<LikelyStart> frames_like_the_scan(const RiggedMesh &actor, const CameraRig &rig, FrameSource &frames,
                                              const SilhouetteExtractor *extractor, int first, int count, int most,
                                              const Context &context) {
  constexpr int kTries = 24, kLongestStride = 8; // a fifth of a second at 40 fps: a pose that is held is not missed
  const int stride = std::clamp(count / kTries, 1, kLongestStride);
  const double looks = (count + stride - 1) / stride + most * (2 * stride - 1);
  int looked = 0;
  const auto look = [&](int frame) {
    context.throw_if_cancelled();
    context.report_progress("where to begin", std::min(1.0, looked++ / looks));
    return LikelyStart{frame, rough_first_pose(actor, rig, masks_at(rig, frames, extractor, frame, context), context)};
  };
  std::vector<LikelyStart> tried;
  for (int frame = first; frame < first + count; frame += stride)
    tried.push_back(look(frame));
  std::vector<LikelyStart> best = peaks(tried, 2 * stride, most);
  for (LikelyStart &peak : best) {
    const int from = std::max(first, peak.frame - stride + 1), to = std::min(first + count, peak.frame + stride);
    for (int frame = from; frame < to; ++frame)
      if (const LikelyStart near = look(frame); more_alike(near, peak))
        peak = near;
    peak.placed = first_pose(actor, rig, masks_at(rig, frames, extractor, peak.frame, context), context);
  }
  std::stable_sort(best.begin(), best.end(), more_alike);
  return best;
}

namespace {

/// The pose of one frame from a few places to begin with.
class PoseSearch {
public:
  PoseSearch(const StartProblem &problem, PoseOptimizer &optimizer, LimbSearch &search, const LimbSearchOptions &options,
             const Context &context)
      : problem_(problem), optimizer_(optimizer), search_(search), options_(options), context_(context),
        limbs_(find_limbs(problem.actor->skeleton)), no_offset_(Vertices::Zero(problem.actor->mesh.vertices.rows(), 3)) {}

  struct Found {
    Eigen::VectorXd placed, dofs; // before and after
    double wrong = 0;
  };

  Found from(const Eigen::VectorXd &placed) const { return optimized(placed, placed); }

  /// The limbs that are lost are sought, and all is optimised again, as long as that helps.
  Found with_lost_limbs(const Found &found) const {
    constexpr int kLimbRounds = 2;
    Found best = found;
    for (int round = 0; round < kLimbRounds; ++round) {
      const std::vector<Limb> lost = lost_limbs(best.dofs);
      if (lost.empty())
        break;
      const Eigen::VectorXd &expected = round == 0 ? found.placed : best.dofs;
      const Found again = optimized(found.placed, search_.search(about(expected), best.dofs, lost, context_));
      if (again.wrong >= best.wrong)
        break;
      best = again;
    }
    return best;
  }

private:
  LimbProblem about(const Eigen::VectorXd &expected) const {
    return {problem_.actor, problem_.rig, problem_.masks, no_offset_, problem_.reliability, expected, problem_.points};
  }

  Found optimized(const Eigen::VectorXd &placed, const Eigen::VectorXd &start) const {
    PoseProblem pose;
    pose.actor = problem_.actor;
    pose.rig = problem_.rig;
    pose.outlines = problem_.outlines;
    pose.offset = no_offset_;
    pose.reliability = problem_.reliability;
    pose.points = problem_.points;
    pose.predicted = pose.start = start;
    pose.first = true;
    const Eigen::VectorXd dofs = optimizer_.optimize(pose, context_).dofs;
    if (dofs.size() != start.size() || !dofs.allFinite())
      throw Error("capture: the pose optimizer returned " + std::to_string(dofs.size()) + " values for the start, expected " +
                  std::to_string(start.size()) + " finite ones");
    return {placed, dofs, overlap_energy(about(start), dofs, options_, context_)};
  }

  std::vector<Limb> lost_limbs(const Eigen::VectorXd &dofs) const {
    const Eigen::VectorXd errors = limb_errors(about(dofs), dofs, limbs_, options_, context_);
    std::vector<Limb> lost;
    for (size_t l = 0; l < limbs_.size(); ++l)
      if (errors[l] > options_.lost_error)
        lost.push_back(limbs_[l]);
    return lost;
  }

  const StartProblem &problem_;
  PoseOptimizer &optimizer_;
  LimbSearch &search_;
  const LimbSearchOptions &options_;
  const Context &context_;
  std::vector<Limb> limbs_;
  Vertices no_offset_;
};

} // namespace

FoundPose search_pose(const StartProblem &problem, PoseOptimizer &optimizer, LimbSearch &search, const LimbSearchOptions &options,
                      const Context &context) {
  constexpr int kHeadings = 8;  // 45 degrees apart: the optimisation turns as far
  constexpr double kSame = 0.4; // rad; two that end so near are one
  const int heading = root_joint(problem.actor->skeleton).first_dof + 3;
  const PoseSearch pose_search(problem, optimizer, search, options, context);
  std::vector<PoseSearch::Found> tries;
  for (const PlacedPose &placed : placed_all_around(*problem.actor, *problem.rig, *problem.masks, kHeadings, context))
    tries.push_back(pose_search.from(placed.dofs));
  if (tries.empty())
    throw std::invalid_argument("search_pose: expected the actor in two cameras at least");
  const auto fewer = [](const auto &a, const auto &b) { return a.wrong < b.wrong; };
  const auto cosine = [&](const auto &a, const auto &b) { return std::cos(a.dofs[heading] - b.dofs[heading]); };
  std::stable_sort(tries.begin(), tries.end(), fewer);
  std::vector<PoseSearch::Found> distinct;
  for (const PoseSearch::Found &found : tries)
    if (std::all_of(distinct.begin(), distinct.end(), [&](const auto &other) { return cosine(found, other) < std::cos(kSame); }))
      distinct.push_back(found);
  for (PoseSearch::Found &found : distinct)
    found = pose_search.with_lost_limbs(found);
  const PoseSearch::Found &best = *std::min_element(distinct.begin(), distinct.end(), fewer);
  FoundPose result{best.dofs, best.wrong, 1};
  for (const PoseSearch::Found &other : distinct)
    if (cosine(other, best) < 0)
      result.rival = std::min(result.rival, other.wrong);
  return result;
}

} // namespace doublet
