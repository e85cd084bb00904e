#pragma once
// The light that fell on a surface when it was photographed, from what it looked like: low-order irradiance by its normal.

#include "doublet/core/types.h"

#include <vector>

namespace doublet {

/// Points of a surface of which something is known about the albedo: those of one patch have the same, but for outliers.
struct ShadedPoints {
  Vertices normals;         ///< (N, 3) unit
  Vertices colours;         ///< (N, 3) linear, above 0, any order of channels
  Eigen::VectorXd weights;  ///< (N) at least 0, such as areas
  std::vector<int> patches; ///< (N) numbered from 0
};

/// Irradiance over normals: its logarithm is a spherical function of order 2, about what distant light leaves on a matt surface
/// (Ramamoorthi, Hanrahan 2001; Basri, Jacobs 2003). From pictures, light and albedo are known up to a factor a channel: here
/// the brightest of the points has 1, so that what faces the light looks as it is.
struct Irradiance {
  Eigen::Matrix<double, 9, 3> coefficients =
      Eigen::Matrix<double, 9, 3>::Zero();          ///< of 1, x, y, z, xy, yz, zx, x^2 - y^2, 3 z^2 - 1
  Eigen::Vector3d lowest = Eigen::Vector3d::Ones(); ///< at the points: it is not extrapolated

  Eigen::Vector3d at(const Eigen::Vector3d &normal) const; ///< of a unit normal, in (0, 1]
};

/// Robust least squares (Geman-McClure weights) of what differs within the patches; where the points say nothing the light is
/// even. Without points it is 1. Throws std::invalid_argument if sizes do not fit or a colour is not above 0.
Irradiance estimate_irradiance(const ShadedPoints &points);

} // namespace doublet
