// Joints that keypoints show: a term of the pose, of what is lost and of its search; where programs see joints; a whole capture.

#include "../../libcapture/src/tracking/seen_joints.h"
#include "person_scene.h"

#include "doublet/core/error.h"
#include "support/temp_folder.h"

#include <gtest/gtest.h>
#include <random>

using namespace doublet;
using namespace person_scene;

namespace keypoints_test {

/// m; a program sees all joints so far beside where the skeleton has them, in the rest pose.
const Eigen::Vector3d kBeside(0.02, -0.01, 0.03);

std::vector<Keypoint> seen_by(const Camera &camera, const Skeleton &skeleton, const Eigen::VectorXd &dofs,
                              const Eigen::Vector3d &beside = Eigen::Vector3d::Zero()) {
  const Transforms world_from_rest = forward_kinematics(skeleton, dofs);
  std::vector<Keypoint> keypoints;
  for (const char *name : kKeypointNames) {
    const Joint &joint = skeleton.joints[skeleton.find(name)];
    keypoints.push_back({camera.project(world_from_rest[joint.parent] * (joint.rest + beside)), 1});
  }
  return keypoints;
}

/// Where these joints are, as if measured without an error.
std::vector<SeenPoint> points(const Skeleton &skeleton, const Eigen::VectorXd &dofs) {
  const Vertices joints = joint_positions(skeleton, forward_kinematics(skeleton, dofs));
  std::vector<SeenPoint> points;
  for (const char *name : kKeypointNames) {
    const int j = skeleton.find(name);
    points.push_back({skeleton.joints[j].parent, skeleton.joints[j].rest, joints.row(j)});
  }
  return points;
}

double worst_keypoint(const Scene &scene, const Eigen::VectorXd &found, const Eigen::VectorXd &truth) {
  double worst = 0;
  for (const char *name : kKeypointNames) {
    const int j = scene.actor.skeleton.find(name);
    worst = std::max(worst, (scene.joints(found) - scene.joints(truth)).row(j).norm());
  }
  return worst;
}

/// Masks, and what a program would find: joints with an error of 1 % of the image, beside where the skeleton has them.
class MasksAndKeypoints : public Masks {
public:
  MasksAndKeypoints(const Scene &scene, const MatrixRM &truth)
      : Masks(scene.actor, scene.rig, tracker_scene::surfaces(scene.actor, truth)) {
    std::mt19937 random(1);
    std::normal_distribution<double> error(0, 0.01 * scene.rig[0].width);
    for (size_t c = 0; c < scene.rig.size(); ++c)
      for (int t = 0; t < truth.rows(); ++t) {
        keypoints_.push_back(seen_by(scene.rig[c], scene.actor.skeleton, truth.row(t), kBeside));
        for (Keypoint &keypoint : keypoints_.back()) {
          const double y = error(random), x = error(random); // in this order with every compiler
          keypoint.pixel += Eigen::Vector2d(x, y);
        }
      }
  }
  std::vector<Keypoint> keypoints(int camera, int frame) override {
    return shown ? keypoints_[static_cast<size_t>(camera * frame_count() + frame)] : std::vector<Keypoint>();
  }
  bool shown = true;
  std::vector<std::vector<Keypoint>> keypoints_; // [cameras * frames]
};

/// Of the scene's actor, begun in its pose.
PoseProblem pose_problem(const Scene &scene, const std::vector<Outline> &outlines, std::vector<SeenPoint> points) {
  PoseProblem problem;
  problem.actor = &scene.actor;
  problem.rig = &scene.rig;
  problem.outlines = &outlines;
  problem.reliability = scene.problem().reliability;
  problem.predicted = problem.start = scene.truth;
  problem.points = std::move(points);
  return problem;
}

TEST(Keypoints, AloneGiveThePose) {
  Scene scene;
  Eigen::VectorXd truth = scene.truth;
  for (const char *dof : {"l_shoulder.z", "r_shoulder.x", "l_elbow.x", "r_hip.x"})
    if (scene.dof(dof) < truth.size())
      truth[scene.dof(dof)] += 0.25;
  truth.head<3>() << 0.05, -0.02, 0.04;
  const std::vector<Outline> nothing(scene.rig.size());
  PoseProblem problem = pose_problem(scene, nothing, points(scene.actor.skeleton, truth));
  problem.first = true; // no pull to the prediction to speak of
  const PoseEstimate found = PoseOptimizer::create()->optimize(problem, scene.context);
  EXPECT_GT(worst_keypoint(scene, scene.truth, truth), 0.1);
  EXPECT_LT(worst_keypoint(scene, found.dofs, truth), 0.005);
  PoseOptions off;
  off.keypoint_weight = 0;
  EXPECT_GT(worst_keypoint(scene, PoseOptimizer::create(off)->optimize(problem, scene.context).dofs, truth), 0.1);
  problem.points[3].joint = 99;
  EXPECT_THROW(PoseOptimizer::create()->optimize(problem, scene.context), std::invalid_argument);
}

TEST(Keypoints, OneThatIsWrongByALimbIsOutweighed) {
  Scene scene;
  std::vector<Outline> outlines;
  for (const Image &mask : scene.masks)
    outlines.push_back(trace_outline(mask));
  PoseProblem problem = pose_problem(scene, outlines, points(scene.actor.skeleton, scene.truth));
  problem.points[4].seen.y() += 0.5; // the left wrist
  EXPECT_LT(worst_keypoint(scene, PoseOptimizer::create()->optimize(problem, scene.context).dofs, scene.truth), 0.015);
}

TEST(Keypoints, GuideTheSearchOfALimb) {
  Scene scene;
  Eigen::VectorXd wrong = scene.truth;
  wrong[scene.dof("l_shoulder.z")] += 40 * kDegree;
  LimbProblem problem = scene.problem();
  for (Image &mask : scene.masks) // all of every image is the actor: silhouettes tell nothing
    std::fill(mask.data.begin(), mask.data.end(), std::uint8_t{255});
  const double energy = overlap_energy(problem, wrong, {}, scene.context);
  problem.points = points(scene.actor.skeleton, scene.truth);
  problem.predicted = wrong;
  EXPECT_GT(overlap_energy(problem, wrong, {}, scene.context), energy + 0.02);
  const auto arm = std::find_if(scene.limbs.begin(), scene.limbs.end(), [](const Limb &l) { return l.name == "l_clavicle"; });
  const Eigen::VectorXd found = LimbSearch::create()->search(problem, wrong, {*arm}, scene.context);
  EXPECT_LT(worst_keypoint(scene, found, scene.truth), 0.3 * worst_keypoint(scene, wrong, scene.truth));
}

/// Silhouettes that show a limb are believed, not a program that sees it elsewhere.
TEST(Keypoints, ThatAreWrongCostNothing) {
  const Scene scene;
  const MatrixRM truth = MatrixRM::Zero(3, scene.truth.size());
  struct Wrong : MasksAndKeypoints {
    using MasksAndKeypoints::MasksAndKeypoints;
    std::vector<Keypoint> keypoints(int camera, int frame) override {
      std::vector<Keypoint> seen = MasksAndKeypoints::keypoints(camera, frame);
      if (shown && frame > 0)
        std::swap(seen[4], seen[5]); // left and right wrist, in all views
      return seen;
    }
  } film(scene, truth);
  CaptureOptions options;
  options.refine_cameras = options.second_pass = false;
  const auto capture = [&] {
    return PerformanceCapture::create(options)->capture(scene.actor, scene.rig, film, nullptr, scene.context);
  };
  const CaptureResult with = capture();
  film.shown = false;
  EXPECT_LT((with.performance.dofs - capture().performance.dofs).cwiseAbs().maxCoeff(), 0.02);
  EXPECT_TRUE(with.summary.lost_limbs.empty());
}

TEST(KeypointPlaces, LearnWhereAProgramSeesJoints) {
  const Scene scene;
  const Skeleton &skeleton = scene.actor.skeleton;
  detail::KeypointPlaces places(skeleton, 0.05);
  Eigen::VectorXd dofs = scene.truth;
  detail::SeenJoints seen;
  for (int t = 0; t < 9; ++t) {
    dofs[scene.dof("l_shoulder.z")] = 0.1 * t;
    dofs[4] = 0.3 * t; // the whole person turns
    std::vector<ViewMeasurement> views(scene.rig.size());
    for (size_t v = 0; v < views.size(); ++v)
      views[v].keypoints = seen_by(scene.rig[v], skeleton, dofs, kBeside);
    views[1].keypoints.clear(); // this camera has none
    seen = detail::seen_joints(views, scene.rig);
    if (t == 3)
      *seen[5] += Eigen::Vector3d(0.4, 0, 0); // the limb is lost there
    if (t == 4)
      *seen[2] += Eigen::Vector3d(0.1, 0, 0);
    places.learn(seen, dofs);
  }
  const std::vector<SeenPoint> points = places.points(seen);
  ASSERT_EQ(points.size(), kKeypointNames.size());
  for (size_t k = 0; k < points.size(); ++k) {
    const Joint &joint = skeleton.joints[skeleton.find(kKeypointNames[k])];
    EXPECT_EQ(points[k].joint, joint.parent);
    EXPECT_LT((points[k].rest - joint.rest - kBeside).norm(), 1e-6) << kKeypointNames[k];
    EXPECT_EQ(points[k].tolerance, 0.05);
  }
  EXPECT_LT(places.distance(seen, dofs), 1e-6);
  EXPECT_TRUE(std::isnan(places.distance({}, dofs)));
}

TEST(KeypointPlaces, AreLessSureWhereAProgramIsNotSteady) {
  const Scene scene;
  detail::KeypointPlaces places(scene.actor.skeleton, 0.05);
  std::vector<ViewMeasurement> views(scene.rig.size());
  for (size_t v = 0; v < views.size(); ++v)
    views[v].keypoints = seen_by(scene.rig[v], scene.actor.skeleton, scene.truth);
  const detail::SeenJoints exact = detail::seen_joints(views, scene.rig);
  for (int t = 0; t < 41; ++t) {
    detail::SeenJoints seen = exact;
    *seen[9] += 0.08 * std::cos(2.0 * t) * Eigen::Vector3d::UnitX(); // a knee
    places.learn(seen, scene.truth);
  }
  const std::vector<SeenPoint> points = places.points(exact);
  EXPECT_NEAR(points[9].tolerance, 3 * 0.08 * std::sqrt(0.5), 0.02); // of a cosine: half of it is below
  EXPECT_EQ(points[8].tolerance, 0.05);
  EXPECT_EQ(points[9].beyond(points[9].seen + Eigen::Vector3d(0, points[9].tolerance / 2, 0)), 0);
  EXPECT_NEAR(points[8].beyond(points[8].seen + Eigen::Vector3d(0, 0.15, 0)), 0.1, 1e-12);
}

TEST(SeenJoints, AreNoneWithoutTwoCameras) {
  const Scene scene;
  std::vector<ViewMeasurement> views(scene.rig.size());
  views[2].keypoints = seen_by(scene.rig[2], scene.actor.skeleton, scene.truth);
  for (const auto &joint : detail::seen_joints(views, scene.rig))
    EXPECT_FALSE(joint);
}

/// Behind the first frame as if she went behind a wide sheet: masks that tell nothing of her.
class Hidden : public MasksAndKeypoints {
public:
  using MasksAndKeypoints::MasksAndKeypoints;
  Image mask(int camera, int frame) override {
    Image mask = Masks::mask(camera, frame);
    constexpr int kBorder = 20; // px
    for (int y = kBorder; frame > 0 && y < mask.height - kBorder; ++y)
      std::fill_n(mask.data.begin() + y * mask.width + kBorder, mask.width - 2 * kBorder, std::uint8_t{255});
    return mask;
  }
};

TEST(Keypoints, TellWhatSilhouettesDoNot) {
  const Scene scene;
  const int frames = 6, wrist = scene.actor.skeleton.find("l_wrist");
  MatrixRM truth = MatrixRM::Zero(frames, scene.truth.size());
  for (int t = 0; t < frames; ++t)
    truth(t, scene.dof("l_shoulder.z")) = 10 * kDegree * t;
  Hidden film(scene, truth);
  CaptureOptions options;
  options.smooth_window = 1;
  options.refine_cameras = options.second_pass = options.find_lost_limbs = false;
  const auto capture = [&] {
    return PerformanceCapture::create(options)->capture(scene.actor, scene.rig, film, nullptr, scene.context);
  };
  const auto off = [&](const CaptureResult &result, int t) {
    return (result.performance.joints[t].row(wrist) - scene.joints(truth.row(t)).row(wrist)).norm();
  };
  const CaptureResult with = capture();
  for (int t = 0; t < frames; ++t) { // at worst 15 to 30 cm, 6 of them tolerated, and 5 to 12 cm in 16 draws of the noise
    EXPECT_LT(off(with, t), 0.35) << "frame " << t;
    EXPECT_LT(with.summary.keypoint_distance[t], 0.13) << "frame " << t;
  }
  film.shown = false;
  const CaptureResult without = capture();
  EXPECT_GT(off(without, frames - 1), 0.5); // else this test shows nothing
  EXPECT_TRUE(std::isnan(without.summary.keypoint_distance[0]));
}

TEST(SlowKeypoints, ACaptureGoesOnByThemToTheSameBits) {
  const Scene scene;
  MatrixRM truth = MatrixRM::Zero(3, scene.truth.size());
  for (int t = 0; t < truth.rows(); ++t)
    truth(t, scene.dof("l_shoulder.z")) = 0.1 * t;
  MasksAndKeypoints film(scene, truth);
  const doublet::testing::TempFolder folder;
  CaptureOptions options;
  options.refine_cameras = options.find_lost_limbs = false;
  const auto capture = [&](double until) {
    double reached = 0;
    std::string log;
    Context context;
    context.progress = [&](const std::string &, double fraction) { reached = fraction; };
    context.cancelled = [&] { return reached > until; };
    context.log = [&](const std::string &line) { log += line; };
    const CaptureResult result = PerformanceCapture::create(options)->capture(scene.actor, scene.rig, film, nullptr, context);
    return std::pair(MatrixRM(result.performance.dofs), log);
  };
  const MatrixRM whole = capture(1).first;
  for (const double until : {0.3, 0.6}) { // in the first pass, in the second
    options.checkpoint = folder / ("checkpoint" + std::to_string(until));
    EXPECT_THROW(capture(until), Cancelled);
    EXPECT_EQ(capture(1).first, whole) << until;
  }
  film.keypoints_[0][0].pixel.x() += 1;
  const std::string log = capture(1).second;
  EXPECT_NE(log.find("was made from other images; starting over"), std::string::npos) << log;
}

TEST(Keypoints, AreTwelveOrNone) {
  const Scene scene;
  struct Three : Masks {
    using Masks::Masks;
    std::vector<Keypoint> keypoints(int, int) override { return std::vector<Keypoint>(3); }
  } film(scene.actor, scene.rig, tracker_scene::surfaces(scene.actor, MatrixRM::Zero(2, scene.truth.size())));
  try {
    PerformanceCapture::create()->capture(scene.actor, scene.rig, film, nullptr, scene.context);
    FAIL() << "three keypoints were taken";
  } catch (const Error &error) {
    EXPECT_NE(std::string(error.what()).find("has 3 keypoints, expected 12, or none"), std::string::npos) << error.what();
  }
}

} // namespace keypoints_test
