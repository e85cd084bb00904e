#pragma once
// The rest pose again, from what was tracked: where there is no scanner the template is one frame's hull, and the frames around
// it show the body better.

#include "doublet/core/context.h"
#include "doublet/core/stage_values.h"
#include "doublet/options/options.h"

#include <cstdint>
#include <numbers>
#include <vector>

namespace doublet {

struct RestPoseOptions {
  int frames = 8;
  double max_bend = 15 * std::numbers::pi / 180;
  double smoothing = 0.015;
  double fade_distance = 0.05;
  static constexpr auto describe() {
    using namespace options;
    using O = RestPoseOptions;
    return Description{
        "RestPoseOptions",
        option(&O::frames, "frames", Range{1, 1000}, "",
               "Number of least bent frames of which the median place of a vertex is taken"),
        option(&O::max_bend, "max_bend", Range{0, std::numbers::pi}, "rad",
               "Frames tell nothing of a vertex whose joints are bent more, on average by skin weight",
               "The default is 15 degrees"),
        option(&O::smoothing, "smoothing", Range{0.001, 0.1}, "m",
               "Detail of the correction that is smaller than this is taken for noise"),
        option(&O::fade_distance, "fade_distance", Range{0.001, 1}, "m",
               "Distance over which the correction of skin fades out in the cloth beside it", "Cloth itself is not corrected"),
    };
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
};

/// (V, 3) m: the actor's vertices in the rest pose, those that follow the skeleton (rigid (V) != 0: skin, not cloth) on valid
/// faces moved to where the frames, taken back to the rest pose (canonical_frames()), have them. A membrane carries the
/// correction over what no frame tells of, and out into the rest. Throws std::invalid_argument unless actor, performance and
/// rigid go together; Error if no frame tells of any vertex.
Vertices refine_rest_pose(const RiggedMesh &actor, const ReferencePerformance &performance, const Mask &rigid,
                          const RestPoseOptions &options = {}, const Context &context = {});

} // namespace doublet
