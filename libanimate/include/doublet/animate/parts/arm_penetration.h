#pragma once
// Arms that another person's clip presses into the body: with other proportions the same angles put a hand into a thigh.

#include "doublet/animate/character.h"
#include "doublet/animate/motion.h"
#include "doublet/core/context.h"

namespace doublet {

/// The motion with shoulders turned so far that forearms and hands are clear of the body, as the character's tapered capsules
/// tell, with room for a layer of cloth that keeps its thickness from both; less where they are nearer in the rest pose. Smooth
/// in time: an arm begins to turn before it would touch. Only the balls l_shoulder and r_shoulder change, a motion in which the
/// arms are clear not at all, and none of a character without capsules below the elbows. Throws std::invalid_argument unless the
/// motion has frames, a rate in [0.1, 10000] 1/s, and the skeleton's degrees of freedom.
Motion resolve_arm_penetration(const Character &character, const Motion &motion, const Context &context = {});

} // namespace doublet
