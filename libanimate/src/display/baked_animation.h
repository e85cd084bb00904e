#pragma once
// What both kinds of baked files ask of an animation.

#include "doublet/animate/animator.h"

namespace doublet {

/// Throws std::invalid_argument unless the animation is of this character, with poses and joints in every frame.
void require_animation(const Character &character, const AnimationResult &animation);

} // namespace doublet
