// The rest pose out of tracked frames: a figure whose template is too thin, tracked as it is.
#include "doublet/capture/rest_pose.h"

#include "../support/figure.h"
#include "../support/option_ranges.h"
#include "doublet/core/error.h"
#include "doublet/core/skinning.h"

#include <gtest/gtest.h>

#include <limits>

using namespace doublet;
using namespace doublet::testing;

namespace rest_pose_test {

struct Tracked {
  RiggedMesh actor = figure_actor(0.04); ///< template, thinner than
  Vertices truth;                        ///< this, 6 mm along the normals
  ReferencePerformance performance;      ///< of the truth
  std::vector<std::uint8_t> rigid;       ///< all but the hips and below, as under a skirt

  Tracked() {
    truth = actor.mesh.vertices;
    actor.mesh.vertices -= 0.006 * vertex_normals(truth, actor.mesh.faces);
    for (Eigen::Index v = 0; v < truth.rows(); ++v)
      rigid.push_back(truth(v, 1) > 0.9);
    const int dofs = actor.skeleton.dof_count();
    for (int t = 0; t < 24; ++t)
      add(Eigen::VectorXd::Constant(dofs, t % 3 == 0 ? 0.05 * std::sin(t) : 0.9), t % 3 != 0);
  }

  /// A frame of the truth; one that is `wrong` is 4 cm off.
  void add(const Eigen::VectorXd &dofs, bool wrong) {
    const Eigen::Index t = performance.dofs.rows();
    performance.dofs.conservativeResize(t + 1, dofs.size());
    performance.dofs.row(t) = dofs.transpose();
    const Vertices seen = truth.array() + (wrong ? 0.04 : 0.0);
    performance.surface.frames.push_back(
        dual_quaternion_skinning(seen, actor.weights, actor.skeleton, forward_kinematics(actor.skeleton, dofs)));
  }
  Eigen::VectorXd errors(const Vertices &vertices) const { return (vertices - truth).rowwise().norm(); }
};

TEST(RestPoseOptions, Ranges) {
  expect_ranges<RestPoseOptions>();
}

TEST(RestPose, SkinGoesWhereTheLeastBentFramesHaveIt) {
  const Tracked tracked;
  const Vertices refined = refine_rest_pose(tracked.actor, tracked.performance, tracked.rigid);
  const Eigen::VectorXd before = tracked.errors(tracked.actor.mesh.vertices), after = tracked.errors(refined);
  double skin = 0, far_below = 0;
  int skin_count = 0;
  for (Eigen::Index v = 0; v < after.size(); ++v)
    if (tracked.truth(v, 1) > 1.0) {
      skin += after[v];
      ++skin_count;
    } else if (tracked.truth(v, 1) < 0.6)
      far_below = std::max(far_below, std::abs(after[v] - before[v]));
  EXPECT_NEAR(before.mean(), 0.006, 1e-6);
  EXPECT_LT(skin / skin_count, 0.0015); // what is smoothed away at hands and neck
  EXPECT_LT(far_below, 1e-3);           // cloth stays
}

TEST(RestPose, OfClothAloneNothingIsTold) {
  const Tracked tracked;
  EXPECT_THROW(refine_rest_pose(tracked.actor, tracked.performance, std::vector<std::uint8_t>(tracked.truth.rows(), 0)), Error);
}

TEST(RestPose, WhatNobodySawFollowsItsSurroundings) {
  Tracked tracked;
  for (Eigen::Index f = 0; f < tracked.actor.mesh.faces.rows(); ++f)
    tracked.actor.face_valid[f] = tracked.truth(tracked.actor.mesh.faces(f, 0), 0) < 0; // one half of the body
  const Vertices refined =
      refine_rest_pose(tracked.actor, tracked.performance, std::vector<std::uint8_t>(tracked.truth.rows(), 1));
  EXPECT_LT(tracked.errors(refined).maxCoeff(), 0.025);
  EXPECT_TRUE(refined.allFinite());
}

TEST(RestPose, SaysWhatDoesNotGoTogether) {
  Tracked tracked;
  EXPECT_THROW(refine_rest_pose(tracked.actor, tracked.performance, {1, 0}), std::invalid_argument);
  tracked.performance.surface.frames[3](0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_ANY_THROW(refine_rest_pose(tracked.actor, tracked.performance, tracked.rigid));
  Tracked broken;
  broken.actor.mesh.faces(5, 1) = -1;
  EXPECT_THROW(refine_rest_pose(broken.actor, broken.performance, broken.rigid), Error);
  RestPoseOptions options;
  options.frames = 0;
  EXPECT_THROW(refine_rest_pose(tracked.actor, tracked.performance, tracked.rigid, options), std::invalid_argument);
}

} // namespace rest_pose_test
