#include "doublet/testing/capture_conformance.h"

#include "doublet/capture/outline.h"
#include "tracker_scene.h"

#include <gtest/gtest.h>

namespace doublet {
namespace conformance_test {

using tracker_scene::Frames;

/// Two frames of the figure, and what the first says about its pose.
struct Film {
  RiggedMesh actor = tracker_scene::figure();
  CameraRig rig = tracker_scene::ring(4);
  Frames frames{actor, rig, tracker_scene::surfaces(actor, tracker_scene::motion(actor, 2))};
  std::vector<Outline> outlines;
  PoseProblem pose;
  SurfaceProblem surface;
  std::vector<Image> masks;
  LimbProblem limbs;

  Film() {
    for (int c = 0; c < static_cast<int>(rig.size()); ++c) {
      masks.push_back(frames.mask(c, 0));
      outlines.push_back(trace_outline(masks.back()));
    }
    const Eigen::Index vertices = actor.mesh.vertices.rows();
    pose.actor = surface.actor = limbs.actor = &actor;
    pose.rig = surface.rig = limbs.rig = &rig;
    limbs.masks = &masks;
    pose.outlines = surface.outlines = &outlines;
    pose.offset = Vertices::Zero(vertices, 3);
    pose.reliability = surface.reliability = limbs.reliability = Eigen::VectorXd::Ones(vertices);
    pose.start = pose.predicted = limbs.predicted = Eigen::VectorXd::Constant(actor.skeleton.dof_count(), 0.02);
    surface.base = surface.skinned = pose_surface(actor, pose.start, {}).vertices;
  }
  std::vector<Limb> lost() const { return {find_limbs(actor.skeleton).front()}; }
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
  expect_none(testing::limb_search_violations(*LimbSearch::create(), film.limbs, film.pose.start, film.lost()));
  expect_none(testing::performance_capture_violations(*PerformanceCapture::create(), film.actor, film.rig, film.frames));
  Image screen(64, 64, 3), actor = screen;
  for (int y = 0; y < 64; ++y)
    for (int x = 0; x < 64; ++x)
      screen.at(x, y, 1) = 200, actor.at(x, y, x > 20 && x < 40 ? 2 : 1) = 200;
  expect_none(testing::silhouette_extractor_violations(*SilhouetteExtractor::create(ChromaKeyOptions{}), {screen}, actor));
  expect_none(testing::silhouette_extractor_violations(*SilhouetteExtractor::create(BackgroundOptions{}), {screen}, actor));
}

TEST(CaptureConformance, OurPartsRefuseProblemsOfAnotherActor) {
  const Film film;
  PoseProblem pose = film.pose;
  pose.predicted.conservativeResize(3);
  EXPECT_THROW(PoseOptimizer::create()->optimize(pose, {}), std::invalid_argument);
  pose = film.pose;
  pose.reliability.conservativeResize(3);
  EXPECT_THROW(PoseOptimizer::create()->optimize(pose, {}), std::invalid_argument);
  pose = film.pose;
  pose.tracks.push_back({99, {0, Eigen::Vector3d(1, 0, 0)}, Eigen::Vector2d(0, 0)});
  EXPECT_THROW(PoseOptimizer::create()->optimize(pose, {}), std::invalid_argument);
  SurfaceProblem surface = film.surface;
  surface.base.conservativeResize(3, 3);
  EXPECT_THROW(SurfaceRefiner::create()->refine(surface, {}), std::invalid_argument);
}

/// Counts its calls, and lets the count show.
class Restless : public FrameSource,
                 public SilhouetteExtractor,
                 public FeatureTracker,
                 public PoseOptimizer,
                 public SurfaceRefiner,
                 public LimbSearch,
                 public PerformanceCapture {
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
  using SilhouetteExtractor::refine;
  SurfaceEstimate refine(const SurfaceProblem &, const Context &) override { return {Vertices::Constant(1, 3, ++calls_), -1, 0}; }
  Eigen::VectorXd search(const LimbProblem &, const Eigen::VectorXd &dofs, const std::vector<Limb> &, const Context &) override {
    return Eigen::VectorXd::Constant(dofs.size(), 100.0 + ++calls_);
  }
  CaptureResult capture(const RiggedMesh &actor, const CameraRig &, FrameSource &, const SilhouetteExtractor *,
                        const Context &) override {
    CaptureResult result;
    result.performance.surface = {actor.mesh.faces, {Vertices::Constant(actor.mesh.vertices.rows(), 3, ++calls_)}};
    result.performance.dofs = MatrixRM::Zero(1, actor.skeleton.dof_count());
    result.performance.frames = {7};
    return result;
  }

private:
  mutable std::uint8_t calls_ = 0;
};

TEST(CaptureConformance, TheKitsCatchWhatIsRestless) {
  Film film;
  Restless all;
  const Image image(8, 8, 3), mask(8, 8, 1, 255);
  EXPECT_EQ(testing::frame_source_violations(all).size(), 4u);                         // channels, mask, sizes, another frame
  EXPECT_EQ(testing::silhouette_extractor_violations(all, {image}, image).size(), 4u); // untrained, mask, another, channels
  EXPECT_EQ(testing::feature_tracker_violations(all, image, mask, 20).size(), 4u);     // descriptors, others, outside, reach
  // Degrees of freedom or vertices, residuals, bits, beside, actor.
  EXPECT_EQ(testing::pose_optimizer_violations(all, film.pose).size(), 5u);
  EXPECT_EQ(testing::surface_refiner_violations(all, film.surface).size(), 5u);
  // Every degree of freedom is moved, or beyond its limits; other bits; a pose without lost limbs.
  const std::size_t limb_rules = testing::limb_search_violations(all, film.limbs, film.pose.start, film.lost()).size();
  EXPECT_EQ(limb_rules, film.actor.skeleton.dof_count() + 2u);
  // A frame that the film has not, no observations, other bits, any rig.
  EXPECT_EQ(testing::performance_capture_violations(all, film.actor, film.rig, film.frames).size(), 4u);
}

/// Does nothing, and that in good form.
class Idle : public SilhouetteExtractor,
             public FeatureTracker,
             public PoseOptimizer,
             public SurfaceRefiner,
             public LimbSearch,
             public PerformanceCapture {
public:
  std::uint8_t all_masks = 0;
  void train(int, const std::vector<Image> &) override { trained_ = true; }
  Image extract(int, const Image &image) const override {
    if (!trained_ || image.channels != 3)
      throw std::invalid_argument("untrained, or grey");
    return Image(image.width, image.height, 1, all_masks);
  }
  Features detect(const Image &, const Image &) const override { return {{{120, 120}, {121, 120}}, MatrixRM::Zero(2, 1)}; }
  std::vector<std::pair<int, int>> match(const Features &, const Features &, double) const override { return {{0, 1}, {1, 0}}; }
  PoseEstimate optimize(const PoseProblem &problem, const Context &) override { return {problem.start, 0, 0, 0, 1}; }
  using SilhouetteExtractor::refine;
  SurfaceEstimate refine(const SurfaceProblem &problem, const Context &) override { return {problem.base, 0, 0}; }
  Eigen::VectorXd search(const LimbProblem &, const Eigen::VectorXd &dofs, const std::vector<Limb> &, const Context &) override {
    return dofs;
  }
  CaptureResult capture(const RiggedMesh &actor, const CameraRig &rig, FrameSource &frames, const SilhouetteExtractor *extractor,
                        const Context &context) override {
    CaptureResult result = PerformanceCapture::create()->capture(actor, rig, frames, extractor, context);
    for (Vertices &surface : result.performance.surface.frames)
      surface.col(0).array() += 0.5; // m
    return result;
  }

private:
  bool trained_ = false;
};

TEST(CaptureConformance, TheKitsCatchWhatIsIdle) {
  Film film;
  const auto only = [](const std::vector<std::string> &broken, const std::string &what) {
    ASSERT_EQ(broken.size(), 1u) << what;
    EXPECT_NE(broken[0].find(what), std::string::npos) << broken[0];
  };
  const Image image = film.frames.image(0, 0), mask = film.frames.mask(0, 0);
  for (const int all : {0, 255}) {
    Idle idle;
    idle.all_masks = static_cast<std::uint8_t>(all);
    only(testing::silhouette_extractor_violations(idle, {image}, image), all ? "all of an image" : "no actor is found");
  }
  Idle idle;
  only(testing::feature_tracker_violations(idle, image, Image(mask.width, mask.height, 1, 255), 20), "does not match itself");
  only(testing::pose_optimizer_violations(idle, film.pose), "does not draw the pose");
  only(testing::surface_refiner_violations(idle, film.surface), "does not draw the surface");
  Eigen::VectorXd away = film.pose.start;
  away[film.lost().front().dofs.front()] += 0.8;
  only(testing::limb_search_violations(idle, film.limbs, away, film.lost()), "no nearer to the masks");
  only(testing::performance_capture_violations(idle, film.actor, film.rig, film.frames), "not where the cameras see the actor");
}

/// All right at its beginning.
class Broken : public FrameSource {
public:
  int frame_count() const override { return 2; }
  int camera_count() const override { return 1; }
  Image image(int, int) override { return Image(4, 4, 3); }
  Image mask(int, int frame) override { return frame == 0 ? Image(4, 4, 1, 255) : Image(5, 4, 1, 255); }
};

TEST(CaptureConformance, TheKitLooksAtTheEndOfAFilm) {
  Broken film;
  EXPECT_EQ(testing::frame_source_violations(film), std::vector<std::string>{"camera 0: image and mask differ in size"});
}

} // namespace conformance_test
} // namespace doublet
