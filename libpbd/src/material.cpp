#include "doublet/pbd/material.h"

namespace doublet::pbd {

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

} // namespace doublet::pbd
