#pragma once
// Dual quaternion skinning, Kavan et al. 2007, with the shortest-arc sign fix per vertex.

#include "doublet/core/types.h"

namespace doublet {

/// (V, 3) skinned positions of `rest` (V, 3) under `weights` (V, J), rows summing to one, and J transforms world_from_rest.
Vertices dual_quaternion_skinning(const Vertices &rest, const MatrixRM &weights, const Transforms &world_from_rest);

/// The blended rigid transform of every vertex (V): skinned position = transform * rest position.
Transforms dual_quaternion_blend(const MatrixRM &weights, const Transforms &world_from_rest);

/// Linear blend skinning, for files made with it.
Vertices linear_blend_skinning(const Vertices &rest, const MatrixRM &weights, const Transforms &world_from_rest);

} // namespace doublet
