#pragma once
// Dual quaternion skinning, Kavan et al. 2007.
//
// The dual quaternions q and -q are the same transform; the sign used in a blend decides the direction of the rotation. With a
// skeleton each joint takes the sign that is nearer to its parent's, from the root outwards, so that all vertices agree, however
// far consecutive joints bend. Without a skeleton each vertex takes the signs nearer to that of its joint with the largest weight
// (the paper's fix); the result is the same while no two joints of a vertex are more than half a turn apart, and beyond that the
// surface tears.

#include "doublet/core/skeleton.h"

namespace doublet {

/// (V, 3) skinned positions of `rest` (V, 3) under `weights` (V, J), rows summing to one, and J transforms world_from_rest.
Vertices dual_quaternion_skinning(const Vertices &rest, const MatrixRM &weights, const Transforms &world_from_rest);
/// The same with signs along the skeleton.
Vertices dual_quaternion_skinning(const Vertices &rest, const MatrixRM &weights, const Skeleton &skeleton,
                                  const Transforms &world_from_rest);

/// A rigid transform as unit dual quaternion: real w x y z, dual w x y z (Kavan et al. 2007, eq. 4).
using DualQuaternion = Eigen::Matrix<double, 8, 1>;
/// (J) one per joint, with the sign that is nearer to its parent's; throws std::invalid_argument unless there are J transforms.
void dual_quaternions(const Skeleton &skeleton, const Transforms &world_from_rest, std::vector<DualQuaternion> &joints);

/// Dual quaternion skinning of one surface in many poses: stores only non-zero weights, contiguously, and allocates nothing once
/// `skinned` has its size. Same bits as dual_quaternion_skinning() with a skeleton. Immutable.
class SkinBinding {
public:
  /// Throws std::invalid_argument unless rest (V, 3) is finite and every row of weights (V, J) has a sum above 0.
  SkinBinding(const Vertices &rest, const MatrixRM &weights);
  /// skinned (V, 3); joints as dual_quaternions() gives them. Throws std::invalid_argument unless there are J.
  void pose(const std::vector<DualQuaternion> &joints, Vertices &skinned) const;

private:
  Vertices rest_;
  Eigen::Index joint_count_;
  std::vector<int> first_;  ///< [V + 1] into what follows
  std::vector<int> joints_; ///< ascending within a vertex
  std::vector<double> weights_;
  std::vector<int> pivots_; ///< [V] the joint with the largest weight, the first of equal ones
};

/// The blended rigid transform of every vertex (V): skinned position = transform * rest position.
Transforms dual_quaternion_blend(const MatrixRM &weights, const Transforms &world_from_rest);
/// The same with signs along the skeleton.
Transforms dual_quaternion_blend(const MatrixRM &weights, const Skeleton &skeleton, const Transforms &world_from_rest);

/// Linear blend skinning, for files made with it.
Vertices linear_blend_skinning(const Vertices &rest, const MatrixRM &weights, const Transforms &world_from_rest);

} // namespace doublet
