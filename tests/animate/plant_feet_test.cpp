#include "doublet/animate/plant_feet.h"
#include "doublet/animate/retarget.h"
#include "figure_character.h"

#include <gtest/gtest.h>

#include <array>

namespace planting {

using namespace doublet;
using namespace doublet::testing;

int dof(const Skeleton &skeleton, const std::string &joint) {
  return skeleton.joints[skeleton.find(joint)].first_dof;
}

/// Steps of half a second on knees that bend in the swing; the whole figure floats and drifts, so that its feet slide.
Motion walking(const Skeleton &skeleton, double floating, double sliding) {
  Motion motion{40, MatrixRM::Zero(160, skeleton.dof_count())};
  for (int t = 0; t < 160; ++t) {
    const double phase = 2 * M_PI * t / 40;
    motion.dofs(t, 1) = floating;
    motion.dofs(t, 2) = sliding * t / 40;
    for (const auto &[side, shift] : {std::pair{"l_", 0.0}, {"r_", M_PI}}) {
      const double swing = std::pow(std::max(0.0, std::sin(phase + shift)), 2);
      motion.dofs(t, dof(skeleton, side + std::string("hip"))) = -0.8 * swing;
      motion.dofs(t, dof(skeleton, side + std::string("knee"))) = 1.5 * swing;
    }
  }
  return motion;
}

/// Heel, ball and tip of the sole of a side, as the marks have them.
std::array<Eigen::Vector3d, 3> sole(const Skeleton &skeleton, const std::string &side, const Eigen::VectorXd &pose) {
  const int ankle = skeleton.find(side + "ankle");
  Eigen::Vector3d a = skeleton.joints[ankle].rest, b = skeleton.joints[skeleton.find(side + "toe")].rest;
  a.y() = b.y() = 0;
  const Eigen::Isometry3d foot = forward_kinematics(skeleton, pose)[ankle];
  return {foot * Eigen::Vector3d(a - 0.4 * (b - a)), foot * b, foot * Eigen::Vector3d(b + 0.4 * (b - a))};
}

double lowest(const Skeleton &skeleton, const Eigen::VectorXd &pose) {
  double result = 1e9;
  for (const char *side : {"l_", "r_"})
    for (const Eigen::Vector3d &point : sole(skeleton, side, pose))
      result = std::min(result, point.y());
  return result;
}

TEST(PlantFeet, PlantedFeetStayAndNoneIsBelowTheFloor) {
  const Skeleton skeleton = figure_skeleton();
  const Motion before = walking(skeleton, 0.08, 0.1), after = plant_feet(skeleton, before);
  int stood = 0;
  for (const FootContacts &foot : find_contacts(skeleton, before)) {
    const std::string side = foot.ankle.substr(0, 2);
    for (int t = 1; t < 160; ++t) {
      if (!foot.heel[t] || !foot.ball[t] || !foot.heel[t - 1] || !foot.ball[t - 1])
        continue;
      const auto a = sole(skeleton, side, after.dofs.row(t - 1)), b = sole(skeleton, side, after.dofs.row(t));
      EXPECT_LT((a[1] - b[1]).norm(), 1e-3) << side << t;
      EXPECT_NEAR(b[0].y(), 0, 1e-3) << side << t;
      EXPECT_NEAR(b[2].y(), 0, 1e-3) << side << t;
      ++stood;
    }
  }
  EXPECT_GT(stood, 80);
  for (int t = 0; t < 160; ++t)
    EXPECT_GT(lowest(skeleton, after.dofs.row(t)), -1e-3) << t;
}

TEST(PlantFeet, StaysWithinLimitsAndChangesNothingAbove) {
  const Skeleton skeleton = figure_skeleton();
  const Motion before = walking(skeleton, -0.05, 0.3), after = plant_feet(skeleton, before);
  for (int t = 0; t < 160; ++t)
    for (int d = 0; d < skeleton.dof_count(); ++d) {
      EXPECT_LE(after.dofs(t, d), skeleton.upper[d]) << skeleton.dof_names[d];
      EXPECT_GE(after.dofs(t, d), skeleton.lower[d]) << skeleton.dof_names[d];
      const std::string name = skeleton.dof_names[d].substr(1, 4);
      if (d != 1 && name != "_hip" && name != "_kne" && name != "_ank") {
        EXPECT_EQ(after.dofs(t, d), before.dofs(t, d)) << skeleton.dof_names[d];
      }
    }
  const int knee = dof(skeleton, "l_knee");
  for (int t = 1; t < 160; ++t)
    EXPECT_LT(std::abs(after.dofs(t, knee) - after.dofs(t - 1, knee)) * 40, 20) << "the knee pops at " << t;
}

TEST(PlantFeet, AJumpStaysInTheAir) {
  const Skeleton skeleton = figure_skeleton();
  Motion jump{40, MatrixRM::Zero(80, skeleton.dof_count())};
  for (int t = 30; t <= 50; ++t)
    jump.dofs(t, 1) = 0.3 * (1 - std::pow((t - 40) / 10.0, 2));
  const Motion after = plant_feet(skeleton, jump);
  EXPECT_NEAR(lowest(skeleton, after.dofs.row(40)), 0.3, 0.02);
  EXPECT_NEAR(lowest(skeleton, after.dofs.row(10)), 0, 1e-6);
}

TEST(PlantFeet, AnglesWoundPastAHalfTurnDoNotJump) {
  const Skeleton skeleton = figure_skeleton();
  Motion motion = walking(skeleton, 0.02, 0.1);
  motion.dofs.col(3).setLinSpaced(2, 8); // the root turns; its angle counts on
  const Motion after = plant_feet(skeleton, motion);
  for (int t = 1; t < 160; ++t)
    EXPECT_LT((after.dofs.row(t) - after.dofs.row(t - 1)).cwiseAbs().maxCoeff(), 0.6) << t;
}

TEST(PlantFeet, RefusesWhatIsNoMotion) {
  const Skeleton skeleton = figure_skeleton();
  EXPECT_THROW(plant_feet(skeleton, Motion{}), std::invalid_argument);
  PlantOptions bad;
  bad.contact_speed = -1;
  EXPECT_THROW(plant_feet(skeleton, walking(skeleton, 0, 0), bad), std::invalid_argument);
}

} // namespace planting
