#pragma once
// Skin weights of a template (Baran & Popovic 2007).

#include "doublet/core/context.h"
#include "doublet/core/stage_values.h"
#include "doublet/options/options.h"

#include <vector>

namespace doublet {

struct HeatWeightOptions {
  double c = 1.0;
  static constexpr auto describe() {
    using namespace options;
    using O = HeatWeightOptions;
    return Description{
        "HeatWeightOptions",
        option(&O::c, "c", above(0), "", "Heat c of the nearest visible bones, H_ii = c / d^2 (Baran & Popovic 2007)"),
    };
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
};
/// (V, J) skin weights by heat equilibrium, nearest visible bone(s); rows sum to one, no entry is negative.
MatrixRM heat_weights(const Mesh &mesh, const Mask &face_valid, const Skeleton &skeleton, const HeatWeightOptions &options = {},
                      const Context &context = {});

} // namespace doublet
