#pragma once
// Between doublet::Mesh and Open3D's classes. Included by the files that use Open3D.

#include "doublet/core/mesh.h"

#include <open3d/geometry/TriangleMesh.h>
#include <open3d/utility/Logging.h>

namespace doublet::detail {

/// While it lives Open3D prints errors only; what went wrong is told by our own exceptions.
class QuietOpen3D {
public:
  QuietOpen3D() { level_.Enter(); }
  ~QuietOpen3D() { level_.Exit(); }
  QuietOpen3D(const QuietOpen3D &) = delete;
  QuietOpen3D &operator=(const QuietOpen3D &) = delete;

private:
  open3d::utility::VerbosityContextManager level_{open3d::utility::VerbosityLevel::Error};
};

inline std::shared_ptr<open3d::geometry::TriangleMesh> to_open3d(const Mesh &mesh) {
  auto out = std::make_shared<open3d::geometry::TriangleMesh>();
  for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v)
    out->vertices_.emplace_back(mesh.vertices.row(v));
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f)
    out->triangles_.emplace_back(mesh.faces.row(f));
  return out;
}

inline Mesh from_open3d(const open3d::geometry::TriangleMesh &mesh) {
  Mesh out;
  out.vertices.resize(mesh.vertices_.size(), 3);
  for (std::size_t v = 0; v < mesh.vertices_.size(); ++v)
    out.vertices.row(v) = mesh.vertices_[v];
  out.faces.resize(mesh.triangles_.size(), 3);
  for (std::size_t f = 0; f < mesh.triangles_.size(); ++f)
    out.faces.row(f) = mesh.triangles_[f];
  return out;
}

} // namespace doublet::detail
