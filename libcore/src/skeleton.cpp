// Forward kinematics, its derivatives, and poses from rotations.

#include "doublet/core/skeleton.h"

#include <Eigen/SVD>

#include <cmath>
#include <stdexcept>

namespace doublet {

namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

Matrix3d about(const Vector3d &axis, double angle) {
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

void require_pose(const Skeleton &skeleton, const Eigen::VectorXd &dofs, const char *caller) {
  if (dofs.size() != skeleton.dof_count())
    throw std::invalid_argument(std::string(caller) + ": expected a pose of " + std::to_string(skeleton.dof_count()) +
                                " degrees of freedom, found " + std::to_string(dofs.size()));
  if (!dofs.allFinite())
    throw std::invalid_argument(std::string(caller) + ": expected a pose of finite numbers, found NaN or infinity");
}

/// The joint's own rotation.
Matrix3d joint_rotation(const Joint &joint, const Eigen::VectorXd &dofs) {
  const auto dof = [&](int k) { return dofs[joint.first_dof + k]; };
  switch (joint.kind) {
  case JointKind::Root:
    return about(Vector3d::UnitY(), dof(3)) * about(Vector3d::UnitX(), dof(4)) * about(Vector3d::UnitZ(), dof(5));
  case JointKind::Ball:
    return rotation_from_vector(dofs.segment<3>(joint.first_dof));
  case JointKind::Hinges: {
    Matrix3d R = about(joint.axes[0], dof(0));
    if (joint.dof_count == 2)
      R = R * about(joint.axes[1], dof(1));
    return R;
  }
  case JointKind::Fixed:
    break;
  }
  return Matrix3d::Identity();
}

Vector3d joint_translation(const Joint &joint, const Eigen::VectorXd &dofs) {
  return joint.kind == JointKind::Root ? Vector3d(dofs.segment<3>(joint.first_dof)) : Vector3d::Zero();
}

Eigen::Isometry3d parent_transform(const Joint &joint, const Transforms &world_from_rest) {
  return joint.parent < 0 ? Eigen::Isometry3d::Identity() : world_from_rest[joint.parent];
}

/// world_from_rest[joint] = parent * (rotate about the rest position, then translate).
Eigen::Isometry3d joint_transform(const Joint &joint, const Eigen::VectorXd &dofs, const Eigen::Isometry3d &parent) {
  const Matrix3d R = joint_rotation(joint, dofs);
  Eigen::Isometry3d local = Eigen::Isometry3d::Identity();
  local.linear() = R;
  local.translation() = joint.rest - R * joint.rest + joint_translation(joint, dofs);
  return parent * local;
}

/// Axes of the joint's angles at the pose, in the frame of its parent; columns in the order of the angles.
Eigen::Matrix3Xd angle_axes(const Joint &joint, const Eigen::VectorXd &dofs) {
  const auto dof = [&](int k) { return dofs[joint.first_dof + k]; };
  Eigen::Matrix3Xd axes;
  if (joint.kind == JointKind::Root) {
    const Matrix3d yaw = about(Vector3d::UnitY(), dof(3));
    axes.resize(3, 3);
    axes << Vector3d::UnitY(), yaw.col(0), yaw * about(Vector3d::UnitX(), dof(4)).col(2);
  } else if (joint.kind == JointKind::Ball) {
    axes = left_jacobian(dofs.segment<3>(joint.first_dof));
  } else if (joint.kind == JointKind::Hinges) {
    axes.resize(3, joint.dof_count);
    axes.col(0) = joint.axes[0];
    if (joint.dof_count == 2)
      axes.col(1) = about(joint.axes[0], dof(0)) * joint.axes[1];
  }
  return axes;
}

std::vector<std::vector<int>> children_of(const Skeleton &skeleton) {
  std::vector<std::vector<int>> children(skeleton.joint_count());
  for (int j = 0; j < skeleton.joint_count(); ++j)
    if (skeleton.joints[j].parent >= 0)
      children[skeleton.joints[j].parent].push_back(j);
  return children;
}

/// The joint whose rotation `joint` takes: the last fixed one of its chain before the chain forks or becomes free again. A joint
/// without children marks the end of a bone and has no rotation of its own, unless it is all that a ball joint carries (a head).
int driving_joint(const Skeleton &skeleton, const std::vector<std::vector<int>> &children, int joint) {
  int driver = joint;
  for (;;) {
    int next = -1, candidates = 0;
    for (const int c : children[driver]) {
      if (skeleton.joints[c].dof_count > 0)
        return driver;
      const bool marker = children[c].empty() && !(driver == joint && skeleton.joints[joint].kind == JointKind::Ball);
      if (!marker) {
        next = c;
        ++candidates;
      }
    }
    if (candidates != 1)
      return driver;
    driver = next;
  }
}

double wrapped(double angle) {
  return std::remainder(angle, 2 * 3.14159265358979323846);
}

/// Angles of the hinges whose rotation is closest to Q. With half-angle vectors u = (cos, sin)(a0 / 2) and v likewise, the cosine
/// between the two unit quaternions is bilinear, u^T M v: its maximum is given by the first pair of singular vectors.
Eigen::Vector2d closest_hinge_angles(const Joint &joint, const Quaterniond &Q) {
  const auto pure = [](const Vector3d &axis) { return Quaterniond(0, axis.x(), axis.y(), axis.z()); };
  const Quaterniond A = pure(joint.axes[0]);
  if (joint.dof_count == 1)
    return {wrapped(2 * std::atan2(Q.vec().dot(joint.axes[0]), Q.w())), 0};
  const Quaterniond B = pure(joint.axes[1]);
  Eigen::Matrix2d M;
  M << Q.w(), Q.dot(B), Q.dot(A), Q.dot(A * B);
  const Eigen::JacobiSVD<Eigen::Matrix2d> svd(M, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector2d u = svd.matrixU().col(0), v = svd.matrixV().col(0);
  return {wrapped(2 * std::atan2(u[1], u[0])), wrapped(2 * std::atan2(v[1], v[0]))};
}

/// R = Ry Rx Rz -> (y, x, z).
Vector3d yaw_pitch_roll(const Matrix3d &R) {
  const double x = std::atan2(-R(1, 2), std::hypot(R(0, 2), R(2, 2)));
  if (std::hypot(R(0, 2), R(2, 2)) < 1e-9) // looking straight up or down: yaw and roll are one, keep it in the yaw
    return {std::atan2(-R(2, 0), R(0, 0)), x, 0};
  return {std::atan2(R(0, 2), R(2, 2)), x, std::atan2(R(1, 0), R(1, 1))};
}

double short_way(double from, double to) {
  return from + std::remainder(to - from, 2 * M_PI);
}

} // namespace

void forward_kinematics(const Skeleton &skeleton, const Eigen::VectorXd &dofs, Transforms &world_from_rest) {
  require_pose(skeleton, dofs, "forward_kinematics");
  world_from_rest.resize(skeleton.joint_count());
  for (int j = 0; j < skeleton.joint_count(); ++j)
    world_from_rest[j] = joint_transform(skeleton.joints[j], dofs, parent_transform(skeleton.joints[j], world_from_rest));
}

Transforms forward_kinematics(const Skeleton &skeleton, const Eigen::VectorXd &dofs) {
  Transforms world_from_rest;
  forward_kinematics(skeleton, dofs, world_from_rest);
  return world_from_rest;
}

void joint_positions(const Skeleton &skeleton, const Transforms &world_from_rest, Vertices &positions) {
  if (static_cast<int>(world_from_rest.size()) != skeleton.joint_count())
    throw std::invalid_argument("joint_positions: expected " + std::to_string(skeleton.joint_count()) + " transforms, found " +
                                std::to_string(world_from_rest.size()));
  positions.resize(skeleton.joint_count(), 3);
  for (int j = 0; j < skeleton.joint_count(); ++j)
    positions.row(j) = world_from_rest[j] * skeleton.joints[j].rest;
}

Vertices joint_positions(const Skeleton &skeleton, const Transforms &world_from_rest) {
  Vertices positions;
  joint_positions(skeleton, world_from_rest, positions);
  return positions;
}

std::vector<DofTwist> dof_twists(const Skeleton &skeleton, const Eigen::VectorXd &dofs) {
  const Transforms world_from_rest = forward_kinematics(skeleton, dofs);
  std::vector<DofTwist> twists(skeleton.dof_count());
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const Joint &joint = skeleton.joints[j];
    const Matrix3d parent = parent_transform(joint, world_from_rest).linear();
    const Vector3d position = world_from_rest[j] * joint.rest;
    int d = joint.first_dof;
    if (joint.kind == JointKind::Root)
      for (int k = 0; k < 3; ++k)
        twists[d++] = {j, Vector3d::Zero(), parent.col(k)};
    const Eigen::Matrix3Xd axes = angle_axes(joint, dofs);
    for (int k = 0; k < axes.cols(); ++k) {
      const Vector3d angular = parent * axes.col(k);
      twists[d++] = {j, angular, position.cross(angular)};
    }
  }
  return twists;
}

Eigen::Matrix<bool, Eigen::Dynamic, Eigen::Dynamic> dof_moves_joint(const Skeleton &skeleton) {
  Eigen::Matrix<bool, Eigen::Dynamic, Eigen::Dynamic> moved(skeleton.dof_count(), skeleton.joint_count());
  moved.setConstant(false);
  for (int j = 0; j < skeleton.joint_count(); ++j)
    for (int a = j; a >= 0; a = skeleton.joints[a].parent)
      moved.col(j).segment(skeleton.joints[a].first_dof, skeleton.joints[a].dof_count).setConstant(true);
  return moved;
}

Eigen::VectorXd pose_from_rotations(const Skeleton &skeleton, const std::vector<Quaterniond> &world_rotations,
                                    const Vector3d &root_position, bool apply_limits) {
  if (static_cast<int>(world_rotations.size()) != skeleton.joint_count())
    throw std::invalid_argument("pose_from_rotations: expected " + std::to_string(skeleton.joint_count()) + " rotations, found " +
                                std::to_string(world_rotations.size()));
  const std::vector<std::vector<int>> children = children_of(skeleton);
  Eigen::VectorXd dofs = Eigen::VectorXd::Zero(skeleton.dof_count());
  Transforms world_from_rest(skeleton.joint_count());
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const Joint &joint = skeleton.joints[j];
    const Eigen::Isometry3d parent = parent_transform(joint, world_from_rest);
    const Quaterniond wanted = world_rotations[driving_joint(skeleton, children, j)].normalized();
    const Matrix3d local = parent.linear().transpose() * wanted.toRotationMatrix();
    auto own = dofs.segment(joint.first_dof, joint.dof_count);
    if (joint.kind == JointKind::Root) {
      if (joint.parent < 0)
        own.head<3>() = root_position - joint.rest;
      own.tail<3>() = yaw_pitch_roll(local);
    } else if (joint.kind == JointKind::Ball) {
      own = vector_from_rotation(local);
    } else if (joint.kind == JointKind::Hinges) {
      own = closest_hinge_angles(joint, Quaterniond(local)).head(joint.dof_count);
    }
    if (apply_limits)
      for (int k = 0; k < joint.dof_count; ++k)
        own[k] = std::min(std::max(own[k], skeleton.lower[joint.first_dof + k]), skeleton.upper[joint.first_dof + k]);
    world_from_rest[j] = joint_transform(joint, dofs, parent);
  }
  return dofs;
}

Matrix3d rotation_from_vector(const Vector3d &rotation_vector) {
  const double angle = rotation_vector.norm();
  if (angle < 1e-300)
    return Matrix3d::Identity();
  return about(rotation_vector / angle, angle);
}

Vector3d vector_from_rotation(const Matrix3d &rotation) {
  const Eigen::AngleAxisd a(rotation);
  return a.angle() * a.axis();
}

Matrix3d left_jacobian(const Vector3d &rotation_vector) {
  const double angle2 = rotation_vector.squaredNorm(), angle = std::sqrt(angle2);
  // (1 - cos) / angle^2 and (angle - sin) / angle^3 by series near zero, where the differences cancel.
  const bool small = angle < 1e-3;
  const double a = small ? 0.5 - angle2 / 24 : (1 - std::cos(angle)) / angle2;
  const double b = small ? 1.0 / 6 - angle2 / 120 : (angle - std::sin(angle)) / (angle2 * angle);
  Matrix3d X;
  X << 0, -rotation_vector.z(), rotation_vector.y(), //
      rotation_vector.z(), 0, -rotation_vector.x(),  //
      -rotation_vector.y(), rotation_vector.x(), 0;
  return Matrix3d::Identity() + a * X + b * X * X;
}

Eigen::VectorXd interpolate_pose(const Skeleton &skeleton, const Eigen::VectorXd &a, const Eigen::VectorXd &b, double s) {
  Eigen::VectorXd pose;
  interpolate_pose(skeleton, a, b, s, pose);
  return pose;
}

void interpolate_pose(const Skeleton &skeleton, const Eigen::VectorXd &a, const Eigen::VectorXd &b, double s,
                      Eigen::VectorXd &result) {
  result = (1 - s) * a + s * b;
  for (const Joint &joint : skeleton.joints) {
    const int d = joint.first_dof;
    if (joint.kind == JointKind::Root) {
      for (int k = 3; k < 6; ++k)
        result[d + k] = (1 - s) * a[d + k] + s * short_way(a[d + k], b[d + k]);
    } else if (joint.kind == JointKind::Ball) {
      const Eigen::Quaterniond from(rotation_from_vector(a.segment<3>(d))), to(rotation_from_vector(b.segment<3>(d)));
      result.segment<3>(d) = vector_from_rotation(from.slerp(s, to).normalized().toRotationMatrix());
    }
  }
}

} // namespace doublet
