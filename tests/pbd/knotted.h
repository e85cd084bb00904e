#pragma once
// Where cloth has passed through itself, found without any of the library's code.

#include "doublet/pbd/cloth_solver.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <set>
#include <utility>

namespace doublet::pbd::scenes {

/// Does the segment (a, b) pass through the face?
inline bool passes_through(const Eigen::Vector3d &a, const Eigen::Vector3d &b, const Vertices &x, const Eigen::Vector3i &face) {
  const Eigen::Vector3d c = x.row(face[0]), u = x.row(face[1]).transpose() - c, v = x.row(face[2]).transpose() - c,
                        n = u.cross(v);
  const double ha = n.dot(a - c), hb = n.dot(b - c);
  if (ha * hb >= 0)
    return false;
  const Eigen::Vector3d p = a + ha / (ha - hb) * (b - a) - c;
  const double s = n.dot(p.cross(v)) / n.squaredNorm(), t = n.dot(u.cross(p)) / n.squaredNorm();
  return s >= 0 && t >= 0 && s + t <= 1;
}

/// Corners of edges that pass through faces, and of these faces: every edge against every face.
inline std::set<int> knotted(const Vertices &x, const Faces &faces) {
  std::set<std::pair<int, int>> edges;
  for (Eigen::Index f = 0; f < faces.rows(); ++f)
    for (int k = 0; k < 3; ++k)
      edges.insert(std::minmax(faces(f, k), faces(f, (k + 1) % 3)));
  std::set<int> found;
  for (const auto &[i, j] : edges)
    for (Eigen::Index f = 0; f < faces.rows(); ++f) {
      const bool shares = (faces.row(f).array() == i).any() || (faces.row(f).array() == j).any();
      if (!shares && passes_through(x.row(i), x.row(j), x, faces.row(f)))
        found.insert({i, j, faces(f, 0), faces(f, 1), faces(f, 2)});
    }
  return found;
}

} // namespace doublet::pbd::scenes
