#include "../../libsegment/src/handles.h"

#include "../../libsegment/src/surface_piece.h"
#include "doublet/core/error.h"
#include "doublet/core/parts/boundary_loops.h"
#include "doublet/core/parts/self_intersection.h"
#include "doublet/segment/garment_mesher.h"
#include "skirt_person.h"
#include "support/manifold.h"
#include "tube.h"

#include <gtest/gtest.h>

#include <algorithm>

using namespace doublet;
using doublet::testing::expect_manifold;

namespace {

/// Opens two faces and joins their edges by six.
void join(Mesh &mesh, int one, int other) {
  const Eigen::RowVector3i a = mesh.faces.row(one), g = mesh.faces.row(other), b(g[0], g[2], g[1]);
  const Eigen::Index faces = mesh.faces.rows();
  mesh.faces.conservativeResize(faces + 4, 3);
  const Eigen::Index place[] = {one, other, faces, faces + 1, faces + 2, faces + 3};
  for (int k = 0; k < 3; ++k) {
    const int l = (k + 1) % 3;
    mesh.faces.row(place[2 * k]) << a[k], a[l], b[l];
    mesh.faces.row(place[2 * k + 1]) << a[k], b[l], b[k];
  }
}

/// Without its caps.
Mesh open_tube() {
  const Faces all = tube::faces();
  return {tube::vertices([](double) { return tube::kRadius; }).topRows(tube::kAround * tube::kRings),
          all.topRows(all.rows() - 2 * tube::kAround)};
}
int face_at(int ring, int column) {
  return 2 * (ring * tube::kAround + column);
}

/// 0.3 m across, the tube itself `thick`.
Mesh torus(double thick) {
  constexpr int kMany = 40, kFew = 12;
  Mesh mesh{Vertices(kMany * kFew, 3), Faces(2 * kMany * kFew, 3)};
  const auto vertex = [](int i, int j) { return i % kMany * kFew + j % kFew; };
  for (int i = 0; i < kMany; ++i)
    for (int j = 0; j < kFew; ++j) {
      const double u = 2 * std::numbers::pi * i / kMany, v = 2 * std::numbers::pi * j / kFew, r = 0.15 + thick * std::cos(v);
      mesh.vertices.row(vertex(i, j)) << r * std::cos(u), thick * std::sin(v), r * std::sin(u);
      mesh.faces.row(2 * vertex(i, j)) << vertex(i, j), vertex(i, j + 1), vertex(i + 1, j);
      mesh.faces.row(2 * vertex(i, j) + 1) << vertex(i + 1, j), vertex(i, j + 1), vertex(i + 1, j + 1);
    }
  return mesh;
}

TEST(Handles, GenusIsThatOfKnownSurfaces) {
  EXPECT_EQ(detail::genus({tube::vertices([](double) { return tube::kRadius; }), tube::faces()}), 0);
  EXPECT_EQ(detail::genus(open_tube()), 0);
  EXPECT_EQ(detail::genus(torus(0.02)), 1);
  Mesh mesh = torus(0.02);
  join(mesh, 0, 400);
  EXPECT_EQ(detail::genus(mesh), 2);
}

TEST(Handles, WhatHasNoneStaysAsItIs) {
  const Mesh mesh = open_tube(), same = detail::without_handles(mesh, 10);
  EXPECT_EQ(same.vertices, mesh.vertices);
  EXPECT_EQ(same.faces, mesh.faces);
}

/// Walking around such a vertex never comes back, and a loop of the boundary that passes it twice loses its way.
TEST(Handles, SurfacesThatAreNoneAreRefused) {
  const auto refusal = [](const auto &call) -> std::string {
    try {
      call();
      return {};
    } catch (const Error &error) {
      return error.what();
    }
  };
  const auto pinched = [](int first, int second) {
    Mesh mesh = open_tube();
    for (int vertex : {first, second})
      mesh.faces = (mesh.faces.array() == vertex).select(vertex + 8, mesh.faces).eval();
    return mesh;
  };
  const std::string touching =
      "garment: expected a manifold surface, found 0 edges with several faces on one side and 2 vertices";
  EXPECT_TRUE(
      refusal([&] { detail::without_handles(pinched(20 * tube::kAround, 25 * tube::kAround), 0.25); }).starts_with(touching));
  EXPECT_NE(refusal([&] { detail::require_manifold(pinched(0, 20), "edge"); }).find("and 2 vertices"), std::string::npos);
  Mesh doubled = open_tube();
  doubled.faces.conservativeResize(doubled.faces.rows() + 1, 3);
  doubled.faces.row(doubled.faces.rows() - 1) = doubled.faces.row(0);
  EXPECT_NE(
      refusal([&] { detail::require_manifold(doubled, "twice"); }).find("twice: expected a manifold surface, found 3 edges"),
      std::string::npos);
  EXPECT_EQ(refusal([] { detail::require_manifold(open_tube(), "open"); }), "");
  EXPECT_EQ(refusal([] { detail::require_manifold(torus(0.02), "closed"); }), "");
}

TEST(Handles, FoldsThatWereJoinedArePartedAndClosed) {
  Mesh mesh = open_tube();
  join(mesh, face_at(20, 0), face_at(20, 24)); // through its inside
  join(mesh, face_at(10, 12), face_at(10, 36));
  EXPECT_EQ(detail::genus(mesh), 2);
  const Mesh parted = detail::without_handles(mesh, 0.25);
  EXPECT_EQ(detail::genus(parted), 0);
  EXPECT_EQ(boundary_loops(parted.faces).size(), 2u);
  expect_manifold(parted);
  EXPECT_EQ(parted.vertices.topRows(mesh.vertices.rows()), mesh.vertices);
  // Around a triangle, each cut has three new corners and two middles.
  EXPECT_EQ(parted.vertices.rows(), mesh.vertices.rows() + 2 * 5);
  EXPECT_EQ(parted.faces.rows(), mesh.faces.rows() + 2 * 6);
}

TEST(Handles, WhatIsFurtherAroundStays) {
  const Mesh mesh = torus(0.02);
  EXPECT_EQ(detail::without_handles(mesh, 0.12).faces, mesh.faces); // 0.124 around
  const Mesh cut = detail::without_handles(mesh, 0.13);
  EXPECT_EQ(detail::genus(cut), 0);
  EXPECT_TRUE(boundary_loops(cut.faces).empty());
  expect_manifold(cut);
}

/// A loop that would run along the boundary is none: cut there, the surface would hang together by a point.
TEST(Handles, LoopsKeepOffTheBoundary) {
  Mesh mesh = open_tube();
  join(mesh, face_at(0, 0) + 1, face_at(0, 24) + 1); // a corner of each lies on the boundary
  const Mesh parted = detail::without_handles(mesh, 1);
  EXPECT_EQ(detail::genus(parted), 0);
  expect_manifold(parted);
}

TEST(Handles, AClosedLoopIsASurfaceLikeThatAroundIt) {
  Mesh mesh = open_tube();
  const Faces whole = mesh.faces;
  mesh.faces = whole.bottomRows(whole.rows() - 2); // two faces at its edge, and one inside, are missing
  mesh.faces.row(face_at(20, 3)) = mesh.faces.row(mesh.faces.rows() - 1);
  mesh.faces.conservativeResize(mesh.faces.rows() - 1, 3);
  std::vector<std::vector<int>> loops = boundary_loops(mesh.faces);
  ASSERT_EQ(loops.size(), 3u);
  std::erase_if(loops, [](const auto &loop) { return loop.size() > 3; });
  const Mesh closed = detail::with_closed_loops(mesh, loops);
  EXPECT_EQ(boundary_loops(closed.faces).size(), 2u);
  expect_manifold(closed);
  EXPECT_EQ(closed.faces.topRows(mesh.faces.rows()), mesh.faces);
}

/// A leg that touches the skirt from inside, and is one surface with it there: no opening, and it does not hold the skirt.
TEST(Handles, SkinThatTouchesTheClothIsNoOpeningOfIt) {
  skirt_person::Person person;
  join(person.actor.mesh, skirt_person::face(40, 0), skirt_person::face(10, 0));
  person.actor.face_valid.resize(person.actor.mesh.faces.rows(), 1);
  MeshSequence captured{person.actor.mesh.faces, std::vector<Vertices>(3, person.actor.mesh.vertices)};
  GarmentOptions options;
  options.vertices = 400;
  const GarmentSummary summary = summarise_garment(mesh_garment(person.actor, person.segmentation, {}, captured, options));
  EXPECT_EQ(summary.loops, 2);
  EXPECT_EQ(summary.hanging_loops, 1);
}

/// Two places of a skirt that the scan has joined: its garment has neither handle nor knot.
TEST(Handles, AGarmentHasNone) {
  skirt_person::Person person;
  const int ring = 40;
  join(person.actor.mesh, skirt_person::face(ring, 0), skirt_person::face(ring, 5));
  person.actor.face_valid.resize(person.actor.mesh.faces.rows(), 1);
  EXPECT_EQ(detail::genus(person.actor.mesh), 1);
  MeshSequence captured{person.actor.mesh.faces, std::vector<Vertices>(3, person.actor.mesh.vertices)};
  GarmentOptions options;
  options.vertices = 400;
  const Garment garment = mesh_garment(person.actor, person.segmentation, {}, captured, options);
  EXPECT_EQ(detail::genus(garment.mesh), 0);
  EXPECT_EQ(summarise_garment(garment).loops, 2);
  const std::vector<std::uint8_t> crossing = self_intersecting_faces({garment.rest, garment.mesh.faces});
  EXPECT_EQ(std::count(crossing.begin(), crossing.end(), 1), 0);
}

} // namespace
