#pragma once
// A closed tube along y and its motions, with known deviations.

#include "doublet/core/mesh_sequence.h"

#include <cmath>
#include <functional>
#include <numbers>

namespace tube {

constexpr int kAround = 48, kRings = 41;
constexpr double kLength = 1.0, kRadius = 0.1;

/// Ring r = 0..kRings-1 from y = 0 to kLength, then the two cap centres. radius(y) in m.
inline doublet::Vertices vertices(const std::function<double(double)> &radius) {
  doublet::Vertices v(kAround * kRings + 2, 3);
  for (int r = 0; r < kRings; ++r)
    for (int a = 0; a < kAround; ++a) {
      const double y = kLength * r / (kRings - 1), phi = 2 * std::numbers::pi * a / kAround;
      v.row(r * kAround + a) << radius(y) * std::sin(phi), y, radius(y) * std::cos(phi);
    }
  v.row(kAround * kRings) << 0, 0, 0;
  v.row(kAround * kRings + 1) << 0, kLength, 0;
  return v;
}

inline doublet::Faces faces() {
  doublet::Faces f(2 * kAround * (kRings - 1) + 2 * kAround, 3);
  int n = 0;
  for (int r = 0; r + 1 < kRings; ++r)
    for (int a = 0; a < kAround; ++a) {
      const int b = (a + 1) % kAround, i = r * kAround + a, j = r * kAround + b;
      f.row(n++) << i, j, i + kAround;
      f.row(n++) << j, j + kAround, i + kAround;
    }
  for (int a = 0; a < kAround; ++a) {
    const int b = (a + 1) % kAround, top = (kRings - 1) * kAround;
    f.row(n++) << kAround * kRings, b, a;
    f.row(n++) << kAround * kRings + 1, top + a, top + b;
  }
  return f;
}

/// The part that is cloth: 0.3 < y < 0.7, with a short ramp.
inline double cloth_share(double y) {
  return std::clamp((0.2 - std::abs(y - 0.5)) / 0.03, 0.0, 1.0);
}

/// Frames 0..count-1: the middle pulsates by `amplitude` (m) over whole periods while the whole tube turns and travels.
inline doublet::MeshSequence pulsating(double amplitude, int count = 40, bool moves = true) {
  doublet::MeshSequence sequence{faces(), {}};
  for (int t = 0; t < count; ++t) {
    const double s = std::sin(2 * std::numbers::pi * 2 * t / count);
    doublet::Vertices v = vertices([&](double y) { return kRadius + amplitude * s * cloth_share(y); });
    if (moves) {
      const Eigen::Matrix3d turn = Eigen::AngleAxisd(0.05 * t, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
      v = (v * turn.transpose()).rowwise() + Eigen::RowVector3d(0.02 * t, 0, -0.01 * t);
    }
    sequence.frames.push_back(std::move(v));
  }
  return sequence;
}

} // namespace tube
