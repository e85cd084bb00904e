#include "bind_pose.h"

#include "nearest_axes.h"

#include <algorithm>

namespace doublet {
namespace {

using Eigen::Affine3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Turns = std::map<int, Quaterniond>;

constexpr double kSameBones = 0.8;    // of a skin that have the directions of the nodes'
constexpr double kAnotherPose = 0.02; // rad, by which a joint stands otherwise than it was bound

/// Along its joint, as it is now and as it was bound.
bool is_same_bone(const Vector3d &now, const Vector3d &bound) {
  return bound.dot(now) >= 0.99 * now.norm() * bound.norm() && (now.norm() == 0 || bound.norm() > 0);
}

/// Has the skin the bones of the nodes? Files with matrices that are none are common.
bool has_bones_of_nodes(const BindPose &bind, const Turns &turns, const std::vector<int> &above,
                        const std::vector<Affine3d> &place, const std::vector<Quaterniond> &rest) {
  int bones = 0, alike = 0;
  for (const auto &[node, joint] : bind) {
    const int parent = above[node];
    if (parent < 0 || !bind.count(parent))
      continue;
    ++bones;
    alike += is_same_bone(rest[parent].conjugate() * (place[node].translation() - place[parent].translation()),
                          turns.at(parent).conjugate() * (joint.translation() - bind.at(parent).translation()));
  }
  return alike >= kSameBones * bones;
}

} // namespace

Turns turns_of_bind_pose(const BindPose &inverse, const std::vector<int> &above, const std::vector<Affine3d> &place,
                         const std::vector<Quaterniond> &rest) {
  BindPose bind;
  Turns turns;
  std::vector<Quaterniond> to_world;
  for (const auto &[node, matrix] : inverse) {
    if (!(matrix.linear().determinant() > 0)) // mirrored, or flat
      return {};
    bind[node] = matrix.inverse();
    turns[node] = Quaterniond(bind[node].linear().colwise().normalized().eval()).normalized();
    to_world.push_back(rest[node] * turns[node].conjugate());
  }
  const Quaterniond axes = nearest_axes(to_world); // exporters turn a mesh by these
  const bool differs = std::any_of(turns.begin(), turns.end(), [&](const auto &turn) {
    return rest[turn.first].angularDistance(axes * turn.second) > kAnotherPose;
  });
  if (!differs || !has_bones_of_nodes(bind, turns, above, place, rest))
    return {};
  for (auto &[node, turn] : turns)
    turn = axes * turn;
  return turns;
}

} // namespace doublet
