#pragma once
// Smoothing that does not shrink.

#include "doublet/core/mesh.h"

#include <vector>

namespace doublet::detail {

/// (N, 3) mean of the neighbours of each vertex of `x` (N, 3) minus the vertex; 0 where there are none.
Vertices laplacian(const Vertices &x, const std::vector<std::vector<int>> &neighbours);

/// (N, 3) `x` without what is shorter than about four edges (Taubin 1995).
Vertices smoothed(Vertices x, const std::vector<std::vector<int>> &neighbours);

} // namespace doublet::detail
