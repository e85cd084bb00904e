#pragma once
// Energies as a Gaussian process sees them: about linear where they are low, logarithmic far above, so that what is hopeless does
// not rule.

#include "doublet/core/parts/quantile.h"
#include "doublet/core/types.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace doublet::fit {

struct EnergyScale {
  double origin = 0, unit = 1;
  double shown(double energy) const { return std::asinh((energy - origin) / unit); }
  double energy(double value) const { return origin + unit * std::sinh(value); }
  Eigen::VectorXd shown(const Eigen::VectorXd &energies) const {
    return energies.unaryExpr([this](double energy) { return shown(energy); });
  }
};

/// The origin is the first quartile, the unit the way from the lowest to the middle; at least one energy.
inline EnergyScale scale_of(const Eigen::VectorXd &energies) {
  const std::vector<double> all(energies.begin(), energies.end());
  const double middle = median(all), width = middle - energies.minCoeff();
  return {quantile(all, 0.25), width > 0 ? width : std::max(1e-12, std::fabs(middle))};
}

} // namespace doublet::fit
