#include "doublet/rays/ray_scene.h"

#include "doublet/core/parts/closest_point.h"

#include "doublet/core/context.h"
#include "doublet/core/error.h"
#include "support/figure.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

namespace doublet {

namespace {

using Eigen::Vector3d;

Vector3d at(const Mesh &m, int face, const Vector3d &bary) {
  Vector3d p = Vector3d::Zero();
  for (int k = 0; k < 3; ++k)
    p += bary[k] * m.vertices.row(m.faces(face, k)).transpose();
  return p;
}

/// Distance to a triangle by dense sampling of its barycentric coordinates, refined around the best sample.
double sampled_distance(const Mesh &m, int face, const Vector3d &p) {
  Vector3d centre(1 / 3.0, 1 / 3.0, 1 / 3.0);
  double best = 1e9;
  for (double step = 0.1; step > 1e-7; step *= 0.5) {
    const Vector3d from = centre;
    for (int i = -10; i <= 10; ++i)
      for (int k = -10; k <= 10; ++k) {
        const Vector3d b(from[0] + step * i, from[1] + step * k, 1 - from[0] - from[1] - step * (i + k));
        if (b.minCoeff() < 0)
          continue;
        const double d = (at(m, face, b) - p).norm();
        if (d < best) {
          best = d;
          centre = b;
        }
      }
  }
  return best;
}

} // namespace

TEST(RayScene, HitsASphereWhereItShould) {
  const Mesh ball = testing::sphere(1, {0, 0, 0}, 64, 128);
  const RayScene scene(ball);
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 200; ++i) {
    const Vector3d d = Vector3d(normal(random), normal(random), normal(random)).normalized(), origin = -3 * d;
    const auto hit = scene.cast(origin, d);
    ASSERT_TRUE(hit);
    EXPECT_NEAR(hit->distance, 2, 3e-3);
    EXPECT_NEAR((at(ball, hit->face, hit->barycentric) - (origin + hit->distance * d)).norm(), 0, 2e-6);
    const auto inner = scene.cast(origin, d, 2.5); // past the front: the back
    ASSERT_TRUE(inner);
    EXPECT_NEAR(inner->distance, 4, 3e-3);
    EXPECT_FALSE(scene.cast(origin, d, 0, 1.9));
    EXPECT_FALSE(scene.cast(origin, -d));
    EXPECT_TRUE(scene.occluded(origin, -origin));
    EXPECT_FALSE(scene.occluded(origin, 1.01 * origin / 3));
    EXPECT_FALSE(scene.occluded(origin, at(ball, hit->face, hit->barycentric))); // a point does not hide itself
  }
  EXPECT_FALSE(scene.occluded({0, 0, 2}, {0, 0, 2}));
}

TEST(RayScene, NoRaySlipsThroughCornersAndEdges) {
  const Mesh ball = testing::sphere(1, {0.3, 1, 0.2}, 40, 80);
  const RayScene scene(ball);
  const Vector3d centre(0.3, 1, 0.2);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(0, 1);
  int missed = 0, rays = 0;
  for (int f = 0; f < ball.faces.rows(); ++f)
    for (int k = 0; k < 6; ++k) {
      const Vector3d a = ball.vertices.row(ball.faces(f, k % 3)), b = ball.vertices.row(ball.faces(f, (k + 1) % 3));
      const Vector3d target = k < 3 ? a : (a + uniform(random) * (b - a)).eval();
      const Vector3d from = centre + (1.3 + uniform(random)) * (target - centre) +
                            0.2 * Vector3d(uniform(random), uniform(random), uniform(random));
      const double length = (target - from).norm();
      const auto outside = scene.cast(from, (target - from) / length);
      missed += !outside || std::abs(outside->distance - length) > 1e-9;
      const auto inside = scene.cast(centre, (target - centre).normalized());
      missed += !inside || std::abs(inside->distance - (target - centre).norm()) > 1e-9;
      missed += !scene.occluded(from, target + 0.2 * (target - from) / length);
      rays += 3;
    }
  EXPECT_GT(rays, 50000);
  EXPECT_EQ(missed, 0);
}

TEST(RayScene, ClosestPointIsTheClosest) {
  const Mesh body = testing::figure_surface(0.08);
  const RayScene scene(body);
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(-0.6, 0.6);
  for (int i = 0; i < 12; ++i) {
    const Vector3d p(uniform(random), 0.9 + uniform(random), 0.3 * uniform(random));
    const ClosestPoint c = scene.closest(p);
    EXPECT_NEAR(c.distance, (c.point - p).norm(), 1e-12);
    EXPECT_NEAR((at(body, c.face, c.barycentric) - c.point).norm(), 0, 1e-12);
    EXPECT_NEAR(c.barycentric.sum(), 1, 1e-12);
    EXPECT_GE(c.barycentric.minCoeff(), 0);
    double best = 1e9;
    for (int f = 0; f < body.faces.rows(); ++f)
      best = std::min(best, sampled_distance(body, f, p));
    EXPECT_NEAR(c.distance, best, 1e-6);
  }
}

TEST(RayScene, ClosestPointOfEveryRegionOfATriangle) {
  const Mesh m = testing::make_mesh({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}});
  const RayScene scene(m);
  const std::vector<std::pair<Vector3d, Vector3d>> expected = {
      {{-1, -1, 1}, {0, 0, 0}},    {{3, -1, 0}, {1, 0, 0}},      {{-1, 4, 0}, {0, 1, 0}},       {{0.4, -1, 0}, {0.4, 0, 0}},
      {{-1, 0.3, 0}, {0, 0.3, 0}}, {{1, 1, 0.5}, {0.5, 0.5, 0}}, {{0.2, 0.3, 9}, {0.2, 0.3, 0}}};
  for (const auto &[p, q] : expected)
    EXPECT_NEAR((scene.closest(p).point - q).norm(), 0, 1e-12);
}

TEST(RayScene, InvalidFacesAreNotThere) {
  const Mesh two = testing::join({testing::sphere(1), testing::sphere(0.5)});
  std::vector<std::uint8_t> valid(two.faces.rows(), 1);
  std::fill(valid.begin(), valid.begin() + two.faces.rows() / 2, 0);
  const RayScene scene(two, valid);
  EXPECT_NEAR(scene.cast({0, 0, 3}, {0, 0, -1})->distance, 2.5, 0.01);
  EXPECT_GE(scene.cast({0, 0, 3}, {0, 0, -1})->face, two.faces.rows() / 2);
  EXPECT_GE(scene.closest({0, 0, 1}).face, two.faces.rows() / 2);
}

TEST(RayScene, ManyThreadsGiveTheSameAnswers) {
  const Mesh body = testing::figure_surface(0.05);
  const RayScene scene(body), copy = scene;
  std::vector<double> one(500), four(500);
  const auto query = [&](int i) { return copy.closest({0.001 * i, 0.9 + 0.1 * std::sin(i), 0.4}).distance; };
  Context context;
  context.threads = 1;
  parallel_for(context, 500, [&](int i) { one[i] = query(i); });
  context.threads = 4;
  parallel_for(context, 500, [&](int i) { four[i] = query(i); });
  EXPECT_EQ(one, four);
}

TEST(ClosestOnTriangle, IsTheNearestPointInAnyNumberOfDimensions) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  const auto draw = [&](int n) -> Eigen::VectorXd { return Eigen::VectorXd::NullaryExpr(n, [&] { return normal(random); }); };
  for (int n : {2, 3, 9})
    for (int trial = 0; trial < 200; ++trial) {
      const Eigen::VectorXd p = 1.5 * draw(n), a = draw(n), b = draw(n), c = draw(n), ab = b - a, ac = c - a;
      const Eigen::Vector3d w =
          closest_on_triangle(ab.dot(p - a), ac.dot(p - a), ab.dot(p - b), ac.dot(p - b), ab.dot(p - c), ac.dot(p - c));
      EXPECT_GE(w.minCoeff(), 0);
      EXPECT_NEAR(w.sum(), 1, 1e-12);
      const double found = (w[0] * a + w[1] * b + w[2] * c - p).norm();
      for (int i = 0; i <= 12; ++i) // no other point of the triangle is nearer
        for (int j = 0; i + j <= 12; ++j)
          EXPECT_LE(found, ((12 - i - j) * a + i * b + j * c - 12 * p).norm() / 12 + 1e-12);
    }
}

TEST(RayScene, RefusesUnusableMeshesAndSurvivesDegenerateOnes) {
  EXPECT_THROW(RayScene{Mesh{}}, Error);
  Mesh m = testing::grid(1, 1, 2, 2);
  EXPECT_THROW(RayScene(m, {1}), std::invalid_argument);
  EXPECT_THROW(RayScene(m, std::vector<std::uint8_t>(8, 0)), Error);
  EXPECT_THROW(RayScene(m).closest({NAN, 0, 0}), std::invalid_argument);
  m.faces.row(0).setConstant(4);
  m.faces.row(1) << 0, 1, 2; // a line
  const ClosestPoint c = RayScene(m).closest({0.1, 0.5, 0.1});
  EXPECT_NEAR(c.distance, 0.5, 1e-9);
  m.vertices(0, 0) = NAN;
  EXPECT_THROW(RayScene{m}, Error);
  m.vertices(0, 0) = 1e30;
  EXPECT_THROW(RayScene{m}, Error);
}

TEST(RayScene, RefusesRaysThatAreNotFinite) {
  const RayScene scene(testing::grid(1, 1, 2, 2));
  const Eigen::Vector3d origin(0.1, 1, 0.1), down(0, -1, 0);
  ASSERT_TRUE(scene.cast(origin, down));
  for (const double bad : {std::nan(""), HUGE_VAL, -HUGE_VAL, 1e300, 1e30, -2e18}) {
    const Eigen::Vector3d broken(0, bad, 0);
    EXPECT_THROW(scene.cast(broken, down), std::invalid_argument);
    EXPECT_THROW(scene.cast(origin, broken), std::invalid_argument);
    EXPECT_THROW(scene.occluded(broken, origin), std::invalid_argument);
    EXPECT_THROW(scene.occluded(origin, broken), std::invalid_argument);
    EXPECT_THROW(scene.closest(broken), std::invalid_argument);
  }
  EXPECT_FALSE(scene.cast(origin, Eigen::Vector3d::Zero()));
  EXPECT_FALSE(scene.cast(Eigen::Vector3d(1e17, 1e17, 1e17), Eigen::Vector3d(1e-30, 0, 1e17)));
}

} // namespace doublet
