#include "doublet/capture/template_builder.h"
#include "doublet/core/parts/self_intersection.h"
#include "doublet/rays/surface_distance.h"
#include "face_mask.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace doublet {
namespace {

/// (F) degrees; 0 for a degenerate face.
std::vector<double> smallest_angles(const Mesh &mesh) {
  std::vector<double> out;
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    double smallest = std::numbers::pi;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d corner = mesh.vertices.row(mesh.faces(f, k)),
                            a = mesh.vertices.row(mesh.faces(f, (k + 1) % 3)).transpose() - corner,
                            b = mesh.vertices.row(mesh.faces(f, (k + 2) % 3)).transpose() - corner;
      smallest = std::min(smallest, std::atan2(a.cross(b).norm(), a.dot(b)));
    }
    out.push_back(smallest * 180 / std::numbers::pi);
  }
  return out;
}

/// Corners, middles of the edges and centroid of the valid faces, (7 N, 3).
Vertices valid_samples(const Mesh &mesh, const std::vector<std::uint8_t> &face_valid) {
  Vertices samples(7 * std::count_if(face_valid.begin(), face_valid.end(), [](auto valid) { return valid != 0; }), 3);
  Eigen::Index row = 0;
  for (Eigen::Index f = 0; f < mesh.faces.rows(); ++f) {
    if (!face_valid[f])
      continue;
    const Eigen::Matrix3d corners = mesh.vertices(mesh.faces.row(f), Eigen::all);
    for (int k = 0; k < 3; ++k) {
      samples.row(row++) = corners.row(k);
      samples.row(row++) = (corners.row(k) + corners.row((k + 1) % 3)) / 2;
    }
    samples.row(row++) = corners.colwise().mean();
  }
  return samples;
}

SurfaceQuality quality(const Mesh &mesh, const std::vector<std::uint8_t> &face_valid, const Mesh &scan, const Context &context) {
  SurfaceQuality out;
  out.triangles = static_cast<int>(mesh.faces.rows());
  const auto crossing = self_intersecting_faces(mesh, context);
  out.self_intersections = static_cast<int>(std::count(crossing.begin(), crossing.end(), 1));
  const Eigen::VectorXd areas = face_areas(mesh.vertices, mesh.faces);
  for (std::size_t f = 0; f < face_valid.size(); ++f)
    out.invalid_area += face_valid[f] ? 0 : areas[static_cast<Eigen::Index>(f)];
  std::vector<double> angles = smallest_angles(mesh);
  std::sort(angles.begin(), angles.end());
  out.smallest_angle = angles.front();
  out.first_centile_angle = angles[angles.size() / 100];
  const Eigen::VectorXd from_scan = distances_to_surface(scan.vertices, mesh, {}, context);
  out.scan_mean = from_scan.mean();
  out.scan_max = from_scan.maxCoeff();
  if (const Vertices samples = valid_samples(mesh, face_valid); samples.rows() > 0) {
    const Eigen::VectorXd to_scan = distances_to_surface(samples, scan, {}, context);
    out.mean_to_scan = to_scan.mean();
    out.max_to_scan = to_scan.maxCoeff();
  }
  return out;
}

} // namespace

TemplateSummary summarise_template(const Template &surface, const Mesh &scan, const Context &context) {
  require_usable(surface.mesh, "template");
  require_usable(surface.high, "template's display surface");
  require_usable(scan, "scan");
  detail::expect_mask(surface.face_valid, surface.mesh, "face_valid");
  detail::expect_mask(surface.high_face_valid, surface.high, "high_face_valid");
  context.report_progress("template: summary", 0.0);
  TemplateSummary out;
  out.mesh = quality(surface.mesh, surface.face_valid, scan, context);
  context.report_progress("template: summary", 0.5);
  out.high = quality(surface.high, surface.high_face_valid, scan, context);
  context.report_progress("template: summary", 1.0);
  return out;
}

} // namespace doublet
