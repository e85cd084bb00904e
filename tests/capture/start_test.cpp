// A take that does not begin in the scan's pose.

#include "doublet/capture/start_frame.h"
#include "doublet/core/error.h"
#include "person_scene.h"

#include <gtest/gtest.h>

using namespace person_scene;

namespace start_test {

struct Logged {
  explicit Logged(int threads = 0) {
    context.threads = threads;
    context.log = [this](const std::string &line) { log += line + "\n"; };
  }
  bool said(const std::string &text) const { return log.find(text) != std::string::npos; }
  Context context;
  std::string log;
};

void turn(const Scene &scene, MatrixRM &dofs, int t, const char *name, double degrees) {
  dofs(t, scene.dof(name)) = degrees * kDegree;
}

/// (T, D): in the scan's pose up to frame 2, then arms up, knees bent and a turn.
MatrixRM raised_arms(const Scene &scene, int frames) {
  MatrixRM dofs = MatrixRM::Zero(frames, scene.actor.skeleton.dof_count());
  for (int t = 3; t < frames; ++t) {
    const int n = t - 2;
    turn(scene, dofs, t, "l_shoulder.z", 6 * n);
    turn(scene, dofs, t, "r_shoulder.z", -6 * n);
    turn(scene, dofs, t, "l_elbow.flex", 5 * n);
    turn(scene, dofs, t, "l_hip.x", -4 * n);
    turn(scene, dofs, t, "l_knee.flex", 6 * n);
    dofs(t, 0) = 0.015 * n;
    dofs(t, 3) = 5 * kDegree * n;
  }
  return dofs;
}

MatrixRM reversed(const MatrixRM &dofs) {
  return dofs.colwise().reverse();
}

double worst_joint_error(const Scene &scene, const CaptureResult &result, const MatrixRM &truth) {
  double worst = 0;
  for (size_t t = 0; t < result.performance.joints.size(); ++t)
    worst = std::max(
        worst, (result.performance.joints[t] - scene.joints(truth.row(result.performance.frames[t]))).rowwise().norm().mean());
  return worst;
}

CaptureResult capture(Scene &scene, const MatrixRM &dofs, const Context &context, const CaptureOptions &options = {}) {
  Masks film(scene.actor, scene.rig, tracker_scene::surfaces(scene.actor, dofs));
  return PerformanceCapture::create(options)->capture(scene.actor, scene.rig, film, nullptr, context);
}

TEST(Start, ATakeThatEndsInTheScansPoseIsTrackedBackFromThere) {
  Scene scene;
  constexpr int kFrames = 10;
  const MatrixRM dofs = reversed(raised_arms(scene, kFrames));
  CaptureOptions options;
  options.second_pass = false;
  Logged logged;
  const CaptureResult result = capture(scene, dofs, logged.context, options);
  EXPECT_GE(result.summary.start_frame, kFrames - 3);
  EXPECT_TRUE(logged.said("frame 0 is not in the scan's pose")) << logged.log;
  EXPECT_TRUE(logged.said("goes on from there, and back")) << logged.log;
  EXPECT_LT(worst_joint_error(scene, result, dofs), 0.02); // m; a pixel is 11 mm
  ASSERT_EQ(result.performance.frames.size(), size_t(kFrames));
  EXPECT_EQ(result.performance.frames.front(), 0);
  for (double overlap : result.summary.silhouette_iou)
    EXPECT_GT(overlap, 0.85);
}

TEST(SlowStart, ItsPoseIsFoundInATakeThatIsNeverInTheScans) {
  Scene scene;
  MatrixRM dofs = raised_arms(scene, 16).bottomRows(4);
  dofs.col(3).array() += 160 * kDegree; // with the back to where the scan faces
  CaptureOptions options;
  options.limbs.annealing.particles = 40;
  Logged logged;
  const CaptureResult result = capture(scene, dofs, logged.context, options);
  EXPECT_TRUE(logged.said("the pose was found in frame")) << logged.log;
  EXPECT_LT(worst_joint_error(scene, result, dofs), 0.03);
}

TEST(SlowStart, TheFrameThatIsAskedForIsTaken) {
  Scene scene;
  const MatrixRM dofs = reversed(raised_arms(scene, 8));
  CaptureOptions options;
  options.start_frame = 5;
  options.first_frame = 1;
  const CaptureResult result = capture(scene, dofs, {}, options);
  EXPECT_EQ(result.summary.start_frame, 5);
  EXPECT_LT(worst_joint_error(scene, result, dofs), 0.02);
}

TEST(Start, AFrameThatIsNotCapturedIsRefused) {
  Scene scene;
  CaptureOptions options;
  options.first_frame = 2;
  for (const int start : {1, 8, 100}) {
    options.start_frame = start;
    EXPECT_THROW(capture(scene, raised_arms(scene, 8), {}, options), std::invalid_argument);
  }
}

TEST(Start, NobodyWhoLooksLikeTheScanIsRefused) {
  Scene scene;
  struct Table : Masks {
    using Masks::Masks;
    Image mask(int camera, int frame) override {
      Image mask = Masks::mask(camera, frame);
      for (int y = 0; y < mask.height; ++y)
        for (int x = 0; x < mask.width; ++x)
          mask.at(x, y) = y > 0.6 * mask.height && y < 0.7 * mask.height ? 255 : 0;
      return mask;
    }
  } table(scene.actor, scene.rig, tracker_scene::surfaces(scene.actor, MatrixRM::Zero(3, scene.truth.size())));
  try {
    PerformanceCapture::create()->capture(scene.actor, scene.rig, table, nullptr, {});
    FAIL();
  } catch (const Error &error) {
    EXPECT_NE(std::string(error.what()).find("found none"), std::string::npos) << error.what();
  }
}

/// A feature whose place is the number of the frame.
struct FrameCounter : FeatureTracker {
  Features detect(const Image &image, const Image &) const override {
    return {{{static_cast<float>(image.at(0, 0, 0)), 7}}, MatrixRM::Zero(1, 4)};
  }
  std::vector<std::pair<int, int>> match(const Features &before, const Features &here, double) const override {
    if (before.points.empty() || here.points.empty())
      return {};
    return {{0, 0}};
  }
};

/// Nobody moves.
struct StillPose : PoseOptimizer {
  PoseEstimate optimize(const PoseProblem &problem, const Context &) override {
    PoseEstimate estimate;
    estimate.dofs = problem.start;
    return estimate;
  }
};
struct StillSurface : SurfaceRefiner {
  SurfaceEstimate refine(const SurfaceProblem &problem, const Context &) override { return {problem.base, 0, 0}; }
};

struct Numbered : Masks {
  using Masks::Masks;
  Image image(int camera, int frame) override {
    Image image(rig()[camera].width, rig()[camera].height, 3, static_cast<std::uint8_t>(frame));
    asked.push_back(frame);
    return image;
  }
  const CameraRig &rig() const { return *rig_; }
  const CameraRig *rig_ = nullptr;
  std::vector<int> asked;
};

TEST(SlowStart, MatchesAreWithTheFrameThatWasFilmedBefore) {
  Scene scene;
  constexpr int kFrames = 24;
  MatrixRM dofs = MatrixRM::Zero(kFrames, scene.truth.size());
  Numbered film(scene.actor, scene.rig, tracker_scene::surfaces(scene.actor, dofs));
  film.rig_ = &scene.rig;
  CaptureOptions options;
  options.start_frame = 20;
  options.second_pass = false;
  CaptureParts parts;
  parts.features = std::make_shared<FrameCounter>();
  parts.pose = std::make_shared<StillPose>();
  parts.surface = std::make_shared<StillSurface>();
  Logged logged(1); // `asked` is in order
  const CaptureResult result =
      PerformanceCapture::create(options, parts)->capture(scene.actor, scene.rig, film, nullptr, logged.context);
  ASSERT_EQ(result.observations.views.size(), static_cast<size_t>(kFrames));
  for (int t = 0; t < kFrames; ++t)
    for (const ViewObservation &view : result.observations.views[t]) {
      ASSERT_EQ(view.matches.size(), t > 0 ? 1u : 0u) << t;
      if (t > 0) {
        EXPECT_EQ(view.matches[0].previous.x(), t - 1);
        EXPECT_EQ(view.matches[0].current.x(), t);
      }
    }
  int jumps = 0;
  for (size_t i = 1; i < film.asked.size(); ++i)
    jumps += film.asked[i] < film.asked[i - 1];
  EXPECT_LE(jumps, 2); // back by stretches: a video is not decoded anew for every frame
}

TEST(StartFrame, IsFoundForAScanThatStandsElsewhere) {
  Scene scene;
  const MatrixRM dofs = reversed(raised_arms(scene, 16));
  Masks film(scene.actor, scene.rig, tracker_scene::surfaces(scene.actor, dofs));
  Mesh scan = scene.actor.mesh;
  const Eigen::RowVector3d away(0.7, 0, -0.4);
  scan.vertices.rowwise() += away;
  for (const int threads : {1, 3}) {
    Logged logged(threads);
    const StartFrame start = find_start_frame(scan, scene.rig, film, nullptr, logged.context);
    EXPECT_GE(start.frame, 13);
    EXPECT_GT(start.overlap, kScanPoseOverlap);
    EXPECT_LT(start.first_overlap, kScanPoseOverlap);
    EXPECT_LT((start.world_from_scan * Eigen::Vector3d(away.x(), 1, away.z()) - Eigen::Vector3d(0, 1, 0)).norm(), 0.03);
  }
}

TEST(StartFrame, IsTheFirstOneThatIsInTheScansPose) {
  Scene scene;
  Masks film(scene.actor, scene.rig, tracker_scene::surfaces(scene.actor, raised_arms(scene, 16)));
  const StartFrame start = find_start_frame(scene.actor.mesh, scene.rig, film, nullptr, {});
  EXPECT_EQ(start.frame, 0);
  EXPECT_EQ(start.overlap, start.first_overlap);
}

TEST(StartFrame, NoScanIsRefused) {
  Scene scene;
  Masks film(scene.actor, scene.rig, tracker_scene::surfaces(scene.actor, raised_arms(scene, 4)));
  EXPECT_THROW(find_start_frame({}, scene.rig, film, nullptr, {}), Error);
  scene.rig.pop_back();
  EXPECT_THROW(find_start_frame(scene.actor.mesh, scene.rig, film, nullptr, {}), std::invalid_argument);
}

} // namespace start_test
