#include "doublet/core/garment.h"

#include "doublet/core/error.h"
#include "doublet/core/files.h"
#include "doublet/core/npz.h"
#include "support/figure.h"
#include "support/temp_folder.h"

#include <gtest/gtest.h>

#include <functional>
#include <limits>

namespace doublet {
namespace {

using testing::TempFolder;

/// A ball with weights and sigmas of no pattern; its first face is invalid.
struct Scene {
  RiggedMesh actor;
  Clothness clothness;
  Garment garment;

  Scene() {
    actor.skeleton = testing::figure_skeleton();
    actor.mesh = testing::sphere(0.5);
    actor.face_valid.assign(actor.mesh.faces.rows(), 1);
    actor.face_valid[0] = 0;
    actor.weights = MatrixRM::Random(actor.mesh.vertices.rows(), actor.skeleton.joint_count()).cwiseAbs();
    actor.weights.array().colwise() /= actor.weights.rowwise().sum().array();
    clothness.sigma = Eigen::VectorXd::LinSpaced(actor.mesh.vertices.rows(), 0, 0.1);
    clothness.clothness = Eigen::VectorXd::Ones(actor.mesh.vertices.rows());
    clothness.region = Eigen::VectorXi::Zero(actor.mesh.vertices.rows());
    clothness.region_count = 1;
    make_garment();
  }

  /// Two triangles of two regions.
  void make_garment() {
    garment.actor_face.resize(6);
    garment.actor_face << 10, 20, 30, 40, 50, 60;
    garment.barycentric.resize(6, 3);
    garment.barycentric << 1, 0, 0, 0.5, 0.5, 0, 0.25, 0.25, 0.5, 0, 1, 0, 0.75, 0, 0.25, 0.125, 0.375, 0.5;
    garment.mesh.vertices = at_garment(garment, actor.mesh.faces, actor.mesh.vertices);
    garment.mesh.faces.resize(2, 3);
    garment.mesh.faces << 0, 1, 2, 3, 4, 5;
    garment.region.resize(6);
    garment.region << 0, 0, 0, 1, 1, 1;
    garment.region_count = 2;
    garment.clothness.resize(6);
    garment.clothness << 0, 0.5, 1, 0, 0.25, 1;
    garment.rest = 1.5 * garment.mesh.vertices;
    garment.covers.assign(actor.mesh.faces.rows(), 0);
    for (int f : {10, 20, 30})
      garment.covers[f] = 1;
  }
  Eigen::Index bare() const { return actor.mesh.vertices.rows(); }
};

Garment empty_garment(const RiggedMesh &actor) {
  Garment garment;
  garment.mesh = {Vertices(0, 3), Faces(0, 3)};
  garment.rest.resize(0, 3);
  garment.barycentric.resize(0, 3);
  garment.covers.assign(actor.mesh.faces.rows(), 0);
  return garment;
}

std::string error_of(const std::function<void()> &call) {
  try {
    call();
  } catch (const Error &error) {
    return error.what();
  }
  return "no Error";
}

} // namespace

TEST(Dress, AppendsTheGarmentToTheActor) {
  const Scene s;
  const DressedActor d = dress(s.actor, s.clothness, s.garment);
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
  const DressedActor d = dress(s.actor, s.clothness, s.garment);
  const auto corner = [&](int face, int k) { return s.actor.weights.row(s.actor.mesh.faces(face, k)); };
  EXPECT_EQ(d.actor.weights.row(s.bare()), corner(10, 0));
  EXPECT_TRUE(d.actor.weights.row(s.bare() + 1).isApprox(0.5 * corner(20, 0) + 0.5 * corner(20, 1), 1e-14));
  EXPECT_TRUE(
      d.actor.weights.row(s.bare() + 5).isApprox(0.125 * corner(60, 0) + 0.375 * corner(60, 1) + 0.5 * corner(60, 2), 1e-14));
  EXPECT_LT((d.actor.weights.rowwise().sum().array() - 1).abs().maxCoeff(), 1e-12);
}

TEST(Dress, CoveredFacesAreInvalidAndNoOthers) {
  const Scene s;
  const DressedActor d = dress(s.actor, s.clothness, s.garment);
  ASSERT_EQ(d.actor.face_valid.size(), s.actor.face_valid.size() + 2);
  for (std::size_t f = 0; f < d.actor.face_valid.size(); ++f) {
    const bool invalid = f == 0 || f == 10 || f == 20 || f == 30; // the first is so by itself
    EXPECT_EQ(d.actor.face_valid[f], invalid ? 0 : 1) << f;
  }
}

TEST(Dress, OnlyTheGarmentIsCloth) {
  const Scene s;
  const Clothness c = dress(s.actor, s.clothness, s.garment).clothness;
  EXPECT_EQ(c.clothness.head(s.bare()), Eigen::VectorXd::Zero(s.bare()));
  EXPECT_EQ(c.clothness.tail(6), s.garment.clothness);
  EXPECT_EQ(c.region.head(s.bare()), Eigen::VectorXi::Constant(s.bare(), -1));
  EXPECT_EQ(c.region.tail(6), s.garment.region);
  EXPECT_EQ(c.region_count, 2);
  EXPECT_EQ(c.sigma.head(s.bare()), s.clothness.sigma);
  EXPECT_TRUE(c.sigma.tail(6).array().isNaN().all());
  EXPECT_EQ(c.rest.topRows(s.bare()), s.actor.mesh.vertices);
  EXPECT_EQ(c.rest.bottomRows(6), s.garment.rest);
}

TEST(Dress, WithoutVerticesNothingChanges) {
  const Scene s;
  const DressedActor d = dress(s.actor, s.clothness, empty_garment(s.actor));
  EXPECT_EQ(d.actor.mesh.vertices, s.actor.mesh.vertices);
  EXPECT_EQ(d.actor.mesh.faces, s.actor.mesh.faces);
  EXPECT_EQ(d.actor.weights, s.actor.weights);
  EXPECT_EQ(d.actor.face_valid, s.actor.face_valid);
  EXPECT_EQ(d.clothness.clothness, s.clothness.clothness);
  EXPECT_EQ(d.clothness.region, s.clothness.region);
  EXPECT_EQ(d.clothness.rest.rows(), 0);
  ReferencePerformance performance;
  performance.surface = {s.actor.mesh.faces, {s.actor.mesh.vertices}, {s.actor.mesh.vertices}};
  const ReferencePerformance same = dress(performance, s.actor, empty_garment(s.actor));
  EXPECT_EQ(same.surface.faces, s.actor.mesh.faces);
  EXPECT_EQ(same.surface.frames[0], s.actor.mesh.vertices);
  EXPECT_EQ(same.surface.unposed.size(), 1u);
}

TEST(Dress, APerformanceCarriesTheGarmentOnItsSurface) {
  const Scene s;
  ReferencePerformance performance;
  performance.surface = {s.actor.mesh.faces, {s.actor.mesh.vertices, Vertices::Random(s.bare(), 3)}, {Vertices(), Vertices()}};
  performance.dofs = MatrixRM::Random(2, s.actor.skeleton.dof_count());
  performance.frames = {7, 8};
  const ReferencePerformance d = dress(performance, s.actor, s.garment);
  EXPECT_EQ(d.surface.faces, dress(s.actor, s.clothness, s.garment).actor.mesh.faces);
  ASSERT_EQ(d.surface.frames.size(), 2u);
  const Vertices &captured = performance.surface.frames[1], &frame = d.surface.frames[1];
  ASSERT_EQ(frame.rows(), s.bare() + 6);
  EXPECT_EQ(frame.topRows(s.bare()), captured);
  const auto corner = [&](int k) { return captured.row(s.actor.mesh.faces(50, k)); };
  EXPECT_TRUE(frame.row(s.bare() + 4).isApprox(0.75 * corner(0) + 0.25 * corner(2), 1e-14));
  EXPECT_TRUE(d.surface.frames[0].bottomRows(6).isApprox(s.garment.mesh.vertices, 1e-14));
  EXPECT_TRUE(d.surface.unposed.empty()); // of another mesh
  EXPECT_EQ(d.dofs, performance.dofs);
  EXPECT_EQ(d.frames, performance.frames);
}

TEST(Dress, RefusesACapturedFrameOfAnotherMesh) {
  const Scene s;
  ReferencePerformance performance;
  performance.surface = {s.actor.mesh.faces, {s.actor.mesh.vertices, s.actor.mesh.vertices.topRows(5)}, {}};
  EXPECT_THROW(dress(performance, s.actor, s.garment), std::invalid_argument);
}

TEST(Dress, RefusesWhatDoesNotFit) {
  Scene s;
  s.clothness.clothness.conservativeResize(5);
  EXPECT_THROW(dress(s.actor, s.clothness, s.garment), std::invalid_argument);
  s.clothness = Scene().clothness;
  s.garment.covers.pop_back();
  EXPECT_THROW(dress(s.actor, s.clothness, s.garment), Error);
}

TEST(ValidateGarment, SaysWhatIsWrong) {
  const Scene good;
  EXPECT_NO_THROW(validate_garment(good.garment, good.actor, "x"));
  const auto said = [&](const std::function<void(Garment &)> &damage) {
    Garment garment = good.garment;
    damage(garment);
    return error_of([&] { validate_garment(garment, good.actor, "coat.npz"); });
  };
  EXPECT_EQ(said([](Garment &g) { g.clothness.conservativeResize(5); }),
            "coat.npz: array 'clothness': expected 6 rows, one a vertex, found 5");
  EXPECT_EQ(said([](Garment &g) { g.region.conservativeResize(7); }),
            "coat.npz: array 'region': expected 6 rows, one a vertex, found 7");
  EXPECT_EQ(said([](Garment &g) { g.rest.conservativeResize(5, 3); }),
            "coat.npz: array 'rest': expected 6 rows, one a vertex, found 5");
  EXPECT_EQ(said([](Garment &g) { g.actor_face.conservativeResize(5); }),
            "coat.npz: array 'actor_face': expected 6 rows, one a vertex, found 5");
  EXPECT_EQ(said([](Garment &g) { g.barycentric.conservativeResize(5, 3); }),
            "coat.npz: array 'barycentric': expected 6 rows, one a vertex, found 5");
  const std::string faces = std::to_string(good.actor.mesh.faces.rows());
  EXPECT_EQ(said([](Garment &g) { g.covers.resize(3); }),
            "coat.npz: array 'covers': expected " + faces + " entries, one a face of the actor, found 3");
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

TEST(GarmentFile, ComesBackAsItWas) {
  const TempFolder folder;
  const Scene s;
  write_garment(folder / "garment.npz", s.garment);
  const Garment back = read_garment(folder / "garment.npz", s.actor);
  EXPECT_TRUE(back.mesh.vertices.isApprox(s.garment.mesh.vertices, 1e-7));
  EXPECT_EQ(back.mesh.faces, s.garment.mesh.faces);
  EXPECT_EQ(back.region, s.garment.region);
  EXPECT_EQ(back.region_count, 2);
  EXPECT_EQ(back.clothness, s.garment.clothness);
  EXPECT_TRUE(back.rest.isApprox(s.garment.rest, 1e-7));
  EXPECT_EQ(back.actor_face, s.garment.actor_face);
  EXPECT_EQ(back.barycentric, s.garment.barycentric);
  EXPECT_EQ(back.covers, s.garment.covers);
}

TEST(GarmentFile, EmptyOneToo) {
  const TempFolder folder;
  const Scene s;
  write_garment(folder / "garment.npz", empty_garment(s.actor));
  const Garment back = read_garment(folder / "garment.npz", s.actor);
  EXPECT_EQ(back.mesh.vertices.rows(), 0);
  EXPECT_EQ(back.mesh.faces.rows(), 0);
  EXPECT_EQ(back.rest.rows(), 0);
  EXPECT_EQ(back.region_count, 0);
  EXPECT_EQ(back.covers.size(), s.actor.face_valid.size());
  EXPECT_EQ(dress(s.actor, s.clothness, back).actor.mesh.vertices, s.actor.mesh.vertices);
}

TEST(GarmentFile, DamagedOnesAreRefusedByName) {
  const TempFolder folder;
  const Scene s;
  write_garment(folder / "good.npz", s.garment);
  const auto said = [&](const std::function<void(Npz &)> &damage) {
    Npz npz = Npz::read(folder / "good.npz");
    damage(npz);
    npz.write(folder / "bad.npz");
    return error_of([&] { read_garment(folder / "bad.npz", s.actor); });
  };
  const auto contains = [](const std::string &text, const std::string &part) {
    EXPECT_NE(text.find("bad.npz"), std::string::npos) << text;
    EXPECT_NE(text.find(part), std::string::npos) << text;
  };
  for (const char *array : {"vertices", "faces", "region", "clothness", "rest", "actor_face", "barycentric", "covers"})
    contains(said([&](Npz &npz) { npz.arrays.erase(array); }), array);
  contains(said([](Npz &npz) { npz.set_i4("region", {5}, std::vector<int>(5, 0)); }), "region");
  contains(said([](Npz &npz) { npz.set_f4("rest", {3, 6}, std::vector<double>(18, 0)); }), "rest");
  contains(said([](Npz &npz) { npz.set_f4("barycentric", {6, 2}, std::vector<double>(12, 0.5)); }), "barycentric");
  contains(said([](Npz &npz) { npz.set_i4("actor_face", {6}, std::vector<int>(6, 1 << 30)); }), "vertex 0");
  contains(said([](Npz &npz) { npz.set_i4("faces", {1, 3}, {0, 1, 6}); }), "bad.npz");
  contains(said([](Npz &npz) { npz.set_b1("covers", std::vector<std::uint8_t>(3, 0)); }), "covers");
  EXPECT_THROW(read_garment(folder / "none.npz", s.actor), FileNotFound);
}

TEST(GarmentFile, OfAnotherActorIsRefusedEvenIfEmpty) {
  const TempFolder folder;
  const Scene s;
  RiggedMesh other = s.actor;
  other.mesh = testing::sphere(0.5, {0, 0, 0}, 12, 20);
  other.face_valid.assign(other.mesh.faces.rows(), 1);
  write_garment(folder / "garment.npz", s.garment);
  write_garment(folder / "empty.npz", empty_garment(s.actor));
  for (const char *name : {"garment.npz", "empty.npz"}) {
    const std::string text = error_of([&] { read_garment(folder / name, other); });
    EXPECT_NE(text.find(name), std::string::npos) << text;
    EXPECT_NE(text.find("'covers'"), std::string::npos) << text;
  }
}

TEST(GarmentFile, WriterRefusesUnequalLengths) {
  const TempFolder folder;
  Scene s;
  s.garment.rest.conservativeResize(5, 3);
  EXPECT_THROW(write_garment(folder / "garment.npz", s.garment), std::invalid_argument);
}

} // namespace doublet
