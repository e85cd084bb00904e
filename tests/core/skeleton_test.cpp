#include "doublet/core/skeleton.h"

#include "doublet/core/error.h"
#include "doublet/core/parts/skeleton_tree.h"
#include "support/figure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

namespace doublet {

namespace {

using Eigen::Vector3d;

Eigen::VectorXd random_pose(const Skeleton &s, unsigned seed, double size = 0.8) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-size, size);
  return Eigen::VectorXd::NullaryExpr(s.dof_count(), [&] { return uniform(random); });
}

int dof(const Skeleton &s, const std::string &name) {
  const auto it = std::find(s.dof_names.begin(), s.dof_names.end(), name);
  EXPECT_NE(it, s.dof_names.end()) << name;
  return static_cast<int>(it - s.dof_names.begin());
}

/// Joint positions with one degree of freedom at `value`, all others zero.
Vertices posed(const Skeleton &s, const std::string &name, double value) {
  Eigen::VectorXd pose = Eigen::VectorXd::Zero(s.dof_count());
  pose[dof(s, name)] = value;
  return joint_positions(s, forward_kinematics(s, pose));
}

std::string error_of(const std::vector<JointAnnotation> &marks) {
  try {
    make_skeleton(marks);
  } catch (const Error &error) {
    return error.what();
  }
  return "";
}

} // namespace

TEST(Skeleton, StandardNamesGiveThirtySixDofs) {
  const Skeleton s = testing::figure_skeleton();
  EXPECT_EQ(s.dof_count(), 36);
  EXPECT_EQ(s.lower.size(), 36);
  for (const char *name : {"pelvis.tx", "pelvis.rz", "spine.x", "neck.z", "l_shoulder.y", "l_elbow.flex", "r_elbow.twist",
                           "l_wrist.flex", "l_wrist.dev", "r_hip.x", "l_knee.flex", "r_ankle.flex"})
    dof(s, name);
  EXPECT_TRUE((s.lower.array() < 0).all() && (s.upper.array() > 0).all()); // the rest pose is allowed
}

TEST(Skeleton, LeavesAreWhereLimbsEnd) {
  const Skeleton s = testing::figure_skeleton();
  std::vector<std::string> leaves;
  for (int j = 0; j < s.joint_count(); ++j)
    if (s.is_leaf(j))
      leaves.push_back(s.joints[j].name);
  std::sort(leaves.begin(), leaves.end());
  EXPECT_EQ(leaves, (std::vector<std::string>{"head_top", "l_hand", "l_toe", "r_hand", "r_toe"}));
}

TEST(Skeleton, LimbsLeaveTheTrunkWhereAJointHasSeveralChildren) {
  const Skeleton s = testing::figure_skeleton();
  const std::vector<int> children = child_counts(s);
  ASSERT_EQ(children.size(), s.joints.size());
  int all = 0;
  for (int j = 0; j < s.joint_count(); ++j) {
    EXPECT_EQ(children[j] == 0, s.is_leaf(j)) << s.joints[j].name;
    all += children[j];
  }
  EXPECT_EQ(all, s.joint_count() - 1); // all but the root
  EXPECT_EQ(children[s.find("l_knee")], 1);
  EXPECT_EQ(children[0], 3); // two legs and the spine
  EXPECT_EQ(first_child(s, s.find("l_knee")), s.find("l_ankle"));
  EXPECT_EQ(s.joints[first_child(s, 0)].parent, 0);
  EXPECT_EQ(first_child(s, s.find("l_hand")), -1);
}

TEST(Skeleton, SortsParentsFirstWhateverTheOrder) {
  std::vector<JointAnnotation> marks = testing::stick_figure();
  std::reverse(marks.begin(), marks.end());
  const Skeleton s = make_skeleton(marks);
  for (int j = 0; j < s.joint_count(); ++j)
    EXPECT_LT(s.joints[j].parent, j);
  EXPECT_EQ(s.dof_count(), 36);
  const Skeleton again = make_skeleton(joint_annotations(s)); // the inverse, and sorting is stable
  EXPECT_EQ(again.dof_names, s.dof_names);
  EXPECT_EQ(again.lower, s.lower);
  for (int j = 0; j < s.joint_count(); ++j) {
    EXPECT_EQ(again.joints[j].name, s.joints[j].name);
    EXPECT_EQ(again.joints[j].axes, s.joints[j].axes);
  }
}

TEST(Skeleton, RefusesWhatIsNoTree) {
  std::vector<JointAnnotation> marks = testing::stick_figure();
  EXPECT_EQ(error_of(marks), "");
  const auto with = [&](auto change) {
    std::vector<JointAnnotation> m = marks;
    change(m);
    return error_of(m);
  };
  EXPECT_NE(with([](auto &m) { m[3].parent = "torso"; }).find("'torso' of joint 'neck'"), std::string::npos);
  EXPECT_NE(with([](auto &m) { m[3].parent = ""; }).find("expected one root"), std::string::npos);
  EXPECT_NE(with([](auto &m) { m[0].parent = "neck"; }).find("found none"), std::string::npos);
  EXPECT_NE(with([](auto &m) { m[3].parent = "head"; }).find("its own ancestor"), std::string::npos);
  EXPECT_NE(with([](auto &m) { m[3].name = "head"; }).find("two joints"), std::string::npos);
  EXPECT_NE(with([](auto &m) { m[3].dof = 4; }).find("'neck' has dof 4"), std::string::npos);
  EXPECT_NE(with([](auto &m) { m[3].position.x() = NAN; }).find("not finite"), std::string::npos);
  EXPECT_NE(with([](auto &m) { m.clear(); }).find("found none in 0"), std::string::npos);
  EXPECT_THROW(make_skeleton(marks).find("l_tail"), Error);
}

TEST(Skeleton, PositiveFlexionBendsAsPeopleDo) {
  const Skeleton s = testing::figure_skeleton();
  const Vertices rest = joint_positions(s, forward_kinematics(s, Eigen::VectorXd::Zero(36)));
  const auto at = [&](const Vertices &p, const char *joint) -> Vector3d { return p.row(s.find(joint)); };
  for (const std::string side : {"l_", "r_"}) {
    const Vertices knee = posed(s, side + "knee.flex", 1.5);
    const std::string ankle = side + "ankle", hand = side + "hand", shoulder = side + "shoulder", toe = side + "toe";
    EXPECT_LT(at(knee, ankle.c_str()).z(), -0.3); // heel behind
    EXPECT_NEAR(at(knee, ankle.c_str()).x(), at(rest, ankle.c_str()).x(), 0.05);
    const Vertices elbow = posed(s, side + "elbow.flex", 1.2);
    EXPECT_LT((at(elbow, hand.c_str()) - at(elbow, shoulder.c_str())).norm(),
              (at(rest, hand.c_str()) - at(rest, shoulder.c_str())).norm() - 0.1);
    EXPECT_GT(at(elbow, hand.c_str()).z(), 0.2); // in front
    EXPECT_GT(at(posed(s, side + "ankle.flex", 0.3), toe.c_str()).y(), at(rest, toe.c_str()).y() + 0.02);
  }
}

TEST(Skeleton, KneesAndAnklesMayTurnAboutTheShank) {
  std::vector<JointAnnotation> marks = testing::stick_figure();
  for (JointAnnotation &m : marks)
    if (m.name.size() > 2 && (m.name.substr(2) == "knee" || m.name.substr(2) == "ankle"))
      m.dof = 2;
  const Skeleton s = make_skeleton(marks), plain = testing::figure_skeleton();
  EXPECT_EQ(s.dof_count(), 40);
  const Vertices rest = joint_positions(s, forward_kinematics(s, Eigen::VectorXd::Zero(40)));
  for (const std::string side : {"l_", "r_"}) {
    const int ankle = s.find(side + "ankle"), toe = s.find(side + "toe");
    for (const std::string turned : {"knee.twist", "ankle.turn"}) {
      const Vertices posed_joints = posed(s, side + turned, 0.4);
      EXPECT_LT((posed_joints.row(ankle) - rest.row(ankle)).norm(), 1e-9) << turned; // about the shank, which keeps its place
      EXPECT_GT(std::abs(posed_joints(toe, 0) - rest(toe, 0)), 0.03) << turned;
    }
    for (const std::string bent : {"knee.flex", "ankle.flex"}) // the second hinge leaves the first as it was
      EXPECT_LT((posed(s, side + bent, 0.5) - posed(plain, side + bent, 0.5)).cwiseAbs().maxCoeff(), 1e-9) << bent;
  }
}

TEST(Skeleton, StraightLimbsBendTheRightWayToo) {
  std::vector<JointAnnotation> t_pose = testing::stick_figure();
  for (JointAnnotation &m : t_pose) {
    const double side = m.name[0] == 'l' ? 1 : -1;
    const std::string joint = m.name.substr(std::min<std::size_t>(2, m.name.size()));
    if (joint == "elbow" || joint == "wrist" || joint == "hand")
      m.position = {side * (joint == "elbow" ? 0.42 : joint == "wrist" ? 0.66 : 0.76), 1.34, -0.02};
    if (joint == "knee")
      m.position.z() = 0;
  }
  const Skeleton s = make_skeleton(t_pose);
  for (const std::string side : {"l_", "r_"}) {
    EXPECT_GT(posed(s, side + "elbow.flex", 1)(s.find(side + "hand"), 2), 0.2);
    EXPECT_LT(posed(s, side + "knee.flex", 1)(s.find(side + "ankle"), 2), -0.2);
  }
}

TEST(Skeleton, LimitsAreRelativeToTheRestBend) {
  const Skeleton s = testing::figure_skeleton();
  const double degree = testing::pi / 180;
  const Vector3d upper = s.joints[s.find("l_elbow")].rest - s.joints[s.find("l_shoulder")].rest;
  const Vector3d lower = s.joints[s.find("l_wrist")].rest - s.joints[s.find("l_elbow")].rest;
  const double bend = std::acos(upper.normalized().dot(lower.normalized()));
  EXPECT_GT(bend, 10 * degree);
  EXPECT_NEAR(s.lower[dof(s, "l_elbow.flex")], -bend - 10 * degree, 1e-9);
  EXPECT_NEAR(s.upper[dof(s, "l_elbow.flex")], 155 * degree - bend, 1e-9);
  EXPECT_EQ(s.upper[dof(s, "pelvis.tx")], std::numeric_limits<double>::infinity());
}

TEST(Skeleton, AnyJointMayHaveAnyFreedom) {
  const Skeleton s = make_skeleton({{"base", "", {0, 0, 0}, {}},
                                    {"a", "base", {0, 1, 0}, 1},
                                    {"b", "a", {0, 1, 0}, 2}, // no length, no child
                                    {"l_knee", "base", {1, 0, 0}, 2},
                                    {"r_elbow", "base", {-1, 0, 0}, 1},
                                    {"l_wrist", "base", {-1, 0, 1}, 2},
                                    {"float", "a", {0, 2, 0}, 6},
                                    {"l_hip", "base", {0, -1, 0}, 1}});
  EXPECT_EQ(s.dof_count(), 6 + 1 + 2 + 2 + 1 + 2 + 6 + 1);
  for (const Joint &j : s.joints)
    for (const Vector3d &axis : j.axes)
      EXPECT_NEAR(axis.norm(), 1, 1e-9) << j.name;
  EXPECT_EQ(make_skeleton({{"only", "", {0, 0, 0}, {}}}).dof_count(), 6);
  EXPECT_EQ(make_skeleton({{"only", "", {0, 0, 0}, 1}}).dof_count(), 1);
  EXPECT_EQ(make_skeleton({{"only", "", {0, 0, 0}, 0}}).dof_count(), 0);
}

TEST(Skeleton, ForwardKinematicsKnowsItsDefinition) {
  const Skeleton s = testing::figure_skeleton();
  for (const Eigen::Isometry3d &T : forward_kinematics(s, Eigen::VectorXd::Zero(36)))
    EXPECT_TRUE(T.isApprox(Eigen::Isometry3d::Identity()));
  Eigen::VectorXd pose = Eigen::VectorXd::Zero(36);
  pose.head<6>() << 0.3, 0.2, -0.1, testing::pi / 2, 0, 0; // a quarter turn to the left, seen from above
  const Transforms T = forward_kinematics(s, pose);
  const Vector3d rest = s.joints[0].rest;
  EXPECT_NEAR((T[0] * rest - (rest + Vector3d(0.3, 0.2, -0.1))).norm(), 0, 1e-12);
  EXPECT_NEAR((T[0].linear() * Vector3d::UnitZ() - Vector3d::UnitX()).norm(), 0, 1e-12);
  const Vertices p = joint_positions(s, forward_kinematics(s, random_pose(s, 3)));
  for (int j = 1; j < s.joint_count(); ++j) { // bones keep their length
    const int q = s.joints[j].parent;
    EXPECT_NEAR((p.row(j) - p.row(q)).norm(), (s.joints[j].rest - s.joints[q].rest).norm(), 1e-12);
  }
  EXPECT_THROW(forward_kinematics(s, Eigen::VectorXd::Zero(35)), std::invalid_argument);
  EXPECT_THROW(joint_positions(s, {}), std::invalid_argument);
}

TEST(Skeleton, TwistsAreTheDerivativesOfForwardKinematics) {
  std::vector<JointAnnotation> marks = testing::stick_figure();
  marks.push_back({"tail", "spine", {0, 1, -0.3}, 6}); // a second free joint, below others
  const Skeleton s = make_skeleton(marks);
  const auto moved = dof_moves_joint(s);
  for (unsigned seed = 0; seed < 4; ++seed) {
    const Eigen::VectorXd pose = seed ? random_pose(s, seed) : Eigen::VectorXd::Zero(s.dof_count());
    const Transforms at = forward_kinematics(s, pose);
    const std::vector<DofTwist> twists = dof_twists(s, pose);
    for (int d = 0; d < s.dof_count(); ++d) {
      Eigen::VectorXd plus = pose, minus = pose;
      plus[d] += 1e-6;
      minus[d] -= 1e-6;
      const Transforms a = forward_kinematics(s, plus), b = forward_kinematics(s, minus);
      for (int j = 0; j < s.joint_count(); ++j) {
        const Vector3d x(0.3, 0.7, -0.2); // any point of the joint
        const Vector3d numeric = (a[j] * x - b[j] * x) / 2e-6;
        const Vector3d exact = moved(d, j) ? Vector3d(twists[d].angular.cross(at[j] * x) + twists[d].linear) : Vector3d::Zero();
        EXPECT_NEAR((numeric - exact).norm(), 0, 1e-8) << s.dof_names[d] << " " << s.joints[j].name;
      }
    }
  }
}

TEST(Skeleton, PoseFromRotationsFindsThePoseAgain) {
  const Skeleton s = testing::figure_skeleton();
  for (unsigned seed = 1; seed < 20; ++seed) {
    const Eigen::VectorXd pose = random_pose(s, seed, 1.2);
    const Transforms T = forward_kinematics(s, pose);
    std::vector<Eigen::Quaterniond> rotations;
    for (const Eigen::Isometry3d &t : T)
      rotations.emplace_back(t.linear());
    const Eigen::VectorXd found = pose_from_rotations(s, rotations, T[0] * s.joints[0].rest, false);
    EXPECT_LT((found - pose).cwiseAbs().maxCoeff(), 1e-9);
  }
}

TEST(Skeleton, SpineDrivesChestAndNeckDrivesHead) {
  const Skeleton s = testing::figure_skeleton();
  std::vector<Eigen::Quaterniond> rotations(s.joint_count(), Eigen::Quaterniond::Identity());
  const auto turn = [](double angle) { return Eigen::Quaterniond(Eigen::AngleAxisd(angle, Vector3d::UnitY())); };
  rotations[s.find("chest")] = turn(0.5);
  rotations[s.find("head")] = turn(0.9);
  rotations[s.find("head_top")] = turn(2); // the end of a bone has no say
  rotations[s.find("l_toe")] = turn(2);
  const Eigen::VectorXd pose = pose_from_rotations(s, rotations, s.joints[0].rest, false);
  const Transforms T = forward_kinematics(s, pose);
  EXPECT_TRUE(T[s.find("chest")].linear().isApprox(turn(0.5).toRotationMatrix()));
  EXPECT_TRUE(T[s.find("head")].linear().isApprox(turn(0.9).toRotationMatrix()));
  EXPECT_TRUE(T[s.find("l_hip")].linear().isIdentity(1e-9));
  EXPECT_NEAR(pose[dof(s, "l_ankle.flex")], 0, 1e-9);
}

TEST(Skeleton, HingesTakeTheClosestRotationAndLimitsHold) {
  const Skeleton s = testing::figure_skeleton();
  const Joint &elbow = s.joints[s.find("l_elbow")];
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 20; ++i) {
    const Eigen::Quaterniond wanted =
        Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random)).normalized();
    std::vector<Eigen::Quaterniond> rotations(s.joint_count(), Eigen::Quaterniond::Identity());
    rotations[s.find("l_elbow")] = wanted;
    const Eigen::VectorXd pose = pose_from_rotations(s, rotations, s.joints[0].rest, false);
    const auto closeness = [&](double a, double b) {
      const Eigen::Matrix3d R = rotation_from_vector(a * elbow.axes[0]) * rotation_from_vector(b * elbow.axes[1]);
      return (R.transpose() * wanted.toRotationMatrix()).trace();
    };
    double best = -1e9;
    for (double a = -testing::pi; a < testing::pi; a += 0.1)
      for (double b = -testing::pi; b < testing::pi; b += 0.1)
        best = std::max(best, closeness(a, b));
    EXPECT_GE(closeness(pose[elbow.first_dof], pose[elbow.first_dof + 1]), best - 1e-9);
    const Eigen::VectorXd limited = pose_from_rotations(s, rotations, s.joints[0].rest, true);
    EXPECT_TRUE((limited.array() >= s.lower.array()).all() && (limited.array() <= s.upper.array()).all());
  }
  EXPECT_THROW(pose_from_rotations(s, {}, Vector3d::Zero(), false), std::invalid_argument);
}

TEST(Skeleton, RotationVectors) {
  for (const double angle : {0.0, 1e-12, 1e-7, 5e-4, 0.002, 1.0, 3.0, 3.14159}) {
    const Vector3d v = angle * Vector3d(1, -2, 0.5).normalized();
    EXPECT_NEAR((vector_from_rotation(rotation_from_vector(v)) - v).norm(), 0, 1e-8);
    const Eigen::Matrix3d J = left_jacobian(v);
    for (int k = 0; k < 3; ++k) {
      const Vector3d h = 1e-5 * Vector3d::Unit(k);
      const Vector3d numeric = vector_from_rotation(rotation_from_vector(v + h) * rotation_from_vector(v - h).transpose()) / 2e-5;
      EXPECT_NEAR((J.col(k) - numeric).norm(), 0, 1e-6);
    }
  }
  const Vector3d half_turn = testing::pi * Vector3d::UnitX();
  EXPECT_NEAR(std::abs(vector_from_rotation(rotation_from_vector(half_turn)).x()), testing::pi, 1e-7);
}

} // namespace doublet
