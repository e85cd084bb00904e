#include "doublet/core/surface_distance.h"

#include "doublet/core/rasterizer.h"
#include "doublet/core/ray_scene.h"

#include <algorithm>
#include <cmath>

namespace doublet {

Eigen::VectorXd distances_to_surface(const Vertices &points, const Mesh &surface, const std::vector<std::uint8_t> &skip_face,
                                     const Context &context) {
  const RayScene scene(surface, skip_face);
  Eigen::VectorXd distances(points.rows());
  constexpr int kChunk = 50000; // between two looks at the user's wish to stop, well under a second
  for (int begin = 0; begin < points.rows(); begin += kChunk) {
    context.check_cancelled();
    parallel_for(context, std::min<int>(kChunk, static_cast<int>(points.rows()) - begin),
                 [&](int i) { distances[begin + i] = scene.closest(points.row(begin + i)).distance; });
  }
  return distances;
}

std::vector<std::uint8_t> visible_vertices(const Vertices &vertices, const Faces &faces, const CameraRig &cameras,
                                           double tolerance) {
  std::vector<std::uint8_t> visible(vertices.rows(), 0);
  for (const Camera &camera : cameras) {
    const FaceBuffer buffer = rasterize(vertices, faces, camera);
    for (Eigen::Index v = 0; v < vertices.rows(); ++v) {
      const double depth = camera.depth(vertices.row(v));
      if (visible[v] || !(depth > 0))
        continue;
      const Eigen::Vector2d pixel = camera.project(vertices.row(v)).array().round();
      const bool inside = pixel.x() >= 0 && pixel.y() >= 0 && pixel.x() < camera.width && pixel.y() < camera.height;
      visible[v] = inside && depth <= buffer.depth_at(static_cast<int>(pixel.x()), static_cast<int>(pixel.y())) + tolerance;
    }
  }
  return visible;
}

} // namespace doublet
