#include "joint_visibility.h"

#include <algorithm>
#include <string>

namespace doublet::detail {
namespace {

/// m; to the farthest joint that hangs on this one directly.
double bone_length(const Skeleton &skeleton, int joint) {
  double length = 0;
  for (const Joint &child : skeleton.joints)
    if (child.parent == joint)
      length = std::max(length, (child.rest - skeleton.joints[joint].rest).norm());
  return length;
}

/// (J) m^2 of valid surface that is seen and moves with each joint.
Eigen::VectorXd seen_areas(const RiggedMesh &actor, const std::vector<FaceBuffer> &visible, const Eigen::VectorXd &reliability) {
  constexpr double kReliable = 0.5; // moves with the skeleton
  std::vector<char> shown(actor.mesh.faces.rows(), 0);
  for (const FaceBuffer &view : visible)
    for (const int face : view.face)
      if (face >= 0)
        shown[face] = actor.face_valid[face];
  const Eigen::VectorXd areas = face_areas(actor.mesh.vertices, actor.mesh.faces);
  Eigen::VectorXd seen = Eigen::VectorXd::Zero(actor.skeleton.joint_count());
  for (int f = 0; f < actor.mesh.faces.rows(); ++f)
    for (int c = 0; shown[f] && c < 3; ++c)
      if (const int i = actor.mesh.faces(f, c); reliability[i] >= kReliable)
        seen += areas[f] / 3 * actor.weights.row(i).transpose();
  return seen;
}

} // namespace

void count_joints(const RiggedMesh &actor, const std::vector<FaceBuffer> &visible, const Eigen::VectorXd &reliability,
                  const std::vector<Limb> &limbs, const std::vector<std::string> &lost, std::vector<JointVisibility> &joints) {
  constexpr double kSeen = 0.08; // m^2 for each m^2 of the bone's length: a fifth of a bare shank
  const Skeleton &skeleton = actor.skeleton;
  const Eigen::VectorXd seen = seen_areas(actor, visible, reliability);
  std::vector<char> of_lost(skeleton.joint_count(), 0);
  for (const Limb &limb : limbs)
    for (int j : limb.joints)
      of_lost[j] = of_lost[j] || std::find(lost.begin(), lost.end(), limb.name) != lost.end();
  for (JointVisibility &sight : joints) {
    const int j = skeleton.find(sight.joint);
    const double length = bone_length(skeleton, j);
    ++(of_lost[j] ? sight.lost : seen[j] >= kSeen * length * length ? sight.seen : sight.inferred);
  }
}

void say_what_was_hidden(const std::vector<JointVisibility> &joints, const Context &context) {
  for (const JointVisibility &sight : joints)
    if (sight.inferred + sight.lost > 0)
      context.log_line("capture: joint '" + sight.joint + "': seen in " + std::to_string(sight.seen) + " frames, inferred in " +
                       std::to_string(sight.inferred) + ", lost in " + std::to_string(sight.lost));
}

} // namespace doublet::detail
