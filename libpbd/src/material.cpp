#include "doublet/pbd/material.h"

#include <stdexcept>

namespace doublet::pbd {

const std::array<MaterialParameter, 6> &material_parameters() {
  static const std::array<MaterialParameter, 6> parameters{{{"d_n", &Material::d_n, 0, 32},
                                                            {"d_t", &Material::d_t, 0, 32},
                                                            {"k_bend", &Material::k_bend, 0, 1},
                                                            {"k_stretch", &Material::k_stretch, 0, 1},
                                                            {"k_friction", &Material::k_friction, 0, 1},
                                                            {"k_damping", &Material::k_damping, 0, 1}}};
  return parameters;
}

void validate(const Material &material) {
  for (const MaterialParameter &p : material_parameters()) {
    const double value = material.*p.value;
    // Cloth without any stretching stiffness is no cloth: the box of k_stretch is open below.
    const bool open_below = p.value == &Material::k_stretch;
    if (!(value >= p.lower && value <= p.upper) || (open_below && value == p.lower))
      throw std::invalid_argument("material parameter " + std::string(p.name) + " must lie in " + (open_below ? "(" : "[") +
                                  std::to_string(p.lower) + ", " + std::to_string(p.upper) + "], found " + std::to_string(value));
  }
}

} // namespace doublet::pbd
