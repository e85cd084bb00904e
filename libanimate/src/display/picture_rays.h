#pragma once
// The rays of a picture's pixels.

#include "doublet/core/camera.h"

#include <array>

namespace doublet::detail {

/// Rays of a camera, whose length along its axis is 1. Of a pinhole camera they are linear in the pixel.
class PictureRays {
public:
  /// `camera` must outlive it.
  explicit PictureRays(const Camera &camera) : camera_(camera), distorted_(camera.distorted()) {
    const Eigen::Vector3d corner = pinhole(0, 0);
    origin_ = corner.cast<float>();
    dx_ = (pinhole(1, 0) - corner).cast<float>();
    dy_ = (pinhole(0, 1) - corner).cast<float>();
  }
  Eigen::Vector3f at(float x, float y) const {
    if (!distorted_)
      return origin_ + x * dx_ + y * dy_;
    const Eigen::Vector3d direction = camera_.ray_direction({x, y});
    return (direction / camera_.R.row(2).dot(direction)).cast<float>();
  }
  /// Of pixels of a row, by coordinate.
  void along(const Eigen::ArrayXf &x, float y, const std::array<Eigen::ArrayXf *, 3> &rays) const {
    const Eigen::Vector3f start = origin_ + y * dy_;
    for (int axis = 0; axis < 3 && !distorted_; ++axis)
      *rays[axis] = start[axis] + dx_[axis] * x;
    for (Eigen::Index i = 0; i < x.size() && distorted_; ++i) {
      const Eigen::Vector3f ray = at(x[i], y);
      for (int axis = 0; axis < 3; ++axis)
        (*rays[axis])[i] = ray[axis];
    }
  }

private:
  Eigen::Vector3d pinhole(double x, double y) const {
    const double v = (y - camera_.K(1, 2)) / camera_.K(1, 1), u = (x - camera_.K(0, 2) - camera_.K(0, 1) * v) / camera_.K(0, 0);
    return camera_.R.transpose() * Eigen::Vector3d(u, v, 1);
  }
  const Camera &camera_;
  bool distorted_;
  Eigen::Vector3f origin_, dx_, dy_;
};

} // namespace doublet::detail
