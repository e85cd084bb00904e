#pragma once
// Arms that another person's clip presses into the body: with other proportions the same angles can put a hand into a thigh.

#include "doublet/animate/character.h"
#include "doublet/animate/motion.h"
#include "doublet/core/context.h"

namespace doublet {

/// The motion with the shoulders turned until forearms and hands are clear of the body, both as the character's tapered capsules,
/// with room for a layer of cloth and its thickness on both sides; less where they are closer in the rest pose. Smooth in time:
/// an arm begins to turn before it would touch. Only the ball joints l_shoulder and r_shoulder change. A motion in which the arms
/// are clear does not change, nor does any motion of a character without capsules below the elbows. Throws std::invalid_argument
/// unless the motion has frames, a rate in [0.1, 10000] 1/s, and the skeleton's degrees of freedom.
Motion resolve_arm_penetration(const Character &character, const Motion &motion, const Context &context = {});

} // namespace doublet
