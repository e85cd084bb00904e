#include "doublet/fit/material_objective.h"
#include "optimizer_checks.h"

#include <algorithm>
#include <cmath>

namespace doublet {
namespace {

// Cloth without any stretching stiffness is no cloth (pbd::validate): the search stays this far, in k, off the open end.
constexpr double kLeastStretch = 1e-3;

const pbd::MaterialParameter *find(const std::string &name) {
  for (const pbd::MaterialParameter &parameter : pbd::material_parameters())
    if (name == parameter.name)
      return &parameter;
  return nullptr;
}

constexpr double kStretchPower = 4; // see ParameterSpace::warp_parameters

/// The share of a parameter's range at u, and back; both increase from 0 to 1.
double warped(const std::string &name, double u) {
  if (name == "d_n" || name == "d_t")
    return u * u;
  return name == "k_stretch" ? 1 - std::pow(1 - u, kStretchPower) : u;
}
double gathered(const std::string &name, double share) {
  if (name == "d_n" || name == "d_t")
    return std::sqrt(share);
  return name == "k_stretch" ? 1 - std::pow(1 - share, 1 / kStretchPower) : share;
}

} // namespace

void ParameterSpace::validate() const {
  options::check(*this);
  require(!names.empty(), "ParameterSpace: names: expected at least one parameter, found none");
  for (const std::string &name : names)
    require(std::count(names.begin(), names.end(), name) == 1, "ParameterSpace: names: '" + name + "' is there twice");
}

pbd::Material ParameterSpace::material(const Eigen::VectorXd &unit) const {
  require(unit.size() == size(),
          "ParameterSpace: unit: expected " + std::to_string(size()) + " numbers, found " + std::to_string(unit.size()));
  require(unit.allFinite(), "ParameterSpace: unit: expected finite numbers, found NaN or infinity");
  pbd::Material result = fixed;
  for (int i = 0; i < size(); ++i) {
    const pbd::MaterialParameter &parameter = *find(names[i]);
    double u = std::clamp(unit[i], 0.0, 1.0);
    if (warp_parameters)
      u = warped(names[i], u);
    result.*parameter.value = parameter.lower + u * (parameter.upper - parameter.lower);
  }
  result.k_stretch = std::max(result.k_stretch, kLeastStretch);
  return result;
}

Eigen::VectorXd ParameterSpace::unit(const pbd::Material &material) const {
  Eigen::VectorXd result(size());
  for (int i = 0; i < size(); ++i) {
    const pbd::MaterialParameter &parameter = *find(names[i]);
    double u = (material.*parameter.value - parameter.lower) / (parameter.upper - parameter.lower);
    if (warp_parameters)
      u = gathered(names[i], u);
    result[i] = u;
  }
  return result;
}

} // namespace doublet
