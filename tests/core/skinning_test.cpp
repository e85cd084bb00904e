#include "doublet/core/skinning.h"

#include "support/figure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace doublet {

namespace {

Transforms random_transforms(int count, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Transforms out(count);
  for (Eigen::Isometry3d &T : out) {
    T = Eigen::Isometry3d::Identity();
    T.linear() =
        Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random)).normalized().toRotationMatrix();
    T.translation() = Eigen::Vector3d(normal(random), normal(random), normal(random));
  }
  return out;
}

} // namespace

TEST(Skinning, OneJointMovesRigidly) {
  const Transforms T = random_transforms(5, 1);
  const Vertices rest = Vertices::Random(40, 3);
  for (int j = 0; j < 5; ++j) {
    MatrixRM weights = MatrixRM::Zero(40, 5);
    weights.col(j).setOnes();
    const Vertices dq = dual_quaternion_skinning(rest, weights, T), lb = linear_blend_skinning(rest, weights, T);
    for (int v = 0; v < 40; ++v) {
      EXPECT_NEAR((dq.row(v).transpose() - T[j] * rest.row(v).transpose()).norm(), 0, 1e-12);
      EXPECT_NEAR((lb.row(v).transpose() - T[j] * rest.row(v).transpose()).norm(), 0, 1e-12);
    }
  }
}

TEST(Skinning, BlendIsTheTransformThatSkins) {
  const Transforms T = random_transforms(4, 2);
  const Vertices rest = Vertices::Random(60, 3);
  MatrixRM weights = MatrixRM::Random(60, 4).cwiseAbs();
  for (int v = 0; v < 60; ++v)
    weights.row(v) /= weights.row(v).sum();
  const Vertices skinned = dual_quaternion_skinning(rest, weights, T);
  const Transforms blend = dual_quaternion_blend(weights, T);
  for (int v = 0; v < 60; ++v) {
    EXPECT_NEAR((blend[v] * rest.row(v).transpose() - skinned.row(v).transpose()).norm(), 0, 1e-12);
    EXPECT_TRUE((blend[v].linear() * blend[v].linear().transpose()).isIdentity(1e-12));
  }
}

TEST(Skinning, HalfwayBetweenTwoTurnsAboutOneAxisIsTheHalfTurn) {
  // About one axis, the blend of angles 0 and a with equal weights turns by a / 2 and keeps the radius (no candy wrapper).
  const Eigen::Vector3d centre(0.3, 1.0, -0.2);
  for (const double angle : {0.5, 2.0, 3.0, -2.5}) {
    const auto turn = [&](double a) {
      Eigen::Isometry3d t = Eigen::Isometry3d::Identity();
      t.linear() = Eigen::AngleAxisd(a, Eigen::Vector3d::UnitX()).toRotationMatrix();
      t.translation() = centre - t.linear() * centre;
      return t;
    };
    Vertices rest(1, 3);
    rest.row(0) = centre + Eigen::Vector3d(0.1, 0.5, 0);
    const MatrixRM half = MatrixRM::Constant(1, 2, 0.5);
    const Vertices p = dual_quaternion_skinning(rest, half, {Eigen::Isometry3d::Identity(), turn(angle)});
    EXPECT_NEAR((p.row(0).transpose() - turn(angle / 2) * rest.row(0).transpose()).norm(), 0, 1e-12);
  }
}

TEST(Skinning, SignOfQuaternionsDoesNotMatter) {
  // More than half a turn between joints, where the signs of quaternions from matrices jump: the surface must not.
  const Skeleton s = testing::figure_skeleton();
  const Mesh body = testing::figure_surface(0.06);
  const MatrixRM weights = testing::figure_weights(body.vertices, s);
  Vertices before;
  for (double yaw = 0; yaw < 6.4; yaw += 0.02) {
    Eigen::VectorXd pose = Eigen::VectorXd::Constant(36, 0.2);
    pose[3] = yaw;
    const Vertices now = dual_quaternion_skinning(body.vertices, weights, forward_kinematics(s, pose));
    if (before.size()) {
      EXPECT_LT((now - before).rowwise().norm().maxCoeff(), 0.05) << yaw;
    }
    before = now;
  }
}

namespace {

/// Three bones in a row along y, joints at 0, 1 and 2 m, each blended over 1.2 m to both sides, so that all three meet; points on
/// a cylinder around them.
struct Stick {
  Skeleton skeleton =
      make_skeleton({{"root", "", {0, 0, 0}, 6}, {"first", "root", {0, 1, 0}, 3}, {"second", "first", {0, 2, 0}, 3}});
  Vertices rest;
  MatrixRM weights;
  Stick() : rest(61 * 8, 3), weights(MatrixRM::Zero(61 * 8, 3)) {
    for (int i = 0; i <= 60; ++i)
      for (int k = 0; k < 8; ++k) {
        const double y = 0.05 * i, angle = k * EIGEN_PI / 4;
        const double first = ramp(y, 1), second = ramp(y, 2);
        rest.row(8 * i + k) << 0.1 * std::cos(angle), y, 0.1 * std::sin(angle);
        weights.row(8 * i + k) << 1 - first, first - second, second;
      }
  }
  static double ramp(double y, double joint) { return std::clamp((y - joint) / 2.4 + 0.5, 0.0, 1.0); }
  Transforms posed(double first, double second) const {
    Eigen::VectorXd dofs = Eigen::VectorXd::Zero(skeleton.dof_count());
    dofs[6] = first, dofs[9] = second;
    return forward_kinematics(skeleton, dofs);
  }
  Vertices skinned(double first, double second) const {
    return dual_quaternion_skinning(rest, weights, skeleton, posed(first, second));
  }
  /// The most that neighbours along the stick are apart, by what they are at rest.
  double stretch(const Vertices &surface) const {
    return (surface.bottomRows(60 * 8) - surface.topRows(60 * 8)).rowwise().norm().maxCoeff() / 0.05;
  }
};

} // namespace

TEST(Skinning, ABindingWithoutWeightsIsRefused) {
  MatrixRM weights = MatrixRM::Ones(4, 2) / 2;
  EXPECT_NO_THROW(SkinBinding(Vertices::Zero(4, 3), weights));
  weights.row(2).setZero();
  EXPECT_THROW(SkinBinding(Vertices::Zero(4, 3), weights), std::invalid_argument);
}

TEST(Skinning, AlongASkeletonOrdinaryPosesHaveTheBitsOfAnySkinning) {
  const Skeleton s = testing::figure_skeleton();
  const Mesh body = testing::figure_surface(0.06);
  const MatrixRM weights = testing::figure_weights(body.vertices, s);
  const SkinBinding skin(body.vertices, weights);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> angle(-0.7, 0.7), turn(-3, 3); // three such joints in a row stay below half a turn
  for (int i = 0; i < 20; ++i) {
    Eigen::VectorXd pose(36);
    for (double &a : pose)
      a = angle(random);
    pose[3] = turn(random);
    const Transforms T = forward_kinematics(s, pose);
    const Vertices expected = dual_quaternion_skinning(body.vertices, weights, T);
    EXPECT_EQ(dual_quaternion_skinning(body.vertices, weights, s, T), expected);
    std::vector<DualQuaternion> joints;
    dual_quaternions(s, T, joints);
    Vertices surface;
    skin.pose(joints, surface);
    EXPECT_EQ(surface, expected);
    for (DualQuaternion &q : joints)
      q = -q;
    skin.pose(joints, surface);
    EXPECT_EQ(surface, expected);
    const Transforms blend = dual_quaternion_blend(weights, T), along = dual_quaternion_blend(weights, s, T);
    for (std::size_t v = 0; v < blend.size(); ++v)
      EXPECT_EQ(along[v].matrix(), blend[v].matrix());
  }
}

TEST(Skinning, AlongASkeletonTheSurfaceIsWholeAndContinuousBeyondHalfATurn) {
  const Stick stick;
  Vertices before;
  for (double bend = 0; bend < 2.2; bend += 0.01) { // both together up to 250 degrees
    const Vertices now = stick.skinned(bend, bend);
    if (before.size()) {
      EXPECT_LT((now - before).rowwise().norm().maxCoeff(), 0.06) << bend; // 3 m of stick turn by 0.02
    }
    EXPECT_LT(stick.stretch(now), 3.5) << bend;
    before = now;
  }
  const Transforms folded = stick.posed(1.8, 1.8);
  EXPECT_GT(stick.stretch(dual_quaternion_skinning(stick.rest, stick.weights, folded)), 10); // each vertex for itself
  // The whole turned beyond half a turn, where the quaternions of matrices change their signs.
  for (double yaw = 0; yaw < 6.4; yaw += 0.1) {
    Eigen::Isometry3d whole = Eigen::Isometry3d::Identity();
    whole.linear() = Eigen::AngleAxisd(yaw, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    Transforms turned;
    for (const Eigen::Isometry3d &t : folded)
      turned.push_back(whole * t);
    const Vertices a = stick.skinned(1.8, 1.8), b = dual_quaternion_skinning(stick.rest, stick.weights, stick.skeleton, turned);
    EXPECT_LT((b - a * whole.linear().transpose()).cwiseAbs().maxCoeff(), 1e-12) << yaw;
  }
}

TEST(Skinning, JointsAWholeTurnApartDoNotCancel) {
  const Stick stick;
  MatrixRM half = MatrixRM::Zero(1, 3);
  half << 0.5, 0, 0.5;
  const Vertices now = dual_quaternion_skinning(Vertices::Constant(1, 3, 0.1), half, stick.skeleton,
                                                stick.posed(EIGEN_PI - 1e-12, EIGEN_PI - 1e-12));
  EXPECT_TRUE(now.allFinite());
  EXPECT_LT((now - Vertices::Constant(1, 3, 0.1)).norm(), 1e-9); // the first of equals is at rest
}

TEST(Skinning, IsEquivariantUnderRigidMotions) {
  const Transforms T = random_transforms(3, 4), G = random_transforms(1, 5);
  const Vertices rest = Vertices::Random(30, 3);
  MatrixRM weights = MatrixRM::Random(30, 3).cwiseAbs();
  for (int v = 0; v < 30; ++v)
    weights.row(v) /= weights.row(v).sum();
  Transforms GT;
  for (const Eigen::Isometry3d &t : T)
    GT.push_back(G[0] * t);
  const Vertices a = dual_quaternion_skinning(rest, weights, T), b = dual_quaternion_skinning(rest, weights, GT);
  for (int v = 0; v < 30; ++v)
    EXPECT_NEAR((G[0] * a.row(v).transpose() - b.row(v).transpose()).norm(), 0, 1e-12);
}

TEST(Skinning, RefusesWrongSizes) {
  const Transforms T(2, Eigen::Isometry3d::Identity());
  EXPECT_THROW(dual_quaternion_skinning(Vertices::Zero(3, 3), MatrixRM::Ones(2, 2), T), std::invalid_argument);
  EXPECT_THROW(linear_blend_skinning(Vertices::Zero(2, 3), MatrixRM::Ones(2, 3), T), std::invalid_argument);
  EXPECT_THROW(dual_quaternion_skinning(Vertices::Zero(2, 3), MatrixRM::Zero(2, 2), T), std::invalid_argument);
  const Skeleton s = testing::figure_skeleton(); // not of two joints
  EXPECT_THROW(dual_quaternion_skinning(Vertices::Zero(2, 3), MatrixRM::Ones(2, 2), s, T), std::invalid_argument);
  EXPECT_THROW(dual_quaternion_blend(MatrixRM::Ones(2, 2), s, T), std::invalid_argument);
}

} // namespace doublet
