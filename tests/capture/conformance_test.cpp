#include "doublet/testing/capture_conformance.h"

#include "doublet/capture/parts/outline.h"
#include "tracker_scene.h"

#include <gtest/gtest.h>

namespace doublet {
namespace {

using tracker_scene::Frames;

/// Two frames of the figure, and what the first says about its pose.
struct Film {
  RiggedMesh actor = tracker_scene::figure();
  CameraRig rig = tracker_scene::ring(4);
  Frames frames{actor, rig, tracker_scene::surfaces(actor, tracker_scene::motion(actor, 2))};
  std::vector<Outline> outlines;
  PoseProblem pose;
  SurfaceProblem surface;

  Film() {
    for (int c = 0; c < static_cast<int>(rig.size()); ++c)
      outlines.push_back(trace_outline(frames.mask(c, 0)));
    const Eigen::Index vertices = actor.mesh.vertices.rows();
    pose.actor = surface.actor = &actor;
    pose.rig = surface.rig = &rig;
    pose.outlines = surface.outlines = &outlines;
    pose.offset = Vertices::Zero(vertices, 3);
    pose.reliability = surface.reliability = Eigen::VectorXd::Ones(vertices);
    pose.start = pose.predicted = Eigen::VectorXd::Constant(actor.skeleton.dof_count(), 0.02);
    surface.base = surface.skinned = pose_surface(actor, pose.start, {}).vertices;
  }
};

void expect_none(const std::vector<std::string> &violations) {
  for (const std::string &broken : violations)
    ADD_FAILURE() << broken;
}

TEST(CaptureConformance, OurPartsConform) {
  Film film;
  const Image image = film.frames.image(0, 0), mask = film.frames.mask(0, 0);
  expect_none(testing::frame_source_violations(film.frames));
  expect_none(testing::feature_tracker_violations(*FeatureTracker::create(), image, mask, 20));
  expect_none(testing::pose_optimizer_violations(*PoseOptimizer::create(), film.pose));
  expect_none(testing::surface_refiner_violations(*SurfaceRefiner::create(), film.surface));
  Image screen(64, 64, 3), actor = screen;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x)
      screen.at(x, y, 1) = 200, actor.at(x, y, x > 20 && x < 40 ? 2 : 1) = 200;
  expect_none(testing::silhouette_extractor_violations(*SilhouetteExtractor::create(ChromaKeyOptions{}), {screen}, actor));
  expect_none(testing::silhouette_extractor_violations(*SilhouetteExtractor::create(BackgroundOptions{}), {screen}, actor));
}

/// Counts its calls, and lets the count show.
class Restless : public FrameSource,
                 public SilhouetteExtractor,
                 public FeatureTracker,
                 public PoseOptimizer,
                 public SurfaceRefiner {
public:
  int frame_count() const override { return 2; }
  int camera_count() const override { return 1; }
  Image image(int, int) override { return Image(4, 4, 1, ++calls_); }
  Image mask(int, int) override { return Image(5, 4, 1, 7); }
  void train(int, const std::vector<Image> &) override {}
  Image extract(int, const Image &) const override { return Image(3, 3, 1, ++calls_); }
  Features detect(const Image &, const Image &) const override { return {{{-9.0f, ++calls_ * 100.0f}, {0, 0}}, MatrixRM(1, 1)}; }
  std::vector<std::pair<int, int>> match(const Features &, const Features &, double) const override { return {{0, 0}, {0, 0}}; }
  PoseEstimate optimize(const PoseProblem &, const Context &) override {
    return {Eigen::VectorXd::Constant(2, ++calls_), -1, 0, 0, 1};
  }
  SurfaceEstimate refine(const SurfaceProblem &, const Context &) override { return {Vertices::Constant(1, 3, ++calls_), -1, 0}; }

private:
  mutable std::uint8_t calls_ = 0;
};

TEST(CaptureConformance, TheKitsCatchWhatIsRestless) {
  const Film film;
  Restless all;
  const Image image(8, 8, 3), mask(8, 8, 1, 255);
  EXPECT_EQ(testing::frame_source_violations(all).size(), 4u);                         // channels, mask, sizes, another frame
  EXPECT_EQ(testing::silhouette_extractor_violations(all, {image}, image).size(), 4u); // untrained, mask, another, channels
  EXPECT_EQ(testing::feature_tracker_violations(all, image, mask, 20).size(), 4u);     // descriptors, others, outside, reach
  EXPECT_EQ(testing::pose_optimizer_violations(all, film.pose).size(), 3u);            // degrees of freedom, residuals, bits
  EXPECT_EQ(testing::surface_refiner_violations(all, film.surface).size(), 3u);        // vertices, residuals, bits
}

} // namespace
} // namespace doublet
