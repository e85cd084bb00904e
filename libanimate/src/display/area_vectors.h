#pragma once
// Normals without the angles of vertex_normals(), which cost as much as all else that a frame needs them for.

#include "doublet/core/mesh.h"

#include <Eigen/Geometry>

namespace doublet::detail {

/// (V, 3) for each vertex twice the area vectors of the faces around it (`face_valid[f]` zero left out; empty = all), summed.
inline void sum_area_vectors(const Vertices &vertices, const Faces &faces, Vertices &sums, const Mask &face_valid = {}) {
  sums.setZero(vertices.rows(), 3);
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    if (!face_valid.empty() && !face_valid[f])
      continue;
    const Eigen::Vector3d a = vertices.row(faces(f, 0)), b = vertices.row(faces(f, 1)), c = vertices.row(faces(f, 2));
    const Eigen::RowVector3d area = (b - a).cross(c - a);
    for (int k = 0; k < 3; ++k)
      sums.row(faces(f, k)) += area;
  }
}

} // namespace doublet::detail
