#pragma once
// The array types of all stages: those of doublet/types, and matrices and transforms of Eigen.

#include "doublet/types/geometry.h"

#include <Eigen/Geometry>

#include <vector>

namespace doublet {

/// (R, C) row-major doubles: skin weights (V, J), poses (T, D), ...
using MatrixRM = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
/// One rigid transform per joint or bone, named `a_from_b` where it is used.
using Transforms = std::vector<Eigen::Isometry3d>;

} // namespace doublet
