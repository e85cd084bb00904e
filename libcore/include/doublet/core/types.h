#pragma once
// The array types every stage speaks. Row-major, so that NumPy sees them without a copy.

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

namespace doublet {

/// (N, 3) positions, metres, +Y up, right-handed.
using Vertices = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
/// (F, 3) triangles as vertex indices, counter-clockwise seen from outside.
using Faces = Eigen::Matrix<int, Eigen::Dynamic, 3, Eigen::RowMajor>;
/// (R, C) row-major doubles: skin weights (V, J), poses (T, D), ...
using MatrixRM = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
/// One rigid transform per joint or bone, named `a_from_b` where it is used.
using Transforms = std::vector<Eigen::Isometry3d>;

} // namespace doublet
