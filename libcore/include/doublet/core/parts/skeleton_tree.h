#pragma once
// The tree of a skeleton's joints.

#include "doublet/core/skeleton.h"

#include <vector>

namespace doublet {

/// (J) number of children of each joint: 0 where a limb ends, more than 1 where limbs leave the trunk.
std::vector<int> child_counts(const Skeleton &skeleton);

/// The joint at the other end of the bone that begins at `joint`: its first child in the skeleton's order; -1 where a limb ends.
int first_child(const Skeleton &skeleton, int joint);

} // namespace doublet
