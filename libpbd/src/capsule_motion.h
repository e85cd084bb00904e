#pragma once
// Capsules of the world made ready for the kernels.

#include "doublet/pbd/cloth_solver.h"
#include "kernels.h"

namespace doublet::pbd {

/// Distances to `c` seen from `origin` (local = world - origin), as kernels want them.
CapsuleShape<float> capsule_shape(const Capsule &c, const Eigen::Vector3d &origin);

/// The shortest rigid motion between two places of a capsule.
CapsuleMotion<float> capsule_motion(const Capsule &start, const Capsule &end, const Eigen::Vector3d &origin);

} // namespace doublet::pbd
