#pragma once
// Refines the template in the rest pose from tracked frames: without a scanner the template is the visual hull of one frame, and
// many frames show the body better.

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
               "Number of frames, the least bent ones, over which the median position of a vertex is taken"),
        option(&O::max_bend, "max_bend", Range{0, std::numbers::pi}, "rad",
               "Frames are not used for a vertex if its joints, weighted by skin weight, are bent by more",
               "The default is 15 degrees"),
        option(&O::smoothing, "smoothing", Range{0.001, 0.1}, "m",
               "Details of the correction that are smaller than this are taken for noise"),
        option(&O::fade_distance, "fade_distance", Range{0.001, 1}, "m",
               "Distance over which the correction of skin fades out in adjacent cloth", "Cloth itself is not corrected"),
    };
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
};

/// (V, 3) m: the actor's vertices in the rest pose. Vertices on valid faces that follow the skeleton (rigid (V) != 0: skin, not
/// cloth) are moved to their median position in the frames transformed back to the rest pose (canonical_frames()). A membrane
/// interpolates the correction where no frame can be used, and fades it out in the rest. Throws std::invalid_argument unless the
/// sizes of actor, performance and rigid agree; Error if no frame can be used for any vertex.
Vertices refine_rest_pose(const RiggedMesh &actor, const ReferencePerformance &performance, const Mask &rigid,
                          const RestPoseOptions &options = {}, const Context &context = {});

} // namespace doublet
