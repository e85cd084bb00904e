#include "doublet/animate/animator.h"
#include "doublet/core/error.h"
#include "doublet/core/skinning.h"
#include "figure_character.h"

#include <gtest/gtest.h>

#include <thread>

using namespace doublet;
using namespace doublet::testing;

TEST(CharacterSimulator, RegionHangsFromItsRigidRing) {
  const Character c = figure_character();
  const CharacterSimulator simulator(c.actor, c.segmentation, c.proxies, c.solver.cloth);
  ASSERT_EQ(simulator.regions().size(), 1u);
  const ClothRegion &region = simulator.regions()[0];
  int pinned = 0;
  for (std::size_t i = 0; i < region.vertex_from_cloth.size(); ++i) {
    const bool rigid = c.segmentation.clothness[region.vertex_from_cloth[i]] == 0;
    EXPECT_EQ(region.model->inverse_masses()[i] == 0, rigid);
    pinned += rigid;
  }
  EXPECT_EQ(pinned, 36); // the waist ring of the skirt
  EXPECT_EQ(region.vertex_from_cloth.size(), static_cast<std::size_t>(skirt(16, 36).vertices.rows()));
}

TEST(CharacterSimulator, ClothHangsAndStaysOutsideTheLegs) {
  const Character c = figure_character();
  const CharacterSimulator simulator(c.actor, c.segmentation, c.proxies, c.solver.cloth);
  const PosedFrame rest = simulator.pose(Eigen::VectorXd::Zero(c.actor.skeleton.dof_count()));
  CharacterState state = simulator.start(rest);
  simulator.settle(state, rest, c.materials, c.solver.dt, 40);
  EXPECT_EQ(state.regions[0].velocities.cwiseAbs().maxCoeff(), 0.0);
  const Vertices hung = simulator.surface(state, rest);
  ASSERT_TRUE(hung.allFinite());
  const ClothRegion &region = simulator.regions()[0];
  double lowest = 1e9, deepest = 1e9;
  const std::vector<Capsule> capsules = pose_capsules(c.proxies, c.actor.skeleton, rest.world_from_rest);
  for (int v : region.vertex_from_cloth) {
    if (c.segmentation.clothness[v] == 0) {
      EXPECT_LT((hung.row(v) - rest.skinned.row(v)).norm(), 1e-6); // the solver computes in float
      continue;
    }
    lowest = std::min(lowest, hung(v, 1));
    if (c.segmentation.clothness[v] == 1)
      for (const Capsule &capsule : capsules)
        deepest = std::min(deepest, signed_distance(capsule, hung.row(v)));
  }
  EXPECT_LT(lowest, 0.5);  // gravity pulls the hem below where it was drawn
  EXPECT_GT(lowest, 0.35); // and the threads hold it
  EXPECT_GT(deepest, -0.002);
}

TEST(CharacterSimulator, StartsFromACapturedSurfaceButPinsFollowTheSkeleton) {
  const Character c = figure_character();
  const CharacterSimulator simulator(c.actor, c.segmentation, c.proxies, c.solver.cloth);
  const PosedFrame rest = simulator.pose(Eigen::VectorXd::Zero(c.actor.skeleton.dof_count()));
  Vertices captured = rest.skinned;
  captured.array() += 0.01;
  const Vertices surface = simulator.surface(simulator.start(rest, &captured), rest);
  for (int v : simulator.regions()[0].vertex_from_cloth)
    EXPECT_NEAR((surface.row(v) - rest.skinned.row(v)).norm(), c.segmentation.clothness[v] > 0 ? 0.01 * std::sqrt(3.0) : 0.0,
                1e-12);
}

namespace {

/// The figure with a skirt cut 1.2 times as large as the scan shows it.
Character figure_in_a_larger_skirt() {
  Character c = figure_character();
  c.segmentation.rest = 1.2 * c.actor.mesh.vertices;
  return c;
}

} // namespace

TEST(CharacterSimulator, StartsAtTheRestShapeInThePose) {
  const Character c = figure_in_a_larger_skirt();
  const CharacterSimulator simulator(c.actor, c.segmentation, c.proxies, c.solver.cloth);
  const PosedFrame frame = simulator.pose(marching(c.actor.skeleton, 12, 40).row(11));
  const Vertices expected = dual_quaternion_skinning(c.segmentation.rest, c.actor.weights, frame.world_from_rest),
                 surface = simulator.surface(simulator.start(frame), frame);
  EXPECT_GT((expected - frame.skinned).rowwise().norm().maxCoeff(), 0.1);
  for (Eigen::Index v = 0; v < surface.rows(); ++v) {
    const bool cloth = c.segmentation.clothness[v] > 0;
    EXPECT_EQ(surface.row(v), cloth ? expected.row(v) : frame.skinned.row(v)) << v; // what it hangs from follows the skeleton
  }
  // Where a captured surface is, it starts there.
  const Vertices captured = frame.skinned.rowwise() + Eigen::RowVector3d(0.01, 0, 0);
  const Vertices from_captured = simulator.surface(simulator.start(frame, &captured), frame);
  for (Eigen::Index v = 0; v < surface.rows(); ++v)
    EXPECT_EQ(from_captured.row(v), c.segmentation.clothness[v] > 0 ? captured.row(v) : frame.skinned.row(v)) << v;
}

TEST(CharacterSimulator, LengthsAndMassesComeFromTheRestShape) {
  const Character small = figure_character(), large = figure_in_a_larger_skirt();
  pbd::ClothOptions options = large.solver.cloth;
  options.gravity.setZero();
  const CharacterSimulator as_scanned(small.actor, small.segmentation, {}, options),
      simulator(large.actor, large.segmentation, {}, options);
  const Eigen::VectorXd before = as_scanned.regions()[0].model->inverse_masses(),
                        after = simulator.regions()[0].model->inverse_masses();
  EXPECT_LT((after * 1.44 - before).cwiseAbs().maxCoeff(), 1e-9 * before.maxCoeff()); // an area
  const PosedFrame rest = simulator.pose(Eigen::VectorXd::Zero(large.actor.skeleton.dof_count()));
  CharacterState state = simulator.start(rest, &rest.skinned);
  simulator.settle(state, rest, large.materials, large.solver.dt, 40);
  const Vertices settled = simulator.surface(state, rest);
  const auto hem = [&](const Vertices &surface) { // the skirt's first ring, its last 17 x 36 vertices
    const Eigen::Index first = surface.rows() - 17 * 36;
    double length = 0;
    for (int k = 0; k < 36; ++k)
      length += (surface.row(first + k) - surface.row(first + (k + 1) % 36)).norm();
    return length;
  };
  EXPECT_NEAR(hem(settled) / hem(rest.skinned), 1.2, 0.02);
}

TEST(CharacterSimulator, RefusesWhatDoesNotFit) {
  const Character c = figure_character();
  Segmentation wrong = c.segmentation;
  wrong.clothness.conservativeResize(10);
  EXPECT_THROW(CharacterSimulator(c.actor, wrong, c.proxies), std::invalid_argument);
  Segmentation unnamed = c.segmentation;
  unnamed.region_count = 0;
  EXPECT_THROW(CharacterSimulator(c.actor, unnamed, c.proxies), Error);
  Segmentation short_rest = c.segmentation;
  short_rest.rest = Vertices::Zero(10, 3);
  EXPECT_THROW(CharacterSimulator(c.actor, short_rest, c.proxies), std::invalid_argument);
  std::vector<TaperedCapsule> proxies = c.proxies;
  proxies[0].joint = 99;
  EXPECT_THROW(CharacterSimulator(c.actor, c.segmentation, proxies), Error);
  RiggedMesh invalid = c.actor;
  std::fill(invalid.face_valid.begin(), invalid.face_valid.end(), 0);
  EXPECT_THROW(CharacterSimulator(invalid, c.segmentation, c.proxies), Error);
  const CharacterSimulator simulator(c.actor, c.segmentation, c.proxies);
  EXPECT_THROW(simulator.pose(Eigen::VectorXd::Zero(3)), std::invalid_argument);
  const PosedFrame rest = simulator.pose(Eigen::VectorXd::Zero(36));
  CharacterState state = simulator.start(rest);
  EXPECT_THROW(simulator.step(state, rest, rest, {}, 0.025), std::invalid_argument);
}

TEST(Animator, MovesEverythingWithThePoseAndIsRepeatable) {
  const Character c = figure_character();
  const Motion motion{40, marching(c.actor.skeleton, 30, 40)};
  AnimateOptions options;
  options.settle_seconds = 0.25;
  Context one, two;
  one.threads = 1;
  two.threads = 2;
  AnimationResult a, b;
  std::thread other([&] { b = animate(c, motion, options, two); }); // beside it, on another thread: nothing is shared
  a = animate(c, motion, options, one);
  other.join();
  ASSERT_EQ(a.surface.size(), 30u);
  ASSERT_EQ(a.high.size(), 30u);
  ASSERT_EQ(a.body.size(), 30u);
  for (int t = 0; t < 30; ++t) {
    EXPECT_TRUE(a.surface[t] == b.surface[t]) << t;
    EXPECT_TRUE(a.high[t] == b.high[t]) << t;
    // no explosion: cloth stays within arm's reach of the pelvis
    EXPECT_LT((a.surface[t].rowwise() - a.joints[t].row(0)).rowwise().norm().maxCoeff(), 1.2);
  }
  EXPECT_GT((a.surface[29] - a.surface[0]).norm(), 0.1);
}

TEST(Animator, ResamplesToTheCharactersRate) {
  const Character c = figure_character();
  AnimateOptions options;
  options.settle_seconds = 0;
  options.high = options.body = false;
  const AnimationResult result = animate(c, {20, marching(c.actor.skeleton, 6, 20)}, options);
  EXPECT_EQ(result.surface.size(), 11u);
  EXPECT_DOUBLE_EQ(result.fps, 40);
  EXPECT_TRUE(result.high.empty());
  EXPECT_THROW(animate(c, {40, MatrixRM::Zero(3, 5)}, options), std::invalid_argument);
}

TEST(Animator, CanBeCancelled) {
  const Character c = figure_character();
  Context context;
  context.cancelled = [] { return true; };
  EXPECT_THROW(animate(c, {40, marching(c.actor.skeleton, 5, 40)}, {}, context), Cancelled);
}
