#include "skirt_person.h"

#include "doublet/segment/cloth_prior.h"

#include <gtest/gtest.h>

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
  const Eigen::VectorXd prior = cloth_prior(person.actor, person.actor.mesh);
  EXPECT_LT(prior_at(prior, 0), -1);
  for (const double y : {0.55, 0.8, 1.2})
    EXPECT_EQ(prior_at(prior, skirt_person::first_ring(y)), 0) << y;
  EXPECT_EQ(prior_at(prior, 12), 0); // of the shank
  EXPECT_LE(prior.maxCoeff(), 0);
}

TEST(ClothPrior, WhatComesOutUnderAHemHangsFromNothing) {
  const skirt_person::Person person = person_on_a_leg(); // the sheet below the hem is invalid
  const Eigen::VectorXd prior = cloth_prior(person.actor, person.actor.mesh);
  EXPECT_LT(prior_at(prior, 12), -3);
  EXPECT_EQ(prior_at(prior, skirt_person::first_ring(0.8)), 0);
}

TEST(ClothPrior, ASkeletonWithoutATrunkTellsNothingOfPieces) {
  skirt_person::Person person = person_on_a_leg();
  person.actor.weights.setZero();
  person.actor.weights.col(person.actor.skeleton.find("l_knee")).setOnes();
  EXPECT_EQ(prior_at(cloth_prior(person.actor, person.actor.mesh), 12), 0);
}

TEST(ClothPrior, DressedAllOverIsSkinWhereNoGarmentIs) {
  const skirt_person::Person person = person_on_a_leg();
  const Segmentation dressed = dressed_all_over(person.actor, person.actor.mesh);
  require_segmentation(dressed, person.actor.mesh.vertices.rows(), "dressed");
  EXPECT_EQ(dressed.clothness[skirt_person::vertex(12, 5)], 0); // the shank hangs on no trunk
  EXPECT_EQ(dressed.clothness[skirt_person::vertex(skirt_person::first_ring(0.8), 5)], 1);
  EXPECT_EQ(dressed.region[skirt_person::vertex(12, 5)], -1);
}
