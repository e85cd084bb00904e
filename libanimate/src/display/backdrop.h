#pragma once
// What lies behind all meshes of a picture: a sky of one colour, and a floor with a grid and a soft shadow, which fades into it.

#include "doublet/animate/renderer.h"
#include "picture_rays.h"

#include <vector>

namespace doublet::detail {

/// How much of the sky the meshes hide from each spot of the floor: their footprint, blurred, stronger where they are low.
class FloorShadow {
public:
  FloorShadow() = default; ///< none
  FloorShadow(const std::vector<const Vertices *> &meshes, double floor);
  /// The brightness of spots (x, z) of the floor, m.
  void darken(const Eigen::ArrayXf &x, const Eigen::ArrayXf &z, Eigen::ArrayXf &brightness) const;

private:
  float at(float x, float z) const;
  std::size_t index(double x, double z) const;
  void blur(std::size_t stride, int length, std::size_t next, int lines);

  float x0_ = 0, z0_ = 0; ///< m
  int nx_ = 0, nz_ = 0;
  std::vector<float> cells_;
};

class Backdrop {
public:
  /// `meshes`: what throws the shadow. `camera` must outlive it.
  Backdrop(const std::vector<const Vertices *> &meshes, const Camera &camera, const RenderOptions &options);
  /// Along a row of `count` rays, through the pixels (first + step i, y): how bright, over the sky. Valid until the next call.
  const Eigen::ArrayXf &row(float first, float step, float y, int count);

private:
  PictureRays rays_;
  Eigen::Vector3f eye_;
  float drop_; ///< m up from the eye to the floor; not below 0 = it is not seen
  FloorShadow shadow_;
  Eigen::ArrayXf ray_x_, ray_y_, ray_z_, inverse_, down_, away_, x_, z_, brightness_; ///< of a row
};

} // namespace doublet::detail
