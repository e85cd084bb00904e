#pragma once
// Distance to the closest of a set of image points, on a coarse grid (the E_sil look-up of Sect. 6.2).

#include "doublet/types/geometry.h"

#include <Eigen/Core>
#include <cstdint>
#include <vector>

namespace doublet {

/// Exact squared Euclidean distance transform (Felzenszwalb & Huttenlocher 2012): for every node of a width x height grid the
/// index of the closest seed node. seed: non-zero = seed. Returns node indices (y * width + x), -1 everywhere if there is no
/// seed.
std::vector<int> nearest_seed(int width, int height, const Mask &seed);

/// Distances to a contour inside a box, 16 bits per node.
class DistanceField {
public:
  struct Box {
    float x0 = 0, y0 = 0, x1 = 0, y1 = 0; ///< pixels
  };
  DistanceField() = default;
  /// points: pixels, any order. Stores distances at nodes `cell` pixels apart, accurate to about half a pixel (the transform uses
  /// whole pixels), clamped to `cap` pixels (> 0). Points outside the box count, too.
  DistanceField(const std::vector<Eigen::Vector2f> &points, const Box &box, int cell, float cap);
  /// Pixels, at most cap. Bilinear between nodes (so off by at most cell / 2 near the contour). Outside the box: the value at the
  /// box plus the distance to it, an upper bound.
  float distance(float x, float y) const;
  bool empty() const { return values_.empty(); }
  std::size_t bytes() const { return values_.size() * sizeof(std::uint16_t); }

private:
  int width_ = 0, height_ = 0, cell_ = 1;
  float x0_ = 0, y0_ = 0, cap_ = 0;
  std::vector<std::uint16_t> values_; ///< distance / cap * 65535
};

} // namespace doublet
