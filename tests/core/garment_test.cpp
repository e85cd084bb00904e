#include "doublet/core/garment.h"

#include "support/error_of.h"
#include "support/garment_scene.h"

#include <gtest/gtest.h>

#include <limits>

namespace doublet {

using testing::empty_garment;
using Scene = testing::GarmentScene;

TEST(Dress, AppendsTheGarmentToTheActor) {
  const Scene s;
  const DressedActor d = dress(s.actor, s.segmentation, s.garment);
  ASSERT_EQ(d.actor.mesh.vertices.rows(), s.bare() + 6);
  EXPECT_EQ(d.actor.mesh.vertices.topRows(s.bare()), s.actor.mesh.vertices);
  EXPECT_EQ(d.actor.mesh.vertices.bottomRows(6), s.garment.mesh.vertices);
  EXPECT_EQ(d.actor.weights.topRows(s.bare()), s.actor.weights);
  const Eigen::Index faces = s.actor.mesh.faces.rows();
  ASSERT_EQ(d.actor.mesh.faces.rows(), faces + 2);
  EXPECT_EQ(d.actor.mesh.faces.topRows(faces), s.actor.mesh.faces);
  EXPECT_EQ(d.actor.mesh.faces(faces + 1, 2), s.bare() + 5);
  EXPECT_EQ(d.actor.skeleton.joint_count(), s.actor.skeleton.joint_count());
}

TEST(Dress, SkinWeightsAreThoseOfThePlace) {
  const Scene s;
  const DressedActor d = dress(s.actor, s.segmentation, s.garment);
  const auto corner = [&](int face, int k) { return s.actor.weights.row(s.actor.mesh.faces(face, k)); };
  EXPECT_EQ(d.actor.weights.row(s.bare()), corner(10, 0));
  EXPECT_TRUE(d.actor.weights.row(s.bare() + 1).isApprox(0.5 * corner(20, 0) + 0.5 * corner(20, 1), 1e-14));
  EXPECT_TRUE(
      d.actor.weights.row(s.bare() + 5).isApprox(0.125 * corner(60, 0) + 0.375 * corner(60, 1) + 0.5 * corner(60, 2), 1e-14));
  EXPECT_LT((d.actor.weights.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-12);
}

TEST(Dress, CoveredFacesAreInvalidAndNoOthers) {
  const Scene s;
  const DressedActor d = dress(s.actor, s.segmentation, s.garment);
  ASSERT_EQ(d.actor.face_valid.size(), s.actor.face_valid.size() + 2);
  for (std::size_t f = 0; f < d.actor.face_valid.size(); ++f) {
    const bool invalid = f == 0 || f == 10 || f == 20 || f == 30; // the first is so by itself
    EXPECT_EQ(d.actor.face_valid[f], invalid ? 0 : 1) << f;
  }
}

TEST(Dress, OnlyTheGarmentIsCloth) {
  const Scene s;
  const Segmentation c = dress(s.actor, s.segmentation, s.garment).segmentation;
  EXPECT_EQ(c.clothness.head(s.bare()), Eigen::VectorXd::Zero(s.bare()));
  EXPECT_EQ(c.clothness.tail(6), s.garment.clothness);
  EXPECT_EQ(c.region.head(s.bare()), Eigen::VectorXi::Constant(s.bare(), -1));
  EXPECT_EQ(c.region.tail(6), s.garment.region);
  EXPECT_EQ(c.region_count, 2);
  EXPECT_EQ(c.sigma.head(s.bare()), s.segmentation.sigma);
  EXPECT_TRUE(c.sigma.tail(6).array().isNaN().all());
  EXPECT_EQ(c.rest.topRows(s.bare()), s.actor.mesh.vertices);
  EXPECT_EQ(c.rest.bottomRows(6), s.garment.rest);
}

TEST(Dress, WithoutVerticesNothingChanges) {
  const Scene s;
  const DressedActor d = dress(s.actor, s.segmentation, empty_garment(s.actor));
  EXPECT_EQ(d.actor.mesh.vertices, s.actor.mesh.vertices);
  EXPECT_EQ(d.actor.mesh.faces, s.actor.mesh.faces);
  EXPECT_EQ(d.actor.weights, s.actor.weights);
  EXPECT_EQ(d.actor.face_valid, s.actor.face_valid);
  EXPECT_EQ(d.segmentation.clothness, s.segmentation.clothness);
  EXPECT_EQ(d.segmentation.region, s.segmentation.region);
  EXPECT_EQ(d.segmentation.rest.rows(), 0);
  ReferencePerformance performance;
  performance.surface = {s.actor.mesh.faces, {s.actor.mesh.vertices}};
  const ReferencePerformance same = dress(performance, s.actor, empty_garment(s.actor));
  EXPECT_EQ(same.surface.faces, s.actor.mesh.faces);
  EXPECT_EQ(same.surface.frames[0], s.actor.mesh.vertices);
}

TEST(Dress, WhatTheBodyCarriesOfTheActorsOwnClothIsNoCloth) {
  Scene s;
  const Eigen::Index half = s.bare() / 2;
  s.segmentation.region.tail(s.bare() - half).setOnes();
  s.segmentation.region_count = 2;
  Garment none = empty_garment(s.actor);
  none.attachment = Eigen::VectorXd::Zero(s.bare());
  none.attachment.head(half).setOnes();
  none.attachment[half] = 0.25;
  const Segmentation c = dress(s.actor, s.segmentation, none).segmentation;
  EXPECT_EQ(c.region_count, 1);
  EXPECT_EQ(c.clothness.head(half), Eigen::VectorXd::Zero(half));
  EXPECT_EQ(c.region.head(half), Eigen::VectorXi::Constant(half, -1));
  EXPECT_EQ(c.region.tail(s.bare() - half), Eigen::VectorXi::Zero(s.bare() - half)) << "numbered from 0";
  EXPECT_EQ(c.clothness[half], 0.75);
  EXPECT_EQ(c.clothness[half + 1], 1);
  none.attachment.conservativeResize(3);
  EXPECT_THROW(dress(s.actor, s.segmentation, none), Error);
}

TEST(Dress, APerformanceCarriesTheGarmentOnItsSurface) {
  const Scene s;
  ReferencePerformance performance;
  performance.surface = {s.actor.mesh.faces, {s.actor.mesh.vertices, Vertices::Random(s.bare(), 3)}};
  performance.dofs = MatrixRM::Random(2, s.actor.skeleton.dof_count());
  performance.frames = {7, 8};
  const ReferencePerformance d = dress(performance, s.actor, s.garment);
  EXPECT_EQ(d.surface.faces, dress(s.actor, s.segmentation, s.garment).actor.mesh.faces);
  ASSERT_EQ(d.surface.frames.size(), 2u);
  const Vertices &captured = performance.surface.frames[1], &frame = d.surface.frames[1];
  ASSERT_EQ(frame.rows(), s.bare() + 6);
  EXPECT_EQ(frame.topRows(s.bare()), captured);
  const auto corner = [&](int k) { return captured.row(s.actor.mesh.faces(50, k)); };
  EXPECT_TRUE(frame.row(s.bare() + 4).isApprox(0.75 * corner(0) + 0.25 * corner(2), 1e-14));
  EXPECT_TRUE(d.surface.frames[0].bottomRows(6).isApprox(s.garment.mesh.vertices, 1e-14));
  EXPECT_EQ(d.dofs, performance.dofs);
  EXPECT_EQ(d.frames, performance.frames);
}

TEST(Dress, RefusesACapturedFrameOfAnotherMesh) {
  const Scene s;
  ReferencePerformance performance;
  performance.surface = {s.actor.mesh.faces, {s.actor.mesh.vertices, s.actor.mesh.vertices.topRows(5)}};
  EXPECT_THROW(dress(performance, s.actor, s.garment), std::invalid_argument);
}

TEST(Dress, RefusesWhatDoesNotFit) {
  Scene s;
  s.segmentation.clothness.conservativeResize(5);
  EXPECT_THROW(dress(s.actor, s.segmentation, s.garment), std::invalid_argument);
  s.segmentation = Scene().segmentation;
  s.garment.replaced_faces.pop_back();
  EXPECT_THROW(dress(s.actor, s.segmentation, s.garment), Error);
}

TEST(ValidateGarment, SaysWhatIsWrong) {
  const Scene good;
  EXPECT_NO_THROW(validate_garment(good.garment, good.actor, "x"));
  const auto said = [&](const std::function<void(Garment &)> &damage) {
    Garment garment = good.garment;
    damage(garment);
    return testing::error_of([&] { validate_garment(garment, good.actor, "coat.npz"); });
  };
  EXPECT_EQ(said([](Garment &g) { g.clothness.conservativeResize(5); }),
            "coat.npz: array 'clothness': expected 6 rows, one per vertex, found 5");
  EXPECT_EQ(said([](Garment &g) { g.region.conservativeResize(7); }),
            "coat.npz: array 'region': expected 6 rows, one per vertex, found 7");
  EXPECT_EQ(said([](Garment &g) { g.rest.conservativeResize(5, 3); }),
            "coat.npz: array 'rest': expected 6 rows, one per vertex, found 5");
  EXPECT_EQ(said([](Garment &g) { g.actor_face.conservativeResize(5); }),
            "coat.npz: array 'actor_face': expected 6 rows, one per vertex, found 5");
  EXPECT_EQ(said([](Garment &g) { g.barycentric.conservativeResize(5, 3); }),
            "coat.npz: array 'barycentric': expected 6 rows, one per vertex, found 5");
  const std::string faces = std::to_string(good.actor.mesh.faces.rows());
  EXPECT_EQ(said([](Garment &g) { g.replaced_faces.resize(3); }),
            "coat.npz: array 'covers': expected " + faces + " entries, one per face of the actor, found 3");
  EXPECT_EQ(said([](Garment &g) { g.region[4] = 2; }), "coat.npz: vertex 4: expected a region below 2, found 2.000000");
  EXPECT_EQ(said([](Garment &g) { g.region[1] = -1; }), "coat.npz: vertex 1: expected a region below 2, found -1.000000");
  EXPECT_EQ(said([](Garment &g) { g.clothness[2] = 1.5; }), "coat.npz: vertex 2: expected a clothness in [0, 1], found 1.500000");
  EXPECT_EQ(said([](Garment &g) { g.rest(3, 0) = std::numeric_limits<double>::quiet_NaN(); }),
            "coat.npz: vertex 3: expected a finite rest position, found nan");
  EXPECT_EQ(said([&](Garment &g) { g.actor_face[5] = static_cast<int>(good.actor.mesh.faces.rows()); }),
            "coat.npz: vertex 5: expected a face below " + faces + " of the actor, found " + faces + ".000000");
  EXPECT_EQ(said([](Garment &g) { g.barycentric(0, 1) = 0.25; }),
            "coat.npz: vertex 0: expected barycentric coordinates with sum one, found 1.250000");
  EXPECT_NE(said([](Garment &g) { g.mesh.faces(0, 0) = 6; }).find("coat.npz"), std::string::npos);
}

} // namespace doublet
