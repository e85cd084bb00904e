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

bool is_stiffness(const std::string &name) {
  return name == "k_bend" || name == "k_stretch";
}

std::string known_names() {
  std::string names;
  for (const pbd::MaterialParameter &parameter : pbd::material_parameters())
    names += (names.empty() ? "" : ", ") + std::string(parameter.name);
  return names;
}

} // namespace

void ParameterSpace::validate() const {
  require(!names.empty(), "ParameterSpace: names: expected at least one parameter, found none");
  for (std::size_t i = 0; i < names.size(); ++i) {
    require(find(names[i]) != nullptr, "ParameterSpace: names: expected some of " + known_names() + ", found '" + names[i] + "'");
    require(std::count(names.begin(), names.end(), names[i]) == 1, "ParameterSpace: names: '" + names[i] + "' is there twice");
  }
  require(iterations >= 1, "ParameterSpace: iterations: expected at least 1, found " + std::to_string(iterations));
  pbd::validate(fixed);
}

pbd::Material ParameterSpace::material(const Eigen::VectorXd &unit) const {
  require(unit.size() == size(),
          "ParameterSpace: unit: expected " + std::to_string(size()) + " numbers, found " + std::to_string(unit.size()));
  pbd::Material result = fixed;
  for (int i = 0; i < size(); ++i) {
    const pbd::MaterialParameter &parameter = *find(names[i]);
    double u = std::clamp(unit[i], 0.0, 1.0);
    if (per_iteration_stiffness && is_stiffness(names[i]))
      u = 1 - std::pow(1 - u, iterations);
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
    if (per_iteration_stiffness && is_stiffness(names[i]))
      u = 1 - std::pow(1 - u, 1.0 / iterations);
    result[i] = u;
  }
  return result;
}

} // namespace doublet
