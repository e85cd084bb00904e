#include "doublet/fit/parts/distance_field.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace doublet {
namespace {

TEST(NearestSeed, EqualsBruteForce) {
  std::mt19937 random(1);
  for (const auto &[width, height, chance] :
       {std::tuple{37, 23, 20}, std::tuple{1, 40, 5}, std::tuple{40, 1, 5}, std::tuple{16, 16, 2}}) {
    std::vector<std::uint8_t> seed(static_cast<std::size_t>(width) * height);
    for (auto &s : seed)
      s = random() % chance == 0;
    seed[random() % seed.size()] = 1;
    const std::vector<int> nearest = nearest_seed(width, height, seed);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        int best = 1 << 30;
        for (int v = 0; v < height; ++v)
          for (int u = 0; u < width; ++u)
            if (seed[v * width + u])
              best = std::min(best, (x - u) * (x - u) + (y - v) * (y - v));
        const int n = nearest[y * width + x];
        ASSERT_GE(n, 0);
        ASSERT_TRUE(seed[n]);
        const int u = n % width, v = n / width;
        ASSERT_EQ((x - u) * (x - u) + (y - v) * (y - v), best) << x << " " << y;
      }
  }
}

TEST(NearestSeed, NoSeedAndBadSize) {
  for (int n : nearest_seed(3, 2, std::vector<std::uint8_t>(6, 0)))
    EXPECT_EQ(n, -1);
  EXPECT_THROW(nearest_seed(3, 2, std::vector<std::uint8_t>(5, 0)), std::invalid_argument);
}

std::vector<Eigen::Vector2f> circle(float cx, float cy, float radius) {
  std::vector<Eigen::Vector2f> points;
  for (int i = 0; i < 400; ++i)
    points.emplace_back(cx + radius * std::cos(i * 0.0157f), cy + radius * std::sin(i * 0.0157f));
  return points;
}

TEST(DistanceField, MatchesTheCircleToHalfACell) {
  const DistanceField field(circle(60, 50, 30), {0, 0, 120, 100}, 2, 64);
  for (float y = 0; y <= 100; y += 3.3f)
    for (float x = 0; x <= 120; x += 3.7f) {
      const float truth = std::fabs(std::hypot(x - 60, y - 50) - 30);
      EXPECT_NEAR(field.distance(x, y), std::min(truth, 64.f), truth > 2 && truth < 28 ? 0.35f : 1.3f) << x << " " << y;
    }
}

TEST(DistanceField, IsExactAtTheNodesUpToTies) {
  const std::vector<Eigen::Vector2f> points = {{10.3f, 12.8f}, {31.6f, 7.1f}};
  const DistanceField field(points, {0, 0, 40, 30}, 2, 40);
  for (float y = 0; y <= 30; y += 2)
    for (float x = 0; x <= 40; x += 2) {
      const Eigen::Vector2f p(x, y);
      EXPECT_NEAR(field.distance(x, y), std::min((p - points[0]).norm(), (p - points[1]).norm()), 0.6f); // ties near the middle
    }
}

TEST(DistanceField, SeesContourJustOutsideTheBoxAndIsCutOff) {
  const DistanceField field({{-5, 10}}, {0, 0, 20, 20}, 2, 16);
  EXPECT_NEAR(field.distance(0, 10), 5, 0.01);
  EXPECT_NEAR(field.distance(20, 10), 16, 0.01); // 25 away
  // Below the box: the value there plus the way to it.
  EXPECT_NEAR(field.distance(0, 23), std::hypot(5, 10) + 3, 0.01);
  EXPECT_NEAR(field.distance(1000, 1000), 16, 1e-3);
  EXPECT_NEAR(DistanceField({}, {0, 0, 4, 4}, 2, 16).distance(1, 1), 16, 1e-3);      // no contour
  EXPECT_NEAR(DistanceField({{3, 0}}, {0, 0, 0, 0}, 2, 16).distance(0, 0), 3, 0.01); // one node
}

TEST(DistanceField, RefusesNonsense) {
  EXPECT_THROW(DistanceField({}, {0, 0, 4, 4}, 0, 16), std::invalid_argument);
  EXPECT_THROW(DistanceField({}, {0, 0, 4, 4}, 1, 0), std::invalid_argument);
  EXPECT_THROW(DistanceField({}, {4, 0, 0, 4}, 1, 1), std::invalid_argument);
}

} // namespace
} // namespace doublet
