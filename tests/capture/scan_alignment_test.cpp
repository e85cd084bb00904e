// Scans of any unit, axis and place are brought to what the cameras see.

#include "doublet/capture/scan_alignment.h"
#include "doublet/core/error.h"
#include "doublet/core/stage_values.h"
#include "doublet/rays/ray_scene.h"
#include "support/figure.h"

#include <gtest/gtest.h>

namespace scan_alignment_test {

using namespace doublet;
using doublet::testing::pi;

/// One arm up and one knee forward: no turn or mirror looks the same.
Mesh person() {
  const Skeleton skeleton = doublet::testing::figure_skeleton();
  Eigen::VectorXd dofs = Eigen::VectorXd::Zero(skeleton.dof_count());
  const auto turn = [&](const char *name, double degrees) {
    const auto at = std::find(skeleton.dof_names.begin(), skeleton.dof_names.end(), name);
    dofs[at - skeleton.dof_names.begin()] = degrees * pi / 180;
  };
  turn("l_shoulder.z", 60);
  turn("r_hip.x", -30);
  turn("r_knee.flex", 40);
  return doublet::testing::figure_surface(skeleton, dofs, 0.035);
}

/// A square of 3 m at the person's feet.
Mesh floor_under(const Mesh &mesh) {
  constexpr int kSide = 16;
  const double bottom = mesh.vertices.col(1).minCoeff();
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3i> faces;
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j) {
      vertices.emplace_back(-1.5 + 0.2 * i, bottom, -1.5 + 0.2 * j);
      const int at = i * kSide + j;
      if (i + 1 < kSide && j + 1 < kSide) {
        faces.emplace_back(at, at + 1, at + kSide + 1);
        faces.emplace_back(at, at + kSide + 1, at + kSide);
      }
    }
  return doublet::testing::make_mesh(vertices, faces);
}

struct Place {
  const char *unit;
  double metres;
  const char *up;
  Eigen::Matrix3d y_from_up;
  bool floor;
  double heading;
};

Eigen::Matrix3d about(const Eigen::Vector3d &axis, double angle) {
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

/// The mesh as a scanner might have it.
Mesh spoilt(const Mesh &mesh, const Place &place) {
  Mesh scan = place.floor ? doublet::testing::join({mesh, floor_under(mesh)}) : mesh;
  scan.vertices.rowwise() -= Eigen::RowVector3d(0.4, 0, 0.1);
  scan.vertices *= about(Eigen::Vector3d::UnitY(), place.heading).transpose() * place.y_from_up / place.metres;
  scan.vertices.array() += 7;
  return scan;
}

TEST(ScanAlignment, BringsAScanBackFromAnyUnitAxisAndPlace) {
  const Mesh mesh = person();
  const RayScene surface(mesh);
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), z = Eigen::Vector3d::UnitZ();
  for (const Place &place : {Place{"mm", 0.001, "+z", about(x, -pi / 2), true, 2.1},
                             {"m", 1, "-y", about(x, pi), false, 0.4},
                             {"inches", 0.0254, "+x", about(z, pi / 2), true, 4.9},
                             {"cm", 0.01, "+y", Eigen::Matrix3d::Identity(), false, 3.0}}) {
    const AlignedScan found = align_scan(spoilt(mesh, place), mesh);
    EXPECT_EQ(found.unit, place.unit);
    EXPECT_EQ(found.up, place.up);
    EXPECT_EQ(found.floor, place.floor) << place.unit;
    EXPECT_LT(found.distance, 0.002) << place.unit;
    EXPECT_GT(found.mesh.vertices.rows(), 0.93 * mesh.vertices.rows()) << place.unit;
    double farthest = 0;
    for (const auto &row : found.mesh.vertices.rowwise())
      farthest = std::max(farthest, surface.closest(row).distance);
    EXPECT_LT(farthest, 0.02) << place.unit;
  }
}

TEST(ScanAlignment, SpecksAndSurroundingsGo) {
  const Mesh mesh = person();
  const Mesh speck = capsule_mesh({{{0.24, 0.4, 0}, {0.24, 0.41, 0}, 0.01, 0.01}}); // beside the knee
  const Mesh rail = capsule_mesh({{{-0.3, 0.7, -0.4}, {0.3, 0.7, -0.4}, 0.04, 0.04}});
  for (const Mesh &other : {speck, rail}) {
    const AlignedScan found = align_scan(doublet::testing::join({mesh, other}), mesh);
    EXPECT_EQ(found.mesh.faces.rows(), mesh.faces.rows());
    EXPECT_LT(found.distance, 0.002);
  }
}

TEST(ScanAlignment, DoesNotDependOnThreads) {
  const Mesh mesh = person(), scan = spoilt(mesh, {"m", 1, "+y", Eigen::Matrix3d::Identity(), false, 1});
  Context one, three;
  one.threads = 1;
  three.threads = 3;
  EXPECT_EQ(align_scan(scan, mesh, one).mesh.vertices, align_scan(scan, mesh, three).mesh.vertices);
}

TEST(ScanAlignment, AnotherPersonOrPoseIsRefused) {
  const Mesh mesh = person();
  Mesh ball = capsule_mesh({{{0, 0.5, 0}, {0, 1.5, 0}, 0.3, 0.3}});
  const auto refusal = [&] {
    try {
      align_scan(ball, mesh);
    } catch (const std::invalid_argument &error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_TRUE(refusal().starts_with("scan: expected the person and the pose that the cameras see, found it ")) << refusal();
  ball.vertices *= 7;
  EXPECT_TRUE(refusal().starts_with("scan: expected a person as high as the cameras see, 1.")) << refusal();
  EXPECT_TRUE(refusal().ends_with("found 4.2, 11.2, 4.2 units")) << refusal();
}

TEST(ScanAlignment, WhatIsNoMeshIsRefused) {
  const Mesh mesh = person();
  EXPECT_THROW(align_scan({}, mesh), Error);
  EXPECT_THROW(align_scan(mesh, {}), Error);
}

} // namespace scan_alignment_test
