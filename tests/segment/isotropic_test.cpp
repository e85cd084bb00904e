#include "../../libsegment/src/isotropic.h"

#include "doublet/core/error.h"
#include "doublet/core/parts/boundary_loops.h"
#include "doublet/rays/surface_distance.h"
#include "support/manifold.h"
#include "support/meshes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

using namespace doublet;
using doublet::testing::expect_manifold;

namespace {

/// Share of the edges that are between 0.5 and 1.6 times as long as wanted.
double share_of_good_edges(const Mesh &mesh, double length) {
  const std::vector<Eigen::Vector2i> edges = edge_topology(mesh.faces).edges;
  const auto good = std::count_if(edges.begin(), edges.end(), [&](const Eigen::Vector2i &e) {
    const double found = (mesh.vertices.row(e[0]) - mesh.vertices.row(e[1])).norm();
    return found > 0.5 * length && found < 1.6 * length;
  });
  return static_cast<double>(good) / static_cast<double>(edges.size());
}

/// m, the largest distance between two surfaces, seen from the vertices of both.
double distance_between(const Mesh &a, const Mesh &b) {
  return std::max(distances_to_surface(a.vertices, b).maxCoeff(), distances_to_surface(b.vertices, a).maxCoeff());
}

/// Share of the vertices inside with five, six or seven neighbours.
double share_of_regular_vertices(const Mesh &mesh) {
  const EdgeTopology edges = edge_topology(mesh.faces);
  std::vector<int> valence(mesh.vertices.rows(), 0);
  std::vector<char> boundary(mesh.vertices.rows(), 0);
  for (std::size_t e = 0; e < edges.edges.size(); ++e)
    for (int v : edges.edges[e]) {
      ++valence[v];
      boundary[v] |= edges.edge_faces[e].minCoeff() < 0;
    }
  int inside = 0, regular = 0;
  for (std::size_t v = 0; v < valence.size(); ++v)
    if (!boundary[v]) {
      ++inside;
      regular += valence[v] >= 5 && valence[v] <= 7;
    }
  return static_cast<double>(regular) / inside;
}

/// V - E + F.
Eigen::Index euler_characteristic(const Mesh &mesh) {
  return mesh.vertices.rows() - static_cast<Eigen::Index>(edge_topology(mesh.faces).edges.size()) + mesh.faces.rows();
}

} // namespace

TEST(Isotropic, ASphereStaysAClosedSphere) {
  const Mesh fine = doublet::testing::sphere(0.5, {0, 1, 0}, 40, 80); // slivers at the poles
  for (double length : {0.05, 0.1}) {
    const Mesh mesh = detail::remesh_isotropic(fine, length);
    expect_manifold(mesh);
    EXPECT_TRUE(report_mesh(mesh).closed());
    EXPECT_EQ(euler_characteristic(mesh), 2);
    EXPECT_GT(share_of_good_edges(mesh, length), 0.98);
    EXPECT_GT(share_of_regular_vertices(mesh), 0.98);
    EXPECT_LT(distances_to_surface(mesh.vertices, fine).maxCoeff(), 0.001); // vertices are on it,
    EXPECT_LT(distance_between(mesh, fine), 0.5 * length * length / 0.5);   // edges are chords
    EXPECT_GT(
        face_normals(mesh.vertices, mesh.faces).row(0).dot(mesh.vertices.row(mesh.faces(0, 0)) - Eigen::RowVector3d(0, 1, 0)), 0);
  }
}

TEST(Isotropic, ACylinderKeepsItsEnds) {
  const Mesh fine = doublet::testing::tube(
      {0, 0, 0}, {0, 1, 0}, [](double) { return 0.2; }, 50, 64);
  for (double length : {0.04, 0.08}) {
    const Mesh mesh = detail::remesh_isotropic(fine, length);
    expect_manifold(mesh);
    EXPECT_EQ(euler_characteristic(mesh), 0); // with two loops
    EXPECT_GT(share_of_good_edges(mesh, length), 0.98);
    EXPECT_GT(share_of_regular_vertices(mesh), 0.98);
    EXPECT_LT(distance_between(mesh, fine), 0.5 * length * length / 0.2);
    const EdgeTopology edges = edge_topology(mesh.faces);
    double around = 0;
    int count = 0;
    for (std::size_t e = 0; e < edges.edges.size(); ++e)
      if (edges.edge_faces[e].minCoeff() < 0) {
        for (int v : edges.edges[e]) {
          const double y = mesh.vertices(v, 1);
          EXPECT_LT(std::min(std::abs(y), std::abs(y - 1)), 1e-9);
        }
        around += (mesh.vertices.row(edges.edges[e][0]) - mesh.vertices.row(edges.edges[e][1])).norm();
        ++count;
      }
    EXPECT_NEAR(around, 2 * 2 * doublet::testing::pi * 0.2, 0.03);
    EXPECT_NEAR(around / count, length, 0.3 * length);
  }
}

TEST(Isotropic, AJaggedHemComesOutSmooth) {
  constexpr int kAround = 96;
  Mesh fine = doublet::testing::tube(
      {0, 0, 0}, {0, 1, 0}, [](double) { return 0.2; }, 50, kAround);
  int tooth = 0;
  for (Eigen::Index v = 0; v < fine.vertices.rows(); ++v)
    if (fine.vertices(v, 1) < 1e-9)
      fine.vertices(v, 1) -= tooth++ % 4 < 2 ? 0.012 : -0.012; // teeth of 5 cm
  ASSERT_EQ(tooth, kAround);
  const Mesh mesh = detail::remesh_isotropic(fine, 0.04);
  expect_manifold(mesh);
  double around = 0;
  for (const std::vector<int> &loop : boundary_loops(mesh.faces))
    for (std::size_t i = 0; i < loop.size(); ++i)
      around += (mesh.vertices.row(loop[i]) - mesh.vertices.row(loop[(i + 1) % loop.size()])).norm();
  EXPECT_NEAR(around, 2 * 2 * doublet::testing::pi * 0.2, 0.03);
}

TEST(Isotropic, AFlatCuffKeepsItsEdges) {
  Mesh fine = doublet::testing::tube(
      {0, 0, 0}, {0, 1, 0}, [](double) { return 0.1; }, 50, 64);
  fine.vertices.col(2) *= 0.05;
  const Mesh mesh = detail::remesh_isotropic(fine, 0.04);
  expect_manifold(mesh);
  const std::vector<std::vector<int>> loops = boundary_loops(mesh.faces);
  ASSERT_EQ(loops.size(), 2u);
  for (const std::vector<int> &loop : loops) {
    const Eigen::VectorXd across = mesh.vertices(loop, 0);
    EXPECT_GT(across.maxCoeff(), 0.07);
    EXPECT_LT(across.minCoeff(), -0.07);
    EXPECT_GT(loop.size(), 7u); // 0.4 m around
  }
}

TEST(Isotropic, WhereBoundariesTouchTheMeshStays) {
  Mesh mesh = doublet::testing::tube(
      {0, 0, 0}, {0, 1, 0}, [](double) { return 0.2; }, 50, 64);
  const int touching = mesh.faces(50 * 64, 0); // two faces that share this corner alone make a hole that touches another
  std::vector<int> around;
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f)
    if ((mesh.faces.row(f).array() == touching).any())
      around.push_back(static_cast<int>(f));
  ASSERT_EQ(around.size(), 6u);
  std::vector<std::uint8_t> kept(mesh.faces.rows(), 1);
  kept[around.front()] = 0;
  const Eigen::RowVector3i gone = mesh.faces.row(around.front());
  for (int f : around) { // the first that shares no other corner with it
    int shared = 0;
    for (int v : mesh.faces.row(f))
      shared += (gone.array() == v).any();
    if (shared == 1) {
      kept[f] = 0;
      break;
    }
  }
  mesh.faces = valid_faces(mesh.faces, kept);
  const Mesh coarse = detail::remesh_isotropic(mesh, 0.04);
  expect_manifold(coarse);
  EXPECT_TRUE(coarse.vertices.allFinite());
  EXPECT_LT((coarse.vertices.rowwise() - mesh.vertices.row(touching)).rowwise().norm().minCoeff(), 1e-9);
  EXPECT_LT(distance_between(coarse, mesh), 0.02);
}

TEST(Isotropic, AHoleMuchSmallerThanTheEdgesKeepsItsSize) {
  Mesh mesh = doublet::testing::tube(
      {0, 0, 0}, {0, 1, 0}, [](double) { return 0.2; }, 50, 64);
  mesh.faces.row(50 * 64) = mesh.faces.row(mesh.faces.rows() - 1);
  mesh.faces.conservativeResize(mesh.faces.rows() - 1, 3);
  const Mesh coarse = detail::remesh_isotropic(mesh, 0.08);
  expect_manifold(coarse);
  EXPECT_EQ(euler_characteristic(coarse), -1); // three loops
  for (const Eigen::Vector2i &edge : edge_topology(coarse.faces).edges)
    EXPECT_GT((coarse.vertices.row(edge[0]) - coarse.vertices.row(edge[1])).norm(), 1e-3);
}

TEST(Isotropic, CoarseMeshesGetFiner) {
  const Mesh coarse = doublet::testing::tube(
      {0, 0, 0}, {0, 1, 0}, [](double) { return 0.2; }, 2, 12);
  const Mesh mesh = detail::remesh_isotropic(coarse, 0.05);
  expect_manifold(mesh);
  EXPECT_GT(share_of_good_edges(mesh, 0.05), 0.98);
  EXPECT_LT(distances_to_surface(mesh.vertices, coarse).maxCoeff(), 0.005);
}

TEST(Isotropic, NonManifoldMeshesAreRefused) {
  Mesh fan =
      doublet::testing::make_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, -1, 0}}, {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}});
  EXPECT_THROW(detail::remesh_isotropic(fan, 0.1), Error);
  EXPECT_THROW(detail::remesh_isotropic(Mesh{}, 0.1), Error);
}
