// Limbs that a garment hides, and feet that turn.

#include "person_scene.h"

#include <gtest/gtest.h>

using namespace doublet;
using namespace person_scene;

namespace hidden_limbs_test {

CaptureResult track(const RiggedMesh &actor, const CameraRig &rig, const std::vector<Vertices> &truth,
                    const CaptureOptions &options) {
  Masks film(actor, rig, truth);
  return PerformanceCapture::create(options)->capture(actor, rig, film, nullptr, {});
}

double joint_error(const CaptureResult &result, const RiggedMesh &actor, const std::vector<Vertices> &truth,
                   const std::string &joint) {
  const int j = actor.skeleton.find(joint);
  double sum = 0;
  for (size_t t = 0; t < truth.size(); ++t)
    sum += (result.performance.joints[t].row(j) - truth[t].row(j)).norm() / truth.size();
  return sum;
}

TEST(SlowHiddenLimbs, AFootThatTurnsDoesNotTurnTheLeg) {
  const Scene scene;
  // The true ankle has a second hinge, about the shank.
  std::vector<JointAnnotation> marks = joint_annotations(scene.actor.skeleton);
  for (JointAnnotation &mark : marks)
    if (mark.name == "l_ankle")
      mark.dof = 2;
  RiggedMesh truth = scene.actor;
  truth.skeleton = make_skeleton(marks);
  const auto dof = [&](const std::string &name) {
    const auto &names = truth.skeleton.dof_names;
    return std::find(names.begin(), names.end(), name) - names.begin();
  };
  MatrixRM dofs = MatrixRM::Zero(8, truth.skeleton.dof_count());
  std::vector<Vertices> joints;
  for (int t = 0; t < dofs.rows(); ++t) {
    dofs(t, dof("l_hip.x")) = -0.09 * t; // the knee rises,
    dofs(t, dof("l_knee.flex")) = 0.12 * t;
    dofs(t, dof("l_ankle.turn")) = -0.09 * t; // and the foot turns by 36 degrees
    joints.push_back(joint_positions(truth.skeleton, forward_kinematics(truth.skeleton, dofs.row(t))));
  }
  const auto surfaces = tracker_scene::surfaces(truth, dofs);
  CaptureOptions options;
  options.second_pass = false;
  const CaptureResult free = track(scene.actor, scene.rig, surfaces, options);
  EXPECT_LT(joint_error(free, scene.actor, joints, "l_toe"), 0.015);
  EXPECT_LT(joint_error(free, scene.actor, joints, "l_knee"), 0.010);
  EXPECT_EQ(free.performance.dofs.cols(), scene.actor.skeleton.dof_count()); // the poses are the actor's
  options.extra_twist_range = 0;
  const CaptureResult stiff = track(scene.actor, scene.rig, surfaces, options);
  EXPECT_GT(joint_error(stiff, scene.actor, joints, "l_toe") + joint_error(stiff, scene.actor, joints, "l_knee"), 0.03);
}

/// The figure in a skirt, skinned to the legs as a template is: the skirt's vertices come last.
RiggedMesh skirted(int &first_of_skirt) {
  RiggedMesh actor = doublet::testing::figure_actor(0.045);
  first_of_skirt = static_cast<int>(actor.mesh.vertices.rows());
  actor.mesh = doublet::testing::join({actor.mesh, doublet::testing::skirt()});
  actor.face_valid.assign(actor.mesh.faces.rows(), 1);
  const int joints = actor.skeleton.joint_count();
  actor.weights.conservativeResize(actor.mesh.vertices.rows(), joints);
  for (int i = first_of_skirt; i < actor.weights.rows(); ++i) {
    const double down = std::clamp((0.95 - actor.mesh.vertices(i, 1)) / 0.15, 0.0, 1.0);
    actor.weights.row(i).setZero();
    actor.weights(i, actor.skeleton.find("pelvis")) = 1 - down;
    actor.weights(i, actor.skeleton.find(actor.mesh.vertices(i, 0) > 0 ? "l_hip" : "r_hip")) = down;
  }
  return actor;
}

TEST(HiddenLimbs, KneesUnderASkirtFollowFromTheShanks) {
  const Scene scene;
  int skirt = 0;
  const RiggedMesh actor = skirted(skirt);
  MatrixRM dofs = MatrixRM::Zero(9, actor.skeleton.dof_count());
  std::vector<Vertices> surfaces, joints;
  for (int t = 0; t < dofs.rows(); ++t) { // the legs move, the skirt hangs
    dofs(t, scene.dof("l_hip.x")) = -std::min(0.08 * t, 0.5);
    dofs(t, scene.dof("l_knee.flex")) = 1.5 * std::min(0.08 * t, 0.5);
    surfaces.push_back(pose_surface(actor, dofs.row(t), {}).vertices);
    const auto hanging = actor.mesh.vertices.rows() - skirt;
    surfaces.back().bottomRows(hanging) = actor.mesh.vertices.bottomRows(hanging);
    joints.push_back(joint_positions(actor.skeleton, forward_kinematics(actor.skeleton, dofs.row(t))));
  }
  tracker_scene::Frames film(actor, scene.rig, surfaces);
  CaptureOptions options;
  options.second_pass = false;
  const CaptureResult result = PerformanceCapture::create(options)->capture(actor, scene.rig, film, nullptr, {});
  EXPECT_LT(joint_error(result, actor, joints, "l_knee"), 0.010);
  for (const JointVisibility &sight : result.summary.joints) {
    EXPECT_EQ(sight.seen + sight.inferred + sight.lost, dofs.rows()) << sight.joint;
    if (sight.joint != "r_hip") { // whose half of the skirt hangs still
      EXPECT_EQ(sight.inferred, sight.joint == "l_hip" ? dofs.rows() : 0) << sight.joint;
    }
  }
}

TEST(SlowHiddenLimbs, TheSecondPassKnowsWhatIsLoose) {
  const RiggedMesh actor = tracker_scene::figure();
  const CameraRig rig = tracker_scene::ring();
  MatrixRM dofs = MatrixRM::Zero(12, actor.skeleton.dof_count());
  std::vector<Vertices> truth;
  const int first = actor.skeleton.joints[actor.skeleton.find("lower")].first_dof;
  for (int t = 0; t < dofs.rows(); ++t) {
    dofs(t, first) = 0.05 * t;
    truth.push_back(pose_surface(actor, dofs.row(t), {}).vertices);
    for (int i = 0; i < truth.back().rows(); ++i) // what covers the upper half of the lower limb stays where it was
      if (const double y = actor.mesh.vertices(i, 1); y > 0.25)
        truth.back().row(i) = actor.mesh.vertices.row(i);
  }
  tracker_scene::Frames film(actor, rig, truth);
  double error[2];
  for (const bool twice : {false, true}) {
    CaptureOptions options;
    options.second_pass = twice;
    const CaptureResult result = PerformanceCapture::create(options)->capture(actor, rig, film, nullptr, {});
    error[twice] = (result.performance.dofs - dofs).middleCols(first, 3).cwiseAbs().maxCoeff();
  }
  EXPECT_LT(error[true], 0.7 * error[false]);
}

} // namespace hidden_limbs_test
