#include "doublet/core/parts/self_intersection.h"

#include "doublet/core/error.h"
#include "doublet/rays/ray_scene.h"
#include "support/figure.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace doublet {
namespace {

int count(const Mesh &mesh) {
  const auto found = self_intersecting_faces(mesh);
  return static_cast<int>(std::count(found.begin(), found.end(), 1));
}

/// By rays along the edges: (F) 1 for the faces of `a` that cross `b`, and after them those of `b`.
std::vector<std::uint8_t> by_rays(const Mesh &a, const Mesh &b) {
  std::vector<std::uint8_t> out(a.faces.rows() + b.faces.rows(), 0);
  const auto mark = [&](const Mesh &from, const Mesh &to, Eigen::Index first, Eigen::Index second) {
    const RayScene scene(to);
    for (Eigen::Index f = 0; f < from.faces.rows(); ++f)
      for (int k = 0; k < 3; ++k) {
        const Eigen::Vector3d p = from.vertices.row(from.faces(f, k)), q = from.vertices.row(from.faces(f, (k + 1) % 3));
        if (const auto hit = scene.cast(p, (q - p).normalized(), 0, (q - p).norm()))
          out[first + f] = out[second + hit->face] = 1;
      }
  };
  mark(a, b, 0, a.faces.rows());
  mark(b, a, a.faces.rows(), 0);
  return out;
}

TEST(SelfIntersection, CleanSurfacesHaveNone) {
  EXPECT_EQ(count(testing::sphere(1)), 0);
  EXPECT_EQ(count(testing::figure_surface(0.03)), 0);
  EXPECT_EQ(count(testing::join({testing::sphere(1), testing::sphere(0.9)})), 0);
}

TEST(SelfIntersection, TwoSpheresCrossWhereRaysAlongTheirEdgesMeet) {
  const Mesh a = testing::sphere(1, {0, 0, 0}, 20, 40), b = testing::sphere(0.7, {0.8, 0.13, 0.21}, 17, 33);
  const auto found = self_intersecting_faces(testing::join({a, b}));
  EXPECT_GT(std::count(found.begin(), found.end(), 1), 40);
  EXPECT_EQ(found, by_rays(a, b));
}

TEST(SelfIntersection, AVertexPushedThroughTheOtherSide) {
  Mesh ball = testing::sphere(1, {0, 0, 0}, 12, 24);
  const int v = 100;
  ball.vertices.row(v) *= -1.05;
  ball.vertices(v, 0) += 0.02; // off the opposite vertex
  const auto found = self_intersecting_faces(ball);
  int fan = 0;
  for (Eigen::Index f = 0; f < ball.faces.rows(); ++f)
    if ((ball.faces.row(f).array() == v).any()) {
      ++fan;
      EXPECT_TRUE(found[f]) << f;
    }
  EXPECT_GT(std::count(found.begin(), found.end(), 1), fan);
}

TEST(SelfIntersection, NeighboursThatShareACornerAreFound) {
  // Two triangles with the corner 0 in common; the far edge of the second crosses the inside of the first.
  const Mesh crossing =
      testing::make_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.3, 0.3, 0.2}, {0.3, 0.35, -0.2}}, {{0, 1, 2}, {0, 3, 4}});
  EXPECT_EQ(count(crossing), 2);
  Mesh apart = crossing;
  apart.vertices.row(4) << 0.3, 0.35, 0.1;
  EXPECT_EQ(count(apart), 0);
}

TEST(SelfIntersection, RepeatedAndDegenerateFacesAreNoCrossing) {
  Mesh mesh = testing::grid(1, 1, 4, 4);
  mesh.faces.row(3) = mesh.faces.row(0);
  mesh.faces.row(5) << 2, 2, 3;
  EXPECT_EQ(count(mesh), 0);
  EXPECT_THROW(self_intersecting_faces(Mesh{}), Error);
}

/// Each edge against the other sphere by rays; those of one sphere lie in its own faces, and cross none.
TEST(SelfIntersection, EdgesCrossFacesThatAreNotTheirOwn) {
  const Mesh one = testing::sphere(1);
  const std::vector<Eigen::Vector2i> edges = edge_topology(one.faces).edges;
  EXPECT_EQ(crossing_edges(one, edges), 0);
  Mesh other = one;
  other.vertices.rowwise() += Eigen::RowVector3d(0.7, 0.31, 0.17);
  const RayScene scene(other);
  int crossing = 0;
  for (const Eigen::Vector2i &e : edges) {
    const Eigen::Vector3d p = one.vertices.row(e[0]), q = one.vertices.row(e[1]);
    crossing += scene.cast(p, (q - p).normalized(), 0, (q - p).norm()).has_value();
  }
  EXPECT_GT(crossing, 5);
  EXPECT_EQ(crossing_edges(testing::join({one, other}), edges), crossing);
}

TEST(SelfIntersection, SegmentsCrossASurfaceWhereRaysDo) {
  const Mesh ball = testing::sphere(1, {0, 0, 0}, 12, 24);
  const RayScene scene(ball);
  int crossed = 0;
  for (int i = 0; i < 200; ++i) {
    const Eigen::Vector3d p = 1.2 * Eigen::Vector3d(std::sin(3.1 * i), std::cos(1.7 * i), std::sin(0.9 * i)),
                          q = 1.2 * Eigen::Vector3d(std::cos(2.3 * i), std::sin(0.7 * i), std::cos(4.1 * i));
    const bool hit = scene.cast(p, (q - p).normalized(), 0, (q - p).norm()).has_value();
    EXPECT_EQ(crosses_surface(p, q, ball), hit) << i;
    crossed += hit;
  }
  EXPECT_GT(crossed, 20);
  EXPECT_LT(crossed, 180);
}

} // namespace
} // namespace doublet
