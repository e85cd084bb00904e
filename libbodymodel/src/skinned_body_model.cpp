#include "skinned_body_model.h"

#include "doublet/core/error.h"
#include "doublet/core/skeleton.h"
#include "doublet/core/skinning.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace doublet {
namespace {

using Quat = Eigen::Quaterniond;

Quat pure(const Eigen::Vector3d &v) {
  return Quat(0, v.x(), v.y(), v.z());
}
Quat scaled(const Quat &q, double s) {
  return Quat(s * q.w(), s * q.x(), s * q.y(), s * q.z());
}
void add(Quat &sum, const Quat &q, double s) {
  sum.coeffs() += s * q.coeffs();
}

Eigen::Matrix3d skew(const Eigen::Vector3d &v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

/// Unnormalised real and dual part of a blend.
struct DualQuat {
  Quat real = Quat(0, 0, 0, 0), dual = Quat(0, 0, 0, 0);
};

/// x(u) = (b u b* + 2 d b*) / |b|^2 and its derivatives.
struct Blend {
  DualQuat q;
  double norm2 = 1;
  Eigen::Vector3d rest, point;

  void finish(const Eigen::Vector3d &u) {
    rest = u;
    norm2 = q.real.coeffs().squaredNorm();
    point = ((q.real * pure(u) * q.real.conjugate()).vec() + 2 * (q.dual * q.real.conjugate()).vec()) / norm2;
  }
  Eigen::Vector3d derivative(const DualQuat &change) const {
    const Eigen::Vector3d moved = (change.real * pure(rest) * q.real.conjugate()).vec() +
                                  (change.dual * q.real.conjugate()).vec() + (q.dual * change.real.conjugate()).vec();
    return 2 * (moved - point * q.real.coeffs().dot(change.real.coeffs())) / norm2;
  }
};

} // namespace

/// The skeleton for one set of coefficients, with derivatives.
struct SkinnedBodyModel::Posed {
  Eigen::VectorXd shape, angles;            ///< (K), (3J)
  Vertices rest_joints, joints;             ///< (J, 3)
  Transforms world_from_rest;               ///< (J)
  std::vector<Eigen::Matrix3d> parent_axes; ///< (J) d(world rotation of joint) / d(its rotation vector)
  MatrixRM joint_shape, offset_shape;       ///< (3J, K) d joints, d translation of world_from_rest
};

SkinnedBodyModel::SkinnedBodyModel(SkinnedBodyData data) : data_(std::move(data)) {
  influences_.resize(data_.mean.rows());
  for (int v = 0; v < data_.mean.rows(); ++v) {
    for (int j = 0; j < data_.weights.cols(); ++j)
      if (data_.weights(v, j) > 0)
        influences_[v].emplace_back(j, data_.weights(v, j));
    std::stable_sort(influences_[v].begin(), influences_[v].end(),
                     [](const auto &a, const auto &b) { return a.second > b.second; });
  }
}

bool SkinnedBodyModel::below(int joint, int ancestor) const {
  while (joint > ancestor)
    joint = data_.joint_parents[joint];
  return joint == ancestor;
}

SkinnedBodyModel::Posed SkinnedBodyModel::pose(const Eigen::VectorXd &coefficients) const {
  if (coefficients.size() != component_count())
    throw std::invalid_argument("body model: expected " + std::to_string(component_count()) + " coefficients, found " +
                                std::to_string(coefficients.size()));
  const int joints = static_cast<int>(data_.joint_mean.rows()), shapes = static_cast<int>(data_.shape.cols());
  Posed p;
  p.shape = coefficients.head(shapes);
  p.angles = data_.pose_mean + data_.pose * coefficients.tail(data_.pose.cols());
  const Eigen::VectorXd change = data_.joint_shape * p.shape;
  p.rest_joints = data_.joint_mean + Eigen::Map<const Vertices>(change.data(), joints, 3);
  p.joints.resize(joints, 3);
  p.world_from_rest.resize(joints);
  p.parent_axes.resize(joints);
  p.joint_shape.resize(3 * joints, shapes);
  p.offset_shape.resize(3 * joints, shapes);
  for (int j = 0; j < joints; ++j) {
    const int parent = data_.joint_parents[j];
    const Eigen::Vector3d angle = p.angles.segment<3>(3 * j), rest = p.rest_joints.row(j);
    const Eigen::Matrix3d above =
        parent < 0 ? Eigen::Matrix3d(Eigen::Matrix3d::Identity()) : Eigen::Matrix3d(p.world_from_rest[parent].linear());
    const Eigen::Matrix3d rotation = above * rotation_from_vector(angle);
    const auto rest_shape = data_.joint_shape.middleRows<3>(3 * j);
    if (parent < 0) {
      p.joints.row(j) = rest.transpose();
      p.joint_shape.middleRows<3>(3 * j) = rest_shape;
    } else {
      p.joints.row(j) = (p.world_from_rest[parent] * rest).transpose();
      p.joint_shape.middleRows<3>(3 * j) =
          p.joint_shape.middleRows<3>(3 * parent) + above * (rest_shape - data_.joint_shape.middleRows<3>(3 * parent));
    }
    p.parent_axes[j] = above * left_jacobian(angle);
    p.world_from_rest[j].linear() = rotation;
    p.world_from_rest[j].translation() = p.joints.row(j).transpose() - rotation * rest;
    p.world_from_rest[j].makeAffine();
    p.offset_shape.middleRows<3>(3 * j) = p.joint_shape.middleRows<3>(3 * j) - rotation * rest_shape;
  }
  return p;
}

Vertices SkinnedBodyModel::vertices(const Eigen::VectorXd &coefficients) const {
  const Posed p = pose(coefficients);
  const Eigen::VectorXd change = data_.shape * p.shape;
  const Vertices rest = data_.mean + Eigen::Map<const Vertices>(change.data(), vertex_count(), 3);
  return dual_quaternion_skinning(rest, data_.weights, p.world_from_rest);
}

Vertices SkinnedBodyModel::component(int k) const {
  if (k < 0 || k >= component_count())
    throw std::invalid_argument("body model: component " + std::to_string(k) + " of " + std::to_string(component_count()));
  std::vector<int> all(vertex_count());
  for (int v = 0; v < vertex_count(); ++v)
    all[v] = v;
  const Eigen::VectorXd column = linearise(Eigen::VectorXd::Zero(component_count()), all).jacobian.col(k);
  return Eigen::Map<const Vertices>(column.data(), vertex_count(), 3);
}

BodyLinearisation SkinnedBodyModel::linearise(const Eigen::VectorXd &coefficients, const std::vector<int> &chosen) const {
  const Posed p = pose(coefficients);
  const int n = static_cast<int>(chosen.size()), joints = static_cast<int>(p.joints.rows());
  const int shapes = static_cast<int>(data_.shape.cols());
  std::vector<DualQuat> bones(joints);
  for (int j = 0; j < joints; ++j) {
    bones[j].real = Quat(p.world_from_rest[j].linear());
    bones[j].dual = scaled(pure(p.world_from_rest[j].translation()) * bones[j].real, 0.5);
  }
  BodyLinearisation result{Vertices(n, 3), MatrixRM(3 * n, component_count())};
  MatrixRM by_angle = MatrixRM::Zero(3, 3 * joints);
  std::vector<DualQuat> carried(joints); // per joint, the part of the blend that it carries
  for (int i = 0; i < n; ++i) {
    const int v = chosen[i];
    const auto &influences = influences_[v];
    const Eigen::Vector3d rest = data_.mean.row(v).transpose() + data_.shape.middleRows<3>(3 * v) * p.shape;
    Blend blend;
    std::fill(carried.begin(), carried.end(), DualQuat());
    for (const auto &[j, weight] : influences) {
      const double w = bones[j].real.dot(bones[influences[0].first].real) < 0 ? -weight : weight; // shortest arc
      add(blend.q.real, bones[j].real, w);
      add(blend.q.dual, bones[j].dual, w);
      for (int k = j; k > 0; k = data_.joint_parents[k]) {
        add(carried[k].real, bones[j].real, w);
        add(carried[k].dual, bones[j].dual, w);
      }
    }
    blend.finish(rest);
    result.points.row(i) = blend.point.transpose();

    // Shape: the rotated component, and the translations of the bones, in which the blend is linear.
    auto rows = result.jacobian.middleRows<3>(3 * i);
    rows.leftCols(shapes) = blend.q.real.normalized().toRotationMatrix() * data_.shape.middleRows<3>(3 * v);
    for (const auto &[j, weight] : influences) {
      const double w = bones[j].real.dot(bones[influences[0].first].real) < 0 ? -weight : weight;
      const Quat relative = bones[j].real * blend.q.real.conjugate();
      const Eigen::Matrix3d share = (relative.w() * Eigen::Matrix3d::Identity() - skew(relative.vec())) * (w / blend.norm2);
      rows.leftCols(shapes) += share * p.offset_shape.middleRows<3>(3 * j);
    }
    // Pose: turning joint k about its position multiplies what it carries from the left by the dual quaternion of that turn.
    by_angle.setZero();
    for (int k = 1; k < joints; ++k) {
      if (carried[k].real.coeffs().squaredNorm() == 0)
        continue;
      Eigen::Matrix3d by_turn;
      for (int axis = 0; axis < 3; ++axis) {
        const Eigen::Vector3d turn = Eigen::Vector3d::Unit(axis);
        const Quat real = scaled(pure(turn), 0.5), dual = scaled(pure(-turn.cross(p.joints.row(k).transpose())), 0.5);
        DualQuat change{real * carried[k].real, real * carried[k].dual};
        add(change.dual, dual * carried[k].real, 1);
        by_turn.col(axis) = blend.derivative(change);
      }
      by_angle.middleCols<3>(3 * k) = by_turn * p.parent_axes[k];
    }
    rows.rightCols(data_.pose.cols()) = by_angle * data_.pose;
  }
  return result;
}

BodyLinearisation SkinnedBodyModel::joints(const Eigen::VectorXd &coefficients) const {
  const Posed p = pose(coefficients);
  const int joints = static_cast<int>(p.joints.rows());
  BodyLinearisation result{p.joints, MatrixRM(3 * joints, component_count())};
  result.jacobian.leftCols(data_.shape.cols()) = p.joint_shape;
  MatrixRM by_angle = MatrixRM::Zero(3 * joints, 3 * joints);
  for (int j = 0; j < joints; ++j)
    for (int k = 1; k < j; ++k)
      if (below(j, k))
        by_angle.block<3, 3>(3 * j, 3 * k) = -skew((p.joints.row(j) - p.joints.row(k)).transpose()) * p.parent_axes[k];
  result.jacobian.rightCols(data_.pose.cols()) = by_angle * data_.pose;
  return result;
}

} // namespace doublet
