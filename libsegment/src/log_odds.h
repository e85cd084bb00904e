#pragma once
// Log odds of cloth, and probabilities.

#include <cmath>

namespace doublet::detail {

/// Log odds: no evidence by itself is surer than 98 %. However much a vertex moves, tracking may have failed there; the body
/// model does not know everybody; and some wear gloves.
constexpr double kSurest = 4;

inline double probability(double log_odds) {
  return 1 / (1 + std::exp(-log_odds));
}

} // namespace doublet::detail
