#include "doublet/core/camera.h"

#include "doublet/core/error.h"
#include "support/figure.h"

#include <gtest/gtest.h>

#include <limits>

namespace doublet {

namespace {

Camera lens() {
  Camera camera = testing::look_at({1, 1.5, 3}, {0.1, 0.9, 0}, 800, 1000, 800);
  camera.K(0, 1) = 3; // skew
  camera.distortion << -0.21, 0.09, 1e-3, -2e-3, -0.01;
  return camera;
}

} // namespace

TEST(Camera, ProjectsWithOpenCvsConventions) {
  Camera camera;
  camera.K << 500, 0, 320, 0, 510, 240, 0, 0, 1;
  EXPECT_NEAR((camera.project({0, 0, 2}) - Eigen::Vector2d(320, 240)).norm(), 0, 1e-12);
  EXPECT_NEAR((camera.project({1, 0.5, 2}) - Eigen::Vector2d(570, 367.5)).norm(), 0, 1e-12); // right and down
  // Brown's model by hand at the normalised point (0.5, 0.25), r^2 = 0.3125.
  camera.distortion << 0.1, 0.01, 0.002, 0.003, 0.001;
  const double radial = 1 + 0.1 * 0.3125 + 0.01 * 0.09765625 + 0.001 * 0.030517578125;
  const double x = 0.5 * radial + 2 * 0.002 * 0.125 + 0.003 * (0.3125 + 2 * 0.25);
  const double y = 0.25 * radial + 0.002 * (0.3125 + 2 * 0.0625) + 2 * 0.003 * 0.125;
  EXPECT_NEAR((camera.project({1, 0.5, 2}) - Eigen::Vector2d(500 * x + 320, 510 * y + 240)).norm(), 0, 1e-9);
}

TEST(Camera, JacobianMatchesFiniteDifferences) {
  const Camera camera = lens();
  const Eigen::Vector3d p(0.3, 1.2, 0.4);
  const auto J = camera.project_jacobian(p);
  for (int k = 0; k < 3; ++k) {
    const Eigen::Vector3d h = 1e-6 * Eigen::Vector3d::Unit(k);
    const Eigen::Vector2d numeric = (camera.project(p + h) - camera.project(p - h)) / 2e-6;
    EXPECT_NEAR((J.col(k) - numeric).norm(), 0, 1e-5);
  }
}

TEST(Camera, RayGoesThroughThePixelItCameFrom) {
  const Camera camera = lens();
  for (const Eigen::Vector2d &pixel : {Eigen::Vector2d(0, 0), Eigen::Vector2d(999, 799), Eigen::Vector2d(499.5, 120)}) {
    const Eigen::Vector3d direction = camera.ray_direction(pixel);
    EXPECT_NEAR(direction.norm(), 1, 1e-12);
    const Eigen::Vector3d point = camera.centre() + 2.7 * direction;
    EXPECT_GT(camera.depth(point), 0);
    EXPECT_NEAR((camera.project(point) - pixel).norm(), 0, 1e-7);
  }
}

TEST(Camera, ResizingMovesPixelsWithTheImagesEdges) {
  const Camera camera = lens(), half = camera.resized(500, 400);
  const Eigen::Vector3d p(0.2, 1, 0.1);
  const Eigen::Vector2d expected = (camera.project(p).array() + 0.5) / 2 - 0.5;
  EXPECT_NEAR((half.project(p) - expected).norm(), 0, 1e-9);
  EXPECT_EQ(half.width, 500);
  EXPECT_THROW(camera.resized(0, 10), std::invalid_argument);
}

TEST(Camera, ValidationNamesCameraAndFault) {
  const auto message = [](const Camera &camera) -> std::string {
    try {
      validate_camera(camera, "calibration.yml");
    } catch (const Error &error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(message(lens()), "");
  Camera camera = lens();
  camera.R.row(0) *= -1; // a mirror
  EXPECT_NE(message(camera).find("calibration.yml: camera 'cam': expected R"), std::string::npos);
  camera = lens();
  camera.K(0, 0) = -1;
  EXPECT_NE(message(camera).find("focal"), std::string::npos);
  camera = lens();
  camera.t.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(message(camera).find("NaN"), std::string::npos);
  camera = lens();
  camera.width = 0;
  EXPECT_NE(message(camera).find("size"), std::string::npos);
  camera = lens();
  camera.K(2, 2) = 2;
  EXPECT_NE(message(camera).find("0 0 1"), std::string::npos);
}

} // namespace doublet
