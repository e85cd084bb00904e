#include "poisson.h"

#include "doublet/core/error.h"
#include "open3d_mesh.h"

#include <open3d/geometry/PointCloud.h>

namespace doublet::detail {

PoissonSurface poisson_surface(const Mesh &scan, int depth) {
  const Vertices normals = vertex_normals(scan.vertices, scan.faces);
  open3d::geometry::PointCloud cloud;
  for (Eigen::Index v = 0; v < scan.vertices.rows(); ++v)
    if (normals.row(v).squaredNorm() > 0.5) { // without a face there is no normal
      cloud.points_.emplace_back(scan.vertices.row(v));
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
