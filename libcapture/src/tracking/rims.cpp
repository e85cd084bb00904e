#include "doublet/capture/rims.h"

#include <algorithm>
#include <cmath>

namespace doublet {
namespace {

/// The ray may leave its triangle by half a pixel at the outline; stay on the surface.
Eigen::Vector3d clamped(const Eigen::Vector3d &barycentric) {
  const Eigen::Vector3d positive = barycentric.cwiseMax(0).cwiseMin(1);
  const double sum = positive.sum();
  return sum > 0 && std::isfinite(sum) ? Eigen::Vector3d(positive / sum) : Eigen::Vector3d::Constant(1. / 3);
}

RimConstraint make_constraint(const Rims &rims, int rim, const Outline &measured, int target, int view) {
  RimConstraint c;
  c.view = view;
  c.surface = rims.surface[rim];
  // The boundary lies up to a pixel outside the surface point that stands for it: move the target, not the point.
  c.target = (measured.points[target] - rims.outline.points[rim] + rims.seen[rim]).cast<double>();
  c.normal = measured.normals[target].cast<double>();
  c.metres_per_pixel = rims.metres_per_pixel;
  return c;
}

} // namespace

Rims find_rims(const Vertices &vertices, const Faces &faces, const std::vector<std::uint8_t> &face_valid, const Camera &camera,
               int raster_size) {
  const double scale = std::min(1.0, static_cast<double>(raster_size) / std::max(camera.width, camera.height));
  const int width = std::max(1, static_cast<int>(std::lround(camera.width * scale)));
  const int height = std::max(1, static_cast<int>(std::lround(camera.height * scale)));
  const Camera small = camera.resized(width, height);
  constexpr int kMargin = 3; // pixels; so that the outline ends at the image's border alone
  const FaceWindow window = rasterize_window(vertices, faces, small, face_valid, kMargin);
  Rims rims;
  rims.outline = trace_outline(silhouette(window.buffer), window.x, window.y, width, height);
  rims.surface.reserve(rims.outline.points.size());
  const Eigen::Vector2f size(static_cast<float>(camera.width) / width, static_cast<float>(camera.height) / height);
  double depth = 0;
  for (size_t i = 0; i < rims.outline.points.size(); ++i) {
    const Eigen::Vector2i &pixel = rims.outline.pixels[i];
    SurfacePoint point;
    point.face = window.buffer.face_at(pixel.x() - window.x, pixel.y() - window.y);
    point.barycentric = clamped(barycentric_at(vertices, faces, point.face, small, pixel.cast<double>()));
    rims.surface.push_back(point);
    depth += window.buffer.depth_at(pixel.x() - window.x, pixel.y() - window.y);
    const auto full_size = [&](const Eigen::Vector2f &p) { // pixel centres stay at integers
      return Eigen::Vector2f(((p.array() + 0.5f) * size.array() - 0.5f).matrix());
    };
    rims.outline.points[i] = full_size(rims.outline.points[i]);
    rims.seen.push_back(full_size(pixel.cast<float>()));
  }
  if (!rims.surface.empty())
    rims.metres_per_pixel = depth / rims.surface.size() / camera.K(0, 0);
  return rims;
}

RimMatches match_rims(const Rims &rims, const Outline &measured, const OutlineIndex &index, int view, const Camera &camera,
                      const RimMatchOptions &options) {
  options.validate();
  RimMatches matches;
  if (rims.outline.empty() || measured.empty())
    return matches;
  const float radius = static_cast<float>(options.gate / rims.metres_per_pixel), cosine = static_cast<float>(options.min_cosine);
  const int rim_count = static_cast<int>(rims.outline.points.size()), measured_count = static_cast<int>(measured.points.size());
  for (int i = 0; i < rim_count; i += std::max(1, rim_count / options.count)) {
    const int target = index.nearest(rims.outline.points[i], rims.outline.normals[i], radius, cosine);
    if (target >= 0)
      matches.constraints.push_back(make_constraint(rims, i, measured, target, view));
    else
      ++matches.unmatched;
  }
  if (!options.both_directions)
    return matches;
  const OutlineIndex rim_index(rims.outline, camera.width, camera.height);
  for (int i = 0; i < measured_count; i += std::max(1, measured_count / options.count)) {
    const int rim = rim_index.nearest(measured.points[i], measured.normals[i], radius, cosine);
    if (rim >= 0)
      matches.constraints.push_back(make_constraint(rims, rim, measured, i, view));
    else
      ++matches.unmatched;
  }
  return matches;
}

double rim_residual(const RimConstraint &constraint, const Vertices &vertices, const Faces &faces, const Camera &camera) {
  return constraint.normal.dot(camera.project(constraint.surface.position(vertices, faces)) - constraint.target);
}

} // namespace doublet
