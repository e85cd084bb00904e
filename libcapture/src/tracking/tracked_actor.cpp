#include "tracked_actor.h"

#include "doublet/core/parts/invalid_faces.h"

namespace doublet {
namespace {

/// Is the joint a single hinge below which nothing moves on its own?
bool ends_with_hinge(const Skeleton &skeleton, int joint) {
  const Joint &hinge = skeleton.joints[joint];
  if (hinge.kind != JointKind::Hinges || hinge.dof_count != 1 || hinge.parent < 0 ||
      (hinge.rest - skeleton.joints[hinge.parent].rest).norm() < 1e-6)
    return false;
  const auto moved = dof_moves_joint(skeleton);
  for (int j = joint + 1; j < skeleton.joint_count(); ++j)
    if (moved(hinge.first_dof, j) && skeleton.joints[j].dof_count > 0)
      return false;
  return true;
}

TrackedActor let_ends_turn(const RiggedMesh &actor, double most) {
  TrackedActor freed{actor, {}};
  Skeleton &skeleton = freed.actor.skeleton;
  skeleton.dof_names.clear();
  std::vector<double> lower, upper;
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    Joint &joint = skeleton.joints[j];
    const Joint &own = actor.skeleton.joints[j];
    joint.first_dof = skeleton.dof_count();
    if (most > 0 && ends_with_hinge(actor.skeleton, j)) {
      joint.axes.insert(joint.axes.begin(), (joint.rest - skeleton.joints[joint.parent].rest).normalized());
      joint.dof_count = 2;
      skeleton.dof_names.push_back(joint.name + ".turn");
      lower.push_back(-most);
      upper.push_back(most);
    }
    for (int d = own.first_dof; d < own.first_dof + own.dof_count; ++d) {
      freed.kept.push_back(skeleton.dof_count());
      skeleton.dof_names.push_back(actor.skeleton.dof_names[d]);
      lower.push_back(actor.skeleton.lower[d]);
      upper.push_back(actor.skeleton.upper[d]);
    }
  }
  skeleton.lower = Eigen::Map<Eigen::VectorXd>(lower.data(), lower.size());
  skeleton.upper = Eigen::Map<Eigen::VectorXd>(upper.data(), upper.size());
  return freed;
}

} // namespace

TrackedActor track_actor(const RiggedMesh &actor, double most_turn) {
  TrackedActor tracked = let_ends_turn(actor, most_turn);
  tracked.actor.face_valid = extend_invalid_faces(actor.mesh, actor.face_valid);
  return tracked;
}

std::vector<int> limb_bones(const Skeleton &skeleton) {
  std::vector<int> ends(skeleton.joint_count(), -1);
  for (int j = 0; j < skeleton.joint_count(); ++j)
    if (const Joint &end = skeleton.joints[j];
        end.kind == JointKind::Hinges && end.parent >= 0 && (end.rest - skeleton.joints[end.parent].rest).norm() > 1e-6)
      ends[end.parent] = j;
  return ends;
}

} // namespace doublet
