#include "../../libcapture/src/calibration/person_bundle.h"

#include "doublet/capture/calibration_refinement.h"
#include "support/figure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace person_bundle_test {

using namespace doublet;
using detail::PersonBundle;

constexpr double kHeight = 1.7;
constexpr int kViews = 3, kMoments = 2, kOfCamera = 7;

/// Joints that nearly are where the cameras see them, with a keypoint, a tangent and a joint that fit nothing.
struct Scene {
  std::vector<std::vector<std::vector<Keypoint>>> seen; // [moment][view]
  PersonBundle bundle;

  Scene() {
    std::mt19937 random(5);
    std::normal_distribution<double> normal;
    const auto jitter = [&](double by) -> Eigen::Vector3d {
      return by * Eigen::Vector3d(normal(random), normal(random), normal(random));
    };
    bundle.rig = doublet::testing::camera_ring(kViews, 640);
    bundle.known_focal = {bundle.rig[0].K(0, 0) * 1.01, 0, 0};
    bundle.focal_error = 0.02;
    bundle.log_focal = 0.3;
    bundle.keypoint_error = 0.01;
    bundle.tangent_scale = 0.02;
    for (int k = 0; k < detail::kBoneLengths; ++k)
      bundle.log_lengths[k] = std::log(detail::kCalibrationLengths[k].share * kHeight) + 0.02 * normal(random);
    seen.resize(kMoments);
    for (auto &views : seen) {
      detail::JointPoints joints;
      for (int j = 0; j < kKeypoints; ++j)
        joints[j] = Eigen::Vector3d(j % 2 ? -0.15 : 0.15, 1.5 - 0.1 * j, 0) + jitter(0.03);
      for (const Camera &camera : bundle.rig) {
        views.emplace_back();
        for (const auto &joint : joints)
          views.back().push_back({camera.project(*joint + jitter(0.02)), 0.9});
      }
      views[0][3].pixel += Eigen::Vector2d(150, -80); // an outlier
      joints[11].reset();                             // not found
      bundle.joints.push_back(joints);
    }
    for (const auto &views : seen) {
      bundle.seen.emplace_back();
      for (const auto &keypoints : views)
        bundle.seen.back().push_back(keypoints.data());
    }
    const Eigen::Vector3d top(0.02, 1.7, 0.05), other(0.05, 1.68, 0.01);
    bundle.tangents = {{0, 1, bundle.rig[0].project(top), bundle.rig[1].project(other), 2.5},
                       {1, 2, bundle.rig[1].project(top), bundle.rig[2].project(top + Eigen::Vector3d(0, 0.2, 0)), 2.5}};
  }
};

/// With one of the unknowns moved, in the order of cost_gradient().
PersonBundle moved(PersonBundle bundle, int unknown, double by) {
  constexpr int kJoints = 3 * kKeypoints;
  if (unknown < kMoments * kJoints) {
    if (auto &joint = bundle.joints[unknown / kJoints][unknown % kJoints / 3])
      (*joint)[unknown % 3] += by;
    return bundle;
  }
  unknown -= kMoments * kJoints;
  if (unknown < kViews * kOfCamera) {
    Camera &camera = bundle.rig[unknown / kOfCamera];
    camera = stepped(camera, by * CameraStep::Unit(unknown % kOfCamera));
    return bundle;
  }
  unknown -= kViews * kOfCamera;
  (unknown < detail::kBoneLengths ? bundle.log_lengths[unknown] : bundle.log_focal) += by;
  return bundle;
}

TEST(PersonBundle, GradientEqualsFiniteDifferences) {
  constexpr double kStep = 1e-6;
  const Scene scene;
  const Eigen::VectorXd gradient = scene.bundle.cost_gradient(kHeight);
  ASSERT_EQ(gradient.size(), kMoments * 3 * kKeypoints + kViews * kOfCamera + detail::kBoneLengths + 1);
  int zeros = 0;
  for (int k = 0; k < gradient.size(); ++k) {
    const double ahead = moved(scene.bundle, k, kStep).cost(kHeight), behind = moved(scene.bundle, k, -kStep).cost(kHeight);
    EXPECT_NEAR(gradient[k], (ahead - behind) / (2 * kStep), 1e-5 * (1 + std::abs(gradient[k]))) << k;
    zeros += gradient[k] == 0;
  }
  EXPECT_EQ(zeros, kMoments * 3); // of the joint that was not found
}

} // namespace person_bundle_test
