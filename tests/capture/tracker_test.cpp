// The tracker on rendered motion: pose, surface, missing cameras, determinism, swapped parts, wrong input.

#include "tracker_scene.h"

#include "doublet/capture/measured_observations.h"
#include "doublet/core/error.h"

#include <atomic>
#include <gtest/gtest.h>

using namespace doublet;
using namespace tracker_scene;

namespace tracker_test {

constexpr int kFrames = 12;

CaptureResult track(const RiggedMesh &actor, FrameSource &frames, const CameraRig &rig, const CaptureOptions &options = {},
                    int threads = 2, const CaptureParts &parts = {}) {
  Context context;
  context.threads = threads;
  return PerformanceCapture::create(options, parts)->capture(actor, rig, frames, nullptr, context);
}

/// Mean distance of captured to true surfaces, m.
double surface_error(const CaptureResult &result, const std::vector<Vertices> &truth) {
  double sum = 0;
  for (size_t t = 0; t < truth.size(); ++t)
    sum += mean_distance(result.performance.surface.frames[t], truth[t]) / truth.size();
  return sum;
}

double joint_error(const CaptureResult &result, const RiggedMesh &actor, const MatrixRM &truth) {
  double sum = 0;
  for (int t = 0; t < truth.rows(); ++t)
    sum += mean_distance(result.performance.joints[t],
                         joint_positions(actor.skeleton, forward_kinematics(actor.skeleton, truth.row(t)))) /
           truth.rows();
  return sum;
}

TEST(Tracker, FollowsAKnownMotion) {
  const RiggedMesh actor = figure();
  const CameraRig rig = ring();
  const MatrixRM dofs = motion(actor, kFrames);
  const auto truth = surfaces(actor, dofs);
  Frames frames(actor, rig, truth);
  const CaptureResult result = track(actor, frames, rig);
  EXPECT_LT(joint_error(result, actor, dofs), 0.005); // a pixel is 11 mm on the figure
  EXPECT_LT(surface_error(result, truth), 0.008);
  for (double iou : result.summary.silhouette_iou)
    EXPECT_GT(iou, 0.96);
  EXPECT_EQ(result.performance.frames.size(), size_t(kFrames));
  EXPECT_EQ(result.performance.dofs.rows(), kFrames);
  EXPECT_EQ(result.observations.views.size(), size_t(kFrames));
  EXPECT_TRUE(result.observations.views[0][0].matches.empty());
  EXPECT_GT(result.observations.views[5][0].matches.size(), 5u);
  EXPECT_GT(result.observations.views[5][0].contour.size(), 100u);
}

TEST(Tracker, FollowsWithSilhouettesAlone) {
  const RiggedMesh actor = figure();
  const CameraRig rig = ring();
  const MatrixRM dofs = motion(actor, kFrames);
  Frames frames(actor, rig, surfaces(actor, dofs));
  CaptureOptions options;
  options.use_sift = false;
  const CaptureResult result = track(actor, frames, rig, options);
  EXPECT_LT(joint_error(result, actor, dofs), 0.008);
  for (const auto &views : result.observations.views)
    for (const ViewObservation &view : views)
      EXPECT_TRUE(view.matches.empty());
}

TEST(SlowTracker, GoesOnWhenCamerasDropOut) {
  const RiggedMesh actor = figure();
  const CameraRig rig = ring();
  const MatrixRM dofs = motion(actor, kFrames);
  Frames frames(actor, rig, surfaces(actor, dofs));
  frames.missing = [](int camera, int frame) { return camera < 3 && frame >= 4 && frame < 8; };
  const CaptureResult result = track(actor, frames, rig);
  EXPECT_LT(joint_error(result, actor, dofs), 0.008);
  EXPECT_EQ(result.summary.views[3], 8);
  EXPECT_EQ(result.summary.views[4], 5);
  EXPECT_TRUE(result.observations.views[5][0].contour.empty());
  frames.missing = [](int, int frame) { return frame == 2; };
  EXPECT_THROW(track(actor, frames, rig), Error);
}

TEST(Tracker, FindsTheActorElsewhereInTheFirstFrame) {
  const RiggedMesh actor = figure();
  const CameraRig rig = ring();
  MatrixRM dofs = MatrixRM::Zero(1, actor.skeleton.dof_count());
  dofs.row(0).head(5) << 0.25, 0.05, -0.2, 0.9, 0; // 0.32 m and 52 degrees
  Frames frames(actor, rig, surfaces(actor, dofs));
  EXPECT_LT(joint_error(track(actor, frames, rig), actor, dofs), 0.012);
}

TEST(SlowTracker, ToleratesAnActorPartlyOutsideTheImages) {
  const RiggedMesh actor = figure();
  CameraRig rig = ring();
  for (size_t c = 0; c < rig.size(); c += 2)
    rig[c].K(1, 2) -= 70; // the upper end leaves half of the images
  const MatrixRM dofs = motion(actor, kFrames);
  Frames frames(actor, rig, surfaces(actor, dofs));
  EXPECT_LT(joint_error(track(actor, frames, rig), actor, dofs), 0.012);
}

TEST(Tracker, RefinementFindsABulge) {
  const RiggedMesh actor = figure();
  const CameraRig rig = ring();
  MatrixRM dofs = MatrixRM::Zero(8, actor.skeleton.dof_count());
  Vertices bulge = Vertices::Zero(actor.mesh.vertices.rows(), 3);
  const Vertices normals = vertex_normals(actor.mesh.vertices, actor.mesh.faces);
  for (int i = 0; i < bulge.rows(); ++i)
    bulge.row(i) = 0.05 * std::exp(-std::pow((actor.mesh.vertices(i, 1) - 0.8) / 0.15, 2)) * normals.row(i);
  std::vector<Vertices> truth;
  for (int t = 0; t < dofs.rows(); ++t)
    truth.push_back(pose_surface(actor, dofs.row(t), bulge * (t / 7.0)).vertices);
  Frames frames(actor, rig, truth);
  CaptureOptions options;
  options.refine_cameras = false; // nothing but the bulge moves: cameras could be taken for what moved
  const CaptureResult result = track(actor, frames, rig, options);
  const Vertices across = vertex_normals(truth.back(), actor.mesh.faces);
  double left = 0, moved = 0;
  for (int i = 0; i < bulge.rows(); ++i)
    if (bulge.row(i).norm() > 0.02) {
      left += std::abs((result.performance.surface.frames.back().row(i) - truth.back().row(i)).dot(across.row(i)));
      moved += bulge.row(i).norm();
    }
  EXPECT_LT(left, 0.25 * moved);                      // of 3.7 cm on average; a pixel is 1.1 cm
  EXPECT_LT(joint_error(result, actor, dofs), 0.006); // the bulge is no motion of the skeleton
}

TEST(Tracker, SameBitsForAnyNumberOfThreads) {
  const RiggedMesh actor = figure();
  const CameraRig rig = ring();
  Frames frames(actor, rig, surfaces(actor, motion(actor, 3)));
  const CaptureResult a = track(actor, frames, rig, {}, 1), b = track(actor, frames, rig, {}, 3);
  EXPECT_EQ(a.performance.dofs, b.performance.dofs);
  for (size_t t = 0; t < 3; ++t)
    EXPECT_EQ(a.performance.surface.frames[t], b.performance.surface.frames[t]);
  EXPECT_EQ(a.summary.silhouette_iou, b.summary.silhouette_iou);
  ASSERT_EQ(a.observations.views[2][2].matches.size(), b.observations.views[2][2].matches.size());
}

TEST(Tracker, ItsObservationsAreMeasuredWithoutIt) {
  const RiggedMesh actor = figure();
  const CameraRig rig = ring(3);
  Frames frames(actor, rig, surfaces(actor, motion(actor, 3)));
  CaptureOptions options;
  options.refine_cameras = false;
  const auto tracker = FeatureTracker::create();
  const Observations captured = track(actor, frames, rig, options).observations,
                     measured = measure_observations(rig, frames, nullptr, {}, tracker.get());
  EXPECT_EQ(measured.frames, captured.frames);
  EXPECT_EQ(measured.cameras.size(), rig.size());
  ASSERT_EQ(measured.views.size(), captured.views.size());
  for (size_t t = 0; t < 3; ++t)
    for (size_t v = 0; v < rig.size(); ++v) {
      const ViewObservation &ours = captured.views[t][v], &theirs = measured.views[t][v];
      EXPECT_EQ(theirs.contour, ours.contour);
      ASSERT_EQ(theirs.matches.size(), ours.matches.size());
      EXPECT_EQ(theirs.matches.empty(), t == 0);
      for (size_t i = 0; i < ours.matches.size(); ++i) {
        EXPECT_EQ(theirs.matches[i].previous, ours.matches[i].previous);
        EXPECT_EQ(theirs.matches[i].current, ours.matches[i].current);
      }
    }
  const Observations some = measure_observations(rig, frames, nullptr, {0, 2}, nullptr);
  EXPECT_EQ(some.frames, (std::vector<int>{0, 2}));
  EXPECT_EQ(some.views[1][1].contour, captured.views[2][1].contour);
  EXPECT_TRUE(some.views[1][1].matches.empty());
  for (const std::vector<int> &wrong : {std::vector<int>{2, 0}, {0, 3}, {-1}, {1, 1}})
    EXPECT_THROW(measure_observations(rig, frames, nullptr, wrong, nullptr), std::invalid_argument);
  EXPECT_THROW(measure_observations(ring(2), frames, nullptr, {}, nullptr), std::invalid_argument);
  frames.missing = [](int, int frame) { return frame == 1; };
  EXPECT_THROW(measure_observations(rig, frames, nullptr, {}, nullptr), Error);
}

TEST(Tracker, EveryPieceCanBeSwapped) {
  struct NoFeatures : FeatureTracker {
    mutable std::atomic<int> calls = 0;
    Features detect(const Image &, const Image &) const override {
      ++calls;
      return {{{50, 50}}, MatrixRM::Zero(1, 4)};
    }
    std::vector<std::pair<int, int>> match(const Features &, const Features &, double) const override { return {{0, 0}}; }
  };
  struct FixedPose : PoseOptimizer {
    PoseEstimate optimize(const PoseProblem &problem, const Context &) override {
      PoseEstimate estimate;
      estimate.dofs = Eigen::VectorXd::Constant(problem.start.size(), 0.01);
      return estimate;
    }
  };
  struct Shifted : SurfaceRefiner {
    SurfaceEstimate refine(const SurfaceProblem &problem, const Context &) override {
      return {problem.skinned.rowwise() + Eigen::RowVector3d(0, 0, 0.02), 0, 0};
    }
  };
  const RiggedMesh actor = figure();
  const CameraRig rig = ring(4);
  Frames frames(actor, rig, surfaces(actor, MatrixRM::Zero(2, actor.skeleton.dof_count())));
  CaptureParts parts;
  const auto features = std::make_shared<NoFeatures>();
  parts.features = features;
  parts.pose = std::make_shared<FixedPose>();
  parts.surface = std::make_shared<Shifted>();
  const CaptureResult result = track(actor, frames, rig, {}, 2, parts);
  EXPECT_EQ(features->calls, 8);
  EXPECT_EQ(result.observations.views[1][0].matches.size(), 1u);
  EXPECT_NEAR((result.performance.dofs.array() - 0.01).abs().maxCoeff(), 0, 1e-12);
  const Vertices skinned = pose_surface(actor, result.performance.dofs.row(1), {}).vertices;
  EXPECT_NEAR((result.performance.surface.frames[1] - skinned).col(2).mean(), 0.02, 1e-9);
}

TEST(Tracker, SaysWhatIsWrong) {
  const RiggedMesh actor = figure();
  const CameraRig rig = ring(4);
  Frames frames(actor, rig, surfaces(actor, MatrixRM::Zero(3, actor.skeleton.dof_count())));
  CaptureOptions options;
  options.frame_count = 4;
  EXPECT_THROW(track(actor, frames, rig, options), std::invalid_argument);
  EXPECT_THROW(track(actor, frames, ring(3)), std::invalid_argument);
  CameraRig other = rig;
  other[1].width = 100;
  EXPECT_THROW(track(actor, frames, other), Error);
  RiggedMesh broken = actor;
  broken.weights.conservativeResize(5, 3);
  EXPECT_THROW(track(broken, frames, rig), std::invalid_argument);
  broken = actor;
  broken.mesh.vertices(3, 1) = std::nan("");
  EXPECT_THROW(track(broken, frames, rig), Error);
  options = {};
  options.pose.scale_end = 0;
  EXPECT_THROW(PerformanceCapture::create(options), std::invalid_argument);
  options = {};
  options.smooth_window = 4;
  EXPECT_THROW(PerformanceCapture::create(options), std::invalid_argument);
}

TEST(Tracker, StopsWhenAsked) {
  const RiggedMesh actor = figure();
  const CameraRig rig = ring(4);
  Frames frames(actor, rig, surfaces(actor, motion(actor, 6)));
  Context context;
  double reached = 0;
  context.progress = [&](const std::string &stage, double fraction) {
    EXPECT_EQ(stage, "capture");
    reached = fraction;
  };
  context.cancelled = [&] { return reached > 0.3; };
  EXPECT_THROW(PerformanceCapture::create()->capture(actor, rig, frames, nullptr, context), Cancelled);
  EXPECT_NEAR(reached, 2.0 / 6, 1e-9);
}

} // namespace tracker_test
