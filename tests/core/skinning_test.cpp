#include "doublet/core/skinning.h"

#include "support/figure.h"

#include <gtest/gtest.h>

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
}

} // namespace doublet
