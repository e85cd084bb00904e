#include "doublet/segment/fullness.h"

#include "doublet/core/parts/quantile.h"
#include "doublet/segment/parts/diffusion.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <stdexcept>
#include <string>

namespace doublet {
namespace {

constexpr int kRings = 2;        // of edges around a vertex
constexpr double kUpright = 0.2; // sine between normal and gravity below which a surface lies flat
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

/// Edges of the surface, and which ones meet at a vertex.
struct Edges {
  std::vector<std::array<int, 2>> ends;
  std::vector<std::vector<int>> at; ///< [V]
};

Edges edges_of(const Faces &faces, Eigen::Index vertex_count) {
  std::set<std::array<int, 2>> unique;
  for (int f = 0; f < faces.rows(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int a = faces(f, k), b = faces(f, (k + 1) % 3);
      unique.insert({std::min(a, b), std::max(a, b)});
    }
  Edges edges{{unique.begin(), unique.end()}, std::vector<std::vector<int>>(vertex_count)};
  for (std::size_t e = 0; e < edges.ends.size(); ++e)
    for (int v : edges.ends[e])
      edges.at[v].push_back(static_cast<int>(e));
  return edges;
}

/// The edges between vertices at most kRings edges away.
std::vector<int> surroundings(const Edges &edges, int vertex) {
  std::set<int> reached{vertex}, chosen;
  std::vector<int> front{vertex};
  for (int ring = 0; ring < kRings; ++ring) {
    std::vector<int> next;
    for (int v : front)
      for (int e : edges.at[v]) {
        chosen.insert(e);
        for (int w : edges.ends[e])
          if (reached.insert(w).second)
            next.push_back(w);
      }
    front = std::move(next);
  }
  return {chosen.begin(), chosen.end()};
}

/// Lengths across and along gravity over those of the scan, one a frame; empty if they cannot be told.
struct Stretches {
  std::vector<double> across, along;
};
Stretches stretches(const Mesh &scan, const Edges &edges, int vertex, const Eigen::Vector3d &normal,
                    const MeshSequence &sequence) {
  const Eigen::Vector3d horizontal = Eigen::Vector3d::UnitY().cross(normal);
  const std::vector<int> chosen = surroundings(edges, vertex);
  if (!(horizontal.norm() > kUpright) || chosen.size() < 4)
    return {};
  const Eigen::Vector3d across = horizontal.normalized(), along = normal.cross(across).normalized();
  // |d|^2 = d' G d for each edge d in the tangent plane, turned into it at its full length; relative to the scan's.
  Eigen::Matrix<double, Eigen::Dynamic, 3> system(chosen.size(), 3);
  Eigen::VectorXd lengths(chosen.size());
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    const auto [a, b] = edges.ends[chosen[i]];
    const Eigen::Vector3d d = (scan.vertices.row(b) - scan.vertices.row(a)).transpose();
    const Eigen::Vector2d flat = Eigen::Vector2d(d.dot(across), d.dot(along)).normalized();
    system.row(i) << flat.x() * flat.x(), 2 * flat.x() * flat.y(), flat.y() * flat.y();
    lengths[i] = d.norm();
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> solver(system);
  if (solver.rank() < 3 || !(lengths.minCoeff() > 0))
    return {};
  Stretches result;
  Eigen::VectorXd squares(chosen.size());
  for (const Vertices &frame : sequence.frames) {
    for (std::size_t i = 0; i < chosen.size(); ++i) {
      const auto [a, b] = edges.ends[chosen[i]];
      squares[i] = (frame.row(b) - frame.row(a)).squaredNorm() / (lengths[i] * lengths[i]);
    }
    const Eigen::Vector3d metric = solver.solve(squares);
    result.across.push_back(std::sqrt(std::max(metric[0], 0.0)));
    result.along.push_back(std::sqrt(std::max(metric[2], 0.0)));
  }
  return result;
}

} // namespace

Eigen::VectorXd estimate_fullness(const Mesh &scan, const std::vector<std::uint8_t> &face_valid, const Segmentation &segmentation,
                                  const MeshSequence &sequence, const FullnessOptions &options, const Context &context) {
  options.validate();
  const Eigen::Index count = scan.vertices.rows();
  require_usable(scan, "estimate_fullness: scan");
  require_segmentation(segmentation, count, "estimate_fullness");
  if (sequence.frames.empty())
    throw std::invalid_argument("estimate_fullness: expected at least one frame, found none");
  require_frames(sequence.frames, count, "estimate_fullness: a frame");
  if (!face_valid.empty() && static_cast<Eigen::Index>(face_valid.size()) != scan.faces.rows())
    throw std::invalid_argument("estimate_fullness: face_valid: expected " + std::to_string(scan.faces.rows()) +
                                " entries, one a face, found " + std::to_string(face_valid.size()));
  if (!options.estimate || segmentation.region_count == 0)
    return Eigen::VectorXd::Ones(count);
  const Faces faces = valid_faces(scan.faces, face_valid);
  const Edges edges = edges_of(faces, count);
  const Vertices normals = vertex_normals(scan.vertices, faces);
  Eigen::VectorXd wide = Eigen::VectorXd::Ones(count);
  parallel_for(context, static_cast<int>(count), [&](int v) {
    if (segmentation.region[v] < 0)
      return;
    const Stretches found = stretches(scan, edges, v, normals.row(v).transpose(), sequence);
    if (found.across.empty()) {
      wide[v] = kUnknown;
      return;
    }
    // Cloth that hangs straight is as long as in the scan: what the video shows it longer is the noise of the tracking.
    const double noise = std::max(1.0, quantile(found.along, options.quantile));
    wide[v] = std::clamp(quantile(found.across, options.quantile) / noise, 1.0, options.largest);
  });
  wide = diffuse_on_surface(scan.vertices, faces, wide, options.smoothing);
  for (Eigen::Index v = 0; v < count; ++v)
    wide[v] = segmentation.region[v] >= 0 && wide[v] > 1 ? std::min(wide[v], options.largest) : 1.0;
  return wide;
}

} // namespace doublet
