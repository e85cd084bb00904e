#pragma once
// The material of a piece of cloth: the parameter vector of Stoll et al. 2010, Sect. 6 (the sixth, damping, is Mueller 2007
// Sect. 3.5).

#include "doublet/options/options.h"

#include <array>
#include <string>

namespace doublet::pbd {

/// The defaults are those of the synthetic example in Sect. 7 of the paper, a skirt that stretches little.
struct Material {
  double d_n = 4.0;
  double d_t = 4.9;
  double k_bend = 0.7;
  double k_stretch = 1.0;
  double k_friction = 0.5;
  double k_damping = 0.0; ///< not estimated unless asked for
  static constexpr auto describe() {
    using namespace options;
    using O = Material;
    return Description{
        "Material",
        option(&O::d_n, "d_n", Range{0, 32}, "1/m", "Drag along the normal, quadratic in the velocity"),
        option(&O::d_t, "d_t", Range{0, 32}, "1/s", "Drag along the surface, linear in the velocity"),
        option(&O::k_bend, "k_bend", Range{0, 1}, "", "Bending stiffness, as a share", "In N m: spring_constant()"),
        option(&O::k_stretch, "k_stretch", Range{0, 1, Open::Below}, "", "Stretching stiffness, as a share",
               "In N/m: spring_constant(). Below 0.99 cloth hangs like rubber"),
        option(&O::k_friction, "k_friction", Range{0, 1}, "", "Friction against proxies and itself"),
        option(&O::k_damping, "k_damping", Range{0, 1}, "", "Damping of the velocity towards rigid motion"),
    };
  }
};

/// Names of the parameters, in the order of Material.
inline constexpr auto kMaterialNames =
    std::apply([](const auto &...field) { return std::array{field.name...}; }, Material::describe().fields);

/// A parameter by name, with the box (bounds) in which it is estimated.
struct MaterialParameter {
  const char *name;
  double Material::*value;
  double lower, upper;
};
/// In the order of kMaterialNames; the first five are the paper's.
const std::array<MaterialParameter, 6> &material_parameters();
/// Throws std::invalid_argument naming parameter, box and value if one lies outside its box or is NaN.
void validate(const Material &material);

/// s, the step to which k_bend and k_stretch refer with Stiffness::Compliance.
inline constexpr double kComplianceStep = 1.0 / 40;
/// The physical spring constant of a stiffness k of Stiffness::Compliance: k / ((1 - k) kComplianceStep^2 response), the inverse
/// of XPBD's compliance. `response`: the sum of |grad C|^2 / mass over the vertices of a constraint C. For an edge, C is its
/// length: the response is 1 / m_a + 1 / m_b in 1/kg, the result is in N/m. For a hinge, C is the angle between its faces: the
/// response is in 1/(kg m^2), the result in N m. Infinite for k = 1. The masses of a ClothModel are areas: multiply them by the
/// areal density (kg/m^2). Throws std::invalid_argument unless k is in [0, 1] and the response is above 0.
double spring_constant(double k, double response);
/// The inverse of spring_constant(): the stiffness k, 0 for a constant of 0, 1 for infinity. Throws std::invalid_argument unless
/// the constant is at least 0 and the response above 0.
double stiffness_of_spring(double constant, double response);

} // namespace doublet::pbd
