#include "doublet/pbd/material.h"

#include <cmath>
#include <limits>

namespace doublet::pbd {
namespace {

void require_response(double response, const char *where) {
  if (!(response > 0) || !std::isfinite(response))
    options::throw_invalid(std::string(where) + ": response", "a finite number above 0", options::to_text(response));
}

} // namespace

const std::array<MaterialParameter, 6> &material_parameters() {
  static const std::array<MaterialParameter, 6> parameters = std::apply(
      [](const auto &...field) {
        return std::array{MaterialParameter{field.name, field.member, field.allowed.lower, field.allowed.upper}...};
      },
      Material::describe().fields);
  return parameters;
}

void validate(const Material &material) {
  options::check(material);
}

double spring_constant(double k, double response) {
  if (!(k >= 0 && k <= 1))
    options::throw_invalid("spring_constant: k", "a number in [0, 1]", options::to_text(k));
  require_response(response, "spring_constant");
  return k < 1 ? k / ((1 - k) * (kComplianceStep * kComplianceStep)) / response : std::numeric_limits<double>::infinity();
}

double stiffness_of_spring(double constant, double response) {
  if (!(constant >= 0))
    options::throw_invalid("stiffness_of_spring: constant", "a number of at least 0", options::to_text(constant));
  require_response(response, "stiffness_of_spring");
  const double ratio = constant * response * (kComplianceStep * kComplianceStep);
  return std::isfinite(ratio) ? ratio / (1 + ratio) : 1;
}

} // namespace doublet::pbd
