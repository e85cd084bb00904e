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

/// On bent knees, the lowest point of the soles at a height over the floor; flat at a pitch of 0, above it the heels are up.
Eigen::VectorXd crouching(const Skeleton &skeleton, double height, double pitch) {
  Eigen::VectorXd pose = Eigen::VectorXd::Zero(skeleton.dof_count());
  for (const std::string side : {"l_", "r_"}) {
    pose[dof(skeleton, side + "hip")] = -0.4;
    pose[dof(skeleton, side + "knee")] = 0.8;
    pose[dof(skeleton, side + "ankle")] = 0.4 + pitch;
  }
  pose[1] = height - lowest(skeleton, pose);
  return pose;
}

/// Stands for 0.75 s, goes half a metre in 0.3 s with the soles 3 mm over the floor, and stands again.
Motion skimming(const Skeleton &skeleton, int fps) {
  const int frames = 9 * fps / 5;
  Motion motion{static_cast<double>(fps), MatrixRM::Zero(frames, skeleton.dof_count())};
  for (int t = 0; t < frames; ++t) {
    const double x = std::clamp((t - 0.75 * fps) / (0.3 * fps), 0.0, 1.0);
    motion.dofs.row(t) = crouching(skeleton, x > 0 && x < 1 ? 0.003 : 0, 0);
    motion.dofs(t, 2) = 0.5 * x * x * (3 - 2 * x);
  }
  return motion;
}

/// Calls use(side, t) for the first frame of every stand and the first after it.
template <class Use> void at_ends_of_stands(const Skeleton &skeleton, const Motion &motion, const Use &use) {
  for (const FootContacts &foot : find_contacts(skeleton, motion)) {
    const auto stands = [&](int t) { return foot.heel[t] || foot.ball[t]; };
    for (int t = 1; t < motion.dofs.rows(); ++t)
      if (stands(t - 1) != stands(t))
        use(foot.ankle.substr(0, 2), t);
  }
}

/// Metres a second of the ball of a sole, along the floor, from the frame before.
double slide(const Skeleton &skeleton, const Motion &motion, const std::string &side, int t) {
  Eigen::Vector3d step = sole(skeleton, side, motion.dofs.row(t))[1] - sole(skeleton, side, motion.dofs.row(t - 1))[1];
  step.y() = 0;
  return step.norm() * motion.fps;
}

TEST(PlantFeet, AFootThatSkimsTheFloorIsHighWhileItIsFast) {
  const Skeleton skeleton = figure_skeleton();
  for (const int fps : {40, 120}) {
    const Motion before = skimming(skeleton, fps), after = plant_feet(skeleton, before);
    int fast = 0;
    for (const FootContacts &foot : find_contacts(skeleton, before))
      for (int t = 1; t < before.dofs.rows(); ++t) {
        const std::string side = foot.ankle.substr(0, 2);
        const auto was = sole(skeleton, side, before.dofs.row(t)), is = sole(skeleton, side, after.dofs.row(t));
        const auto before_it = sole(skeleton, side, after.dofs.row(t - 1));
        const double height = 0.5 * (std::min(is[0].y(), is[2].y()) + std::min(before_it[0].y(), before_it[2].y()));
        const double speed = slide(skeleton, after, side, t);
        EXPECT_GT(height, -1e-3) << fps << side << t;
        EXPECT_LT(height, 0.02) << fps << side << t;
        EXPECT_LT(speed, 1.15 * 2.5) << fps << side << t << ": the clip's own is 0.5 m / 0.3 s * 1.5";
        if (foot.heel[t] && foot.ball[t]) {
          EXPECT_LT((is[1] - was[1]).norm(), 6e-3) << fps << side << t << ": it stands where it stood";
        }
        if (speed > 1.25) {
          EXPECT_GT(height, 0.0055) << fps << side << t << " at " << speed;
          ++fast;
        }
        if (speed > 1.75) {
          EXPECT_GT(height, 0.009) << fps << side << t << " at " << speed;
        }
      }
    EXPECT_GT(fast, 12);
  }
}

TEST(PlantFeet, AFootIsSlowedDownBeforeItStands) {
  const Skeleton skeleton = figure_skeleton();
  for (const int fps : {40, 120}) {
    const Motion before = skimming(skeleton, fps), after = plant_feet(skeleton, before);
    int ends = 0;
    at_ends_of_stands(skeleton, before, [&](const std::string &side, int t) {
      EXPECT_GT(slide(skeleton, before, side, t), 0.2) << fps << side << t;
      EXPECT_LT(slide(skeleton, after, side, t), 0.5 * slide(skeleton, before, side, t)) << fps << side << t;
      ++ends;
    });
    EXPECT_EQ(ends, 4);
  }
}

TEST(PlantFeet, AFootWhoseAnkleCannotTurnLandsWithoutAJump) {
  Skeleton skeleton = figure_skeleton();
  for (const std::string side : {"l_", "r_"}) {
    skeleton.lower[dof(skeleton, side + "ankle")] = 0.78;
    skeleton.upper[dof(skeleton, side + "ankle")] = 0.82;
  }
  Motion before{40, MatrixRM::Zero(80, skeleton.dof_count())}; // on its toes; slides, hops, and slides on
  for (int t = 0; t < 80; ++t) {
    before.dofs.row(t) = crouching(skeleton, 0.15 * std::max(0.0, 1 - std::pow((t - 40) / 10.0, 2)), 0.4);
    before.dofs(t, 2) = 0.3 * t / 40;
  }
  const Motion after = plant_feet(skeleton, before);
  int ends = 0;
  at_ends_of_stands(skeleton, before, [&](const std::string &side, int t) {
    const auto moved = [&](const Motion &motion) {
      return (sole(skeleton, side, motion.dofs.row(t))[2] - sole(skeleton, side, motion.dofs.row(t - 1))[2]).norm();
    };
    EXPECT_LT(moved(after), moved(before) + 2e-3) << side << t;
    ++ends;
  });
  EXPECT_EQ(ends, 4);
}

TEST(PlantFeet, RefusesWhatIsNoMotion) {
  const Skeleton skeleton = figure_skeleton();
  EXPECT_THROW(plant_feet(skeleton, Motion{}), std::invalid_argument);
  PlantOptions bad;
  bad.contact_speed = -1;
  EXPECT_THROW(plant_feet(skeleton, walking(skeleton, 0, 0), bad), std::invalid_argument);
}

} // namespace planting
