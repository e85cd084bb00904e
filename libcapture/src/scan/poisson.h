#pragma once
#include "doublet/core/mesh.h"

namespace doublet::detail {

struct PoissonSurface {
  Mesh mesh;               ///< outward-oriented; nearly always closed, seldom quite manifold
  Eigen::VectorXd density; ///< (V) octree depth at which the scan has about one sample a cell: high = well sampled
};

/// Screened Poisson reconstruction (Kazhdan & Hoppe 2013) of the scan's vertices with their angle-weighted normals.
PoissonSurface poisson_surface(const Mesh &scan, int depth);
/// The same of points and their unit normals; points whose normal is zero are left out.
PoissonSurface poisson_surface(const Vertices &points, const Vertices &normals, int depth);

} // namespace doublet::detail
