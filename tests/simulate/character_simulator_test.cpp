#include "doublet/core/skinning.h"
#include "doublet/simulate/character_simulator.h"
#include "doublet/simulate/solver_settings.h"
#include "support/figure.h"
#include "support/option_ranges.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace doublet;
using namespace doublet::testing;

namespace {

/// Everything below the knees is cloth.
Segmentation shins_of(const RiggedMesh &actor) {
  const Eigen::Index count = actor.mesh.vertices.rows();
  const Eigen::Array<bool, Eigen::Dynamic, 1> shin = actor.mesh.vertices.col(1).array() < 0.4;
  Segmentation shins;
  shins.region_count = 1;
  shins.clothness = shin.cast<double>();
  shins.region = shin.select(Eigen::VectorXi::Zero(count), -Eigen::VectorXi::Ones(count));
  return shins;
}

} // namespace

TEST(CharacterSimulator, WithoutClothIsSkinning) {
  const RiggedMesh actor = figure_actor(0.05);
  Segmentation none;
  none.clothness = Eigen::VectorXd::Zero(actor.mesh.vertices.rows());
  none.region = Eigen::VectorXi::Constant(actor.mesh.vertices.rows(), -1);
  const CharacterSimulator simulator(actor, none, {});
  EXPECT_TRUE(simulator.regions().empty());
  MatrixRM dofs(12, actor.skeleton.dof_count());
  for (Eigen::Index t = 0; t < dofs.rows(); ++t)
    dofs.row(t).setConstant(0.3 * std::sin(0.4 * static_cast<double>(t)));
  PosedFrame previous = simulator.pose(dofs.row(0));
  CharacterState state = simulator.start(previous);
  for (int t = 1; t < 12; ++t) {
    const PosedFrame current = simulator.pose(dofs.row(t));
    simulator.step(state, previous, current, {}, 1.0 / 40);
    const Vertices expected =
        dual_quaternion_skinning(actor.mesh.vertices, actor.weights, forward_kinematics(actor.skeleton, dofs.row(t)));
    EXPECT_EQ((simulator.surface(state, current) - expected).cwiseAbs().maxCoeff(), 0.0);
    previous = current;
  }
}

TEST(CharacterSimulator, RegionsThatTouchAreShownWhereTheyAreSimulated) {
  const RiggedMesh actor = figure_actor(0.05);
  Segmentation cloth = shins_of(actor);
  cloth.region_count = 2;
  for (Eigen::Index v = 0; v < cloth.region.size(); ++v)
    if (cloth.region[v] == 0 && actor.mesh.vertices(v, 1) < 0.2)
      cloth.region[v] = 1;
  const CharacterSimulator simulator(actor, cloth, {});
  const PosedFrame frame = simulator.pose(Eigen::VectorXd::Zero(actor.skeleton.dof_count()));
  CharacterState state = simulator.start(frame);
  for (int r = 0; r < 2; ++r)
    state.regions[r].positions.array() += 0.01 * (r + 1);
  const Vertices surface = simulator.surface(state, frame);
  int shared = 0; // vertices of both
  for (int r = 0; r < 2; ++r) {
    const std::vector<int> &vertices = simulator.regions()[r].vertex_from_cloth;
    for (std::size_t i = 0; i < vertices.size(); ++i)
      if (cloth.region[vertices[i]] == r) {
        EXPECT_EQ(surface.row(vertices[i]), state.regions[r].positions.row(static_cast<Eigen::Index>(i))) << vertices[i];
      } else {
        shared += cloth.region[vertices[i]] == 1 - r;
      }
  }
  EXPECT_GT(shared, 0);
}

TEST(CharacterSimulator, TheWayInLeadsFromTheRestPoseToThePose) {
  const Skeleton skeleton = figure_actor(0.05).skeleton;
  Eigen::VectorXd dofs = Eigen::VectorXd::Constant(skeleton.dof_count(), 0.3);
  EXPECT_EQ(lead_in_poses(skeleton, dofs, 0.025), std::vector<Eigen::VectorXd>{dofs}); // near the rest pose
  dofs[dofs.size() - 1] = -0.9;
  const std::vector<Eigen::VectorXd> poses = lead_in_poses(skeleton, dofs, 0.025);
  ASSERT_EQ(poses.size(), 25u);
  EXPECT_EQ(poses.back(), dofs);
  EXPECT_EQ(poses.front().head(6), dofs.head(6)); // the root is there from the beginning
  EXPECT_TRUE(poses.front().tail(dofs.size() - 6).isZero());
  for (std::size_t i = 1; i < poses.size(); ++i)
    EXPECT_LT((poses[i] - poses[i - 1]).cwiseAbs().maxCoeff(), 0.06); // half as fast again as evenly
  EXPECT_THROW(lead_in_poses(skeleton, dofs.head(3), 0.025), std::invalid_argument);
  EXPECT_THROW(lead_in_poses(skeleton, dofs, 0), std::invalid_argument);
}

TEST(CharacterSimulator, ClothThatIsPutOnGoesAlongThroughAllOfTheWay) {
  const RiggedMesh actor = figure_actor(0.05);
  const CharacterSimulator simulator(actor, shins_of(actor), {});
  const std::vector<pbd::Material> materials(simulator.regions().size());
  ASSERT_FALSE(materials.empty());
  std::vector<PosedFrame> way;
  for (const Eigen::VectorXd &dofs :
       lead_in_poses(actor.skeleton, Eigen::VectorXd::Constant(actor.skeleton.dof_count(), 0.6), 0.025))
    way.push_back(simulator.pose(dofs));
  CharacterState expected = simulator.start(way[0]);
  for (std::size_t i = 1; i < way.size(); ++i)
    simulator.step(expected, way[i - 1], way[i], materials, 0.025);
  StepEnvironment world;
  world.dt = 0.025;
  const CharacterState state = simulator.drape_along(way, materials, world);
  EXPECT_EQ(state.regions[0].positions, expected.regions[0].positions);
  EXPECT_GT((state.regions[0].positions - simulator.start(way[0]).regions[0].positions).norm(), 0.1);
  EXPECT_THROW(simulator.drape_along({}, materials, world), std::invalid_argument);
}

TEST(CharacterSimulator, AFrameOfAnotherCharacterIsRefused) {
  const RiggedMesh actor = figure_actor(0.05);
  const CharacterSimulator simulator(actor, shins_of(actor), {});
  const Eigen::VectorXd rest = Eigen::VectorXd::Zero(actor.skeleton.dof_count());
  const RiggedMesh coarse = figure_actor(0.08);
  const Eigen::Index fewer = coarse.mesh.vertices.rows();
  const Segmentation bare{Eigen::VectorXd::Zero(fewer), Eigen::VectorXd::Zero(fewer), -Eigen::VectorXi::Ones(fewer), 0};
  const PosedFrame own = simulator.pose(rest), other = CharacterSimulator(coarse, bare, {}).pose(rest);
  CharacterState state = simulator.start(own);
  const std::vector<pbd::Material> materials(1);
  const std::vector<CharacterState *> states{&state};
  const std::vector<const std::vector<pbd::Material> *> given{&materials};
  EXPECT_THROW(simulator.start(other), std::invalid_argument);
  EXPECT_THROW(simulator.start(PosedFrame()), std::invalid_argument);
  EXPECT_THROW(simulator.move_rigidly(state, other, own), std::invalid_argument);
  EXPECT_THROW(simulator.move_rigidly(state, own, PosedFrame()), std::invalid_argument);
  EXPECT_THROW(simulator.settle(state, other, materials, 0.025, 1), std::invalid_argument);
  EXPECT_THROW(simulator.step(state, other, own, materials, 0.025), std::invalid_argument);
  EXPECT_THROW(simulator.step_batch(states, own, other, given, 0.025), std::invalid_argument);
  EXPECT_THROW(simulator.step_region(0, states, other, own, given, 0.025), std::invalid_argument);
  EXPECT_THROW(simulator.surface(state, other), std::invalid_argument);
  EXPECT_NO_THROW(simulator.step(state, own, own, materials, 0.025));
}

/// A trouser leg that is twice as wide at rest is where cloth begins; one that the leg has left is not.
TEST(CharacterSimulator, ClothBeginsAtARestShapeThatTheLimbsAreStillIn) {
  const RiggedMesh actor = figure_actor(0.05);
  const Eigen::Array<bool, Eigen::Dynamic, 1> shin = actor.mesh.vertices.col(1).array() < 0.4;
  Segmentation shins = shins_of(actor);
  const auto start_at = [&](const Vertices &rest) {
    shins.rest = rest;
    const CharacterSimulator simulator(actor, shins, {});
    const CharacterState state = simulator.start(simulator.pose(Eigen::VectorXd::Zero(actor.skeleton.dof_count())));
    Vertices all = actor.mesh.vertices;
    for (std::size_t i = 0; i < simulator.regions()[0].vertex_from_cloth.size(); ++i)
      all.row(simulator.regions()[0].vertex_from_cloth[i]) = state.regions[0].positions.row(static_cast<Eigen::Index>(i));
    return all;
  };
  Vertices longer = actor.mesh.vertices, aside = longer;
  longer.col(1) = shin.select(longer.col(1).array() * 1.2 - 0.08, longer.col(1).array());
  aside.col(2).array() += 0.2 * shin.cast<double>();
  EXPECT_LT((start_at(longer) - longer).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT((start_at(aside) - actor.mesh.vertices).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(SolverSettings, WhatLiesOutsideARangeIsRefusedByName) {
  expect_ranges<SolverSettings>();
}
