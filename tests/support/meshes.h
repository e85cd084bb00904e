#pragma once
// Meshes for tests, all counter-clockwise seen from outside; metres, +Y up.

#include "doublet/core/mesh.h"

#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <vector>

namespace doublet::testing {

using std::numbers::pi;

inline Mesh make_mesh(const std::vector<Eigen::Vector3d> &vertices, const std::vector<Eigen::Vector3i> &faces) {
  Mesh mesh;
  mesh.vertices.resize(vertices.size(), 3);
  mesh.faces.resize(faces.size(), 3);
  for (std::size_t i = 0; i < vertices.size(); ++i)
    mesh.vertices.row(i) = vertices[i];
  for (std::size_t i = 0; i < faces.size(); ++i)
    mesh.faces.row(i) = faces[i];
  return mesh;
}

/// One mesh of several, unconnected.
inline Mesh join(const std::vector<Mesh> &parts) {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3i> faces;
  for (const Mesh &part : parts) {
    const int base = static_cast<int>(vertices.size());
    for (int v = 0; v < part.vertices.rows(); ++v)
      vertices.push_back(part.vertices.row(v));
    for (int f = 0; f < part.faces.rows(); ++f)
      faces.push_back(part.faces.row(f).transpose() + Eigen::Vector3i::Constant(base));
  }
  return make_mesh(vertices, faces);
}

/// Rings of `segments` points about the axis from p0 to p1, point k of ring i at angle 2 pi k / segments and with radius(s) at
/// the height s = i / rings in [0, 1]; vertex i * segments + k. Open at both ends.
inline Mesh tube(const Eigen::Vector3d &p0, const Eigen::Vector3d &p1, const std::function<double(double)> &radius, int rings,
                 int segments) {
  const Eigen::Vector3d axis = (p1 - p0).normalized(), u = axis.unitOrthogonal(), w = axis.cross(u);
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3i> faces;
  for (int i = 0; i <= rings; ++i)
    for (int k = 0; k < segments; ++k) {
      const double s = static_cast<double>(i) / rings, a = 2 * pi * k / segments;
      vertices.push_back(p0 + s * (p1 - p0) + radius(s) * (std::cos(a) * u + std::sin(a) * w));
    }
  for (int i = 0; i < rings; ++i)
    for (int k = 0; k < segments; ++k) {
      const int a = i * segments + k, b = i * segments + (k + 1) % segments;
      faces.emplace_back(a, b, b + segments);
      faces.emplace_back(a, b + segments, a + segments);
    }
  return make_mesh(vertices, faces);
}

/// The tube with a fan over each end (two more vertices, the last ones: at p0, then at p1). Closed.
inline Mesh closed_tube(const Eigen::Vector3d &p0, const Eigen::Vector3d &p1, const std::function<double(double)> &radius,
                        int rings, int segments) {
  const Mesh open = tube(p0, p1, radius, rings, segments);
  const int n = static_cast<int>(open.vertices.rows()), f = static_cast<int>(open.faces.rows());
  Mesh mesh;
  mesh.vertices.resize(n + 2, 3);
  mesh.vertices << open.vertices, p0.transpose(), p1.transpose();
  mesh.faces.resize(f + 2 * segments, 3);
  mesh.faces.topRows(f) = open.faces;
  for (int k = 0; k < segments; ++k) {
    const int next = (k + 1) % segments, top = rings * segments;
    mesh.faces.row(f + k) << n, next, k;
    mesh.faces.row(f + segments + k) << n + 1, top + k, top + next;
  }
  return mesh;
}

inline Mesh cylinder(const Eigen::Vector3d &p0, const Eigen::Vector3d &p1, double radius, int rings = 10, int segments = 16) {
  return closed_tube(
      p0, p1, [radius](double) { return radius; }, rings, segments);
}

/// Latitude-longitude sphere, poles on the Y axis. Closed.
inline Mesh sphere(double radius, const Eigen::Vector3d &centre = Eigen::Vector3d::Zero(), int rings = 16, int segments = 32) {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3i> faces;
  for (int i = 1; i < rings; ++i)
    for (int k = 0; k < segments; ++k) {
      const double polar = pi * i / rings, a = 2 * pi * k / segments;
      vertices.push_back(
          centre + radius * Eigen::Vector3d(std::sin(polar) * std::cos(a), -std::cos(polar), -std::sin(polar) * std::sin(a)));
    }
  const int south = static_cast<int>(vertices.size()), north = south + 1, last = (rings - 2) * segments;
  vertices.push_back(centre - Eigen::Vector3d(0, radius, 0));
  vertices.push_back(centre + Eigen::Vector3d(0, radius, 0));
  for (int k = 0; k < segments; ++k) {
    const int next = (k + 1) % segments;
    faces.emplace_back(south, next, k);
    faces.emplace_back(north, last + k, last + next);
    for (int i = 0; i + 2 < rings; ++i) {
      const int a = i * segments + k, b = i * segments + next;
      faces.emplace_back(a, b, b + segments);
      faces.emplace_back(a, b + segments, a + segments);
    }
  }
  return make_mesh(vertices, faces);
}

/// A sheet in the plane y = 0, normals up, centred at the origin: vertex i * (nx + 1) + k at column k of row i. Open.
inline Mesh grid(double width, double depth, int nx, int nz) {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3i> faces;
  for (int i = 0; i <= nz; ++i)
    for (int k = 0; k <= nx; ++k)
      vertices.emplace_back(width * (static_cast<double>(k) / nx - 0.5), 0, depth * (static_cast<double>(i) / nz - 0.5));
  for (int i = 0; i < nz; ++i)
    for (int k = 0; k < nx; ++k) {
      const int a = i * (nx + 1) + k, b = a + nx + 1;
      faces.emplace_back(a, b, a + 1);
      faces.emplace_back(a + 1, b, b + 1);
    }
  return make_mesh(vertices, faces);
}

/// The zero level of a signed distance (negative inside) as a closed manifold mesh, by marching tetrahedra on cubes of edge
/// `cell`. The level set must lie inside the box.
inline Mesh level_set(const std::function<double(const Eigen::Vector3d &)> &distance, const Eigen::Vector3d &low,
                      const Eigen::Vector3d &high, double cell) {
  const Eigen::Vector3i n = ((high - low) / cell).array().ceil().cast<int>() + 1;
  const auto index = [&](int x, int y, int z) { return (z * n.y() + y) * n.x() + x; };
  std::vector<Eigen::Vector3d> at(static_cast<std::size_t>(n.prod()));
  std::vector<double> value(at.size());
  for (int z = 0; z < n.z(); ++z)
    for (int y = 0; y < n.y(); ++y)
      for (int x = 0; x < n.x(); ++x) {
        at[index(x, y, z)] = low + cell * Eigen::Vector3d(x, y, z);
        value[index(x, y, z)] = distance(at[index(x, y, z)]);
      }
  std::map<std::pair<int, int>, int> vertex_on;
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3i> faces;
  const auto crossing = [&](int a, int b) {
    const auto key = std::minmax(a, b);
    const auto [it, fresh] = vertex_on.emplace(key, static_cast<int>(vertices.size()));
    if (fresh) {
      const double s = std::clamp(value[key.first] / (value[key.first] - value[key.second]), 0.1, 0.9); // no slivers
      vertices.push_back((1 - s) * at[key.first] + s * at[key.second]);
    }
    return it->second;
  };
  const auto emit = [&](int a, int b, int c, const Eigen::Vector3d &outwards) {
    const Eigen::Vector3d normal = (vertices[b] - vertices[a]).cross(vertices[c] - vertices[a]);
    if (normal.dot(outwards) < 0)
      std::swap(b, c);
    faces.emplace_back(a, b, c);
  };
  const auto tetrahedron = [&](const std::array<int, 4> &t) {
    std::vector<int> in, out;
    for (const int c : t)
      (value[c] < 0 ? in : out).push_back(c);
    if (in.empty() || out.empty())
      return;
    Eigen::Vector3d outwards = Eigen::Vector3d::Zero();
    for (const int c : out)
      outwards += at[c] / static_cast<double>(out.size());
    for (const int c : in)
      outwards -= at[c] / static_cast<double>(in.size());
    if (in.size() == 2) {
      const int a = crossing(in[0], out[0]), b = crossing(in[0], out[1]), c = crossing(in[1], out[1]),
                d = crossing(in[1], out[0]);
      emit(a, b, c, outwards);
      emit(a, c, d, outwards);
      return;
    }
    const std::vector<int> &one = in.size() == 1 ? in : out, &three = in.size() == 1 ? out : in;
    emit(crossing(one[0], three[0]), crossing(one[0], three[1]), crossing(one[0], three[2]), outwards);
  };
  // Kuhn's six tetrahedra along the cube's diagonal: neighbouring cubes agree on the diagonals of their faces.
  static constexpr int axes[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  for (int z = 0; z + 1 < n.z(); ++z)
    for (int y = 0; y + 1 < n.y(); ++y)
      for (int x = 0; x + 1 < n.x(); ++x)
        for (const auto &order : axes) {
          Eigen::Vector3i p(x, y, z);
          std::array<int, 4> t = {index(x, y, z), 0, 0, 0};
          for (int k = 0; k < 3; ++k) {
            ++p[order[k]];
            t[k + 1] = index(p.x(), p.y(), p.z());
          }
          tetrahedron(t);
        }
  return make_mesh(vertices, faces);
}

} // namespace doublet::testing
