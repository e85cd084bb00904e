#pragma once
// Implicit diffusion of a scalar on a surface, which also fills in what is unknown.

#include "doublet/core/mesh.h"

namespace doublet {

/// Solves (M + t L) x = M x_0 with t = length^2, L the cotangent Laplacian and M the lumped areas (one backward Euler step of the
/// heat equation, Desbrun et al. 1999). NaN in `values` (V) is unknown: its row of M is zero, so it takes the harmonic
/// interpolation of its surroundings. Obeys the maximum principle. NaN stays only in components of `faces` without any known
/// value and off the faces. Throws std::invalid_argument if sizes disagree or length < 0.
Eigen::VectorXd diffuse_on_surface(const Vertices &vertices, const Faces &faces, const Eigen::VectorXd &values, double length);

} // namespace doublet
