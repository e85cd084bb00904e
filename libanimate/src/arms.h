#pragma once
// Which joints are of an arm.

#include "doublet/core/skeleton.h"

#include <array>
#include <vector>

namespace doublet::detail {

inline constexpr std::array kShoulders{"l_shoulder", "r_shoulder"};

/// (J) of each joint: 1 of the left arm, 2 of the right, from the shoulder on; 0 of none.
inline std::vector<int> arms_of_joints(const Skeleton &skeleton) {
  std::vector<int> arms;
  for (const Joint &joint : skeleton.joints) {
    int arm = joint.parent < 0 ? 0 : arms[joint.parent];
    for (std::size_t k = 0; k < kShoulders.size(); ++k)
      if (joint.name == kShoulders[k])
        arm = static_cast<int>(k) + 1;
    arms.push_back(arm);
  }
  return arms;
}

} // namespace doublet::detail
