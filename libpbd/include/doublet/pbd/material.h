#pragma once
// The material of a piece of cloth: the parameter vector of Stoll et al. 2010, Sect. 6 (the sixth, damping, is Mueller 2007
// Sect. 3.5).

#include <array>
#include <string>

namespace doublet::pbd {

/// The defaults are the cloth of the synthetic example in Sect. 7 of the paper, a skirt that stretches little.
struct Material {
  double d_n = 4.0;        ///< drag along the normal, quadratic, 1/m, box [0, 32]
  double d_t = 4.9;        ///< drag along the surface, linear, 1/s, box [0, 32]
  double k_bend = 0.7;     ///< bending stiffness, box [0, 1]
  double k_stretch = 1.0;  ///< stretching stiffness, box (0, 1]; below 0.99 cloth hangs like rubber
  double k_friction = 0.5; ///< friction against proxies and itself, box [0, 1]
  double k_damping = 0.0;  ///< velocity damping towards rigid motion, box [0, 1]; not estimated unless asked for
};

/// A parameter by name, with the box it is estimated in.
struct MaterialParameter {
  const char *name;
  double Material::*value;
  double lower, upper;
};
/// d_n, d_t, k_bend, k_stretch, k_friction, k_damping in this order; the first five are the paper's.
const std::array<MaterialParameter, 6> &material_parameters();
/// Throws std::invalid_argument naming parameter, box and value if one lies outside its box or is NaN.
void validate(const Material &material);

} // namespace doublet::pbd
