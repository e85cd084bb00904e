#pragma once
// The rays of a picture's pixels.

#include "doublet/core/camera.h"

#include <array>

namespace doublet::detail {

/// Three numbers and an idle fourth, so that it is one register.
inline Eigen::Vector4f four(const Eigen::Vector3f &v) {
  return {v[0], v[1], v[2], 0};
}

/// Rays of a camera, whose length along its axis is 1. Of a pinhole camera they are linear in the pixel.
class PictureRays {
public:
  /// `camera` must outlive it.
  explicit PictureRays(const Camera &camera) : camera_(camera), distorted_(camera.distorted()) {
    const Eigen::Vector3d corner = pinhole(0, 0);
    origin_ = four(corner.cast<float>());
    dx_ = four((pinhole(1, 0) - corner).cast<float>());
    dy_ = four((pinhole(0, 1) - corner).cast<float>());
  }
  Eigen::Vector4f at(float x, float y) const {
    if (!distorted_)
      return origin_ + x * dx_ + y * dy_;
    const Eigen::Vector3d direction = camera_.ray_direction({x, y});
    return four((direction / camera_.R.row(2).dot(direction)).cast<float>());
  }
  /// Of pixels of a row, by coordinate.
  void along(const Eigen::ArrayXf &x, float y, const std::array<Eigen::ArrayXf *, 3> &rays) const {
    const Eigen::Vector4f start = origin_ + y * dy_;
    for (int axis = 0; axis < 3; ++axis)
      *rays[axis] = start[axis] + dx_[axis] * x;
    if (!distorted_)
      return;
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      const Eigen::Vector4f ray = at(x[i], y);
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
  Eigen::Vector4f origin_, dx_, dy_;
};

} // namespace doublet::detail
