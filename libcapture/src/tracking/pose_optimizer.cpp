#include "doublet/capture/pose_optimizer.h"

#include "../weighted_rows.h"
#include "shown_surface.h"

#include "doublet/core/skinning.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace doublet {
namespace {

using detail::ShownSurface;
using detail::WeightedRows;

constexpr double kUnit = 0.01; // m; residual that costs one unit, so that prior weights count correspondences

double geman_mcclure(double squared, double scale) {
  return squared / (squared + scale * scale);
}
double geman_mcclure_weight(double squared, double scale) {
  const double s = scale * scale / (squared + scale * scale);
  return s * s;
}

/// The normal equations H x = -g and the energy they come from.
struct NormalEquations {
  Eigen::MatrixXd hessian;
  Eigen::VectorXd gradient;
  double energy = 0;
  explicit NormalEquations(int size) : hessian(Eigen::MatrixXd::Zero(size, size)), gradient(Eigen::VectorXd::Zero(size)) {}
  void add(const NormalEquations &other) {
    hessian += other.hessian;
    gradient += other.gradient;
    energy += other.energy;
  }
};

double at(const Eigen::VectorXd &values, const SurfacePoint &p, const Faces &faces) {
  return p.barycentric[0] * values[faces(p.face, 0)] + p.barycentric[1] * values[faces(p.face, 1)] +
         p.barycentric[2] * values[faces(p.face, 2)];
}

class GaussNewtonPose : public PoseOptimizer {
public:
  explicit GaussNewtonPose(const PoseOptions &options) : options_(options) {}

  PoseEstimate optimize(const PoseProblem &problem, const Context &context) override {
    prepare(problem);
    const int iterations = problem.first ? options_.first_iterations : options_.iterations;
    PoseEstimate estimate;
    estimate.dofs = problem.start;
    posed_ = pose_surface(*actor_, estimate.dofs, problem.offset);
    double damping = 1e-3;
    for (int k = 0; k < iterations; ++k) {
      const double progress = iterations > 1 ? static_cast<double>(k) / (iterations - 1) : 1.0;
      const double widen = problem.first ? 2.0 : 1.0;
      gate_ = widen * options_.gate_start * std::pow(options_.gate_end / options_.gate_start / widen, progress);
      scale_ = widen * options_.scale_start * std::pow(options_.scale_end / options_.scale_start / widen, progress);
      match(problem, context);
      step(problem, context, estimate, damping);
      estimate.iterations = k + 1;
      context.throw_if_cancelled();
    }
    if (const Eigen::VectorXd allowed = clamped(estimate.dofs); allowed != estimate.dofs) {
      estimate.dofs = allowed;
      posed_ = pose_surface(*actor_, allowed, problem.offset);
    }
    measure(problem, estimate);
    return estimate;
  }

private:
  void prepare(const PoseProblem &problem) {
    if (!problem.actor || !problem.rig || !problem.outlines || problem.outlines->size() != problem.rig->size())
      throw std::invalid_argument("PoseOptimizer: the problem needs an actor, a rig and one outline per camera");
    actor_ = problem.actor;
    const int dofs = actor_->skeleton.dof_count();
    if (problem.start.size() != dofs || problem.predicted.size() != dofs ||
        problem.reliability.size() != actor_->mesh.vertices.rows())
      throw std::invalid_argument(
          "PoseOptimizer: the problem needs a start and a prediction of all degrees of freedom, and a reliability per vertex");
    detail::require_tracks(problem.tracks, problem.rig->size(), actor_->mesh.faces, "PoseOptimizer");
    if (problem.timing.late.size() > 0 && (problem.timing.late.size() != static_cast<Eigen::Index>(problem.rig->size()) ||
                                           problem.timing.velocity.rows() != problem.actor->mesh.vertices.rows()))
      throw std::invalid_argument("PoseOptimizer: the timing needs a delay per camera and a velocity per vertex");
    for (const SeenPoint &point : problem.points)
      if (point.joint < 0 || point.joint >= actor_->skeleton.joint_count() || !point.rest.allFinite() ||
          !point.seen.allFinite() || !(point.tolerance >= 0))
        throw std::invalid_argument(
            "PoseOptimizer: a seen point must have a joint of the skeleton, finite places and a tolerance");
    moved_ = dof_moves_joint(actor_->skeleton);
    influence_ = dof_influence(*actor_); // anew: another actor may be at the same address
    views_ = static_cast<int>(problem.rig->size());
    indices_.clear();
    for (int v = 0; v < views_; ++v)
      indices_.emplace_back((*problem.outlines)[v], (*problem.rig)[v].width, (*problem.rig)[v].height);
    matches_.assign(views_, {});
  }

  void match(const PoseProblem &problem, const Context &context) {
    const ShownSurface shown(posed_.vertices, problem.timing);
    RimMatchOptions options;
    options.count = options_.rims_per_view;
    options.gate = gate_;
    parallel_for(context, views_, [&](int v) {
      if ((*problem.outlines)[v].empty())
        return;
      const Camera &camera = (*problem.rig)[v];
      const Rims rims = find_rims(shown.in(v), actor_->mesh.faces, actor_->face_valid, camera, options_.raster_size);
      matches_[v] = match_rims(rims, (*problem.outlines)[v], indices_[v], v, camera, options);
    });
  }

  /// One accepted Levenberg-Marquardt step with the current matches; leaves the pose if none lowers the energy.
  void step(const PoseProblem &problem, const Context &context, PoseEstimate &estimate, double &damping) {
    const NormalEquations system = linearize(problem, context, estimate.dofs, posed_.vertices, true);
    estimate.energy = system.energy;
    for (int attempt = 0; attempt < 4; ++attempt) {
      Eigen::MatrixXd h = system.hessian.selfadjointView<Eigen::Lower>();
      h.diagonal() += damping * h.diagonal() + Eigen::VectorXd::Constant(h.rows(), 1e-6);
      const Eigen::VectorXd candidate = clamped(estimate.dofs - h.ldlt().solve(system.gradient));
      if (candidate.allFinite()) {
        PosedSurface posed = pose_surface(*actor_, candidate, problem.offset);
        if (linearize(problem, context, candidate, posed.vertices, false).energy < system.energy) {
          estimate.dofs = candidate;
          posed_ = std::move(posed);
          damping = std::max(damping * 0.3, 1e-5);
          return;
        }
      }
      damping = std::min(damping * 10, 1e3);
    }
  }

  /// Robust energy at a pose, in which the surface is `vertices`, and its Gauss-Newton system if asked for; one partial sum a
  /// view, added in order.
  NormalEquations linearize(const PoseProblem &problem, const Context &context, const Eigen::VectorXd &dofs,
                            const Vertices &vertices, bool derivatives) {
    const std::vector<DofTwist> twists = dof_twists(actor_->skeleton, dofs);
    const int size = static_cast<int>(dofs.size());
    const ShownSurface shown(vertices, problem.timing);
    std::vector<NormalEquations> parts(views_, NormalEquations(size));
    parallel_for(context, views_, [&](int v) { add_view(problem, v, shown.in(v), twists, derivatives, parts[v]); });
    NormalEquations sum(size);
    for (const NormalEquations &part : parts)
      sum.add(part);
    add_points(problem, dofs, twists, derivatives, sum);
    add_prior(problem, dofs, sum);
    return sum;
  }

  void add_view(const PoseProblem &problem, int view, const Vertices &vertices, const std::vector<DofTwist> &twists,
                bool derivatives, NormalEquations &system) const {
    const Faces &faces = actor_->mesh.faces;
    const Camera &camera = (*problem.rig)[view];
    WeightedRows rows(system.hessian, system.gradient);
    for (const RimConstraint &c : matches_[view].constraints) {
      const Eigen::Vector3d x = c.surface.position(vertices, faces);
      if (camera.depth(x) <= 0)
        continue;
      const double residual = c.metres_per_pixel * c.normal.dot(camera.project(x) - c.target);
      const double weight = at(problem.reliability, c.surface, faces) / (kUnit * kUnit);
      system.energy += weight * scale_ * scale_ * geman_mcclure(residual * residual, scale_);
      if (derivatives) {
        const Eigen::RowVector3d slope = c.metres_per_pixel * c.normal.transpose() * camera.project_jacobian(x);
        rows.add((slope * surface_jacobian(c.surface, vertices, faces, influence_, twists)).transpose(), residual,
                 weight * geman_mcclure_weight(residual * residual, scale_));
      }
    }
    for (const SurfaceTrack &track : problem.tracks)
      if (track.view == view)
        add_track(problem, track, camera, vertices, twists, derivatives, system, rows);
    rows.finish();
  }

  void add_track(const PoseProblem &problem, const SurfaceTrack &track, const Camera &camera, const Vertices &vertices,
                 const std::vector<DofTwist> &twists, bool derivatives, NormalEquations &system, WeightedRows &rows) const {
    const Faces &faces = actor_->mesh.faces;
    const Eigen::Vector3d x = track.surface.position(vertices, faces);
    if (camera.depth(x) <= 0)
      return;
    const double metres_per_pixel = camera.depth(x) / camera.K(0, 0);
    const Eigen::Vector2d residual = metres_per_pixel * (camera.project(x) - track.pixel);
    // Squared: cloth that hangs on a limb follows it with a lag, and its many features would hold the limb back.
    const double reliable = at(problem.reliability, track.surface, faces);
    const double weight = options_.sift_weight * track.weight * reliable * reliable / (kUnit * kUnit);
    system.energy += weight * scale_ * scale_ * geman_mcclure(residual.squaredNorm(), scale_);
    if (!derivatives)
      return;
    const Eigen::Matrix2Xd jacobian =
        metres_per_pixel * camera.project_jacobian(x) * surface_jacobian(track.surface, vertices, faces, influence_, twists);
    const double robust = weight * geman_mcclure_weight(residual.squaredNorm(), scale_);
    for (int axis = 0; axis < 2; ++axis)
      rows.add(jacobian.row(axis).transpose(), residual[axis], robust);
  }

  void add_points(const PoseProblem &problem, const Eigen::VectorXd &dofs, const std::vector<DofTwist> &twists, bool derivatives,
                  NormalEquations &system) const {
    if (problem.points.empty())
      return;
    const Transforms world_from_rest = forward_kinematics(actor_->skeleton, dofs);
    const double weight = options_.keypoint_weight / (kUnit * kUnit),
                 scale = options_.keypoint_scale * scale_ / options_.scale_end;
    WeightedRows rows(system.hessian, system.gradient);
    for (const SeenPoint &point : problem.points) {
      const Eigen::Vector3d x = world_from_rest[point.joint] * point.rest;
      const double residual = point.beyond(x);
      system.energy += weight * scale * scale * geman_mcclure(residual * residual, scale);
      if (!derivatives || residual == 0)
        continue;
      Eigen::Matrix3Xd jacobian = Eigen::Matrix3Xd::Zero(3, dofs.size());
      for (int d = 0; d < dofs.size(); ++d)
        if (moved_(d, point.joint))
          jacobian.col(d) = twists[d].angular.cross(x) + twists[d].linear;
      const Eigen::Vector3d off = residual * (x - point.seen).normalized(); // from the nearest place that is tolerated
      const double robust = weight * geman_mcclure_weight(residual * residual, scale);
      for (int axis = 0; axis < 3; ++axis)
        rows.add(jacobian.row(axis).transpose(), off[axis], robust);
    }
    rows.finish();
  }

  /// Pull to the prediction, and walls at the joint limits.
  void add_prior(const PoseProblem &problem, const Eigen::VectorXd &dofs, NormalEquations &system) const {
    const Skeleton &skeleton = actor_->skeleton;
    for (int d = 0; d < dofs.size(); ++d) {
      const bool shift = is_shift(d);
      const double unit = shift ? options_.prior_shift : options_.prior_angle;
      const double weight = (problem.first ? 1e-2 : 1.0) * options_.prior_weight / (unit * unit);
      const double off = dofs[d] - problem.predicted[d];
      system.energy += weight * off * off;
      system.hessian(d, d) += weight;
      system.gradient[d] += weight * off;
      const double beyond = dofs[d] - std::clamp(dofs[d], skeleton.lower[d], skeleton.upper[d]);
      if (beyond != 0) {
        const double wall = options_.limit_weight / (unit * unit);
        system.energy += wall * beyond * beyond;
        system.hessian(d, d) += wall;
        system.gradient[d] += wall * beyond;
      }
    }
  }

  bool is_shift(int dof) const {
    for (const Joint &joint : actor_->skeleton.joints)
      if (joint.kind == JointKind::Root)
        return dof >= joint.first_dof && dof < joint.first_dof + 3;
    return false;
  }

  Eigen::VectorXd clamped(const Eigen::VectorXd &dofs) const {
    const Skeleton &skeleton = actor_->skeleton;
    return dofs.cwiseMax(skeleton.lower).cwiseMin(skeleton.upper);
  }

  /// Residuals of the last matches at the final pose.
  void measure(const PoseProblem &problem, PoseEstimate &estimate) const {
    const ShownSurface shown(posed_.vertices, problem.timing);
    const Faces &faces = actor_->mesh.faces;
    double rim = 0, sift = 0, energy = 0, samples = 0, rims = 0;
    for (int v = 0; v < views_; ++v) {
      for (const RimConstraint &c : matches_[v].constraints) {
        const double residual = std::abs(rim_residual(c, shown.in(v), faces, (*problem.rig)[v]));
        const double metres = residual * c.metres_per_pixel, weight = at(problem.reliability, c.surface, faces);
        rim += residual;
        rims += 1;
        energy += weight * geman_mcclure(metres * metres, options_.scale_end);
        samples += weight;
      }
      energy += matches_[v].unmatched;
      samples += matches_[v].unmatched;
    }
    for (const SurfaceTrack &track : problem.tracks)
      sift += ((*problem.rig)[track.view].project(track.surface.position(shown.in(track.view), faces)) - track.pixel).norm();
    estimate.rim_px = rims > 0 ? rim / rims : 0;
    estimate.sift_px = problem.tracks.empty() ? 0 : sift / problem.tracks.size();
    estimate.energy = samples > 0 ? energy / samples : 1;
  }

  PoseOptions options_;
  const RiggedMesh *actor_ = nullptr;
  MatrixRM influence_;
  Eigen::Matrix<bool, Eigen::Dynamic, Eigen::Dynamic> moved_; // (D, J)
  int views_ = 0;
  std::vector<OutlineIndex> indices_;
  std::vector<RimMatches> matches_;
  PosedSurface posed_; // in the pose that is best so far
  double gate_ = 0, scale_ = 0;
};

} // namespace

std::unique_ptr<PoseOptimizer> PoseOptimizer::create(const PoseOptions &options) {
  options.validate();
  return std::make_unique<GaussNewtonPose>(options);
}

PosedSurface pose_surface(const RiggedMesh &actor, const Eigen::VectorXd &dofs, const Vertices &offset) {
  const auto vertices = actor.mesh.vertices.rows();
  if ((offset.rows() > 0 && offset.rows() != vertices) || actor.weights.rows() != vertices)
    throw std::invalid_argument("pose_surface: expected " + std::to_string(vertices) + " rows of weights and of offset, found " +
                                std::to_string(actor.weights.rows()) + " and " + std::to_string(offset.rows()));
  if (!offset.allFinite())
    throw std::invalid_argument("pose_surface: offset: expected finite numbers, found NaN or infinity");
  PosedSurface surface;
  surface.blend = dual_quaternion_blend(actor.weights, actor.skeleton, forward_kinematics(actor.skeleton, dofs));
  surface.vertices.resize(actor.mesh.vertices.rows(), 3);
  for (int i = 0; i < surface.vertices.rows(); ++i) {
    Eigen::Vector3d rest = actor.mesh.vertices.row(i);
    if (offset.rows() > 0)
      rest += offset.row(i);
    surface.vertices.row(i) = surface.blend[i] * rest;
  }
  return surface;
}

MatrixRM dof_influence(const RiggedMesh &actor) {
  return actor.weights * dof_moves_joint(actor.skeleton).cast<double>().transpose();
}

Eigen::Matrix3Xd surface_jacobian(const SurfacePoint &point, const Vertices &vertices, const Faces &faces,
                                  const MatrixRM &influence, const std::vector<DofTwist> &twists) {
  const int a = faces(point.face, 0), b = faces(point.face, 1), c = faces(point.face, 2);
  const Eigen::Vector3d x = point.position(vertices, faces);
  Eigen::Matrix3Xd jacobian(3, twists.size());
  for (size_t d = 0; d < twists.size(); ++d) {
    const double share =
        point.barycentric[0] * influence(a, d) + point.barycentric[1] * influence(b, d) + point.barycentric[2] * influence(c, d);
    jacobian.col(d) = share * (twists[d].angular.cross(x) + twists[d].linear);
  }
  return jacobian;
}

} // namespace doublet
