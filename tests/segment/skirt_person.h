#pragma once
// A plain person in a skirt, as a scan shows them: one closed surface of revolution that stands on one leg, with a sheet below
// the hem that is not there in truth. Of known measures.

#include "doublet/core/stage_values.h"
#include "doublet/segment/garment_mesher.h"
#include "support/figure.h"

#include <cmath>
#include <functional>
#include <vector>

namespace skirt_person {

using doublet::testing::pi;

constexpr int kAround = 96;
constexpr double kHem = 0.5, kWaist = 1.0;              // m, heights
constexpr double kHemRadius = 0.3, kWaistRadius = 0.15; // m
constexpr double kLegRadius = 0.08;

/// Rings of the surface, from below.
struct Ring {
  double y, radius;
  bool cloth;
};

inline std::vector<Ring> rings() {
  std::vector<Ring> all;
  const auto add = [&](double y0, double r0, double y1, double r1, int count, bool cloth) { // without the last
    for (int i = 0; i < count; ++i)
      all.push_back({y0 + (y1 - y0) * i / count, r0 + (r1 - r0) * i / count, cloth});
  };
  add(0, kLegRadius, kHem, kLegRadius, 20, false);
  add(kHem, kLegRadius, kHem, kHemRadius, 8, false); // the sheet
  add(kHem, kHemRadius, kWaist, kWaistRadius, 26, true);
  add(kWaist, kWaistRadius, 1.4, kWaistRadius, 20, false);
  add(1.4, kWaistRadius, 1.7, 0.05, 15, false);
  all.push_back({1.7, 0.05, false});
  return all;
}

inline int first_ring(double y) { // at this height or above, of the skirt or the trunk
  const std::vector<Ring> all = rings();
  int r = 28;
  while (all[r].y < y - 1e-9)
    ++r;
  return r;
}
inline int vertex(int ring, int column) {
  return ring * kAround + (column + kAround) % kAround;
}
/// The two faces between a ring and the next, and a column and the next.
inline int face(int ring, int column) {
  return 2 * vertex(ring, column);
}

/// The surface with its skirt in another shape: (height, radius) of the place at a share of the way from hem to waist and an
/// angle.
inline doublet::Vertices surface(const std::function<Eigen::Vector2d(double, double)> &skirt) {
  const std::vector<Ring> all = rings();
  const int n = static_cast<int>(all.size()) * kAround;
  doublet::Vertices result(n + 2, 3);
  for (int i = 0; i < n; ++i) {
    const Ring &ring = all[i / kAround];
    const double angle = 2 * pi * (i % kAround) / kAround;
    double y = ring.y, radius = ring.radius;
    if (ring.cloth) {
      const Eigen::Vector2d place = skirt((ring.y - kHem) / (kWaist - kHem), angle);
      y = place[0], radius = place[1];
    }
    result.row(i) << radius * std::sin(angle), y, radius * std::cos(angle);
  }
  result.row(n) << 0, 0, 0;
  result.row(n + 1) << 0, 1.7, 0;
  return result;
}

inline Eigen::Vector2d plain(double up, double) {
  return {kHem + up * (kWaist - kHem), kHemRadius + up * (kWaistRadius - kHemRadius)};
}

struct Person {
  doublet::RiggedMesh actor;
  doublet::Segmentation segmentation;
  doublet::Mesh body; ///< trunk and leg

  explicit Person(const std::function<Eigen::Vector2d(double, double)> &skirt = plain) {
    const std::vector<Ring> all = rings();
    const int count = static_cast<int>(all.size());
    const auto radius = [](double) { return 1.0; };
    actor.mesh = doublet::testing::closed_tube({0, 0, 0}, {0, 1, 0}, radius, count - 1, kAround);
    actor.mesh.vertices = surface(skirt);
    actor.skeleton = doublet::testing::figure_skeleton();
    actor.weights = doublet::testing::figure_weights(actor.mesh.vertices, actor.skeleton);
    actor.face_valid.assign(actor.mesh.faces.rows(), 1);
    for (int ring = 20; ring < 28; ++ring)
      for (int k = 0; k < kAround; ++k)
        set_invalid(ring, k);
    segmentation.clothness = Eigen::VectorXd::Zero(actor.mesh.vertices.rows());
    segmentation.region = Eigen::VectorXi::Constant(actor.mesh.vertices.rows(), -1);
    segmentation.sigma = segmentation.clothness;
    for (int ring = 0; ring < count; ++ring)
      if (all[ring].cloth)
        set_cloth(ring, 0);
    body = doublet::testing::closed_tube(
        {0, 0, 0}, {0, 1.7, 0}, [](double s) { return 1.7 * s > 0.9 ? kWaistRadius : kLegRadius; }, 170, kAround);
  }
  void set_invalid(int ring, int column) { actor.face_valid[face(ring, column)] = actor.face_valid[face(ring, column) + 1] = 0; }
  void set_cloth(int ring, int region) {
    for (int k = 0; k < kAround; ++k) {
      segmentation.clothness[vertex(ring, k)] = region >= 0 ? 1 : 0;
      segmentation.region[vertex(ring, k)] = region;
    }
    segmentation.region_count = std::max(segmentation.region_count, region + 1);
  }
};

inline doublet::GarmentOptions small_garment() {
  doublet::GarmentOptions options;
  options.vertices = 400;
  return options;
}

} // namespace skirt_person
