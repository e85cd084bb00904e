#include "leg.h"

#include "doublet/core/parts/alignment.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace doublet {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

/// u . (v turned by an angle about an axis) = offset + size cos(angle - peak)
struct TurnedDot {
  double offset, size, peak;
  TurnedDot(const Vector3d &u, const Vector3d &v, const Vector3d &axis) {
    const double along = u.dot(axis) * v.dot(axis), c = u.dot(v) - along, s = u.dot(axis.cross(v));
    offset = along;
    size = std::hypot(c, s);
    peak = std::atan2(s, c);
  }
  /// From the peak to where the product is `value`, or as near as it gets.
  double angle(double value) const { return size > 0 ? std::acos(std::clamp((value - offset) / size, -1.0, 1.0)) : 0; }
};

Matrix3d about(const Vector3d &axis, double angle) {
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

double near(double angle, double other) {
  return other + std::remainder(angle - other, 2 * M_PI);
}

/// The rotation vector of R that lies nearest to `other`: vectors wind past pi without a jump.
Vector3d vector_near(const Matrix3d &R, const Vector3d &other) {
  const Vector3d v = vector_from_rotation(R);
  const double angle = v.norm();
  if (angle < 1e-9)
    return v;
  const Vector3d wound = v * (1 - 2 * M_PI / angle);
  return (wound - other).norm() < (v - other).norm() ? wound : v;
}

double within(const Skeleton &skeleton, int dof, double value, double before) {
  return std::clamp(value, std::min(skeleton.lower[dof], before), std::max(skeleton.upper[dof], before));
}

/// The leg's bones in the rest pose, and its angles.
struct Chain {
  const Joint &hip, &knee, &ankle;
  Vector3d thigh, shin;
  TurnedDot bend; ///< thigh . shin by the knee's angle: the leg's length
  Chain(const Skeleton &skeleton, const Leg &leg)
      : hip(skeleton.joints[leg.hip]), knee(skeleton.joints[leg.knee]), ankle(skeleton.joints[leg.ankle]),
        thigh(knee.rest - hip.rest), shin(ankle.rest - knee.rest), bend(thigh, shin, knee.axes[0]) {}

  Vector3d hip_to_ankle(double flexion) const { return thigh + about(knee.axes[0], flexion) * shin; }
  double flexion(double length) const {
    return bend.peak + bend.angle(0.5 * (length * length - thigh.squaredNorm() - shin.squaredNorm()));
  }
};

/// The ankle's angle for a foot under a shin: of the slope where the foot is not steep, else the nearest to the rotation.
double ankle_angle(const Leg &leg, const Vector3d &axis, const Matrix3d &shin, const FootGoal &goal, double before) {
  const Quaterniond wanted(shin.transpose() * goal.rotation);
  const double nearest = near(2 * std::atan2(wanted.vec().dot(axis), wanted.w()), before);
  const double flat = std::clamp((0.9 - std::abs(goal.slope)) / 0.2, 0.0, 1.0);
  const TurnedDot height(shin.transpose() * Vector3d::UnitY(), (leg.tip - leg.heel) / leg.sole(), axis);
  const double away = height.angle(goal.slope);
  const double a = near(height.peak + away, nearest), b = near(height.peak - away, nearest);
  const double sloped = std::abs(a - nearest) < std::abs(b - nearest) ? a : b;
  return nearest + flat * (sloped - nearest);
}

} // namespace

std::vector<Leg> find_legs(const Skeleton &skeleton, double floor_height) {
  const auto index = [&](const std::string &name) {
    for (int j = 0; j < skeleton.joint_count(); ++j)
      if (skeleton.joints[j].name == name)
        return j;
    return -1;
  };
  std::vector<Leg> legs;
  for (const std::string side : {"l_", "r_"}) {
    const std::array<int, 4> chain{index(side + "hip"), index(side + "knee"), index(side + "ankle"), index(side + "toe")};
    bool fits = chain[0] > 0 && skeleton.joints[chain[0]].kind == JointKind::Ball;
    for (int k = 1; k < 4; ++k)
      fits = fits && chain[k] > 0 && skeleton.joints[chain[k]].parent == chain[k - 1];
    fits = fits && skeleton.joints[chain[1]].dof_count == 1 && skeleton.joints[chain[2]].dof_count == 1;
    if (!fits)
      continue;
    Vector3d ankle = skeleton.joints[chain[2]].rest, toe = skeleton.joints[chain[3]].rest;
    ankle.y() = toe.y() = floor_height;
    // The mark of the toe is at the ball; heel and tip of a foot lie beyond the marks by about 0.4 of their distance.
    const Vector3d along = toe - ankle;
    if (along.norm() > 0.01)
      legs.push_back({chain[0], chain[1], chain[2], ankle - 0.4 * along, toe, toe + 0.4 * along});
  }
  return legs;
}

double longest_reach(const Skeleton &skeleton, const Leg &leg) {
  const Chain chain(skeleton, leg);
  return chain.hip_to_ankle(chain.bend.peak).norm();
}

void solve_leg(const Skeleton &skeleton, const Leg &leg, const FootGoal &goal, Eigen::VectorXd &pose) {
  const Chain chain(skeleton, leg);
  const Transforms world = forward_kinematics(skeleton, pose);
  const int h = chain.hip.first_dof, k = chain.knee.first_dof, a = chain.ankle.first_dof;
  const Eigen::VectorXd before = pose;
  const Vector3d from = world[leg.hip] * chain.hip.rest;
  const Matrix3d above = world[chain.hip.parent].linear();
  const double own = chain.flexion(chain.hip_to_ankle(before[k]).norm());
  Matrix3d foot = goal.rotation;
  // The ankle's place depends on how the foot ends up under the leg: a few rounds, each ten times nearer.
  for (int round = 0; round < 6; ++round) {
    const Vector3d wanted = goal.at - foot * (goal.point - chain.ankle.rest) - from;
    // By difference, so that a knee bent the wrong way, which has two angles for one length, does not jump.
    pose[k] = within(skeleton, k, before[k] + chain.flexion(wanted.norm()) - own, before[k]);
    const Matrix3d thigh_before = above * rotation_from_vector(before.segment<3>(h));
    const Matrix3d turn = shortest_turn(thigh_before * chain.hip_to_ankle(pose[k]), wanted);
    pose.segment<3>(h) = vector_near(above.transpose() * turn * thigh_before, before.segment<3>(h));
    for (int i = 0; i < 3; ++i)
      pose[h + i] = within(skeleton, h + i, pose[h + i], before[h + i]);
    const Matrix3d shin = above * rotation_from_vector(pose.segment<3>(h)) * about(chain.knee.axes[0], pose[k]);
    pose[a] = within(skeleton, a, ankle_angle(leg, chain.ankle.axes[0], shin, goal, before[a]), before[a]);
    foot = shin * about(chain.ankle.axes[0], pose[a]);
  }
}

void lift_feet(const Skeleton &skeleton, double floor_height, Eigen::VectorXd &pose) {
  for (const Leg &leg : find_legs(skeleton, floor_height)) {
    const Eigen::Isometry3d foot = forward_kinematics(skeleton, pose)[leg.ankle];
    const double heel = (foot * leg.heel).y(), tip = (foot * leg.tip).y(), below = floor_height - std::min(heel, tip);
    if (below > 1e-9)
      solve_leg(skeleton, leg, {leg.ball, foot * leg.ball + below * Vector3d::UnitY(), foot.linear(), (tip - heel) / leg.sole()},
                pose);
  }
}

} // namespace doublet
