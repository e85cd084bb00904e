#pragma once
// How the joints of a skeleton hang together.

#include "doublet/core/skeleton.h"

#include <vector>

namespace doublet {

/// (J) number of joints whose parent each is: 0 where a limb ends, more than 1 where limbs leave the trunk.
std::vector<int> child_counts(const Skeleton &skeleton);

/// The joint at the other end of the bone that begins at `joint`: the first in the skeleton's order whose parent it is; -1 where
/// a limb ends.
int first_child(const Skeleton &skeleton, int joint);

} // namespace doublet
