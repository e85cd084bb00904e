#pragma once
// What both kinds of baked files ask of an animation.

#include "doublet/animate/animator.h"
#include "doublet/core/textured_faces.h"

namespace doublet {

/// Throws std::invalid_argument unless the animation is of this character, with poses and joints in every frame.
void require_animation(const Character &character, const AnimationResult &animation);

/// What is drawn of M_high: `drawn`, or if that is empty its valid faces. Throws std::invalid_argument if it does not fit.
TexturedFaces faces_to_draw(const Character &character, const AnimationResult &animation, const TexturedFaces &drawn);

} // namespace doublet
