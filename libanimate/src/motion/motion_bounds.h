#pragma once
// How large a clip may be: no body has so many joints, and no file that fits in memory so many poses.

#include "doublet/core/error.h"
#include "doublet/options/options.h"

#include <cstddef>
#include <string>

namespace doublet {

constexpr std::size_t kMostJoints = 10'000;
constexpr double kMostPoses = 2e7; ///< joints (or nodes) x frames

inline void require_poses(double frames, std::size_t joints, const std::string &source) {
  if (!(frames * static_cast<double>(joints) <= kMostPoses))
    throw Error(source + ": expected a clip of at most " + options::to_text(kMostPoses) + " poses of nodes, found " +
                options::to_text(frames) + " of " + std::to_string(joints));
}

} // namespace doublet
