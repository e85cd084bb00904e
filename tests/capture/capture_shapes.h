#pragma once
// Meshes with known answers for the tests of the template.

#include "support/meshes.h"

namespace doublet::testing {

/// Surface of revolution about +Y through (cx, ., cz): rings of `around` vertices at the profile points (radius, height), listed
/// from bottom to top; a radius of 0 closes an end with a single vertex. Outward-oriented.
inline Mesh lathe(const std::vector<std::pair<double, double>> &profile, int around, double cx = 0, double cz = 0) {
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3i> faces;
  std::vector<int> first;
  for (const auto &[radius, height] : profile) {
    first.push_back(static_cast<int>(vertices.size()));
    for (int k = 0; k < (radius > 0 ? around : 1); ++k) {
      const double a = 2 * std::numbers::pi * k / around;
      vertices.emplace_back(cx + radius * std::cos(a), height, cz + radius * std::sin(a));
    }
  }
  for (std::size_t i = 0; i + 1 < profile.size(); ++i)
    for (int k = 0; k < around; ++k) {
      const bool low_tip = profile[i].first <= 0, high_tip = profile[i + 1].first <= 0;
      const int next = (k + 1) % around;
      const int a = first[i] + (low_tip ? 0 : k), b = first[i] + (low_tip ? 0 : next);
      const int c = first[i + 1] + (high_tip ? 0 : k), d = first[i + 1] + (high_tip ? 0 : next);
      if (!low_tip)
        faces.emplace_back(a, high_tip ? c : d, b);
      if (!high_tip)
        faces.emplace_back(a, c, d);
    }
  return make_mesh(vertices, faces);
}

/// Points of an arc (radius about (0, centre height)) from angle a to b, degrees from straight down.
inline void arc(std::vector<std::pair<double, double>> &profile, double radius, double centre, double a, double b, int steps) {
  for (int i = 0; i <= steps; ++i) {
    const double t = (a + (b - a) * i / steps) * std::numbers::pi / 180;
    const double r = radius * std::sin(t);
    profile.emplace_back(r < 1e-9 ? 0.0 : r, centre - radius * std::cos(t));
  }
}

inline void line(std::vector<std::pair<double, double>> &profile, double r0, double y0, double r1, double y1, int steps) {
  for (int i = 0; i <= steps; ++i)
    profile.emplace_back(r0 + (r1 - r0) * i / steps, y0 + (y1 - y0) * i / steps);
}

inline Mesh capsule(double radius, double y0, double y1, int around, int along, double cx = 0, double cz = 0) {
  std::vector<std::pair<double, double>> profile;
  arc(profile, radius, y0, 0, 90, 8);
  line(profile, radius, y0 + (y1 - y0) / along, radius, y1 - (y1 - y0) / along, along - 2);
  arc(profile, radius, y1, 90, 180, 8);
  return lathe(profile, around, cx, cz);
}

/// m^3; positive for a closed mesh that is oriented outward.
inline double signed_volume(const Mesh &mesh) {
  double volume = 0;
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    const Eigen::Vector3d a = mesh.vertices.row(mesh.faces(f, 0)), b = mesh.vertices.row(mesh.faces(f, 1)),
                          c = mesh.vertices.row(mesh.faces(f, 2));
    volume += a.dot(b.cross(c)) / 6;
  }
  return volume;
}

} // namespace doublet::testing
