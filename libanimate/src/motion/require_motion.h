#pragma once
#include "doublet/animate/motion.h"

#include <string>

namespace doublet {

/// Throws std::invalid_argument, `who` in front, unless the motion has a rate, frames and the skeleton's degrees of freedom.
void require_motion(const Skeleton &skeleton, const Motion &motion, const std::string &who);

/// Is the rate, 1/s, one at which steps can be told and motions be smoothed?
bool has_steps(const Motion &motion);
/// Throws as require_motion, and unless has_steps().
void require_steps(const Skeleton &skeleton, const Motion &motion, const std::string &who);

} // namespace doublet
