#pragma once
// Collision proxies (Sect. 5): tapered capsules that approximate the fitted body.

#include "doublet/core/context.h"
#include "doublet/core/stage_values.h"
#include "doublet/options/options.h"

#include <vector>

namespace doublet {

struct ProxyOptions {
  double clearance = 0.0;
  double cloth_margin = 0.004;
  int capsules_per_bone = 2;
  int iterations = 40;
  static constexpr auto describe() {
    using namespace options;
    using O = ProxyOptions;
    return Description{
        "ProxyOptions",
        option(&O::clearance, "clearance", Range{-0.1, 0.1, Open::Both}, "m",
               "The capsules are this far inside the body on average"),
        option(&O::cloth_margin, "cloth_margin", Range{0, 0.1, Open::Above}, "m",
               "The capsules are at least this far inside the cloth of the scan pose", "Resting cloth is never pushed"),
        option(&O::capsules_per_bone, "capsules_per_bone", Range{1, 3}, "", "Number of tapered capsules along one bone"),
        option(&O::iterations, "iterations", at_least(0), "", "Number of iterations of the least squares"),
    };
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
};
/// Tapered capsules for the bones that cloth can touch: bones with cloth over their body surface, the next bones down the chain,
/// limbs that reach cloth, and bones of the trunk that hanging cloth can be thrown over. Empty if nothing is cloth.
std::vector<TaperedCapsule> fit_proxies(const BodyFit &fit, const RiggedMesh &actor, const Segmentation &segmentation,
                                        const ProxyOptions &options = {});

/// How well the capsules approximate the body.
struct ProxyStatistics {
  int capsules = 0;
  int samples = 0;            ///< body vertices under cloth
  double mean_distance = 0;   ///< m, mean |signed distance| of body vertices under cloth to the union of capsules
  double percentile95 = 0;    ///< m, of the same
  double largest_bulge = 0;   ///< m, largest distance by which a capsule protrudes from the body (0 = none)
  double cloth_clearance = 0; ///< m, smallest signed distance of the resting cloth to the capsules (negative = pushed)
};
ProxyStatistics proxy_statistics(const std::vector<TaperedCapsule> &capsules, const BodyFit &fit, const RiggedMesh &actor,
                                 const Segmentation &segmentation);

} // namespace doublet
