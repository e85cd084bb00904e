#include "doublet/core/stage_values.h"

#include "doublet/core/skinning.h"
#include "support/figure.h"

#include <gtest/gtest.h>

#include <random>

namespace doublet {

TEST(Capsules, SignedDistanceIsThatOfTheHullOfSpheres) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const auto &[r0, r1] : {std::pair{0.3, 0.1}, {0.1, 0.3}, {0.2, 0.2}, {0.9, 0.1}, {0.1, 0.9}}) {
    const Capsule c{{0.1, -0.2, 0}, {0.3, 0.4, 0.2}, r0, r1};
    for (int i = 0; i < 100; ++i) {
      const Eigen::Vector3d p(uniform(random), uniform(random), uniform(random));
      double best = 1e9; // over 10000 spheres
      for (int k = 0; k <= 10000; ++k) {
        const double t = k / 10000.0;
        best = std::min(best, (p - (1 - t) * c.p0 - t * c.p1).norm() - (1 - t) * r0 - t * r1);
      }
      EXPECT_NEAR(signed_distance(c, p), best, 1e-6);
    }
  }
  EXPECT_NEAR(signed_distance({{0, 0, 0}, {0, 0, 0}, 0.1, 0.2}, {1, 0, 0}), 0.8, 1e-12);
}

TEST(Capsules, MeshesAreClosedAndOnTheSurface) {
  for (const auto &[r0, r1] : {std::pair{0.3, 0.1}, {0.1, 0.3}, {0.2, 0.2}}) {
    const Capsule c{{0.1, -0.2, 0}, {0.3, 0.4, 0.2}, r0, r1};
    const Mesh mesh = capsule_mesh({c, c});
    const MeshReport report = report_mesh(mesh);
    EXPECT_TRUE(report.closed()) << report.to_string();
    EXPECT_EQ(report.degenerate_faces, 0);
    EXPECT_EQ(report.unused_vertices, 0);
    EXPECT_EQ(report.components, 2);
    for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v)
      EXPECT_NEAR(signed_distance(c, mesh.vertices.row(v)), 0, 1e-12);
    double volume = 0; // m^3; above 0 if faces look outwards
    for (const auto &face : mesh.faces.rowwise())
      volume += mesh.vertices.row(face[0]).dot(mesh.vertices.row(face[1]).cross(mesh.vertices.row(face[2]))) / 6;
    EXPECT_GT(volume, 0);
  }
}

TEST(UnposedFrames, UndoSkinning) {
  RiggedMesh actor;
  actor.skeleton = testing::figure_skeleton();
  actor.mesh = {Vertices::Random(30, 3), Faces(0, 3)};
  actor.weights = MatrixRM::Random(30, actor.skeleton.joint_count()).cwiseAbs();
  actor.weights.array().colwise() /= actor.weights.rowwise().sum().array();
  ReferencePerformance performance;
  performance.dofs = MatrixRM::Random(4, actor.skeleton.dof_count()) * 0.5;
  for (int t = 0; t < 4; ++t)
    performance.surface.frames.push_back(dual_quaternion_skinning(actor.mesh.vertices, actor.weights,
                                                                  forward_kinematics(actor.skeleton, performance.dofs.row(t))));
  for (const Vertices &frame : canonical_frames(actor, performance))
    EXPECT_LT((frame - actor.mesh.vertices).cwiseAbs().maxCoeff(), 1e-12);
  performance.dofs.conservativeResize(3, Eigen::NoChange);
  EXPECT_THROW(canonical_frames(actor, performance), std::invalid_argument);
}

TEST(Capsules, FollowTheirJoints) {
  const Skeleton s = testing::figure_skeleton();
  Eigen::VectorXd pose = Eigen::VectorXd::Constant(36, 0.3);
  const Transforms T = forward_kinematics(s, pose);
  const int knee = s.find("l_knee"), ankle = s.find("l_ankle");
  const auto posed = pose_capsules({{knee, {0, 0, 0}, s.joints[ankle].rest - s.joints[knee].rest, 0.06, 0.04}}, s, T);
  const Vertices joints = joint_positions(s, T);
  EXPECT_NEAR((posed[0].p0 - joints.row(knee).transpose()).norm(), 0, 1e-12);
  EXPECT_NEAR((posed[0].p1 - joints.row(ankle).transpose()).norm(), 0, 1e-12);
  EXPECT_THROW(pose_capsules({{99, {0, 0, 0}, {0, 1, 0}, 1, 1}}, s, T), std::invalid_argument);
  EXPECT_THROW(pose_capsules({}, s, {}), std::invalid_argument);
}

} // namespace doublet
