#include "doublet/segment/fullness.h"
#include "tube.h"

#include <gtest/gtest.h>

using namespace doublet;

namespace {

/// The tube's side is cloth but for its upper quarter. `radius` (m) of each frame.
struct Scene {
  Mesh scan{tube::vertices([](double) { return tube::kRadius; }), tube::faces()};
  Segmentation segmentation;
  MeshSequence sequence;
  explicit Scene(const std::vector<std::function<double(double)>> &radius) {
    const Eigen::Index count = scan.vertices.rows();
    segmentation.clothness = Eigen::VectorXd::Zero(count);
    segmentation.region = Eigen::VectorXi::Constant(count, -1);
    segmentation.region_count = 1;
    for (Eigen::Index v = 0; v + 2 < count; ++v)
      if (scan.vertices(v, 1) < 0.75)
        segmentation.clothness[v] = 1, segmentation.region[v] = 0;
    sequence.faces = scan.faces;
    for (const auto &r : radius)
      sequence.frames.push_back(tube::vertices(r));
  }
  double at(const Eigen::VectorXd &fullness, double y) const {
    return fullness[static_cast<int>(y * (tube::kRings - 1)) * tube::kAround];
  }
};

double narrow(double) {
  return tube::kRadius;
}
double wide(double) {
  return 1.3 * tube::kRadius;
}
double flared(double y) { // 1.4 times at the hem, as in the scan from y = 0.7 on
  return tube::kRadius * (1 + 0.4 * std::clamp((0.7 - y) / 0.7, 0.0, 1.0));
}

} // namespace

TEST(Fullness, IsTheWidthThatAPartOfTheMotionShows) {
  const Scene scene({narrow, wide, wide, narrow});
  const Eigen::VectorXd fullness = estimate_fullness(scene.scan, {}, scene.segmentation, scene.sequence);
  EXPECT_NEAR(scene.at(fullness, 0.2), 1.3, 0.02);
  EXPECT_NEAR(scene.at(fullness, 0.4), 1.3, 0.02);
  EXPECT_EQ(scene.at(fullness, 0.9), 1.0); // rigid
  FullnessOptions half;
  half.quantile = 0.25; // only the narrow ones reach that
  EXPECT_NEAR(estimate_fullness(scene.scan, {}, scene.segmentation, scene.sequence, half).maxCoeff(), 1.0, 1e-6);
}

TEST(Fullness, FollowsTheFlare) {
  const Scene scene({flared});
  const Eigen::VectorXd fullness = estimate_fullness(scene.scan, {}, scene.segmentation, scene.sequence);
  for (double y : {0.2, 0.35, 0.5})
    EXPECT_NEAR(scene.at(fullness, y), flared(y) / tube::kRadius, 0.03) << y;
}

TEST(Fullness, LengthAlongGravityIsTheScans) {
  Scene scene({narrow});
  scene.sequence.frames[0].col(1) *= 1.5;
  EXPECT_NEAR(estimate_fullness(scene.scan, {}, scene.segmentation, scene.sequence).maxCoeff(), 1.0, 1e-5);
  scene.sequence.frames[0] = 0.8 * tube::vertices(narrow); // nor does cloth ever get narrower
  EXPECT_EQ(estimate_fullness(scene.scan, {}, scene.segmentation, scene.sequence).minCoeff(), 1.0);
}

TEST(Fullness, DoesNotDependOnThePoseOrTheThreads) {
  Scene scene({flared, wide});
  Context one, two;
  one.threads = 1, two.threads = 2;
  const Eigen::VectorXd before = estimate_fullness(scene.scan, {}, scene.segmentation, scene.sequence, {}, one);
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.8, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
  for (Vertices &frame : scene.sequence.frames)
    frame = (frame * turn.transpose()).rowwise() + Eigen::RowVector3d(3, -1, 2);
  EXPECT_LT((estimate_fullness(scene.scan, {}, scene.segmentation, scene.sequence, {}, one) - before).cwiseAbs().maxCoeff(),
            1e-9);
  EXPECT_EQ(estimate_fullness(scene.scan, {}, scene.segmentation, scene.sequence, {}, two),
            estimate_fullness(scene.scan, {}, scene.segmentation, scene.sequence, {}, one));
}

TEST(Fullness, SwitchedOffAndBadInput) {
  Scene scene({wide});
  FullnessOptions options;
  options.estimate = false;
  EXPECT_EQ(estimate_fullness(scene.scan, {}, scene.segmentation, scene.sequence, options).maxCoeff(), 1.0);
  options = {};
  options.quantile = 2;
  EXPECT_THROW(estimate_fullness(scene.scan, {}, scene.segmentation, scene.sequence, options), std::invalid_argument);
  scene.sequence.frames[0].conservativeResize(5, 3);
  EXPECT_THROW(estimate_fullness(scene.scan, {}, scene.segmentation, scene.sequence), std::invalid_argument);
  scene.sequence.frames.clear();
  EXPECT_THROW(estimate_fullness(scene.scan, {}, scene.segmentation, scene.sequence), std::invalid_argument);
}
