// A point of the person from what several cameras say of it.

#include "doublet/capture/triangulation.h"
#include "support/figure.h"

#include <gtest/gtest.h>

#include <limits>

namespace triangulation_test {

using namespace doublet;

/// Six cameras of 640 pixels: two without a lens, two of Brown's extended one, two fisheyes.
std::vector<CalibratedCamera> cameras() {
  std::vector<CalibratedCamera> result;
  for (Camera camera : doublet::testing::camera_ring(6, 640)) {
    Lens lens;
    switch (result.size() / 2) {
    case 0:
      camera.distortion << -0.1, 0.05, 0.001, -0.002, 0.01;
      break;
    case 1:
      lens.distortion.resize(8);
      lens.distortion << -0.12, 0.03, 0.001, -0.001, 0.01, 0.02, -0.01, 0.003;
      break;
    default:
      lens.fisheye = true;
      lens.distortion = Eigen::Vector4d(0.02, -0.01, 0.003, 0.001);
    }
    result.push_back({camera, lens});
  }
  return result;
}

const Eigen::Vector3d kPoint(0.21, 1.3, -0.17);

std::vector<Keypoint> keypoints(const std::vector<CalibratedCamera> &seen_by, const Eigen::Vector3d &point = kPoint) {
  std::vector<Keypoint> seen;
  for (const CalibratedCamera &camera : seen_by)
    seen.push_back({camera.project(point), 0.9});
  return seen;
}

TEST(Triangulation, DerivativesAreThoseOfTheProjection) {
  constexpr double kStep = 1e-5;
  for (const CalibratedCamera &camera : cameras()) {
    const Eigen::Matrix<double, 2, 3> jacobian = camera.project_jacobian(kPoint);
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d step = kStep * Eigen::Vector3d::Unit(k);
      const Eigen::Vector2d slope = (camera.project(kPoint + step) - camera.project(kPoint - step)) / (2 * kStep);
      EXPECT_LT((jacobian.col(k) - slope).norm(), 1e-4) << camera.camera.name << " " << k; // of about 270 pixels a metre
    }
  }
}

TEST(Triangulation, FindsThePointThroughEveryLens) {
  const auto rig = cameras();
  const auto found = triangulate(rig, keypoints(rig));
  ASSERT_TRUE(found);
  EXPECT_LT((*found - kPoint).norm(), 1e-6);
}

TEST(Triangulation, CamerasThatExchangeLeftAndRightAreOutvoted) {
  const auto rig = cameras();
  std::vector<Keypoint> seen = keypoints(rig);
  const std::vector<Keypoint> other = keypoints(rig, {-0.21, 1.3, -0.17});
  seen[1] = other[1];
  seen[4] = other[4];
  const auto found = triangulate(rig, seen);
  ASSERT_TRUE(found);
  EXPECT_LT((*found - kPoint).norm(), 1e-6);
}

TEST(Triangulation, IsTheMeanOfWhatIsMeasured) {
  const auto rig = cameras();
  std::vector<Keypoint> seen = keypoints(rig);
  for (std::size_t c = 0; c < seen.size(); ++c)
    seen[c].pixel += Eigen::Vector2d(c % 2 ? 3 : -3, c % 3 ? 2 : -4);
  const auto found = triangulate(rig, seen);
  ASSERT_TRUE(found);
  EXPECT_LT((*found - kPoint).norm(), 0.02); // a pixel is 4 mm
  const auto wrong = [&](const Eigen::Vector3d &point) {
    double sum = 0;
    for (std::size_t c = 0; c < rig.size(); ++c)
      sum += (rig[c].project(point) - seen[c].pixel).squaredNorm();
    return sum;
  };
  for (int k = 0; k < 3; ++k)
    for (const double step : {-1e-4, 1e-4})
      EXPECT_GT(wrong(*found + step * Eigen::Vector3d::Unit(k)), wrong(*found)); // nowhere near are squares less
}

TEST(Triangulation, WhatIsUnsureOrNoNumberDoesNotCount) {
  const auto rig = cameras();
  std::vector<Keypoint> seen = keypoints(rig);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  seen[0] = {{nan, nan}, 0.9};
  seen[2].pixel.x() += 8; // within what agrees: it would pull
  seen[2].confidence = 0.2;
  const auto found = triangulate(rig, seen);
  ASSERT_TRUE(found);
  EXPECT_LT((*found - kPoint).norm(), 1e-6);
}

TEST(Triangulation, IsNoneWhereNoTwoAgree) {
  const auto rig = cameras();
  std::vector<Keypoint> seen = keypoints(rig);
  for (std::size_t c = 1; c < seen.size(); ++c)
    seen[c].confidence = 0;
  EXPECT_FALSE(triangulate(rig, seen)); // one alone
  const std::vector<CalibratedCamera> two(rig.begin(), rig.begin() + 2);
  EXPECT_FALSE(triangulate(two, {seen[0], {{seen[1].pixel.x(), seen[1].pixel.y() + 200}, 0.9}}));
  EXPECT_FALSE(triangulate({}, {}));
}

TEST(Triangulation, RaysThatMeetBehindTheCamerasAreNoPoint) {
  std::vector<CalibratedCamera> two;
  for (const double side : {-0.3, 0.3})
    two.push_back({doublet::testing::look_at({side, 1, 3}, {2 * side, 1, 0}, 900, 640, 640, "cam"), {}});
  const Keypoint middle{{319.5, 319.5}, 0.9}; // they look apart: their rays meet behind them
  EXPECT_FALSE(triangulate(two, {middle, middle}));
}

TEST(Triangulation, OneKeypointACamera) {
  const auto rig = cameras();
  EXPECT_THROW(triangulate(rig, {{{1, 2}, 0.9}}), std::invalid_argument);
}

} // namespace triangulation_test
