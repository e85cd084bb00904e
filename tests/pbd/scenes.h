#pragma once
// Cloth made in the test: a grid, a skirt, and a pair of legs that dance.

#include "doublet/pbd/cloth_solver.h"

#include <cmath>

namespace doublet::pbd::scenes {

inline constexpr double kPi = 3.14159265358979324;

struct Sheet {
  Vertices rest;
  Faces faces;
  Eigen::VectorXd clothness;
};

/// columns x rows quads in the plane y = height, centred on the y axis, vertex (r, c) = r (columns + 1) + c at x from c, z from
/// r. Free.
inline Sheet grid(int columns, int rows, double spacing, double height = 0) {
  Sheet s;
  s.rest.resize((columns + 1) * (rows + 1), 3);
  s.faces.resize(2 * columns * rows, 3);
  for (int r = 0; r <= rows; ++r)
    for (int c = 0; c <= columns; ++c)
      s.rest.row(r * (columns + 1) + c) << (c - columns * 0.5) * spacing, height, (r - rows * 0.5) * spacing;
  int f = 0;
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      const int a = r * (columns + 1) + c, b = a + 1, d = a + columns + 1, e = d + 1;
      if ((r + c) % 2 == 0) { // alternating diagonals: no preferred direction
        s.faces.row(f++) << a, d, e;
        s.faces.row(f++) << a, e, b;
      } else {
        s.faces.row(f++) << a, d, b;
        s.faces.row(f++) << b, d, e;
      }
    }
  s.clothness = Eigen::VectorXd::Ones(s.rest.rows());
  return s;
}

/// Flared skirt: rings from the waist (radius 0.13 m, y = 1) to the hem (radius 0.30 m, y = 0.45). The waist ring is pinned, the
/// next two are blended. around x (rows + 1) vertices, 2 around rows faces: (52, 24) gives 1300 and 2496, (72, 35) gives 2592 and
/// 5040.
inline Sheet skirt(int around, int rows) {
  Sheet s;
  s.rest.resize(around * (rows + 1), 3);
  s.faces.resize(2 * around * rows, 3);
  s.clothness = Eigen::VectorXd::Ones(s.rest.rows());
  for (int r = 0; r <= rows; ++r)
    for (int k = 0; k < around; ++k) {
      const double t = static_cast<double>(r) / rows, angle = 2 * kPi * k / around,
                   radius = 0.13 + 0.17 * t + 0.015 * t * std::sin(7 * angle);
      s.rest.row(r * around + k) << radius * std::cos(angle), 1 - 0.55 * t, radius * std::sin(angle);
      s.clothness[r * around + k] = std::min(1.0, r / 3.0);
    }
  int f = 0;
  for (int r = 0; r < rows; ++r)
    for (int k = 0; k < around; ++k) {
      const int a = r * around + k, b = r * around + (k + 1) % around, c = a + around, d = b + around;
      s.faces.row(f++) << a, b, d;
      s.faces.row(f++) << a, d, c;
    }
  return s;
}

/// A body under the skirt at time t (s): hips that sway and turn, two legs that kick.
struct Dancer {
  double vigour = 1;

  Eigen::Matrix3d turn(double t) const {
    const double a = 1.2 * vigour * std::sin(2.2 * t);
    Eigen::Matrix3d r;
    r << std::cos(a), 0, std::sin(a), 0, 1, 0, -std::sin(a), 0, std::cos(a);
    return r;
  }
  Eigen::RowVector3d shift(double t) const {
    return {0.15 * vigour * std::sin(3.1 * t), 0.04 * vigour * std::sin(6 * t), 0.1 * vigour * std::sin(1.7 * t)};
  }
  Vertices targets(const Vertices &rest, double t) const { return ((rest * turn(t).transpose()).rowwise() + shift(t)).eval(); }
  std::vector<Capsule> capsules(double t) const {
    std::vector<Capsule> list;
    const auto world = [&](double x, double y, double z) {
      return Eigen::Vector3d(turn(t) * Eigen::Vector3d(x, y, z) + shift(t).transpose());
    };
    list.push_back({world(-0.03, 0.95, 0), world(0.03, 0.95, 0), 0.115, 0.115}); // hips
    for (int side : {-1, 1}) {
      const double swing = 0.5 * vigour * side * std::sin(4.5 * t), x = 0.07 * side;
      const auto leg = [&](double down) { return world(x, 0.92 - down * std::cos(swing), down * std::sin(swing)); };
      list.push_back({leg(0), leg(0.42), 0.075, 0.055});
      list.push_back({leg(0.42), leg(0.82), 0.055, 0.04});
    }
    return list;
  }
};

/// A frame of 1/40 s of a dance, from t (s) on, and what a step is told about it.
struct DancerFrame {
  Vertices before, after;
  std::vector<Capsule> capsules_before, capsules_after;
  StepInputs inputs;
  DancerFrame(const Dancer &dancer, const Vertices &rest, double t)
      : before(dancer.targets(rest, t)), after(dancer.targets(rest, t + 1.0 / 40)), capsules_before(dancer.capsules(t)),
        capsules_after(dancer.capsules(t + 1.0 / 40)) {
    inputs.previous_targets = before;
    inputs.targets = after;
    inputs.previous_capsules = capsules_before;
    inputs.capsules = capsules_after;
  }
  DancerFrame(const DancerFrame &) = delete; // inputs point into this one
};

} // namespace doublet::pbd::scenes
