#include "poisson.h"

#include "doublet/core/error.h"
#include "open3d_mesh.h"

#include <open3d/geometry/PointCloud.h>

namespace doublet::detail {

PoissonSurface poisson_surface(const Mesh &scan, int depth) {
  return poisson_surface(scan.vertices, vertex_normals(scan.vertices, scan.faces), depth);
}

PoissonSurface poisson_surface(const Vertices &points, const Vertices &normals, int depth) {
  open3d::geometry::PointCloud cloud;
  for (Eigen::Index v = 0; v < points.rows(); ++v)
    if (normals.row(v).squaredNorm() > 0.5) { // a vertex without a face has no normal
      cloud.points_.emplace_back(points.row(v));
      cloud.normals_.emplace_back(normals.row(v));
    }
  if (cloud.points_.size() < 4)
    throw Error("scan: expected triangles with an area, found only degenerate ones");
  const QuietOpen3D quiet;
  constexpr int kThreads = 1; // more threads change the last bits of the result
  try {
    const auto [surface, density] =
        open3d::geometry::TriangleMesh::CreateFromPointCloudPoisson(cloud, depth, 0, 1.1F, false, kThreads);
    return {from_open3d(*surface), Eigen::Map<const Eigen::VectorXd>(density.data(), static_cast<Eigen::Index>(density.size()))};
  } catch (const std::runtime_error &e) {
    throw Error(std::string("scan: the Poisson reconstruction failed (") + e.what() + ")");
  }
}

} // namespace doublet::detail
