#include "doublet/core/parts/skeleton_tree.h"
#include "doublet/rays/ray_scene.h"
#include "doublet/segment/cloth_prior.h"

#include <algorithm>
#include <string>

namespace doublet {
namespace {

constexpr double kOffMirror = 0.05; // m; arms and legs of a person are alike to that, and stances differ by more only in angles
constexpr double kSameWay = 0.5;    // cosine of mirrored normals

/// (J) the joint on the other side; of joints in the middle they themselves. Empty if no joint has a side.
std::vector<int> other_sides(const Skeleton &skeleton) {
  std::vector<int> other(skeleton.joint_count());
  bool sided = false;
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const std::string &name = skeleton.joints[j].name, side = name.substr(0, 2);
    const std::string wanted = side == "l_" ? "r_" + name.substr(2) : side == "r_" ? "l_" + name.substr(2) : name;
    const auto found =
        std::find_if(skeleton.joints.begin(), skeleton.joints.end(), [&](const Joint &joint) { return joint.name == wanted; });
    other[j] = found == skeleton.joints.end() ? -1 : static_cast<int>(found - skeleton.joints.begin());
    sided |= other[j] >= 0 && other[j] != j;
  }
  return sided ? other : std::vector<int>{};
}

/// From right to left, unit.
Eigen::Vector3d to_the_left(const Skeleton &skeleton, const std::vector<int> &other) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int j = 0; j < skeleton.joint_count(); ++j)
    if (other[j] >= 0 && skeleton.joints[j].name[0] == 'l')
      sum += skeleton.joints[j].rest - skeleton.joints[other[j]].rest;
  return sum.normalized();
}

/// Along the bone that begins at a joint, or, where a limb ends, along the one that leads to it; 0 turns nothing.
Eigen::Vector3d bone_of(const Skeleton &skeleton, int joint) {
  const Joint &at = skeleton.joints[joint];
  if (const int child = first_child(skeleton, joint); child >= 0)
    return skeleton.joints[child].rest - at.rest;
  return at.parent < 0 ? Eigen::Vector3d(0, 0, 0) : Eigen::Vector3d(at.rest - skeleton.joints[at.parent].rest);
}

/// (J) what carries a point beside a bone to the same place beside the bone of the other side.
std::vector<Eigen::Affine3d> mirrors(const Skeleton &skeleton, const std::vector<int> &other) {
  const Eigen::Vector3d left = to_the_left(skeleton, other);
  const Eigen::Matrix3d mirror = Eigen::Matrix3d::Identity() - 2 * left * left.transpose();
  std::vector<Eigen::Affine3d> result(skeleton.joint_count(), Eigen::Affine3d::Identity());
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    if (other[j] < 0)
      continue;
    const Eigen::Matrix3d turn =
        Eigen::Quaterniond::FromTwoVectors(mirror * bone_of(skeleton, j), bone_of(skeleton, other[j])).toRotationMatrix();
    result[j].linear() = turn * mirror;
    result[j].translation() = skeleton.joints[other[j]].rest - result[j].linear() * skeleton.joints[j].rest;
  }
  return result;
}

} // namespace

Eigen::VectorXi mirrored_vertices(const RiggedMesh &actor) {
  require_actor(actor, "mirrored_vertices");
  Eigen::VectorXi mirrored = Eigen::VectorXi::Constant(actor.mesh.vertices.rows(), -1);
  const std::vector<int> other = other_sides(actor.skeleton);
  if (other.empty())
    return mirrored;
  const std::vector<Eigen::Affine3d> carried = mirrors(actor.skeleton, other);
  const Vertices normals = vertex_normals(actor.mesh.vertices, actor.mesh.faces);
  const RayScene scene(actor.mesh, actor.face_valid);
  for (Eigen::Index v = 0; v < mirrored.size(); ++v) {
    Eigen::Index joint = 0;
    actor.weights.row(v).maxCoeff(&joint);
    if (other[joint] < 0)
      continue;
    const Eigen::Vector3d place = carried[joint] * Eigen::Vector3d(actor.mesh.vertices.row(v)),
                          normal = carried[joint].linear() * Eigen::Vector3d(normals.row(v));
    const Eigen::Index face = scene.closest(place).face;
    int nearest = -1;
    double least = kOffMirror;
    for (const int w : actor.mesh.faces.row(face))
      if (const double d = (actor.mesh.vertices.row(w).transpose() - place).norm();
          d < least && normals.row(w).dot(normal) > kSameWay) {
        least = d;
        nearest = w;
      }
    mirrored[v] = nearest;
  }
  return mirrored;
}

} // namespace doublet
