#include "doublet/animate/animator.h"
#include "doublet/animate/parts/arm_penetration.h"
#include "doublet/core/parts/self_intersection.h"
#include "figure_character.h"

#include <gtest/gtest.h>

using namespace doublet;
using namespace doublet::testing;

namespace {

Character with_arms() {
  Character c = figure_character();
  c.proxies = figure_capsules(c.actor.skeleton);
  return c;
}

bool of_arm(const Skeleton &skeleton, int joint, bool below_the_elbow) {
  const std::string &name = skeleton.joints[joint].name;
  return name.find("elbow") != name.npos || name.find("wrist") != name.npos ||
         (!below_the_elbow && name.find("shoulder") != name.npos);
}

/// m between the axes of forearms and hands, with their radii, and the capsules of trunk and legs; least over a frame.
double room(const Character &c, const Eigen::VectorXd &dofs) {
  const Skeleton &skeleton = c.actor.skeleton;
  const Transforms pose = forward_kinematics(skeleton, dofs);
  double least = 1;
  for (const TaperedCapsule &arm : c.proxies)
    for (const TaperedCapsule &other : c.proxies) {
      if (!of_arm(skeleton, arm.joint, true) || of_arm(skeleton, other.joint, false))
        continue;
      const Capsule a = pose_capsule(arm, skeleton, pose), b = pose_capsule(other, skeleton, pose);
      for (int i = 0; i <= 10; ++i)
        least = std::min(least, signed_distance(b, a.p0 + 0.1 * i * (a.p1 - a.p0)) - (a.r0 + 0.1 * i * (a.r1 - a.r0)));
    }
  return least;
}

/// Both arms go down into the thighs, stay there and come up again.
Motion into_the_thighs(const Skeleton &skeleton, double degrees) {
  Motion motion{40, MatrixRM::Zero(120, skeleton.dof_count())};
  for (int t = 0; t < 120; ++t) {
    const double down = std::clamp(std::min(t - 20, 100 - t) / 20.0, 0.0, 1.0), angle = down * degrees * pi / 180;
    motion.dofs(t, skeleton.joints[skeleton.find("l_shoulder")].first_dof + 2) = -angle;
    motion.dofs(t, skeleton.joints[skeleton.find("r_shoulder")].first_dof + 2) = angle;
  }
  return motion;
}

} // namespace

TEST(ArmPenetration, ArmsComeOutOfTheBodySmoothly) {
  const Character c = with_arms();
  const Motion motion = into_the_thighs(c.actor.skeleton, 65), out = resolve_arm_penetration(c, motion);
  double before = 1, after = 1, jump = 0;
  for (Eigen::Index t = 0; t < motion.dofs.rows(); ++t) {
    before = std::min(before, room(c, motion.dofs.row(t)));
    after = std::min(after, room(c, out.dofs.row(t)));
    if (t > 0)
      jump = std::max(jump, (out.dofs.row(t) - out.dofs.row(t - 1)).cwiseAbs().maxCoeff());
  }
  EXPECT_LT(before, -0.05);
  EXPECT_GT(after, 0.012); // of 2 x 12 mm
  EXPECT_LT(jump, 65 * pi / 180 / 20 + 0.01);
  for (const char *name : {"pelvis", "l_hip", "l_elbow", "r_wrist"}) {
    const Joint &joint = c.actor.skeleton.joints[c.actor.skeleton.find(name)];
    EXPECT_EQ(out.dofs.middleCols(joint.first_dof, joint.dof_count), motion.dofs.middleCols(joint.first_dof, joint.dof_count));
  }
}

TEST(ArmPenetration, ArmsThatAreClearKeepTheirBits) {
  const Character c = with_arms();
  const Motion motion = into_the_thighs(c.actor.skeleton, 10);
  EXPECT_EQ(resolve_arm_penetration(c, motion).dofs, motion.dofs);
  Character armless = c;
  std::erase_if(armless.proxies, [&](const TaperedCapsule &p) { return of_arm(c.actor.skeleton, p.joint, true); });
  const Motion deep = into_the_thighs(c.actor.skeleton, 65);
  EXPECT_EQ(resolve_arm_penetration(armless, deep).dofs, deep.dofs);
}

TEST(ArmPenetration, TheSameForAnyNumberOfThreads) {
  const Character c = with_arms();
  const Motion motion = into_the_thighs(c.actor.skeleton, 65);
  Context one, many;
  one.threads = 1;
  many.threads = 3;
  EXPECT_EQ(resolve_arm_penetration(c, motion, one).dofs, resolve_arm_penetration(c, motion, many).dofs);
}

TEST(ArmPenetration, AnimateDoesItUnlessItIsTurnedOff) {
  const Character c = with_arms();
  Motion motion = into_the_thighs(c.actor.skeleton, 65);
  motion.dofs = MatrixRM(motion.dofs.middleRows(15, 30));
  AnimateOptions options;
  options.high = options.body = false;
  options.settle_seconds = 0.1;
  EXPECT_GT(room(c, animate(c, motion, options).dofs.row(29)), 0.012);
  options.resolve_arm_penetration = false;
  EXPECT_EQ(animate(c, motion, options).dofs, motion.dofs);
}

/// A character that is simulated at 20000 frames a second.
TEST(ArmPenetration, AnimateSaysThatItLeavesArmsAsTheyAre) {
  Character c = with_arms();
  Motion motion = into_the_thighs(c.actor.skeleton, 65);
  motion.dofs = MatrixRM(motion.dofs.middleRows(40, 2));
  AnimateOptions options;
  options.high = options.body = false;
  options.settle_seconds = 0;
  std::string said;
  Context context;
  context.log = [&](const std::string &line) { said += line + "\n"; };
  animate(c, motion, options, context);
  EXPECT_EQ(said.find("arms are not cleared"), said.npos) << said;
  c.solver.dt = 1.0 / 20000;
  motion.fps = 20000;
  EXPECT_EQ(animate(c, motion, options, context).dofs, motion.dofs);
  EXPECT_NE(said.find("arms are not cleared of the body: expected 0.1 to 10000 frames per second, found 20000"), said.npos)
      << said;
  options.resolve_arm_penetration = false;
  said.clear();
  animate(c, motion, options, context);
  EXPECT_EQ(said, "");
}

TEST(ArmPenetration, ASkirtYieldsToAnArmThatIsPressedIntoIt) {
  const Character c = with_arms();
  const Skeleton &skeleton = c.actor.skeleton;
  std::vector<int> cloth;
  for (int f = 0; f < c.actor.mesh.faces.rows(); ++f)
    if (c.segmentation.region[c.actor.mesh.faces.row(f).maxCoeff()] == 0)
      cloth.push_back(f);
  int crossed = 0;
  AnimateOptions options;
  options.high = options.body = false;
  animate(c, into_the_thighs(skeleton, 65), options, [&](const AnimationFrame &frame) {
    const Mesh skirt = submesh({frame.surface, c.actor.mesh.faces}, cloth);
    for (const TaperedCapsule &proxy : c.proxies) {
      const Capsule arm = pose_capsule(proxy, skeleton, frame.world_from_rest);
      crossed += of_arm(skeleton, proxy.joint, true) && crosses_surface(arm.p0, arm.p1, skirt);
    }
  });
  EXPECT_EQ(crossed, 0);
}

TEST(ArmPenetration, RefusesWhatIsNoMotionOfTheCharacter) {
  const Character c = with_arms();
  EXPECT_THROW(resolve_arm_penetration(c, Motion{40, MatrixRM::Zero(3, 5)}), std::invalid_argument);
}
