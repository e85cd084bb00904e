#pragma once

#include "doublet/core/types.h"

#include <memory>

namespace doublet {

/// Exact nearest neighbour among points (nanoflann's kd-tree behind it). Immutable; safe from many threads.
class NearestPoints {
public:
  explicit NearestPoints(const Vertices &points); ///< (N, 3), N >= 1
  ~NearestPoints();
  int nearest(const Eigen::Vector3d &query) const; ///< row

private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

} // namespace doublet
