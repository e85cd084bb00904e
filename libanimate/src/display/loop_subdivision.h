#pragma once
// Smooth surfaces and boundary curves out of coarse triangles.

#include "doublet/core/mesh.h"

#include <Eigen/SparseCore>

namespace doublet::detail {

constexpr int kMostSubdivisions = 4;

struct Subdivision {
  Faces faces;                                          ///< (4^n F, 3)
  Eigen::SparseMatrix<double, Eigen::RowMajor> weights; ///< (V', V) fine vertices from coarse ones; rows sum to one
};

/// Each triangle in four, `levels` times (>= 0): Loop 1987 with the weights of Warren 1995. A boundary becomes the uniform cubic
/// B-spline of its vertices, whatever lies behind it; where more than two boundary edges meet, the vertex stays.
Subdivision subdivide(const Faces &faces, int vertices, int levels);

} // namespace doublet::detail
