#pragma once
// Kinematic skeleton: joints marked in the rest pose (the scan pose), a pose vector, forward kinematics and its twists.
//
// All joint frames are parallel to the world in the rest pose; a joint's transform world_from_rest carries rest-pose world points
// that are attached to the bone that *starts* at the joint. Joints without freedom follow their parent rigidly.

#include "doublet/core/types.h"

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace doublet {

/// How a joint's degrees of freedom move it.
enum class JointKind {
  Fixed,  ///< 0 dof
  Root,   ///< 6 dof: translation x y z (m) from the rest position, then angles y x z (rad), R = Ry Rx Rz (yaw never locks)
  Ball,   ///< 3 dof: rotation vector (rad), world axes of the rest pose
  Hinges, ///< 1 or 2 dof: R = exp(axes[0] a0) exp(axes[1] a1)
};

/// A joint as the user annotates it (joints.json).
struct JointAnnotation {
  std::string name;
  std::string parent;       ///< empty for the root
  Eigen::Vector3d position; ///< rest pose, world, m
  std::optional<int> dof;   ///< 0, 1, 2, 3 or 6; without it the default for the joint's name (36 in all for the standard names)
};

struct Joint {
  std::string name;
  int parent = -1;      ///< index, always smaller than the joint's own
  Eigen::Vector3d rest; ///< rest pose, world, m
  JointKind kind = JointKind::Fixed;
  std::vector<Eigen::Vector3d> axes; ///< Hinges: unit axes, world frame of the rest pose; axes[0] is outermost
  int first_dof = 0, dof_count = 0;
};

struct Skeleton {
  std::vector<Joint> joints;          ///< parents first
  std::vector<std::string> dof_names; ///< (D) "joint.component", e.g. "pelvis.tx", "l_knee.flex"
  Eigen::VectorXd lower, upper;       ///< (D) limits, human defaults; +-infinity where free

  int joint_count() const { return static_cast<int>(joints.size()); }
  int dof_count() const { return static_cast<int>(dof_names.size()); }
  /// Index of a joint; throws Error naming it and the joints there are if unknown.
  int find(const std::string &name) const;
  /// True if a limb, or the neck, ends at the joint: no joint has it as parent.
  bool is_leaf(int joint) const;
};

/// Builds the skeleton: sorts parents first (stable), chooses hinge axes from the rest geometry (knee, ankle, elbow flexion about
/// the normal of the bend; elbow twist along the forearm; wrist flexion and deviation across the hand), sets limits. Throws Error
/// on an unknown or missing parent, a cycle, no or two roots, a repeated name, a dof outside {0,1,2,3,6}.
Skeleton make_skeleton(const std::vector<JointAnnotation> &marks);

/// The inverse of make_skeleton: name, parent, rest position and dof count of every joint.
std::vector<JointAnnotation> joint_annotations(const Skeleton &skeleton);

/// world_from_rest of every joint for the pose `dofs` (D); throws std::invalid_argument unless it is that long and finite.
Transforms forward_kinematics(const Skeleton &skeleton, const Eigen::VectorXd &dofs);
void forward_kinematics(const Skeleton &skeleton, const Eigen::VectorXd &dofs, Transforms &world_from_rest);
/// (J, 3) joint positions of a pose.
Vertices joint_positions(const Skeleton &skeleton, const Transforms &world_from_rest);
void joint_positions(const Skeleton &skeleton, const Transforms &world_from_rest, Vertices &positions);

/// The instantaneous motion of one degree of freedom at a pose: a point x attached below `joint` moves by angular x x + linear.
struct DofTwist {
  int joint;
  Eigen::Vector3d angular, linear;
};
/// (D) spatial twists at the pose; exact derivatives of forward_kinematics (checked against finite differences).
std::vector<DofTwist> dof_twists(const Skeleton &skeleton, const Eigen::VectorXd &dofs);
/// (D, J) true if degree of freedom d moves points attached to joint j.
Eigen::Matrix<bool, Eigen::Dynamic, Eigen::Dynamic> dof_moves_joint(const Skeleton &skeleton);

/// The pose whose world rotations of joints (relative to the rest pose) are closest to the given ones, joint by joint from the
/// root; the root joint is at `root_position`. A joint with degrees of freedom takes the rotation of the last fixed joint in its
/// chain before the next joint with degrees of freedom (spine drives chest, neck drives head).
Eigen::VectorXd pose_from_rotations(const Skeleton &skeleton, const std::vector<Eigen::Quaterniond> &world_rotations,
                                    const Eigen::Vector3d &root_position, bool apply_limits);

/// The pose between `a` (s = 0) and `b` (s = 1): ball joints along the great arc, the root's yaw the short way round, the rest
/// linear.
Eigen::VectorXd interpolate_pose(const Skeleton &skeleton, const Eigen::VectorXd &a, const Eigen::VectorXd &b, double s);
/// The same into `pose`, which must be neither of them.
void interpolate_pose(const Skeleton &skeleton, const Eigen::VectorXd &a, const Eigen::VectorXd &b, double s,
                      Eigen::VectorXd &pose);

/// Rotation vector <-> rotation, and the left Jacobian of SO(3) (Sola et al. 2018, eq. 145).
Eigen::Matrix3d rotation_from_vector(const Eigen::Vector3d &rotation_vector);
Eigen::Vector3d vector_from_rotation(const Eigen::Matrix3d &rotation);
Eigen::Matrix3d left_jacobian(const Eigen::Vector3d &rotation_vector);

// Deprecated names.
using JointMark [[deprecated("use JointAnnotation")]] = JointAnnotation;
template <class... A> [[deprecated("use joint_annotations")]] decltype(auto) joint_marks(A &&...a) {
  return joint_annotations(std::forward<A>(a)...);
}

} // namespace doublet
