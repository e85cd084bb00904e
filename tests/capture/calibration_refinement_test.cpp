// Cameras refined by the take: known errors are found, right cameras stay, late ones are noticed.

#include "tracker_scene.h"

#include "doublet/core/error.h"
#include "support/temp_folder.h"

#include <gtest/gtest.h>
#include <random>

using namespace doublet;
using namespace tracker_scene;

namespace calibration_refinement_test {

TEST(CameraStep, JacobianEqualsFiniteDifferences) {
  constexpr double kStep = 1e-6;
  for (const Camera &camera : ring(3)) {
    const Eigen::Vector3d point(0.2, 1.3, -0.1);
    const auto jacobian = step_jacobian(camera, point);
    for (int k = 0; k < 8; ++k) {
      const Eigen::Vector2d ahead = stepped(camera, kStep * CameraStep::Unit(k)).project(point),
                            behind = stepped(camera, -kStep * CameraStep::Unit(k)).project(point);
      EXPECT_LT((jacobian.col(k) - (ahead - behind) / (2 * kStep)).norm(), 1e-5 * (1 + jacobian.col(k).norm())) << k;
    }
  }
}

TEST(CameraStep, TurnsAboutTheCentre) {
  const Camera camera = ring(1)[0];
  CameraStep step = CameraStep::Zero();
  step << 0.01, -0.02, 0.03, 0, 0, 0, 0, 0;
  EXPECT_LT((stepped(camera, step).centre() - camera.centre()).norm(), 1e-12);
  step.segment<3>(3) << 0.1, 0.2, 0.3;
  EXPECT_LT((stepped(camera, step).centre() - camera.centre() - step.segment<3>(3)).norm(), 1e-12);
}

/// Every camera turned by about half a degree, moved by millimetres and zoomed by a third of a per cent.
CameraRig disturbed(CameraRig rig) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  for (Camera &camera : rig) {
    CameraStep step;
    for (int k = 0; k < 8; ++k)
      step[k] = normal(random);
    step.head<3>() *= 0.005;
    step.segment<3>(3) *= 0.003;
    step[6] *= 0.003;
    step[7] = 0;
    camera = stepped(camera, step);
  }
  return rig;
}

/// A dance seen by cameras, some of which show it `late` frames later, and what refine_calibration is asked.
struct Take {
  static constexpr int kFrames = 24;
  RiggedMesh actor = figure();
  CameraRig rig = ring(6, 320);
  MatrixRM dofs = motion(actor, kFrames);
  std::vector<std::vector<Outline>> outlines;
  CalibrationProblem problem;

  explicit Take(const std::vector<int> &late = {0, 0, 0, 0, 0, 0}) {
    for (int t = 0; t < kFrames; t += 4) {
      outlines.emplace_back();
      for (size_t v = 0; v < rig.size(); ++v) {
        const Eigen::VectorXd pose = dofs.row(std::max(0, t - late[v]));
        const Vertices surface = pose_surface(actor, pose, {}).vertices;
        outlines.back().push_back(trace_outline(silhouette(rasterize(surface, actor.mesh.faces, rig[v]))));
      }
    }
    for (size_t m = 0; m < outlines.size(); ++m)
      problem.moments.push_back({static_cast<int>(4 * m), &outlines[m], Vertices(0, 3), m == 0});
    problem.actor = &actor;
    problem.given = problem.rig = rig;
    problem.poses = dofs;
    problem.reliability = Eigen::VectorXd::Ones(actor.mesh.vertices.rows());
  }

  /// m, RMS over cameras and frames: from where the true cameras show the actor.
  double error(const CameraRig &cameras) const {
    double sum = 0, count = 0;
    for (size_t v = 0; v < rig.size(); ++v)
      for (int i = 0; i < actor.mesh.vertices.rows(); i += 10) {
        const Eigen::Vector3d x = actor.mesh.vertices.row(i);
        const double metres_per_pixel = rig[v].depth(x) / rig[v].K(0, 0);
        sum += (metres_per_pixel * (cameras[v].project(x) - rig[v].project(x))).squaredNorm();
        count += 1;
      }
    return std::sqrt(sum / count);
  }
};

TEST(CalibrationRefinement, FindsKnownErrors) {
  Take take;
  take.problem.given = take.problem.rig = disturbed(take.rig);
  const CalibrationEstimate found = refine_calibration(take.problem, {}, {});
  EXPECT_GT(take.error(take.problem.given), 0.015);
  EXPECT_LT(take.error(found.rig), 0.003); // a pixel is 8 mm
  EXPECT_LT(found.after_px, 0.5 * found.before_px);
  EXPECT_NEAR(found.change, take.error(take.problem.given), 0.5 * take.error(take.problem.given));
  for (size_t v = 0; v < take.rig.size(); ++v) {
    EXPECT_EQ(found.cameras[v].camera, take.rig[v].name);
    EXPECT_TRUE(found.cameras[v].seen);
    EXPECT_LT(found.cameras[v].sure, 0.004);
    EXPECT_GT(found.cameras[v].sure, 0.0002);
    EXPECT_LT(std::abs(found.cameras[v].late), 0.15);
  }
}

TEST(CalibrationRefinement, RightCamerasHardlyMove) {
  const Take take;
  const CalibrationEstimate found = refine_calibration(take.problem, {}, {});
  EXPECT_LT(found.change, CalibrationRefinementOptions().min_change);
}

TEST(CalibrationRefinement, GoesByTheGivenCamerasWhereverItBegins) {
  Take take;
  take.problem.given = disturbed(take.rig);
  take.problem.rig = take.rig;
  const CalibrationEstimate from_right = refine_calibration(take.problem, {}, {});
  take.problem.rig = take.problem.given;
  const CalibrationEstimate from_given = refine_calibration(take.problem, {}, {});
  for (size_t v = 0; v < take.rig.size(); ++v)
    EXPECT_LT((from_right.rig[v].R - from_given.rig[v].R).norm(), 0.0005);
}

TEST(CalibrationRefinement, FindsLateCameras) {
  const Take take({0, 1, 0, 2, 0, 0});
  const CalibrationEstimate found = refine_calibration(take.problem, {}, {});
  EXPECT_NEAR(found.cameras[0].late, 0, 0.15);
  EXPECT_NEAR(found.cameras[1].late, 1, 0.3);
  EXPECT_NEAR(found.cameras[3].late, 2, 0.4);
  EXPECT_LT(found.cameras[1].late_sure, 0.4);
}

TEST(CalibrationRefinement, ACameraThatSeesNothingStays) {
  Take take;
  take.problem.given = take.problem.rig = disturbed(take.rig);
  for (auto &views : take.outlines)
    views[2] = {};
  const CalibrationEstimate found = refine_calibration(take.problem, {}, {});
  EXPECT_FALSE(found.cameras[2].seen);
  EXPECT_EQ(found.rig[2].R, take.problem.given[2].R);
  EXPECT_EQ(found.rig[2].t, take.problem.given[2].t);
  EXPECT_LT((found.rig[1].R - take.rig[1].R).norm(), (take.problem.given[1].R - take.rig[1].R).norm());
}

TEST(CalibrationRefinement, SaysWhatDoesNotGoTogether) {
  Take take;
  take.problem.rig.pop_back();
  EXPECT_THROW(refine_calibration(take.problem, {}, {}), std::invalid_argument);
  take.problem.rig = take.rig;
  take.problem.reliability[3] = NAN;
  EXPECT_THROW(refine_calibration(take.problem, {}, {}), std::invalid_argument);
  take.problem.reliability[3] = 1;
  take.problem.rig[1].t[2] = NAN;
  EXPECT_THROW(refine_calibration(take.problem, {}, {}), std::exception);
  take.problem.rig = take.rig;
  take.problem.moments[0].row = Take::kFrames;
  EXPECT_THROW(refine_calibration(take.problem, {}, {}), std::invalid_argument);
  take.problem.moments.clear();
  EXPECT_THROW(refine_calibration(take.problem, {}, {}), std::invalid_argument);
}

/// Frames some of whose cameras are late.
class Late : public FrameSource {
public:
  Late(FrameSource &all, std::vector<int> late) : all_(all), late_(std::move(late)) {}
  int frame_count() const override { return all_.frame_count(); }
  int camera_count() const override { return all_.camera_count(); }
  Image image(int camera, int frame) override { return all_.image(camera, std::max(0, frame - late_[camera])); }
  Image mask(int camera, int frame) override { return all_.mask(camera, std::max(0, frame - late_[camera])); }

private:
  FrameSource &all_;
  std::vector<int> late_;
};

struct RefinedCapture : ::testing::Test {
  static constexpr int kFrames = 12;
  RiggedMesh actor = figure();
  CameraRig rig = ring(6, 240);
  MatrixRM dofs = motion(actor, kFrames);
  Frames film{actor, rig, surfaces(actor, dofs)};
  CaptureOptions options;
  std::string log;

  CaptureResult capture(const CameraRig &cameras, FrameSource &frames, bool stopped = false) {
    Context context;
    double first = -1, last = 0;
    context.log = [&](const std::string &line) { log += line + "\n"; };
    context.progress = [&](const std::string &, double fraction) {
      first = first < 0 ? fraction : first;
      EXPECT_GE(fraction, last);
      last = fraction;
    };
    context.cancelled = [&] { return stopped && last > first + 0.25; };
    return PerformanceCapture::create(options)->capture(actor, cameras, frames, nullptr, context);
  }

  double joint_error(const CaptureResult &result) const {
    double sum = 0;
    for (int t = 0; t < kFrames; ++t)
      sum += mean_distance(result.performance.joints[t],
                           joint_positions(actor.skeleton, forward_kinematics(actor.skeleton, dofs.row(t))));
    return sum / kFrames;
  }
};

TEST_F(RefinedCapture, RightCamerasStay) {
  const CaptureResult result = capture(rig, film);
  options.refine_cameras = false;
  const CaptureResult without = capture(rig, film);
  EXPECT_FALSE(result.summary.cameras_refined);
  EXPECT_EQ(result.performance.dofs, without.performance.dofs);
  EXPECT_EQ(result.observations.cameras[3].R, rig[3].R);
  EXPECT_EQ(result.summary.cameras.size(), rig.size());
  EXPECT_TRUE(without.summary.cameras.empty());
}

TEST_F(RefinedCapture, WrongCamerasAreMended) {
  const CameraRig given = disturbed(rig);
  const CaptureResult result = capture(given, film);
  options.refine_cameras = false;
  const CaptureResult without = capture(given, film);
  EXPECT_TRUE(result.summary.cameras_refined);
  EXPECT_LT(joint_error(result), 0.6 * joint_error(without));
  EXPECT_NE(result.observations.cameras[3].R, given[3].R);
  EXPECT_EQ(without.observations.cameras[3].R, given[3].R);
  EXPECT_NE(log.find("the calibration is "), std::string::npos) << log;
}

/// Some cameras film between the frames of the others.
class Between : public FrameSource {
public:
  Between(FrameSource &on, FrameSource &between) : on_(on), between_(between) {}
  int frame_count() const override { return on_.frame_count(); }
  int camera_count() const override { return on_.camera_count(); }
  Image image(int camera, int frame) override { return of(camera).image(camera, frame); }
  Image mask(int camera, int frame) override { return of(camera).mask(camera, frame); }

private:
  FrameSource &of(int camera) { return camera == 1 || camera == 3 ? between_ : on_; }
  FrameSource &on_, &between_;
};

using SlowRefinedCapture = RefinedCapture;

TEST_F(SlowRefinedCapture, LateCamerasAreWaitedFor) {
  Late late(film, {0, 1, 0, 1, 0, 0});
  const CaptureResult result = capture(rig, late);
  options.refine_cameras = false;
  const CaptureResult without = capture(rig, late);
  EXPECT_EQ(result.summary.cameras[1].delay, 1) << log;
  EXPECT_EQ(result.summary.cameras[3].delay, 1);
  EXPECT_EQ(result.summary.cameras[0].delay, 0);
  EXPECT_NEAR(result.summary.cameras[1].late, 1, 0.3);
  EXPECT_LT(joint_error(result), joint_error(without));
  EXPECT_EQ(result.summary.views.back(), 4); // the film of the late ones is over
}

TEST_F(SlowRefinedCapture, CamerasMayFilmBetweenTheFramesOfOthers) {
  constexpr double kLate = 0.4;
  const MatrixRM on_from = motion(actor, kFrames + 1);
  const MatrixRM earlier = dofs - kLate * (on_from.bottomRows(kFrames) - on_from.topRows(kFrames));
  Frames on(actor, rig, surfaces(actor, dofs)), before(actor, rig, surfaces(actor, earlier));
  Between film_of_both(on, before);
  const CaptureResult result = capture(rig, film_of_both);
  options.calibration.late = 0;
  const CaptureResult without = capture(rig, film_of_both);
  EXPECT_NEAR(result.summary.cameras[1].late, kLate, 0.1);
  EXPECT_NEAR(result.summary.cameras[0].late, 0, 0.1);
  EXPECT_EQ(result.summary.cameras[1].delay, 0);
  EXPECT_LT(joint_error(result), 0.7 * joint_error(without)) << log;
}

TEST_F(SlowRefinedCapture, GoesOnToTheSameBitsWhereverItIsStopped) {
  Late late(film, {0, 1, 0, 1, 0, 0});
  const CameraRig given = disturbed(rig);
  const CaptureResult whole = capture(given, late);
  ASSERT_TRUE(whole.summary.cameras_refined);
  const doublet::testing::TempFolder folder;
  options.checkpoint = folder / "checkpoint";
  int stops = 0;
  for (bool done = false; !done && stops < 20; ++stops) {
    try {
      const CaptureResult result = capture(given, late, true);
      done = true;
      EXPECT_EQ(result.performance.dofs, whole.performance.dofs);
      EXPECT_EQ(result.observations.cameras[2].R, whole.observations.cameras[2].R);
      EXPECT_EQ(result.summary.cameras[1].delay, whole.summary.cameras[1].delay);
    } catch (const Cancelled &) {
    }
  }
  EXPECT_GE(stops, 3);
  EXPECT_LT(stops, 20);
}

} // namespace calibration_refinement_test
