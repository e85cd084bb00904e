#include "skirt_person.h"

#include "doublet/segment/cloth_prior.h"

#include <gtest/gtest.h>

#include <utility>

using namespace doublet;

namespace {

/// A person in a skirt on one leg, whose foot (four rings) the ankle moves, the shank the knee, and all else the root.
skirt_person::Person person_on_a_leg() {
  skirt_person::Person person;
  const Skeleton &skeleton = person.actor.skeleton;
  const int ankle = skeleton.find("l_ankle"), knee = skeleton.find("l_knee");
  person.actor.weights.setZero();
  for (Eigen::Index v = 0; v < person.actor.weights.rows(); ++v) {
    const bool leg = v < skirt_person::vertex(28, 0); // and the sheet around it
    person.actor.weights(v, person.actor.mesh.vertices(v, 1) < 0.1 ? ankle : leg ? knee : 0) = 1;
  }
  return person;
}

double prior_at(const Eigen::VectorXd &prior, int ring) {
  return prior[skirt_person::vertex(ring, 5)];
}

} // namespace

TEST(ClothPrior, AFootIsSkinAndAWaistMayBeAnything) {
  skirt_person::Person person = person_on_a_leg();
  person.actor.face_valid.assign(person.actor.mesh.faces.rows(), 1); // the leg hangs together with the skirt
  const Eigen::VectorXd prior = cloth_prior(person.actor);
  EXPECT_LT(prior_at(prior, 0), -1);
  for (const double y : {0.55, 0.8, 1.2})
    EXPECT_EQ(prior_at(prior, skirt_person::first_ring(y)), 0) << y;
  EXPECT_EQ(prior_at(prior, 12), 0); // of the shank
  EXPECT_LE(prior.maxCoeff(), 0);
}

TEST(ClothPrior, WhatComesOutUnderAHemHangsFromNothing) {
  const skirt_person::Person person = person_on_a_leg(); // the sheet below the hem is invalid
  const Eigen::VectorXd prior = cloth_prior(person.actor);
  EXPECT_LT(prior_at(prior, 12), -3);
  EXPECT_EQ(prior_at(prior, skirt_person::first_ring(0.8)), 0);
}

TEST(ClothPrior, ASkeletonWithoutATrunkTellsNothingOfPieces) {
  skirt_person::Person person = person_on_a_leg();
  person.actor.weights.setZero();
  person.actor.weights.col(person.actor.skeleton.find("l_knee")).setOnes();
  EXPECT_EQ(prior_at(cloth_prior(person.actor), 12), 0);
}

TEST(ClothPrior, DressedAllOverIsSkinWhereNoGarmentIs) {
  const skirt_person::Person person = person_on_a_leg();
  const Segmentation dressed = dressed_all_over(person.actor);
  require_segmentation(dressed, person.actor.mesh.vertices.rows(), "dressed");
  EXPECT_EQ(dressed.clothness[skirt_person::vertex(12, 5)], 0); // the shank hangs on no trunk
  EXPECT_EQ(dressed.clothness[skirt_person::vertex(skirt_person::first_ring(0.8), 5)], 1);
  EXPECT_EQ(dressed.region[skirt_person::vertex(12, 5)], -1);
}

namespace {

/// A figure that is scanned with its left arm raised and its left leg lifted.
RiggedMesh figure_in_a_stance() {
  const Skeleton standing = doublet::testing::figure_skeleton();
  Eigen::VectorXd dofs = Eigen::VectorXd::Zero(standing.dof_count());
  dofs[standing.joints[standing.find("l_shoulder")].first_dof + 2] = 0.6;
  dofs[standing.joints[standing.find("l_hip")].first_dof] = -0.4;
  std::vector<JointAnnotation> marks = joint_annotations(standing);
  const Vertices joints = joint_positions(standing, forward_kinematics(standing, dofs));
  for (std::size_t j = 0; j < marks.size(); ++j)
    marks[j].position = joints.row(static_cast<Eigen::Index>(j));
  RiggedMesh actor;
  actor.mesh = doublet::testing::figure_surface(standing, dofs);
  actor.skeleton = make_skeleton(marks);
  actor.weights = doublet::testing::figure_weights(actor.mesh.vertices, actor.skeleton);
  actor.face_valid.assign(actor.mesh.faces.rows(), 1);
  return actor;
}

} // namespace

TEST(MirroredVertices, LieBesideTheOtherSidesBonesWhateverTheStance) {
  const RiggedMesh actor = figure_in_a_stance();
  const Eigen::VectorXi mirrored = mirrored_vertices(actor);
  const Skeleton &skeleton = actor.skeleton;
  ASSERT_EQ(mirrored.size(), actor.mesh.vertices.rows());
  EXPECT_GT((mirrored.array() >= 0).count(), 0.9 * static_cast<double>(mirrored.size()));
  for (const auto &[from, to] : {std::pair{"l_elbow", "r_elbow"}, {"r_elbow", "l_elbow"}, {"l_knee", "r_knee"}}) {
    const int a = skeleton.find(from), b = skeleton.find(to);
    int checked = 0;
    for (Eigen::Index v = 0; v < mirrored.size(); ++v) {
      if (actor.weights(v, a) < 0.9 || mirrored[v] < 0)
        continue;
      ++checked;
      EXPECT_GT(actor.weights(mirrored[v], b), 0.5);
      EXPECT_NEAR((actor.mesh.vertices.row(v).transpose() - skeleton.joints[a].rest).norm(),
                  (actor.mesh.vertices.row(mirrored[v]).transpose() - skeleton.joints[b].rest).norm(), 0.03);
    }
    EXPECT_GT(checked, 50) << from;
  }
}

TEST(MirroredVertices, NoneWhereNoJointHasASideAndNoneOnInvalidFaces) {
  RiggedMesh actor = figure_in_a_stance();
  actor.face_valid.assign(actor.face_valid.size(), 0);
  actor.face_valid[0] = 1;
  const Eigen::RowVector3i seen = actor.mesh.faces.row(0);
  for (const int v : mirrored_vertices(actor))
    EXPECT_TRUE(v == -1 || (seen.array() == v).any());
  actor = figure_in_a_stance();
  for (Joint &joint : actor.skeleton.joints) // bones without a length
    joint.rest = actor.skeleton.joints[0].rest;
  EXPECT_EQ(mirrored_vertices(actor).size(), actor.mesh.vertices.rows());
  for (Joint &joint : actor.skeleton.joints)
    joint.name = "joint " + joint.name;
  EXPECT_EQ(mirrored_vertices(actor).maxCoeff(), -1);
}
