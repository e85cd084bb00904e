#pragma once
// The rest pose again, from what was tracked: where there is no scanner the template is one frame's hull, and the frames around
// it show the body better.

#include "doublet/core/context.h"
#include "doublet/core/stage_values.h"
#include "doublet/options/options.h"

#include <cstdint>
#include <vector>

namespace doublet {

struct RestPoseOptions {
  int frames = 8;
  double most_bend = 15;
  double smoothing = 0.015;
  double reach = 0.05;
  static constexpr auto describe() {
    using namespace options;
    using O = RestPoseOptions;
    return Description{
        "RestPoseOptions",
        option(&O::frames, "frames", Range{1, 1000}, "",
               "a vertex is where the median of so many frames has it, of those in which the joints around it are bent least"),
        option(&O::most_bend, "most_bend", Range{0, 180}, "degrees",
               "frames in which they are bent more than this, on average by skin weight, tell nothing of a vertex"),
        option(&O::smoothing, "smoothing", Range{0.001, 0.1}, "m", "detail of the correction smaller than this is noise"),
        option(&O::reach, "reach", Range{0.001, 1}, "m",
               "how far into cloth, which is not corrected, the correction of the skin beside it fades"),
    };
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
};

/// (V, 3) m: the actor's vertices in the rest pose, those that follow the skeleton (rigid (V) != 0: skin, not cloth) on valid
/// faces moved to where the frames, taken back to the rest pose (unposed_frames()), have them. A membrane carries the correction
/// over what no frame tells of, and out into the rest. Throws std::invalid_argument unless actor, performance and rigid go
/// together; Error if no frame tells of any vertex.
Vertices refine_rest_pose(const RiggedMesh &actor, const ReferencePerformance &performance,
                          const std::vector<std::uint8_t> &rigid, const RestPoseOptions &options = {},
                          const Context &context = {});

} // namespace doublet
