#pragma once

#include "doublet/core/types.h"

namespace doublet::detail {

/// (N, 3) points moved rigidly.
inline Vertices placed(const Vertices &points, const Eigen::Isometry3d &place) {
  return (points * place.linear().transpose()).rowwise() + place.translation().transpose();
}

} // namespace doublet::detail
