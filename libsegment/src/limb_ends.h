#pragma once
// Where limbs end: toes, hands, the top of the head.

#include "doublet/core/stage_values.h"

#include <vector>

namespace doublet::detail {

struct LimbEnd {
  int leaf = 0;  ///< the last joint
  int mover = 0; ///< the joint that moves the surface there: the leaf if it moves anything (a wrist), else its parent (the leaf
                 ///< only marks a fingertip)
};

/// In the order of the skeleton, without limbs that the root moves: it carries the trunk.
std::vector<LimbEnd> limb_ends(const RiggedMesh &actor);

} // namespace doublet::detail
