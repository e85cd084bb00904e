#pragma once
// A motion of our own skeleton, and the small things one does with it.

#include "doublet/core/skeleton.h"

namespace doublet {

/// Poses at a constant rate; row t of `dofs` is a pose vector of the character's skeleton.
struct Motion {
  double fps = 0; ///< frames a second
  MatrixRM dofs;  ///< (T, D) rad and m
};

/// The same motion at another rate; first and last pose stay (the last as far as the new rate reaches it).
/// Throws std::invalid_argument unless both rates are positive and the motion has the skeleton's degrees of freedom.
Motion resample(const Skeleton &skeleton, const Motion &motion, double fps);

/// The motion with a start in front of it: `hold_seconds` in the rest pose, then `blend_seconds` from there to the motion's first
/// pose (smoothstep), so that cloth that rests in the rest pose is not torn away.
Motion blend_in(const Skeleton &skeleton, const Motion &motion, double hold_seconds, double blend_seconds);

} // namespace doublet
