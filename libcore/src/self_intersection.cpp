#include "doublet/core/parts/self_intersection.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace doublet {
namespace {

using Eigen::Vector3d;

/// Six times the signed volume of the tetrahedron a b c d.
double volume(const Vector3d &a, const Vector3d &b, const Vector3d &c, const Vector3d &d) {
  return (b - a).cross(c - a).dot(d - a);
}

/// Does the segment p q cross the inside of the triangle a b c?
bool crosses(const Vector3d &p, const Vector3d &q, const Vector3d &a, const Vector3d &b, const Vector3d &c) {
  if (volume(a, b, c, p) * volume(a, b, c, q) >= 0)
    return false;
  const double u = volume(p, q, a, b), v = volume(p, q, b, c), w = volume(p, q, c, a);
  return (u > 0 && v > 0 && w > 0) || (u < 0 && v < 0 && w < 0);
}

/// A uniform grid of the cells that the faces' boxes touch, sorted by cell.
class FaceGrid {
public:
  FaceGrid(const Mesh &mesh, double cell) : mesh_(mesh), cell_(cell), low_(mesh.vertices.colwise().minCoeff()) {
    for (int f = 0; f < mesh.faces.rows(); ++f)
      visit_cells(f, [&](std::int64_t key) { entries_.push_back({key, f}); });
    std::sort(entries_.begin(), entries_.end());
  }

  /// Calls visit(g) for every face g > f whose box shares a cell with that of f; perhaps more than once.
  template <class Visit> void visit_later(int f, const Visit &visit) const {
    visit_cells(f, [&](std::int64_t key) {
      const Entry from{key, f + 1};
      for (auto at = std::lower_bound(entries_.begin(), entries_.end(), from); at != entries_.end() && at->first == key; ++at)
        visit(at->second);
    });
  }

private:
  using Entry = std::pair<std::int64_t, int>;

  template <class Visit> void visit_cells(int f, const Visit &visit) const {
    std::array<std::int64_t, 3> first{}, last{};
    for (int k = 0; k < 3; ++k) {
      const double a = mesh_.vertices(mesh_.faces(f, 0), k), b = mesh_.vertices(mesh_.faces(f, 1), k),
                   c = mesh_.vertices(mesh_.faces(f, 2), k);
      first[k] = static_cast<std::int64_t>((std::min({a, b, c}) - low_[k]) / cell_);
      last[k] = static_cast<std::int64_t>((std::max({a, b, c}) - low_[k]) / cell_);
    }
    for (std::int64_t x = first[0]; x <= last[0]; ++x)
      for (std::int64_t y = first[1]; y <= last[1]; ++y)
        for (std::int64_t z = first[2]; z <= last[2]; ++z)
          visit((x << 42) + (y << 21) + z);
  }

  const Mesh &mesh_;
  double cell_;
  Eigen::RowVector3d low_;
  std::vector<Entry> entries_;
};

/// Does an edge of face f cross face g, other than an edge that ends in a corner of g?
bool edge_crosses(const Mesh &mesh, int f, int g) {
  const Eigen::RowVector3i corners = mesh.faces.row(g);
  const auto shared = [&](int v) { return v == corners[0] || v == corners[1] || v == corners[2]; };
  const auto at = [&](int v) -> Vector3d { return mesh.vertices.row(v); };
  for (int k = 0; k < 3; ++k) {
    const int a = mesh.faces(f, k), b = mesh.faces(f, (k + 1) % 3);
    if (!shared(a) && !shared(b) && crosses(at(a), at(b), at(corners[0]), at(corners[1]), at(corners[2])))
      return true;
  }
  return false;
}

/// m, of the grid: some faces a cell, and at most 100 cells along an axis.
double cell_size(const Mesh &mesh) {
  const Eigen::RowVector3d extent = mesh.vertices.colwise().maxCoeff() - mesh.vertices.colwise().minCoeff();
  return std::max({2 * mean_edge_length(mesh.vertices, mesh.faces), extent.maxCoeff() / 100, 1e-12});
}

} // namespace

std::vector<std::uint8_t> self_intersecting_faces(const Mesh &mesh, const Context &context) {
  require_usable(mesh, "self_intersecting_faces");
  const FaceGrid grid(mesh, cell_size(mesh));
  const int count = static_cast<int>(mesh.faces.rows());
  std::vector<std::vector<int>> partners(count);
  parallel_for(context, count, [&](int f) {
    grid.visit_later(f, [&](int g) {
      if (edge_crosses(mesh, f, g) || edge_crosses(mesh, g, f))
        partners[f].push_back(g);
    });
  });
  std::vector<std::uint8_t> out(count, 0);
  for (int f = 0; f < count; ++f)
    for (int g : partners[f])
      out[f] = out[g] = 1;
  return out;
}

bool crosses_surface(const Vector3d &p, const Vector3d &q, const Mesh &mesh) {
  const auto corner = [&](Eigen::Index f, int k) -> Vector3d { return mesh.vertices.row(mesh.faces(f, k)); };
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f)
    if (crosses(p, q, corner(f, 0), corner(f, 1), corner(f, 2)))
      return true;
  return false;
}

int crossing_edges(const Mesh &mesh, const std::vector<Eigen::Vector2i> &edges) {
  int count = 0;
  for (const Eigen::Vector2i &edge : edges)
    for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
      const Eigen::RowVector3i v = mesh.faces.row(f);
      if ((v.array() == edge[0]).any() || (v.array() == edge[1]).any())
        continue;
      if (crosses(mesh.vertices.row(edge[0]), mesh.vertices.row(edge[1]), mesh.vertices.row(v[0]), mesh.vertices.row(v[1]),
                  mesh.vertices.row(v[2]))) {
        ++count;
        break;
      }
    }
  return count;
}

} // namespace doublet
