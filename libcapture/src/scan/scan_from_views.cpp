#include "doublet/capture/scan_from_views.h"

#include "closed_surface.h"
#include "doublet/core/error.h"
#include "doublet/rays/ray_scene.h"
#include "photo_consistency.h"
#include "poisson.h"
#include "visual_hull.h"

#include <cmath>
#include <stdexcept>

namespace doublet {
namespace {

void require_views(const CameraRig &rig, const std::vector<CameraView> &views) {
  if (views.size() != rig.size())
    throw std::invalid_argument("scan: expected " + std::to_string(rig.size()) + " views, one per camera, found " +
                                std::to_string(views.size()));
  for (std::size_t c = 0; c < rig.size(); ++c)
    for (const Image *image : {&views[c].image, &views[c].mask})
      if (!image->empty() && (image->width != rig[c].width || image->height != rig[c].height))
        throw std::invalid_argument("scan: camera '" + rig[c].name + "': expected images of " + std::to_string(rig[c].width) +
                                    " x " + std::to_string(rig[c].height) + ", found " + std::to_string(image->width) + " x " +
                                    std::to_string(image->height));
}

/// Without the faces that face down and whose middle no camera sees, or only too flat: cloth is open there (a hem), and the hull
/// a sheet. What faces up or aside is bounded by the silhouettes even if nobody sees it.
Mesh without_sheets(const Mesh &surface, const CameraRig &rig, const std::vector<CameraView> &views, double grazing_angle,
                    const Context &context) {
  const RayScene scene(surface);
  const double flattest = std::cos(grazing_angle);
  std::vector<std::uint8_t> seen(surface.faces.rows(), 0);
  parallel_for(context, static_cast<int>(seen.size()), [&](int f) {
    const Eigen::Vector3d a = surface.vertices.row(surface.faces(f, 0)), b = surface.vertices.row(surface.faces(f, 1)),
                          c = surface.vertices.row(surface.faces(f, 2));
    const Eigen::Vector3d normal = (b - a).cross(c - a).normalized(), middle = (a + b + c) / 3;
    constexpr double kDown = -0.5, kAbove = 1e-3; // cosine; m, a face must not hide itself
    seen[f] = normal.y() > kDown;
    for (std::size_t i = 0; i < rig.size() && !seen[f]; ++i)
      if (!views[i].mask.empty() && normal.dot((rig[i].centre() - middle).normalized()) > flattest)
        seen[f] = !scene.occluded(middle + kAbove * normal, rig[i].centre());
  });
  std::vector<int> kept;
  for (std::size_t f = 0; f < seen.size(); ++f)
    if (seen[f])
      kept.push_back(static_cast<int>(f));
  return submesh(surface, kept);
}

Mesh one_piece(const detail::PoissonSurface &surface) {
  std::vector<int> source; // not needed: nothing hangs on the vertices yet
  return detail::closed_surface(surface.mesh, source);
}

} // namespace

namespace {

Mesh scan_around(const Mesh *body, const CameraRig &rig, const std::vector<CameraView> &views, const ViewScanOptions &options,
                 const Context &context) {
  options.validate();
  require_views(rig, views);
  const detail::OrientedPoints points = detail::visual_hull(rig, views, body, options, context);
  // Coarse first: where the hull is far off its normals are, too, and point past what the cameras could agree on.
  const int passes = options.search_depth > 0 ? 2 : 0;
  const auto depth_of = [&](int pass) { return options.poisson_depth - (pass + 1 < passes); };
  context.report_progress("scan: surface of the hull", 0);
  Mesh surface = one_piece(detail::poisson_surface(points.points, points.normals, depth_of(-1)));
  for (int pass = 0; pass < passes; ++pass) {
    surface.vertices = detail::photo_consistent(surface, rig, views, options, context);
    context.report_progress("scan: surface", 0);
    surface = one_piece(detail::poisson_surface(surface, depth_of(pass)));
  }
  return without_sheets(surface, rig, views, options.grazing_angle, context);
}

} // namespace

Mesh scan_from_views(const CameraRig &rig, const std::vector<CameraView> &views, const ViewScanOptions &options,
                     const Context &context) {
  return scan_around(nullptr, rig, views, options, context);
}

Mesh scan_from_views(const CameraRig &rig, const std::vector<CameraView> &views, const Mesh &body, const ViewScanOptions &options,
                     const Context &context) {
  return scan_around(&body, rig, views, options, context);
}

} // namespace doublet
