#pragma once
// Dual quaternion skinning, Kavan et al. 2007.
//
// A transform is two dual quaternions, q and -q, and which of them a blend takes decides which way round it goes. Where there is
// a skeleton each joint takes the one nearer to its parent's, from the root outwards, so that all vertices agree, however far
// joints in a row bend together. Without one each vertex takes those nearer to that of its heaviest joint (the paper's fix),
// which is the same while no two joints of a vertex are more than half a turn apart, and tears the surface beyond.

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

/// Dual quaternion skinning of one surface in many poses: the weights that are not 0 lie in a row, and once `skinned` has its
/// size nothing is allocated. The bits of dual_quaternion_skinning() along the skeleton. Immutable.
class SkinBinding {
public:
  /// rest (V, 3) finite, weights (V, J) with a row sum above 0; else std::invalid_argument.
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
