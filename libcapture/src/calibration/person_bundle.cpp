#include "person_bundle.h"

#include "doublet/capture/calibration_refinement.h"
#include "doublet/capture/triangulation.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace doublet::detail {
namespace {

constexpr int kStep = 7; // of a CameraStep; distortion stays
constexpr int kJointUnknowns = 3 * kKeypoints;
constexpr double kScale = 3;         // of Geman and McClure, in expected errors
constexpr double kHeld = 1e12;       // weight of the first camera's place, which is the world's
constexpr double kEnoughGain = 1e-3; // share by which the cost must fall
constexpr double kMostDamped = 1e8;
constexpr double kTangent = 0.004; // m, expected error of silhouettes where planes touch them
// Focal lengths that are not known, as logarithms of shares of the larger side: those of one take are alike.
constexpr double kFocalAlike = 0.1, kUsualFocal = 0.2, kFocalUnknown = 0.5;

double robust_cost(double squared, double scale = kScale) {
  return scale * scale * squared / (squared + scale * scale);
}
double robust_weight(double squared, double scale = kScale) {
  const double w = scale * scale / (squared + scale * scale);
  return w * w;
}

using TangentSlope = Eigen::Matrix<double, kStep, 1>;
/// d residual / d step of the first or the second camera, by central differences.
TangentSlope tangent_slope(const PersonBundle &bundle, const TangentPair &pair, bool of_first) {
  constexpr double kSmall = 1e-6;
  const Camera &first = bundle.rig[pair.first], &second = bundle.rig[pair.second];
  TangentSlope slope;
  for (int k = 0; k < kStep; ++k) {
    const CameraStep step = kSmall * CameraStep::Unit(k);
    const auto residual = [&](const CameraStep &s) {
      return of_first ? tangent_residual(stepped(first, s), second, pair) : tangent_residual(first, stepped(second, s), pair);
    };
    slope[k] = (residual(step) - residual(-step)) / (2 * kSmall);
  }
  return slope;
}

/// The normal equations of one moment: its joints against themselves and against what is common to all (cameras, lengths).
struct MomentEquations {
  Eigen::MatrixXd joints, coupling, common;
  Eigen::VectorXd joint_gradient, common_gradient;
  explicit MomentEquations(int size)
      : joints(Eigen::MatrixXd::Zero(kJointUnknowns, kJointUnknowns)), coupling(Eigen::MatrixXd::Zero(kJointUnknowns, size)),
        common(Eigen::MatrixXd::Zero(size, size)), joint_gradient(Eigen::VectorXd::Zero(kJointUnknowns)),
        common_gradient(Eigen::VectorXd::Zero(size)) {}
};

class Adjustment {
public:
  Adjustment(const PersonBundle &bundle, double height)
      : height_(height), views_(static_cast<int>(bundle.rig.size())), size_(views_ * kStep + kBoneLengths + 1) {}

  double cost(const PersonBundle &bundle) const {
    double sum = 0;
    for (size_t m = 0; m < bundle.seen.size(); ++m) {
      for (int v = 0; v < views_; ++v)
        for (int j = 0; j < kKeypoints; ++j)
          if (const Keypoint &seen = bundle.seen[m][v][j]; seen.counts()) {
            const auto &joint = bundle.joints[m][j];
            const double r = joint ? keypoint_residual(bundle.rig[v], seen, *joint, bundle.keypoint_error)
                                   : std::numeric_limits<double>::infinity();
            sum += std::isfinite(r) ? robust_cost(r * r) : kScale * kScale;
          }
      for (const CalibrationBone &bone : kCalibrationBones)
        if (const auto &a = bundle.joints[m][bone.from], &b = bundle.joints[m][bone.to]; a && b && *a != *b) {
          const double r = bone_residual(bundle, bone, (*a - *b).norm());
          sum += robust_cost(r * r);
        }
    }
    for (const TangentPair &pair : bundle.tangents)
      sum += robust_cost(std::pow(tangent_residual(bundle.rig[pair.first], bundle.rig[pair.second], pair) / kTangent, 2),
                         bundle.tangent_scale / kTangent);
    for (int v = 0; v < views_; ++v)
      sum += std::pow(focal_residual(bundle, v), 2);
    for (int k = 0; k < kBoneLengths; ++k)
      sum += std::pow(length_residual(bundle, k), 2);
    return sum + std::pow((bundle.log_focal - kUsualFocal) / kFocalUnknown, 2);
  }

  /// Sums up all moments; `equations` are those of each.
  void linearize(const PersonBundle &bundle, std::vector<MomentEquations> &equations, Eigen::MatrixXd &common,
                 Eigen::VectorXd &gradient) const {
    common = Eigen::MatrixXd::Zero(size_, size_);
    gradient = Eigen::VectorXd::Zero(size_);
    common.diagonal().head<6>().setConstant(kHeld);
    for (int v = 0; v < views_; ++v) {
      const int f = v * kStep + 6, shared = size_ - 1;
      const double weight = 1 / focal_deviation(bundle, v), residual = focal_residual(bundle, v);
      common(f, f) += weight * weight;
      gradient[f] += weight * residual;
      if (bundle.known_focal[v] == 0) {
        common(shared, shared) += weight * weight;
        common(f, shared) -= weight * weight;
        common(shared, f) -= weight * weight;
        gradient[shared] -= weight * residual;
      }
    }
    common(size_ - 1, size_ - 1) += 1 / (kFocalUnknown * kFocalUnknown);
    gradient[size_ - 1] += (bundle.log_focal - kUsualFocal) / (kFocalUnknown * kFocalUnknown);
    for (int k = 0; k < kBoneLengths; ++k) {
      const int l = views_ * kStep + k;
      common(l, l) += 1 / std::pow(kCalibrationLengths[k].deviation, 2);
      gradient[l] += length_residual(bundle, k) / kCalibrationLengths[k].deviation;
    }
    for (const TangentPair &pair : bundle.tangents)
      add_tangent(bundle, pair, common, gradient);
    equations.assign(bundle.seen.size(), MomentEquations(size_));
    for (size_t m = 0; m < bundle.seen.size(); ++m) {
      add_keypoints(bundle, m, equations[m]);
      add_bones(bundle, m, equations[m]);
      common += equations[m].common;
      gradient += equations[m].common_gradient;
    }
  }

  /// Joints are eliminated (Schur complement), moment by moment. Returns whether there is a finite step.
  bool step(PersonBundle &bundle, std::vector<MomentEquations> equations, Eigen::MatrixXd common, Eigen::VectorXd gradient,
            double damping) const {
    std::vector<Eigen::LDLT<Eigen::MatrixXd>> factors;
    common.diagonal() *= 1 + damping;
    for (MomentEquations &m : equations) {
      m.joints.diagonal().array() += damping * m.joints.diagonal().array() + 1e-9; // joints that were not found
      factors.emplace_back(m.joints);
      common -= m.coupling.transpose() * factors.back().solve(m.coupling);
      gradient -= m.coupling.transpose() * factors.back().solve(m.joint_gradient);
    }
    const Eigen::VectorXd change = -Eigen::LDLT<Eigen::MatrixXd>(common).solve(gradient);
    if (!change.allFinite())
      return false;
    for (size_t k = 0; k < equations.size(); ++k) {
      const Eigen::VectorXd moved = -factors[k].solve(equations[k].joint_gradient + equations[k].coupling * change);
      for (int j = 0; j < kKeypoints; ++j)
        if (bundle.joints[k][j])
          *bundle.joints[k][j] += moved.segment<3>(3 * j);
    }
    for (int v = 0; v < views_; ++v) {
      CameraStep camera = CameraStep::Zero();
      camera.head<kStep>() = change.segment<kStep>(v * kStep);
      bundle.rig[v] = stepped(bundle.rig[v], camera);
    }
    for (int k = 0; k < kBoneLengths; ++k)
      bundle.log_lengths[k] += change[views_ * kStep + k];
    bundle.log_focal += change[size_ - 1];
    return true;
  }

private:
  static double focal_deviation(const PersonBundle &bundle, int view) {
    return bundle.known_focal[view] > 0 ? bundle.focal_error : kFocalAlike;
  }
  static double focal_residual(const PersonBundle &bundle, int view) {
    const Camera &camera = bundle.rig[view];
    const double expected =
        bundle.known_focal[view] > 0 ? std::log(bundle.known_focal[view]) : bundle.log_focal + std::log(larger_side(camera));
    return (std::log(camera.K(0, 0)) - expected) / focal_deviation(bundle, view);
  }
  double length_residual(const PersonBundle &bundle, int k) const {
    return (bundle.log_lengths[k] - std::log(kCalibrationLengths[k].share * height_)) / kCalibrationLengths[k].deviation;
  }
  static double bone_residual(const PersonBundle &bundle, const CalibrationBone &bone, double length) {
    return (std::log(length) - bundle.log_lengths[bone.length]) / kCalibrationLengths[bone.length].change;
  }

  static void add_tangent(const PersonBundle &bundle, const TangentPair &pair, Eigen::MatrixXd &common,
                          Eigen::VectorXd &gradient) {
    const double residual = tangent_residual(bundle.rig[pair.first], bundle.rig[pair.second], pair) / kTangent;
    const double weight = robust_weight(residual * residual, bundle.tangent_scale / kTangent);
    const std::array slopes{TangentSlope(tangent_slope(bundle, pair, true) / kTangent),
                            TangentSlope(tangent_slope(bundle, pair, false) / kTangent)};
    const std::array places{kStep * pair.first, kStep * pair.second};
    for (int a = 0; a < 2; ++a) {
      gradient.segment<kStep>(places[a]) += weight * residual * slopes[a];
      for (int b = 0; b < 2; ++b)
        common.block<kStep, kStep>(places[a], places[b]) += weight * slopes[a] * slopes[b].transpose();
    }
  }

  void add_keypoints(const PersonBundle &bundle, size_t moment, MomentEquations &to) const {
    for (int v = 0; v < views_; ++v) {
      const Camera &camera = bundle.rig[v];
      const double error = bundle.keypoint_error * larger_side(camera);
      for (int j = 0; j < kKeypoints; ++j) {
        const Keypoint &seen = bundle.seen[moment][v][j];
        const auto &joint = bundle.joints[moment][j];
        if (!joint || !seen.counts() || camera.depth(*joint) <= 0)
          continue;
        const Eigen::Vector2d residual = (camera.project(*joint) - seen.pixel) / error;
        const double weight = robust_weight(residual.squaredNorm());
        const Eigen::Matrix<double, 2, 3> point = camera.project_jacobian(*joint) / error;
        const Eigen::Matrix<double, 2, kStep> turn = step_jacobian(camera, *joint).leftCols<kStep>() / error;
        to.joints.block<3, 3>(3 * j, 3 * j) += weight * point.transpose() * point;
        to.coupling.block<3, kStep>(3 * j, v * kStep) += weight * point.transpose() * turn;
        to.common.block<kStep, kStep>(v * kStep, v * kStep) += weight * turn.transpose() * turn;
        to.joint_gradient.segment<3>(3 * j) += weight * point.transpose() * residual;
        to.common_gradient.segment<kStep>(v * kStep) += weight * turn.transpose() * residual;
      }
    }
  }

  void add_bones(const PersonBundle &bundle, size_t moment, MomentEquations &to) const {
    for (const CalibrationBone &bone : kCalibrationBones) {
      const auto &a = bundle.joints[moment][bone.from], &b = bundle.joints[moment][bone.to];
      if (!a || !b || (*a - *b).norm() == 0)
        continue;
      const double change = kCalibrationLengths[bone.length].change, length = (*a - *b).norm();
      const double residual = bone_residual(bundle, bone, length), weight = robust_weight(residual * residual);
      const Eigen::Vector3d along = (*a - *b) / (length * length * change);
      const int from = 3 * bone.from, to_joint = 3 * bone.to, l = views_ * kStep + bone.length;
      const Eigen::Matrix3d square = weight * along * along.transpose();
      to.joints.block<3, 3>(from, from) += square;
      to.joints.block<3, 3>(to_joint, to_joint) += square;
      to.joints.block<3, 3>(from, to_joint) -= square;
      to.joints.block<3, 3>(to_joint, from) -= square;
      to.coupling.block<3, 1>(from, l) -= weight * along / change;
      to.coupling.block<3, 1>(to_joint, l) += weight * along / change;
      to.common(l, l) += weight / (change * change);
      to.joint_gradient.segment<3>(from) += weight * residual * along;
      to.joint_gradient.segment<3>(to_joint) -= weight * residual * along;
      to.common_gradient[l] -= weight * residual / change;
    }
  }

  double height_;
  int views_, size_;
};

} // namespace

double keypoint_residual(const Camera &camera, const Keypoint &seen, const Eigen::Vector3d &joint, double keypoint_error) {
  if (!(camera.depth(joint) > 0))
    return std::numeric_limits<double>::infinity();
  return (camera.project(joint) - seen.pixel).norm() / (keypoint_error * larger_side(camera));
}

void PersonBundle::triangulate_joints() {
  std::vector<CalibratedCamera> cameras;
  for (const Camera &camera : rig)
    cameras.push_back({camera, {}});
  std::vector<Keypoint> one(rig.size());
  for (size_t m = 0; m < seen.size(); ++m)
    for (int j = 0; j < kKeypoints; ++j) {
      for (size_t v = 0; v < rig.size(); ++v)
        one[v] = seen[m][v][j];
      joints[m][j] = triangulate(cameras, one);
    }
}

double PersonBundle::cost(double height) const {
  return Adjustment(*this, height).cost(*this);
}

Eigen::VectorXd PersonBundle::cost_gradient(double height) const {
  std::vector<MomentEquations> equations;
  Eigen::MatrixXd common;
  Eigen::VectorXd gradient;
  Adjustment(*this, height).linearize(*this, equations, common, gradient);
  const auto of_joints = static_cast<Eigen::Index>(equations.size()) * kJointUnknowns;
  Eigen::VectorXd all(of_joints + gradient.size());
  for (std::size_t m = 0; m < equations.size(); ++m)
    all.segment<kJointUnknowns>(static_cast<Eigen::Index>(m) * kJointUnknowns) = equations[m].joint_gradient;
  all.tail(gradient.size()) = gradient;
  return 2 * all; // the equations are those of half the cost
}

double PersonBundle::adjust(int iterations, double height) {
  const Adjustment adjustment(*this, height);
  std::vector<MomentEquations> equations;
  Eigen::MatrixXd common;
  Eigen::VectorXd gradient;
  double best = adjustment.cost(*this), damping = 1e-4;
  for (int k = 0; k < iterations; ++k) {
    adjustment.linearize(*this, equations, common, gradient);
    const double before = best;
    for (bool better = false; !better && damping < kMostDamped;) {
      PersonBundle next = *this;
      const double cost = adjustment.step(next, equations, common, gradient, damping) ? adjustment.cost(next)
                                                                                      : std::numeric_limits<double>::infinity();
      better = cost < best;
      damping *= better ? 0.1 : 10;
      if (better) {
        *this = std::move(next);
        best = cost;
      }
    }
    if (!(best < (1 - kEnoughGain) * before))
      break;
    damping = std::max(damping, 1e-9);
  }
  return best;
}

} // namespace doublet::detail
