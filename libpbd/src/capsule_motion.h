#pragma once
// A tapered capsule moving rigidly during one step, and what a vertex meets on its way past it.

#include "doublet/pbd/cloth_solver.h"
#include "kernels.h"

namespace doublet::pbd {

/// Distances to `c` seen from `origin` (local = world - origin), as kernels want them.
CapsuleShape capsule_shape(const Capsule &c, const Eigen::Vector3d &origin);

/// Start and end of one step. The motion between is the rigid one that turns the axis by the shortest way; spin about the axis
/// leaves the surface where it is and is left out.
struct CapsuleMotion {
  CapsuleShape start, end;
  float rotation[9]; ///< row-major, end_from_start

  Vec3f rotate(Vec3f d) const;      ///< direction, start -> end
  Vec3f rotate_back(Vec3f d) const; ///< direction, end -> start
  Vec3f carry(Vec3f p) const;       ///< point fixed to the capsule, start -> end
  Vec3f carry_back(Vec3f p) const;  ///< the same, end -> start
};
CapsuleMotion capsule_motion(const Capsule &start, const Capsule &end, const Eigen::Vector3d &origin);

/// First point of the segment q0 -> q1 closer than `thickness` to the capsule, as a fraction in [0, 1]; 2 if there is none. The
/// distance to a convex body is convex along a line, so Newton's method from an outside q0 walks up to the first root and never
/// past it.
float entry_time(const CapsuleShape &shape, Vec3f q0, Vec3f q1, float thickness);

} // namespace doublet::pbd
