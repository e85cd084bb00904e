// Cameras from the joints and silhouettes of a figure that moves.

#include "doublet/capture/person_calibration.h"
#include "doublet/capture/pose_optimizer.h"
#include "doublet/core/error.h"
#include "doublet/core/parts/alignment.h"
#include "doublet/core/skeleton.h"
#include "support/figure.h"

#include <gtest/gtest.h>

#include <numbers>
#include <random>

namespace person_calibration_test {

using namespace doublet;

constexpr int kFrames = 60, kSize = 640;
constexpr double kHeight = 1.7, kFocalShare = 1.5; // of camera_ring

/// Walks about, turns, bends knees and elbows, swings the arms below the shoulders; stands upright, or leans forward (rad).
Eigen::VectorXd pose(const Skeleton &skeleton, int frame, double lean) {
  const double t = 2 * std::numbers::pi * frame / kFrames;
  Eigen::VectorXd dofs = Eigen::VectorXd::Zero(skeleton.dof_count());
  const auto set = [&](const std::string &joint, int k, double value) {
    dofs[skeleton.joints[skeleton.find(joint)].first_dof + k] = value;
  };
  set("pelvis", 0, 0.4 * std::sin(t));
  set("pelvis", 2, 0.3 * std::sin(2 * t));
  set("pelvis", 3, 1.5 * std::sin(t + 1));
  set("pelvis", 4, lean);
  set("l_shoulder", 0, 0.5 * std::sin(3 * t));
  set("r_shoulder", 0, 0.4 * std::cos(4 * t));
  set("l_hip", 0, 0.3 * std::sin(2 * t));
  set("r_hip", 0, -0.3 * std::sin(2 * t));
  set("l_elbow", 0, 0.6 + 0.5 * std::sin(5 * t));
  set("r_elbow", 0, 0.6 + 0.5 * std::cos(3 * t));
  return dofs;
}

struct Take {
  CameraRig rig;
  std::vector<Vertices> joints; // (12, 3) each
  std::vector<PersonView> views;
};

Take film(CameraRig rig, bool silhouettes, double noise = 0, double swapped = 0, double lean = 0) {
  const RiggedMesh actor = doublet::testing::figure_actor(0.04);
  Take take;
  take.rig = std::move(rig);
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform;
  for (const Camera &camera : take.rig)
    take.views.push_back({camera.name, camera.width, camera.height, 0, {}, {}});
  for (int f = 0; f < kFrames; ++f) {
    const Eigen::VectorXd dofs = pose(actor.skeleton, f, lean);
    const Vertices all = joint_positions(actor.skeleton, forward_kinematics(actor.skeleton, dofs));
    Vertices joints(kKeypoints, 3);
    for (int j = 0; j < kKeypoints; ++j)
      joints.row(j) = all.row(actor.skeleton.find(kKeypointNames[j]));
    take.joints.push_back(joints);
    const Vertices surface = pose_surface(actor, dofs, Vertices(0, 3)).vertices;
    for (size_t v = 0; v < take.rig.size(); ++v) {
      const bool swap = uniform(random) < swapped;
      for (int j = 0; j < kKeypoints; ++j) {
        const double y = normal(random), x = normal(random); // in this order with every compiler
        take.views[v].seen.push_back({take.rig[v].project(joints.row(swap ? j ^ 1 : j)) + noise * Eigen::Vector2d(x, y), 0.9});
      }
      std::vector<Eigen::Vector2d> outline;
      for (int i = 0; silhouettes && i < surface.rows(); ++i)
        outline.push_back(take.rig[v].project(surface.row(i)));
      take.views[v].silhouettes.push_back(f % 3 == 0 ? outline : std::vector<Eigen::Vector2d>{});
    }
  }
  return take;
}

/// Pixels by which the joints appear elsewhere, RMS, when the world is laid over the true one (Umeyama 1991).
double image_error(const Take &take, const PersonCalibration &found) {
  const auto moments = static_cast<Eigen::Index>(found.frames.size());
  Vertices truth(moments * kKeypoints, 3);
  for (Eigen::Index m = 0; m < moments; ++m)
    truth.middleRows(m * kKeypoints, kKeypoints) = take.joints[found.frames[m]];
  const Eigen::Matrix4d world = nearest_similarity(truth.transpose(), found.joints.transpose(), AlignmentScale::Free);
  double sum = 0;
  for (size_t v = 0; v < take.rig.size(); ++v)
    for (Eigen::Index i = 0; i < truth.rows(); ++i) {
      const Eigen::Vector3d x = truth.row(i), there = (world * x.homogeneous()).head<3>();
      sum += (found.rig[v].project(there) - take.rig[v].project(x)).squaredNorm();
    }
  return std::sqrt(sum / static_cast<double>(take.rig.size() * truth.rows()));
}

PersonCalibrationOptions options() {
  PersonCalibrationOptions result;
  result.height = kHeight;
  return result;
}

TEST(PersonCalibration, ExactKeypointsGiveTheCamerasBack) {
  const Take take = film(doublet::testing::camera_ring(4, kSize), false);
  const PersonCalibration found = calibrate_from_person(take.views, options());
  EXPECT_LT(image_error(take, found), 0.5);
  for (size_t v = 0; v < take.rig.size(); ++v) {
    EXPECT_EQ(found.rig[v].name, take.rig[v].name);
    EXPECT_NEAR(found.rig[v].K(0, 0), kFocalShare * kSize, 0.03 * kFocalShare * kSize) << v;
    EXPECT_GT(found.cameras[v].agreeing, 0.99);
    EXPECT_TRUE(std::isnan(found.cameras[v].tangent_error));
  }
}

TEST(PersonCalibration, TheWorldIsUprightAndMetric) {
  const Take take = film(doublet::testing::camera_ring(4, kSize), true);
  PersonCalibrationOptions tall;
  const Mesh figure = doublet::testing::figure_surface();
  tall.height = figure.vertices.col(1).maxCoeff() - figure.vertices.col(1).minCoeff(); // its skull is round its bones
  const PersonCalibration found = calibrate_from_person(take.views, tall);
  double low = 1e9;
  for (size_t v = 0; v < take.rig.size(); ++v) {
    // The true rig stands in +Y up with the floor at 0, so that heights are the same whatever she looks along.
    EXPECT_NEAR(found.rig[v].centre().y(), take.rig[v].centre().y(), 0.08) << v;
    const double distance = (found.rig[v].centre() - found.rig[(v + 1) % take.rig.size()].centre()).norm();
    EXPECT_NEAR(distance, (take.rig[v].centre() - take.rig[(v + 1) % take.rig.size()].centre()).norm(), 0.05 * distance) << v;
  }
  for (Eigen::Index i = 0; i < found.joints.rows(); ++i)
    low = std::min(low, found.joints(i, 1));
  EXPECT_NEAR(low, 0.08, 0.06); // an ankle
}

TEST(SlowPersonCalibration, LeftAndRightExchangedAndNoiseAreOutvoted) {
  const Take take = film(doublet::testing::camera_ring(6, kSize), false, 2.0, 0.15);
  EXPECT_LT(image_error(take, calibrate_from_person(take.views, options())), 2.5);
}

TEST(SlowPersonCalibration, WithoutSilhouettesBonesTellTheScale) {
  const Take take = film(doublet::testing::camera_ring(4, kSize), false, 6.0);
  const PersonCalibration found = calibrate_from_person(take.views, options());
  const double across = (found.rig[0].centre() - found.rig[2].centre()).norm();
  EXPECT_NEAR(across, (take.rig[0].centre() - take.rig[2].centre()).norm(), 0.12 * across);
}

TEST(PersonCalibration, SilhouettesMakeItFiner) {
  const Take without = film(doublet::testing::camera_ring(5, kSize), false, 4.0),
             with = film(doublet::testing::camera_ring(5, kSize), true, 4.0);
  const PersonCalibration coarse = calibrate_from_person(without.views, options()),
                          fine = calibrate_from_person(with.views, options());
  // 0.41 to 0.68 of it in ten draws of the noise.
  EXPECT_LT(image_error(with, fine), 0.75 * image_error(without, coarse));
  for (const PersonCamera &camera : fine.cameras)
    EXPECT_LT(camera.tangent_error, 0.003);
}

TEST(PersonCalibration, TwoCamerasWithKnownFocalLengthsAreEnough) {
  const CameraRig ring = doublet::testing::camera_ring(8, kSize);
  Take take = film({ring[0], ring[2]}, true);
  for (PersonView &view : take.views)
    view.focal = kFocalShare * kSize;
  EXPECT_LT(image_error(take, calibrate_from_person(take.views, options())), 1.0);
}

TEST(SlowPersonCalibration, ACameraThatIsNotLevelDoesNotTiltTheWorld) {
  CameraRig rig = doublet::testing::camera_ring(6, kSize);
  rig[2].R = Eigen::AngleAxisd(0.5, Eigen::Vector3d::UnitZ()) * rig[2].R;
  const Eigen::Vector3d centre = doublet::testing::camera_ring(6, kSize)[2].centre();
  rig[2].t = -rig[2].R * centre;
  const Take take = film(rig, true);
  const PersonCalibration found = calibrate_from_person(take.views, options());
  for (size_t v = 0; v < rig.size(); ++v)
    EXPECT_NEAR(found.rig[v].R.row(0).y(), rig[v].R.row(0).y(), 0.02) << v;
}

TEST(PersonCalibration, LevelCamerasTellUpWhereSheLeans) {
  const Take take = film(doublet::testing::camera_ring(4, kSize), true, 0, 0, 0.2);
  const PersonCalibration found = calibrate_from_person(take.views, options());
  for (size_t v = 0; v < take.rig.size(); ++v)
    EXPECT_NEAR(found.rig[v].R(1, 1), take.rig[v].R(1, 1), 0.01) << v;
}

TEST(PersonCalibration, AnswersAreTheSameBitsOnAnyNumberOfThreads) {
  const Take take = film(doublet::testing::camera_ring(3, kSize), true, 2.0);
  Context one, three;
  one.threads = 1;
  three.threads = 3;
  const PersonCalibration a = calibrate_from_person(take.views, options(), one),
                          b = calibrate_from_person(take.views, options(), three);
  for (size_t v = 0; v < a.rig.size(); ++v)
    EXPECT_EQ(a.rig[v].R, b.rig[v].R);
}

TEST(PersonCalibration, StopsWhenItIsAskedTo) {
  const Take take = film(doublet::testing::camera_ring(4, kSize), false);
  Context context;
  bool stop = false;
  context.progress = [&](const std::string &, double share) { stop = share > 0; };
  context.cancelled = [&] { return stop; };
  EXPECT_THROW(calibrate_from_person(take.views, options(), context), Cancelled);
}

TEST(SlowPersonCalibration, ACameraOfAnotherTimeIsNamed) {
  Take take = film(doublet::testing::camera_ring(5, kSize), false);
  std::rotate(take.views[3].seen.begin(), take.views[3].seen.begin() + 25 * kKeypoints, take.views[3].seen.end());
  try {
    calibrate_from_person(take.views, options());
    FAIL() << "expected an error";
  } catch (const Error &error) {
    EXPECT_NE(std::string(error.what()).find("camera 'cam3'"), std::string::npos) << error.what();
  }
}

TEST(PersonCalibration, WhatDoesNotGoTogetherIsRefused) {
  Take take = film(doublet::testing::camera_ring(3, kSize), false);
  EXPECT_THROW(calibrate_from_person({take.views[0]}), std::invalid_argument);
  std::vector<PersonView> shorter = take.views;
  shorter[1].seen.pop_back();
  EXPECT_THROW(calibrate_from_person(shorter), std::invalid_argument);
  std::vector<PersonView> flat = take.views;
  flat[2].width = 0;
  EXPECT_THROW(calibrate_from_person(flat), std::invalid_argument);
  for (PersonView &view : take.views)
    for (Keypoint &seen : view.seen)
      seen.confidence = 0.1;
  EXPECT_THROW(calibrate_from_person(take.views), Error);
}

TEST(PersonCalibration, AHullIsThatOfWholeSilhouettesAlone) {
  Image mask(40, 30, 1);
  for (int y = 5; y < 20; ++y)
    for (int x = 10; x < 25; ++x)
      mask.at(x, y) = 255;
  EXPECT_EQ(silhouette_hull(mask).size(), 4u);
  mask.at(39, 12) = 255; // goes on beyond the border
  EXPECT_TRUE(silhouette_hull(mask).empty());
  EXPECT_TRUE(silhouette_hull(Image(40, 30, 1)).empty());
  EXPECT_THROW(silhouette_hull(Image(40, 30, 3)), std::invalid_argument);
}

} // namespace person_calibration_test
