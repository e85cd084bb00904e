#include "doublet/rays/surface_distance.h"

#include "doublet/core/error.h"
#include "support/figure.h"

#include <gtest/gtest.h>

#include <limits>

namespace doublet {

TEST(SurfaceDistance, ToASphereIsTheRadiusOff) {
  const Mesh ball = testing::sphere(0.5, {0, 0, 0}, 128, 256);
  Vertices points(3, 3);
  points << 1, 0, 0, 0, 0.2, 0, 0, 0, -0.5;
  const Eigen::VectorXd d = distances_to_surface(points, ball);
  EXPECT_NEAR(d[0], 0.5, 2e-4);
  EXPECT_NEAR(d[1], 0.3, 2e-4);
  EXPECT_NEAR(d[2], 0, 2e-4);
}

TEST(SurfaceDistance, DoesNotDependOnThreadsAndSkipsFaces) {
  const Mesh body = testing::figure_surface(0.05);
  const Vertices points = Vertices::Random(60000, 3);
  Context one, three;
  one.threads = 1;
  three.threads = 3;
  EXPECT_EQ(distances_to_surface(points, body, {}, one), distances_to_surface(points, body, {}, three));
  const Mesh two = testing::join({testing::sphere(0.5), testing::sphere(0.1)});
  std::vector<std::uint8_t> valid(two.faces.rows(), 1);
  std::fill(valid.begin(), valid.begin() + two.faces.rows() / 2, 0);
  Vertices point(1, 3);
  point << 0, 0.5, 0;
  EXPECT_NEAR(distances_to_surface(point, two, valid)[0], 0.4, 1e-6);
}

TEST(SurfaceDistance, StopsAndRefuses) {
  Context context;
  context.cancelled = [] { return true; };
  EXPECT_THROW(distances_to_surface(Vertices::Zero(3, 3), testing::sphere(1), {}, context), Cancelled);
  EXPECT_THROW(distances_to_surface(Vertices::Zero(3, 3), Mesh{}), Error);
  EXPECT_EQ(distances_to_surface(Vertices(0, 3), testing::sphere(1)).size(), 0);
  Vertices point(1, 3);
  point << std::numeric_limits<double>::quiet_NaN(), 0, 0;
  EXPECT_THROW(distances_to_surface(point, testing::sphere(1)), std::invalid_argument);
}

TEST(Visibility, CamerasSeeTheirSideOfASphere) {
  const Mesh ball = testing::sphere(0.4, {0, 0.9, 0}, 40, 80);
  const CameraRig ring = testing::camera_ring(4, 300);
  const auto one = visible_vertices(ball.vertices, ball.faces, {ring[0]}, 0.01);
  const auto all = visible_vertices(ball.vertices, ball.faces, ring, 0.01);
  for (int v = 0; v < ball.vertices.rows(); ++v) {
    const Eigen::Vector3d p = ball.vertices.row(v), normal = (p - Eigen::Vector3d(0, 0.9, 0)).normalized();
    const auto facing = [&](const Camera &camera) { return normal.dot((camera.centre() - p).normalized()); };
    double best = -1;
    for (const Camera &camera : ring)
      best = std::max(best, facing(camera));
    // The rim is a matter of a pixel: 7 mm here, the depth by which a sphere of 0.4 m has curved away where its normal is 0.19
    // off.
    if (facing(ring[0]) > 0.1 || facing(ring[0]) < -0.25) {
      EXPECT_EQ(one[v], facing(ring[0]) > 0);
    }
    if (best > 0.1 || best < -0.25) {
      EXPECT_EQ(all[v], best > 0);
    }
  }
}

TEST(Visibility, HiddenAndOutsideIsUnseen) {
  const Mesh m =
      testing::join({testing::sphere(0.4, {0, 0.9, 0}), testing::sphere(0.1, {0, 0.9, 0}), testing::sphere(0.1, {0, 9, 0})});
  const auto seen = visible_vertices(m.vertices, m.faces, testing::camera_ring(8, 300), 0.01);
  const int big = static_cast<int>(testing::sphere(0.4).vertices.rows());
  EXPECT_EQ(std::count(seen.begin() + big, seen.end(), 1), 0);
  EXPECT_TRUE(visible_vertices(Vertices(0, 3), Faces(0, 3), testing::camera_ring(), 0.01).empty());
}

} // namespace doublet
