#include "doublet/bodymodel/body_fitter.h"
#include "doublet/bodymodel/proxies.h"
#include "doublet/core/error.h"
#include "support/figure.h"

#include <gtest/gtest.h>

#include <set>

using namespace doublet;

namespace {

/// One long limb along y that is itself a tapered capsule (0.10 m to 0.06 m), its cloth a wider cone around the upper half.
struct Limb {
  RiggedMesh actor;
  Segmentation segmentation;
  BodyFit fit;
  Capsule truth{{0, 0.9, 0}, {0, 0.5, 0}, 0.10, 0.06};
};

Limb make_limb(double cloth_radius = 0.18) {
  Limb limb;
  auto distance = [&](const Eigen::Vector3d &p) { return signed_distance(limb.truth, p); };
  limb.fit.body = doublet::testing::level_set(distance, {-0.2, 0.3, -0.2}, {0.2, 1.1, 0.2}, 0.015);
  limb.actor.skeleton =
      make_skeleton({{"root", "", {0, 0.9, 0}, 6}, {"knee", "root", {0, 0.5, 0}, 1}, {"end", "knee", {0, 0.35, 0}, 0}});
  limb.actor.mesh = doublet::testing::closed_tube(
      {0, 0.4, 0}, {0, 1.05, 0}, [&](double) { return cloth_radius; }, 20, 40);
  limb.actor.face_valid.assign(limb.actor.mesh.faces.rows(), 1);
  const int n = static_cast<int>(limb.actor.mesh.vertices.rows());
  limb.actor.weights = MatrixRM::Constant(n, 3, 1.0 / 3);
  limb.segmentation = {Eigen::VectorXd::Zero(n), Eigen::VectorXd::Ones(n), Eigen::VectorXi::Zero(n), 1};
  limb.segmentation.clothness[n - 1] = 0; // the top is skin
  return limb;
}

} // namespace

TEST(Proxies, RecoverAKnownCapsule) {
  const Limb limb = make_limb();
  ProxyOptions options;
  options.capsules_per_bone = 1;
  const std::vector<TaperedCapsule> capsules = fit_proxies(limb.fit, limb.actor, limb.segmentation, options);
  ASSERT_FALSE(capsules.empty());
  EXPECT_EQ(capsules[0].joint, 0);
  EXPECT_NEAR(std::max(capsules[0].r0, capsules[0].r1), 0.10, 0.012);
  const ProxyStatistics statistics = proxy_statistics(capsules, limb.fit, limb.actor, limb.segmentation);
  EXPECT_LT(statistics.mean_distance, 0.005);
  EXPECT_LT(statistics.percentile95, 0.015);
  EXPECT_LT(statistics.largest_bulge, 0.020);
  EXPECT_GT(statistics.cloth_clearance, 0.004);
  EXPECT_GT(statistics.samples, 100);
}

TEST(Proxies, NeverReachIntoRestingCloth) {
  const Limb limb = make_limb(0.07); // cloth tighter than the body at the thick end
  const ProxyOptions options;
  const auto capsules = fit_proxies(limb.fit, limb.actor, limb.segmentation, options);
  EXPECT_GE(proxy_statistics(capsules, limb.fit, limb.actor, limb.segmentation).cloth_clearance, options.cloth_margin - 1e-9);
}

TEST(Proxies, WhatIsInsideTheBodyIsNoBulgeWhereSkinIsFoldedIntoIt) {
  // A closed bubble in the flesh stands for the folded skin of an arm pit: around it, the nearest normals say "outside".
  Limb limb = make_limb();
  const Mesh bubble =
      doublet::testing::level_set([](const Eigen::Vector3d &p) { return (p - Eigen::Vector3d(0, 0.7, 0)).norm() - 0.04; },
                                  {-0.1, 0.6, -0.1}, {0.1, 0.8, 0.1}, 0.01);
  limb.fit.body = doublet::testing::join({limb.fit.body, bubble});
  const TaperedCapsule inside{0, {0, -0.1, 0}, {0, -0.3, 0}, 0.055, 0.055};
  EXPECT_EQ(proxy_statistics({inside}, limb.fit, limb.actor, limb.segmentation).largest_bulge, 0);
  const TaperedCapsule outside{0, {0, -0.1, 0}, {0, -0.3, 0}, 0.13, 0.13};
  EXPECT_NEAR(proxy_statistics({outside}, limb.fit, limb.actor, limb.segmentation).largest_bulge, 0.06, 0.01);
}

TEST(Proxies, ClearanceMovesThemIntoTheBody) {
  const Limb limb = make_limb();
  ProxyOptions thin;
  thin.clearance = 0.015;
  auto thickness = [&](const ProxyOptions &options) {
    double sum = 0;
    for (const TaperedCapsule &c : fit_proxies(limb.fit, limb.actor, limb.segmentation, options))
      sum += c.r0 + c.r1;
    return sum;
  };
  EXPECT_LT(thickness(thin), thickness({}) - 0.02);
}

TEST(Proxies, StandWhereClothCanTouch) {
  // The figure in a skirt: pelvis, thighs, the shins it swings against, and hands and forearms that swing against it; no head.
  const RiggedMesh figure = doublet::testing::figure_actor(0.03);
  BodyFit fit;
  fit.body = figure.mesh;
  RiggedMesh actor = figure;
  const Mesh skirt = doublet::testing::skirt();
  actor.mesh = doublet::testing::join({figure.mesh, skirt});
  actor.face_valid.assign(actor.mesh.faces.rows(), 1);
  const int body = static_cast<int>(figure.mesh.vertices.rows()), n = static_cast<int>(actor.mesh.vertices.rows());
  actor.weights = doublet::testing::figure_weights(actor.mesh.vertices, actor.skeleton);
  Segmentation segmentation{Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n), Eigen::VectorXi::Constant(n, -1), 1};
  for (int f = 0; f < figure.mesh.faces.rows(); ++f) { // what the skirt covers is not part of a real scan
    const auto p = figure.mesh.vertices.row(figure.mesh.faces(f, 0));
    if (p[1] > 0.5 && p[1] < 1.0 && std::abs(p[0]) < 0.3)
      actor.face_valid[f] = 0;
  }
  std::vector<int> kept;
  for (int f = 0; f < actor.mesh.faces.rows(); ++f)
    if (actor.face_valid[f])
      kept.push_back(f);
  std::vector<int> from;
  const Mesh scan = submesh(actor.mesh, kept, &from);
  Segmentation seen{Eigen::VectorXd::Zero(scan.vertices.rows()), Eigen::VectorXd::Zero(scan.vertices.rows()),
                    Eigen::VectorXi::Constant(scan.vertices.rows(), -1), 1};
  for (std::size_t i = 0; i < from.size(); ++i)
    seen.clothness[i] = from[i] >= body;
  actor.mesh = scan;
  actor.face_valid.assign(scan.faces.rows(), 1);
  std::map<std::string, int> count;
  for (const TaperedCapsule &c : fit_proxies(fit, actor, seen))
    ++count[actor.skeleton.joints[c.joint].name];
  for (const char *name : {"pelvis", "l_hip", "r_hip", "l_knee", "r_knee", "l_elbow", "r_elbow", "l_wrist", "r_wrist"})
    EXPECT_GT(count[name], 0) << name;
  for (const char *name : {"head", "neck", "chest"})
    EXPECT_EQ(count[name], 0) << name;
  for (std::size_t i = 0; i < from.size(); ++i) // hung at its upper edge, it can be thrown over the back
    if (scan.vertices(static_cast<Eigen::Index>(i), 1) > 0.97)
      seen.clothness[static_cast<Eigen::Index>(i)] = 0;
  count.clear();
  for (const TaperedCapsule &c : fit_proxies(fit, actor, seen))
    ++count[actor.skeleton.joints[c.joint].name];
  EXPECT_GT(count["chest"], 0);
  EXPECT_EQ(count["head"], 0);
}

TEST(Proxies, AHandIsAsWideAsItIs) {
  // An arm from the side of the limb down to a hand that is a board of 9 x 3 cm, and cloth where the hand reaches.
  Limb limb = make_limb();
  const Capsule arm{{0.3, 0.9, 0}, {0.3, 0.65, 0}, 0.03, 0.03};
  const auto distance = [&](const Eigen::Vector3d &p) {
    const Eigen::Vector3d from = (p - Eigen::Vector3d(0.3, 0.58, 0)).cwiseAbs() - Eigen::Vector3d(0.015, 0.08, 0.045);
    return std::min(signed_distance(arm, p), from.cwiseMax(0).norm() + std::min(from.maxCoeff(), 0.0));
  };
  limb.fit.body =
      doublet::testing::join({limb.fit.body, doublet::testing::level_set(distance, {0.2, 0.45, -0.1}, {0.4, 1, 0.1}, 0.01)});
  limb.actor.skeleton = make_skeleton({{"root", "", {0, 0.9, 0}, 6},
                                       {"knee", "root", {0, 0.5, 0}, 1},
                                       {"end", "knee", {0, 0.35, 0}, 0},
                                       {"l_shoulder", "root", {0.3, 0.9, 0}, 3},
                                       {"l_wrist", "l_shoulder", {0.3, 0.66, 0}, 2},
                                       {"l_hand", "l_wrist", {0.3, 0.55, 0}, 0}});
  const int wrist = limb.actor.skeleton.find("l_wrist");
  std::vector<Capsule> hand;
  for (const TaperedCapsule &c : fit_proxies(limb.fit, limb.actor, limb.segmentation))
    if (c.joint == wrist)
      hand.push_back(pose_capsule(c, limb.actor.skeleton, Transforms(6, Eigen::Isometry3d::Identity())));
  ASSERT_FALSE(hand.empty());
  for (const double z : {-0.045, 0.0, 0.045})
    for (const double y : {0.52, 0.6}) {
      double nearest = 1;
      for (const Capsule &c : hand)
        nearest = std::min(nearest, signed_distance(c, {0.3, y, z}));
      EXPECT_LT(nearest, 0.012) << y << ' ' << z;
    }
}

/// A pennant at the hip, of which no bone is covered by more than a tenth, hangs in the reach of an arm.
TEST(Proxies, LimbsThatReachClothThatCoversHardlyAnything) {
  Limb limb = make_limb();
  const Capsule arm{{0.3, 0.5, 0}, {0.3, 0.9, 0}, 0.04, 0.04};
  limb.fit.body = doublet::testing::join(
      {limb.fit.body, doublet::testing::level_set([&](const Eigen::Vector3d &p) { return signed_distance(arm, p); },
                                                  {0.2, 0.4, -0.1}, {0.4, 1, 0.1}, 0.01)});
  limb.actor.skeleton = make_skeleton({{"root", "", {0, 0.9, 0}, 6},
                                       {"knee", "root", {0, 0.5, 0}, 1},
                                       {"end", "knee", {0, 0.35, 0}, 0},
                                       {"l_shoulder", "root", {0.3, 0.9, 0}, 3},
                                       {"l_wrist", "l_shoulder", {0.3, 0.5, 0}, 2}});
  limb.actor.weights = MatrixRM::Constant(limb.actor.mesh.vertices.rows(), 5, 0.2);
  for (Eigen::Index v = 0; v < limb.actor.mesh.vertices.rows(); ++v) {
    const Eigen::RowVector3d x = limb.actor.mesh.vertices.row(v);
    limb.segmentation.clothness[v] = x.z() < -0.1 && x.x() > 0.1 && x.y() > 0.64 && x.y() < 0.72;
  }
  ASSERT_GT(limb.segmentation.clothness.sum(), 0);
  std::set<int> joints;
  for (const TaperedCapsule &c : fit_proxies(limb.fit, limb.actor, limb.segmentation))
    joints.insert(c.joint);
  EXPECT_EQ(joints, std::set<int>{limb.actor.skeleton.find("l_shoulder")}); // no bone is covered
}

TEST(Proxies, NoClothNoCapsules) {
  Limb limb = make_limb();
  limb.segmentation.clothness.setZero();
  EXPECT_TRUE(fit_proxies(limb.fit, limb.actor, limb.segmentation).empty());
  EXPECT_EQ(proxy_statistics({}, limb.fit, limb.actor, limb.segmentation).capsules, 0);
}

TEST(Proxies, RejectWrongInput) {
  const Limb limb = make_limb();
  ProxyOptions options;
  options.capsules_per_bone = 4;
  EXPECT_THROW(fit_proxies(limb.fit, limb.actor, limb.segmentation, options), std::invalid_argument);
  BodyFit empty;
  EXPECT_THROW(fit_proxies(empty, limb.actor, limb.segmentation), Error);
  Segmentation small;
  EXPECT_THROW(fit_proxies(limb.fit, limb.actor, small), std::invalid_argument);
}
