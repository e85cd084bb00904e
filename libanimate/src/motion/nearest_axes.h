#pragma once
// Coordinate axes, of which exporters take one for another.

#include <Eigen/Geometry>

#include <vector>

namespace doublet {

inline Eigen::Vector3d nearest_axis(const Eigen::Vector3d &v) {
  Eigen::Index k;
  v.cwiseAbs().maxCoeff(&k);
  return (v[k] < 0 ? -1.0 : 1.0) * Eigen::Vector3d::Unit(k);
}

/// Of the 24 rotations that take axes to axes the one that is nearest to all of these.
inline Eigen::Quaterniond nearest_axes(const std::vector<Eigen::Quaterniond> &turns) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero(), best = Eigen::Matrix3d::Identity();
  for (const Eigen::Quaterniond &turn : turns)
    sum += turn.toRotationMatrix();
  double most = -1e30;
  for (int x = 0; x < 6; ++x)
    for (int y = 0; y < 6; ++y) {
      if (x % 3 == y % 3)
        continue;
      Eigen::Matrix3d axes;
      axes.col(0) = (x < 3 ? 1.0 : -1.0) * Eigen::Vector3d::Unit(x % 3);
      axes.col(1) = (y < 3 ? 1.0 : -1.0) * Eigen::Vector3d::Unit(y % 3);
      axes.col(2) = axes.col(0).cross(axes.col(1));
      if (const double near = axes.cwiseProduct(sum).sum(); near > most + 1e-9) {
        most = near;
        best = axes;
      }
    }
  return Eigen::Quaterniond(best);
}

} // namespace doublet
