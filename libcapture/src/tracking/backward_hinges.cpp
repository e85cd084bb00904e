#include "backward_hinges.h"

#include "doublet/core/parts/skeleton_tree.h"

#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace doublet::detail {
namespace {

constexpr double kBackwards = 3 * std::numbers::pi / 180; // marks of joints are not exact

bool is_flexion(const Skeleton &skeleton, int joint) {
  const Joint &hinge = skeleton.joints[joint];
  return first_child(skeleton, joint) >= 0 && hinge.kind == JointKind::Hinges &&
         skeleton.dof_names[hinge.first_dof] == hinge.name + ".flex" && hinge.parent >= 0 &&
         skeleton.joints[hinge.parent].kind == JointKind::Ball;
}

/// rad, in the rest pose.
double bend_at_rest(const Skeleton &skeleton, int joint) {
  const Joint &hinge = skeleton.joints[joint];
  const Eigen::Vector3d in = hinge.rest - skeleton.joints[hinge.parent].rest,
                        out = skeleton.joints[first_child(skeleton, joint)].rest - hinge.rest;
  return std::atan2(hinge.axes[0].dot(in.cross(out)), in.dot(out));
}

} // namespace

bool bends_backwards(const Skeleton &skeleton, const Limb &limb, const Eigen::VectorXd &dofs) {
  return std::any_of(limb.joints.begin(), limb.joints.end(), [&](int joint) {
    return is_flexion(skeleton, joint) && dofs[skeleton.joints[joint].first_dof] + bend_at_rest(skeleton, joint) < -kBackwards;
  });
}

RiggedMesh forwards_only(RiggedMesh actor) {
  Skeleton &skeleton = actor.skeleton;
  for (int j = 0; j < skeleton.joint_count(); ++j)
    if (is_flexion(skeleton, j))
      skeleton.lower[skeleton.joints[j].first_dof] = -bend_at_rest(skeleton, j);
  return actor;
}

} // namespace doublet::detail
