#pragma once
// A motion of a character's skeleton; resampling and blending in.

#include "doublet/core/skeleton.h"

namespace doublet {

/// Poses at a constant rate; row t of `dofs` is a pose vector of the character's skeleton.
struct Motion {
  double fps = 0; ///< frames per second
  MatrixRM dofs;  ///< (T, D) rad and m
};

/// The same motion at another rate; the first pose stays, and the last one if it falls on a frame of the new rate.
/// Throws std::invalid_argument unless both rates are positive and the motion has the skeleton's degrees of freedom.
Motion resample(const Skeleton &skeleton, const Motion &motion, double fps);

/// Prepends `hold_seconds` in the rest pose and `blend_seconds` from there to the motion's first pose (smoothstep), so that cloth
/// that is at rest in the rest pose is not torn away.
Motion blend_in(const Skeleton &skeleton, const Motion &motion, double hold_seconds, double blend_seconds);

} // namespace doublet
