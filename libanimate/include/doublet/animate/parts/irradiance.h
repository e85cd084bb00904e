#pragma once
// The light that fell on a surface when it was photographed, estimated from its colours: low-order irradiance as a function of
// the normal.

#include "doublet/core/types.h"

#include <vector>

namespace doublet {

/// Points of a surface; all points of a patch have the same albedo, apart from outliers.
struct ShadedPoints {
  Vertices normals;         ///< (N, 3) unit
  Vertices colours;         ///< (N, 3) linear, above 0, any order of channels
  Eigen::VectorXd weights;  ///< (N) at least 0, such as areas
  std::vector<int> patches; ///< (N) numbered from 0
};

/// Irradiance as a function of the normal: its logarithm is a spherical function of order 2, which approximates distant light on
/// a matt surface (Ramamoorthi, Hanrahan 2001; Basri, Jacobs 2003). Images determine light and albedo only up to one factor per
/// channel; here the irradiance of the brightest point is 1, so that surface that faces the light keeps its colour.
struct Irradiance {
  Eigen::Matrix<double, 9, 3> coefficients =
      Eigen::Matrix<double, 9, 3>::Zero();          ///< of 1, x, y, z, xy, yz, zx, x^2 - y^2, 3 z^2 - 1
  Eigen::Vector3d lowest = Eigen::Vector3d::Ones(); ///< lowest value at the points: it is not extrapolated below

  Eigen::Vector3d at(const Eigen::Vector3d &normal) const; ///< of a unit normal, in (0, 1]
};

/// Robust least squares (Geman-McClure weights) of the differences within patches; regularised towards uniform light. Without
/// points it is 1. Throws std::invalid_argument if sizes do not fit or a colour is not above 0.
Irradiance estimate_irradiance(const ShadedPoints &points);

} // namespace doublet
