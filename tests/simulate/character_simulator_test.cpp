#include "doublet/core/skinning.h"
#include "doublet/simulate/character_simulator.h"
#include "doublet/simulate/solver_settings.h"
#include "support/figure.h"
#include "support/option_ranges.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace doublet;
using namespace doublet::testing;

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

TEST(SolverSettings, WhatLiesOutsideARangeIsRefusedByName) {
  expect_ranges<SolverSettings>();
}
