#pragma once
// Rays of several cameras that should meet.

#include "doublet/core/camera.h"

#include <Eigen/Cholesky>

namespace doublet::detail {

/// The point closest to the rays through the pixels, in least squares.
struct RayBundle {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  int rays = 0;
  void add(const Camera &camera, const Eigen::Vector2d &pixel) {
    const Eigen::Vector3d d = camera.ray_direction(pixel);
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - d * d.transpose();
    normal += across;
    right += across * camera.centre();
    ++rays;
  }
  Eigen::Vector3d point() const { return normal.ldlt().solve(right); }
};

} // namespace doublet::detail
