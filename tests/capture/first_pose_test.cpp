// The first frame: an actor who stands elsewhere, faces elsewhere and holds the limbs otherwise than in the scan.

#include "doublet/core/error.h"
#include "person_scene.h"

#include <gtest/gtest.h>

using namespace person_scene;

namespace first_pose_test {

struct Start {
  const char *name;
  double x, z, heading; // m, m, degrees
  bool other_limbs;
  int cameras;
  double zoom = 1; // > 1: the images cut the actor
};

const Start kStarts[] = {
    {"Turned60", 0, 0, 60, false, 8},  {"Turned67BetweenTwoHeadings", 0, 0, 67, false, 8}, {"AMetreAway", -0.8, 0.6, 0, false, 8},
    {"Both", 0.7, 0.7, -60, false, 8}, {"FourCameras", -0.7, 0.7, -60, true, 4},
};
const Start kMoreStarts[] = {
    {"BothAndOtherLimbs", 0.7, -0.7, 60, true, 8},
    {"SixteenCameras", -0.7, 0.7, 52, true, 16},
    {"CutByTheImages", 0.5, 0.3, 60, true, 8, 1.35},
};

class FirstPose : public ::testing::TestWithParam<Start> {};

TEST_P(FirstPose, IsFoundFromTheScanPose) {
  const Start &start = GetParam();
  Scene scene;
  scene.rig = doublet::testing::camera_ring(start.cameras, 320);
  for (Camera &camera : scene.rig)
    camera.K.topLeftCorner<2, 2>() *= 0.8 * start.zoom;
  scene.truth.head<4>() << start.x, 0.03, start.z, start.heading * kDegree;
  if (start.other_limbs)
    for (const auto &[name, degrees] : {std::pair{"l_shoulder.z", 15},
                                        {"r_shoulder.x", -12},
                                        {"l_elbow.flex", 20},
                                        {"r_hip.x", -10},
                                        {"r_knee.flex", 12},
                                        {"neck.x", 8}})
      scene.truth[scene.dof(name)] = degrees * kDegree;
  Masks film(scene.actor, scene.rig, tracker_scene::surfaces(scene.actor, scene.truth.transpose()));
  const auto result = PerformanceCapture::create()->capture(scene.actor, scene.rig, film, nullptr, scene.context);
  const double error = (result.performance.joints[0] - scene.joints(scene.truth)).rowwise().norm().mean();
  EXPECT_LT(error, 0.015); // m; a pixel is 9 mm
}

const auto name_of = [](const auto &start) { return start.param.name; };
INSTANTIATE_TEST_SUITE_P(Capture, FirstPose, ::testing::ValuesIn(kStarts), name_of);
INSTANTIATE_TEST_SUITE_P(SlowCapture, FirstPose, ::testing::ValuesIn(kMoreStarts), name_of);

TEST(FirstHeading, IsTheScansWhereFrontAndBackLookAlike) {
  Scene scene;
  Masks film(scene.actor, scene.rig, tracker_scene::surfaces(scene.actor, scene.truth.transpose()));
  const auto result = PerformanceCapture::create()->capture(scene.actor, scene.rig, film, nullptr, scene.context);
  EXPECT_LT(std::abs(result.performance.dofs(0, 3)), 3 * kDegree);
}

} // namespace first_pose_test
