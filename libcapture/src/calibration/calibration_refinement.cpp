#include "doublet/capture/calibration_refinement.h"

#include "../weighted_rows.h"
#include "doublet/capture/pose_optimizer.h"
#include "doublet/core/parts/quantile.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <stdexcept>

namespace doublet {
namespace {

// What is estimated of a camera: a CameraStep, its delay (frames), and how far its silhouettes reach beyond the true outline
// (px).
constexpr int kStep = 8, kLate = 8, kBias = 9, kUnknowns = 10;
constexpr double kOutline = 0.005;  // m; an outline's error, which is that of shape and skinning
constexpr double kAlike = 10;       // neighbours on an outline err together: so many samples tell as much as one
constexpr double kBiasPixels = 0.5; // px; half a pixel of halo or erosion is common
constexpr double kPoseAngle = 0.1, kPoseShift = 0.05; // rad, m; a tracked pose's error under a wrong calibration
constexpr double kScanAngle = std::numbers::pi / 360, kScanShift = 0.005; // rad, m; where a scan stands in its cameras
constexpr double kStays = 1e-7;                                           // deviation of what is not estimated
constexpr double kWidest = 0.05, kNarrowest = 0.01;                       // m, Geman-McClure scale, first and last iteration
constexpr double kWidestGate = 0.15, kNarrowestGate = 0.04;               // m

using Unknowns = Eigen::Matrix<double, kUnknowns, 1>;

double between(double first, double last, double progress) {
  return first * std::pow(last / first, progress);
}

/// The normal equations of one moment: pose against pose, pose against cameras, each camera against itself.
struct MomentSystem {
  Eigen::MatrixXd pose, coupling; // (D, D), (D, C * kUnknowns)
  Eigen::VectorXd pose_gradient, camera_gradient;
  std::vector<Eigen::Matrix<double, kUnknowns, kUnknowns>> cameras;
  double residual = 0, count = 0; // sum of |px|, and of how many
  MomentSystem(int dofs, int views)
      : pose(Eigen::MatrixXd::Zero(dofs, dofs)), coupling(Eigen::MatrixXd::Zero(dofs, views * kUnknowns)),
        pose_gradient(Eigen::VectorXd::Zero(dofs)), camera_gradient(Eigen::VectorXd::Zero(views * kUnknowns)),
        cameras(views, Eigen::Matrix<double, kUnknowns, kUnknowns>::Zero()) {}
};

/// How the outline of the actor appears in a camera, for telling how far cameras have moved.
struct OutlinePoint {
  Eigen::Vector3d x;
  double metres_per_pixel;
};

class BundleAdjustment {
public:
  BundleAdjustment(const CalibrationProblem &problem, const CalibrationRefinementOptions &options, const Context &context)
      : problem_(problem), options_(options), context_(context), actor_(*problem.actor), influence_(dof_influence(actor_)),
        views_(static_cast<int>(problem.rig.size())), dofs_(actor_.skeleton.dof_count()), rig_(problem.rig),
        unknowns_(views_, Unknowns::Zero()), seen_(views_) {
    for (int v = 0; v < views_; ++v)
      unknowns_[v].head<kStep>() = step_between(problem.given[v], problem.rig[v]);
    for (const CalibrationMoment &moment : problem.moments) {
      poses_.push_back(problem.poses.row(moment.row));
      indices_.emplace_back();
      for (int v = 0; v < views_; ++v)
        indices_.back().push_back(
            std::make_unique<OutlineIndex>((*moment.outlines)[v], problem.rig[v].width, problem.rig[v].height));
    }
    start_poses_ = poses_;
  }

  CalibrationEstimate run() {
    CalibrationEstimate estimate;
    estimate.before_px = residual();
    for (int k = 0; k < options_.iterations; ++k) {
      const double progress = options_.iterations > 1 ? static_cast<double>(k) / (options_.iterations - 1) : 1.0;
      iterate(between(kWidestGate, kNarrowestGate, progress), between(kWidest, kNarrowest, progress));
      context_.throw_if_cancelled();
    }
    estimate.after_px = residual();
    tell(estimate);
    return estimate;
  }

private:
  /// So that stepped(from, step) is `to`.
  static CameraStep step_between(const Camera &from, const Camera &to) {
    CameraStep step;
    const Eigen::AngleAxisd turn(to.R * from.R.transpose());
    step << turn.angle() * turn.axis(), to.centre() - from.centre(), std::log(to.K(0, 0) / from.K(0, 0)),
        to.distortion[0] - from.distortion[0];
    return step;
  }

  /// Deviations that the calibration is expected to have.
  Unknowns expected(int view) const {
    const auto or_fixed = [](double deviation) { return deviation > 0 ? deviation : kStays; };
    Unknowns d;
    d << Eigen::Vector3d::Constant(options_.rotation), Eigen::Vector3d::Constant(options_.position), options_.focal,
        problem_.given[view].distorted() ? or_fixed(options_.distortion) : kStays,
        problem_.timed ? or_fixed(options_.late) : kStays, kBiasPixels;
    return d;
  }

  /// The tracked poses at a time between frames.
  Eigen::VectorXd tracked(double time) const {
    const double last = static_cast<double>(problem_.poses.rows() - 1), t = std::clamp(time, 0.0, last);
    const Eigen::Index i = std::min(static_cast<Eigen::Index>(t), problem_.poses.rows() - 1);
    const Eigen::Index j = std::min(i + 1, problem_.poses.rows() - 1);
    const double part = t - static_cast<double>(i);
    return (1 - part) * problem_.poses.row(i) + part * problem_.poses.row(j);
  }

  /// Which pose a camera shows at a moment: a late one shows an earlier.
  Eigen::VectorXd shown(int moment, double late) const {
    const int row = problem_.moments[moment].row;
    return late == 0 ? poses_[moment] : Eigen::VectorXd(poses_[moment] + tracked(row - late) - tracked(row));
  }

  struct Shown {
    Vertices vertices;
    std::vector<DofTwist> twists;
  };
  Shown show(int moment, double late) const {
    const Eigen::VectorXd pose = shown(moment, late);
    return {pose_surface(actor_, pose, problem_.moments[moment].offset).vertices, dof_twists(actor_.skeleton, pose)};
  }

  std::vector<RimConstraint> match(int moment, int view, const Vertices &vertices, double gate) const {
    const Outline &measured = (*problem_.moments[moment].outlines)[view];
    if (measured.empty())
      return {};
    RimMatchOptions options;
    options.count = options_.rims_per_view;
    options.gate = gate;
    const Rims rims = find_rims(vertices, actor_.mesh.faces, actor_.face_valid, rig_[view], options_.raster_size);
    return match_rims(rims, measured, *indices_[moment][view], view, rig_[view], options).constraints;
  }

  MomentSystem linearize(int moment, double gate, double scale) const {
    MomentSystem system(dofs_, views_);
    const int row = problem_.moments[moment].row;
    Shown all;
    double all_late = 0;
    for (int v = 0; v < views_; ++v) {
      const double late = unknowns_[v][kLate];
      if (v == 0 || late != all_late) {
        all = show(moment, late);
        all_late = late;
      }
      const Eigen::VectorXd velocity =
          problem_.timed ? Eigen::VectorXd(tracked(row - late + 0.5) - tracked(row - late - 0.5)) : Eigen::VectorXd::Zero(dofs_);
      add_view(moment, v, all, velocity, gate, scale, system);
    }
    add_pose_prior(moment, system);
    return system;
  }

  void add_view(int moment, int view, const Shown &surface, const Eigen::VectorXd &velocity, double gate, double scale,
                MomentSystem &system) const {
    const Camera &camera = rig_[view];
    const int size = dofs_ + kUnknowns;
    Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(size), slope(size);
    detail::WeightedRows rows(hessian, gradient);
    for (const RimConstraint &c : match(moment, view, surface.vertices, gate)) {
      const Eigen::Vector3d x = c.surface.position(surface.vertices, actor_.mesh.faces);
      if (camera.depth(x) <= 0)
        continue;
      const double pixels = c.normal.dot(camera.project(x) - c.target),
                   residual = c.metres_per_pixel * (pixels - unknowns_[view][kBias]);
      const Eigen::RowVector2d normal = c.metres_per_pixel * c.normal.transpose();
      const Eigen::Matrix3Xd motion =
          surface_jacobian(c.surface, surface.vertices, actor_.mesh.faces, influence_, surface.twists);
      slope.head(dofs_) = (normal * camera.project_jacobian(x) * motion).transpose();
      slope.segment<kStep>(dofs_) = (normal * step_jacobian(camera, x)).transpose();
      slope[dofs_ + kLate] = -slope.head(dofs_).dot(velocity);
      slope[dofs_ + kBias] = -c.metres_per_pixel;
      const double robust = scale * scale / (residual * residual + scale * scale);
      const double weight = reliability(c.surface) * robust * robust / (kAlike * kOutline * kOutline);
      rows.add(slope, residual, weight);
      system.residual += std::abs(residual) / c.metres_per_pixel;
      system.count += 1;
    }
    rows.finish();
    hessian = hessian.selfadjointView<Eigen::Lower>();
    system.pose += hessian.topLeftCorner(dofs_, dofs_);
    system.coupling.middleCols<kUnknowns>(view * kUnknowns) += hessian.topRightCorner(dofs_, kUnknowns);
    system.cameras[view] += hessian.bottomRightCorner<kUnknowns, kUnknowns>();
    system.pose_gradient += gradient.head(dofs_);
    system.camera_gradient.segment<kUnknowns>(view * kUnknowns) += gradient.tail<kUnknowns>();
  }

  double reliability(const SurfacePoint &p) const {
    double sum = 0;
    for (int c = 0; c < 3; ++c)
      sum += p.barycentric[c] * problem_.reliability[actor_.mesh.faces(p.face, c)];
    return sum;
  }

  /// Poses stay near those that were tracked; the root stays where the scan is, if the actor stands there.
  void add_pose_prior(int moment, MomentSystem &system) const {
    for (const Joint &joint : actor_.skeleton.joints)
      for (int k = 0; k < joint.dof_count; ++k) {
        const int d = joint.first_dof + k;
        const bool root = joint.kind == JointKind::Root, shift = root && k < 3;
        const bool held = root && problem_.moments[moment].in_scan_pose;
        const double deviation = held ? (shift ? kScanShift : kScanAngle) : (shift ? kPoseShift : kPoseAngle);
        const double expected = held ? 0 : start_poses_[moment][d], weight = 1 / (deviation * deviation);
        system.pose(d, d) += weight;
        system.pose_gradient[d] += weight * (poses_[moment][d] - expected);
      }
  }

  std::vector<MomentSystem> linearize_all(double gate, double scale) const {
    const int count = static_cast<int>(poses_.size());
    std::vector<MomentSystem> systems(count, MomentSystem(0, 0));
    parallel_for(context_, count, [&](int m) { systems[m] = linearize(m, gate, scale); });
    return systems;
  }

  /// One Gauss-Newton step; poses are eliminated (Schur complement), moment by moment in order.
  void iterate(double gate, double scale) {
    const std::vector<MomentSystem> systems = linearize_all(gate, scale);
    const int size = views_ * kUnknowns;
    Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd gradient = Eigen::VectorXd::Zero(size);
    for (int v = 0; v < views_; ++v) {
      const Unknowns weight = expected(v).cwiseAbs2().cwiseInverse();
      hessian.diagonal().segment<kUnknowns>(v * kUnknowns) += weight;
      gradient.segment<kUnknowns>(v * kUnknowns) += weight.cwiseProduct(unknowns_[v]);
    }
    std::vector<Eigen::LDLT<Eigen::MatrixXd>> factors;
    for (const MomentSystem &system : systems) {
      factors.emplace_back(system.pose);
      hessian -= system.coupling.transpose() * factors.back().solve(system.coupling);
      gradient += system.camera_gradient - system.coupling.transpose() * factors.back().solve(system.pose_gradient);
      for (int v = 0; v < views_; ++v)
        hessian.block<kUnknowns, kUnknowns>(v * kUnknowns, v * kUnknowns) += system.cameras[v];
    }
    const Eigen::LDLT<Eigen::MatrixXd> factor(hessian);
    const Eigen::VectorXd step = -factor.solve(gradient);
    if (!step.allFinite())
      return;
    covariance_ = factor.solve(Eigen::MatrixXd::Identity(size, size));
    for (size_t m = 0; m < systems.size(); ++m)
      poses_[m] = (poses_[m] - factors[m].solve(systems[m].pose_gradient + systems[m].coupling * step))
                      .cwiseMax(actor_.skeleton.lower)
                      .cwiseMin(actor_.skeleton.upper);
    for (int v = 0; v < views_; ++v) {
      unknowns_[v] += step.segment<kUnknowns>(v * kUnknowns);
      rig_[v] = stepped(problem_.given[v], unknowns_[v].head<kStep>());
    }
  }

  double residual() const {
    double sum = 0, count = 0;
    for (const MomentSystem &system : linearize_all(kNarrowestGate, kNarrowest)) {
      sum += system.residual;
      count += system.count;
    }
    return count > 0 ? sum / count : 0;
  }

  /// The actor's outline as each camera sees it at all moments.
  void look(std::vector<std::vector<OutlinePoint>> &seen) const {
    const int count = static_cast<int>(poses_.size());
    std::vector<std::vector<std::vector<OutlinePoint>>> of_moments(count, seen);
    parallel_for(context_, count, [&](int m) {
      const Vertices vertices = show(m, 0).vertices;
      for (int v = 0; v < views_; ++v)
        for (const RimConstraint &c : match(m, v, vertices, kNarrowestGate))
          of_moments[m][v].push_back({c.surface.position(vertices, actor_.mesh.faces), c.metres_per_pixel});
    });
    for (const auto &of_views : of_moments)
      for (int v = 0; v < views_; ++v)
        seen[v].insert(seen[v].end(), of_views[v].begin(), of_views[v].end());
  }

  /// How far the actor's outline moves in each picture, m^2, mean over its points, and the variance of that, but for what a
  /// motion of the whole world explains: that changes nothing, and no take tells it.
  struct PictureMotion {
    std::vector<double> squared, variance;
  };

  void tell(CalibrationEstimate &estimate) {
    look(seen_);
    estimate.rig = rig_;
    for (int v = 0; v < views_; ++v)
      if (seen_[v].empty())
        estimate.rig[v] = problem_.rig[v];
    const PictureMotion from_given = picture_motion(problem_.given), from_start = picture_motion(problem_.rig);
    double cameras = 0, change = 0, sure = 0;
    for (int v = 0; v < views_; ++v) {
      estimate.cameras.push_back(tell(v, from_given));
      change += from_start.squared[v];
      sure += from_start.variance[v];
      cameras += !seen_[v].empty();
    }
    if (cameras > 0) {
      estimate.change = std::sqrt(change / cameras);
      estimate.sure = std::sqrt(sure / cameras);
    }
    take_off_common_delay(estimate.cameras);
  }

  RefinedCamera tell(int view, const PictureMotion &motion) const {
    RefinedCamera camera;
    camera.camera = rig_[view].name;
    camera.seen = !seen_[view].empty();
    if (!camera.seen)
      return camera;
    camera.moved = std::sqrt(motion.squared[view]);
    camera.sure = std::sqrt(motion.variance[view]);
    camera.turned = unknowns_[view].head<3>().norm() * 180 / std::numbers::pi;
    camera.shifted = unknowns_[view].segment<3>(3).norm();
    camera.focal = std::expm1(unknowns_[view][6]);
    camera.late = unknowns_[view][kLate];
    camera.late_sure = std::sqrt(std::max(0.0, variance_of_delay(view)));
    return camera;
  }

  /// frames^2, of a camera's delay against the mean of those that see the actor: how late all are together nobody can tell.
  double variance_of_delay(int view) const {
    Eigen::VectorXd against = Eigen::VectorXd::Zero(covariance_.rows());
    const auto seen =
        static_cast<double>(std::count_if(seen_.begin(), seen_.end(), [](const auto &points) { return !points.empty(); }));
    for (int v = 0; v < views_; ++v)
      if (!seen_[v].empty())
        against[v * kUnknowns + kLate] = (v == view ? 1 : 0) - 1 / seen;
    return against.dot(covariance_ * against);
  }

  PictureMotion picture_motion(const CameraRig &from) const {
    using World = Eigen::Matrix<double, 6, 1>; // turn about the actor, translation
    std::vector<ViewSums> sums(views_);
    Eigen::Matrix<double, 6, 6> world = Eigen::Matrix<double, 6, 6>::Zero();
    World pulled = World::Zero();
    Eigen::MatrixXd by_steps = Eigen::MatrixXd::Zero(6, views_ * kStep); // of the world motion that explains steps best
    const Eigen::Vector3d centre = centre_of_actor();
    for (int v = 0; v < views_; ++v) {
      sums[v] = sum_view(v, from[v], centre);
      world += sums[v].world;
      pulled += sums[v].pulled;
      by_steps.middleCols<kStep>(v * kStep) = sums[v].world_steps;
    }
    const Eigen::LDLT<Eigen::Matrix<double, 6, 6>> factor(world + 1e-12 * Eigen::Matrix<double, 6, 6>::Identity());
    const World motion = factor.solve(pulled);
    by_steps = factor.solve(by_steps).eval();
    const Eigen::MatrixXd covariance = covariance_of_steps();
    PictureMotion result;
    for (int v = 0; v < views_; ++v) {
      result.squared.push_back(
          std::max(0.0, sums[v].squared - 2 * motion.dot(sums[v].pulled) + motion.dot(sums[v].world * motion)));
      Eigen::MatrixXd form = by_steps.transpose() * sums[v].world * by_steps;
      const Eigen::MatrixXd cross = by_steps.transpose() * sums[v].world_steps;
      form.middleCols<kStep>(v * kStep) -= cross;
      form.middleRows<kStep>(v * kStep) -= cross.transpose();
      form.block<kStep, kStep>(v * kStep, v * kStep) += sums[v].steps;
      result.variance.push_back(std::max(0.0, form.cwiseProduct(covariance).sum()));
    }
    return result;
  }

  /// Means over the points a camera sees of how they move in its picture (m): `pulled` and `squared` from the camera `from` to
  /// the refined one, others by steps of the camera and motions of the world.
  struct ViewSums {
    Eigen::Matrix<double, kStep, kStep> steps = Eigen::Matrix<double, kStep, kStep>::Zero();
    Eigen::Matrix<double, 6, kStep> world_steps = Eigen::Matrix<double, 6, kStep>::Zero();
    Eigen::Matrix<double, 6, 6> world = Eigen::Matrix<double, 6, 6>::Zero();
    Eigen::Matrix<double, 6, 1> pulled = Eigen::Matrix<double, 6, 1>::Zero();
    double squared = 0;
  };
  ViewSums sum_view(int view, const Camera &from, const Eigen::Vector3d &centre) const {
    ViewSums sums;
    const double share = 1 / static_cast<double>(std::max<size_t>(1, seen_[view].size()));
    for (const OutlinePoint &point : seen_[view]) {
      const Eigen::Matrix<double, 2, kStep> step = point.metres_per_pixel * step_jacobian(rig_[view], point.x);
      const Eigen::Vector2d moved = point.metres_per_pixel * (rig_[view].project(point.x) - from.project(point.x));
      Eigen::Matrix<double, 2, 6> world;
      world.rightCols<3>() = point.metres_per_pixel * rig_[view].project_jacobian(point.x);
      for (int k = 0; k < 3; ++k)
        world.col(k) = world.rightCols<3>() * Eigen::Vector3d::Unit(k).cross(point.x - centre);
      sums.steps += share * step.transpose() * step;
      sums.world_steps += share * world.transpose() * step;
      sums.world += share * world.transpose() * world;
      sums.pulled += share * world.transpose() * moved;
      sums.squared += share * moved.squaredNorm();
    }
    return sums;
  }

  Eigen::Vector3d centre_of_actor() const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double count = 0;
    for (const std::vector<OutlinePoint> &points : seen_)
      for (const OutlinePoint &point : points) {
        sum += point.x;
        count += 1;
      }
    return count > 0 ? Eigen::Vector3d(sum / count) : sum;
  }

  Eigen::MatrixXd covariance_of_steps() const {
    Eigen::MatrixXd steps(views_ * kStep, views_ * kStep);
    for (int a = 0; a < views_; ++a)
      for (int b = 0; b < views_; ++b)
        steps.block<kStep, kStep>(a * kStep, b * kStep) = covariance_.block<kStep, kStep>(a * kUnknowns, b * kUnknowns);
    return steps;
  }

  /// Whose clock counts is open: that of the most cameras, of equally many that of the first one.
  static void take_off_common_delay(std::vector<RefinedCamera> &cameras) {
    std::vector<double> most;
    for (const RefinedCamera &candidate : cameras) {
      std::vector<double> alike;
      for (const RefinedCamera &camera : cameras)
        if (candidate.seen && camera.seen && std::abs(camera.late - candidate.late) < 0.5)
          alike.push_back(camera.late);
      if (alike.size() > most.size())
        most = std::move(alike);
    }
    const double clock = most.empty() ? 0 : median(std::move(most));
    for (RefinedCamera &camera : cameras)
      if (camera.seen)
        camera.late -= clock;
  }

  const CalibrationProblem &problem_;
  const CalibrationRefinementOptions &options_;
  const Context &context_;
  const RiggedMesh &actor_;
  const MatrixRM influence_;
  const int views_, dofs_;
  CameraRig rig_;
  std::vector<Unknowns> unknowns_; // against the given cameras
  std::vector<Eigen::VectorXd> poses_, start_poses_;
  std::vector<std::vector<std::unique_ptr<OutlineIndex>>> indices_;
  std::vector<std::vector<OutlinePoint>> seen_;
  Eigen::MatrixXd covariance_;
};

void require(bool right, const std::string &expected) {
  if (!right)
    throw std::invalid_argument("refine_calibration: expected " + expected);
}

void validate(const CalibrationProblem &problem) {
  require(problem.actor, "an actor");
  const size_t views = problem.given.size();
  require(views > 0 && problem.rig.size() == views, "as many cameras to begin with as were given");
  require(!problem.moments.empty(), "at least one moment");
  require(problem.poses.cols() == problem.actor->skeleton.dof_count() && problem.poses.allFinite(), "finite poses of the actor");
  require(problem.reliability.size() == problem.actor->mesh.vertices.rows() && problem.reliability.allFinite(),
          "a finite reliability for every vertex");
  for (const CameraRig *rig : {&problem.given, &problem.rig})
    for (const Camera &camera : *rig)
      validate_camera(camera, "refine_calibration");
  for (const CalibrationMoment &moment : problem.moments) {
    require(moment.outlines && moment.outlines->size() == views, "one outline per camera");
    require(moment.row >= 0 && moment.row < problem.poses.rows(), "moments of the poses");
  }
}

} // namespace

Camera stepped(const Camera &camera, const CameraStep &step) {
  Camera moved = camera;
  const Eigen::Vector3d turn = step.head<3>();
  const double angle = turn.norm();
  if (angle > 0)
    moved.R = Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix() * camera.R;
  moved.t = -moved.R * (camera.centre() + step.segment<3>(3));
  moved.K.topLeftCorner<2, 2>() *= std::exp(step[6]);
  moved.distortion[0] += step[7];
  return moved;
}

Eigen::Matrix<double, 2, 8> step_jacobian(const Camera &camera, const Eigen::Vector3d &point) {
  const Eigen::Vector3d y = camera.R * point + camera.t;
  const Eigen::Vector2d n = y.head<2>() / y.z();
  const Eigen::Matrix<double, 2, 3> by_point = camera.project_jacobian(point), by_camera_point = by_point * camera.R.transpose();
  Eigen::Matrix<double, 2, 8> jacobian;
  for (int k = 0; k < 3; ++k)
    jacobian.col(k) = by_camera_point * Eigen::Vector3d::Unit(k).cross(y);
  jacobian.middleCols<3>(3) = -by_point;
  jacobian.col(6) = camera.project(point) - camera.K.topRightCorner<2, 1>();
  jacobian.col(7) = camera.K.topLeftCorner<2, 2>() * n * n.squaredNorm();
  return jacobian;
}

CalibrationEstimate refine_calibration(const CalibrationProblem &problem, const CalibrationRefinementOptions &options,
                                       const Context &context) {
  options.validate();
  validate(problem);
  return BundleAdjustment(problem, options, context).run();
}

} // namespace doublet
