#include "doublet/rays/surface_distance.h"

#include "doublet/core/rasterizer.h"
#include "doublet/options/options.h"
#include "doublet/rays/ray_scene.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace doublet {

namespace {

/// The largest depth at the four pixel centres around `pixel`: what a slanted surface through the pixel reaches there. Minus
/// infinity outside the image.
double farthest_around(const FaceBuffer &buffer, const Eigen::Vector2d &pixel) {
  double depth = -std::numeric_limits<double>::infinity();
  if (!(pixel.x() >= -0.5 && pixel.y() >= -0.5 && pixel.x() <= buffer.width - 0.5 && pixel.y() <= buffer.height - 0.5))
    return depth;
  const int x = static_cast<int>(std::floor(pixel.x())), y = static_cast<int>(std::floor(pixel.y()));
  for (int k = 0; k < 4; ++k)
    depth = std::max<double>(
        depth, buffer.depth_at(std::clamp(x + k % 2, 0, buffer.width - 1), std::clamp(y + k / 2, 0, buffer.height - 1)));
  return depth;
}

} // namespace

Eigen::VectorXd distances_to_surface(const Vertices &points, const Mesh &surface, const std::vector<std::uint8_t> &face_valid,
                                     const Context &context) {
  const RayScene scene(surface, face_valid);
  Eigen::VectorXd distances(points.rows());
  constexpr int kChunk = 50000; // between two looks at the user's wish to stop, well under a second
  for (int begin = 0; begin < points.rows(); begin += kChunk) {
    context.throw_if_cancelled();
    parallel_for(context, std::min<int>(kChunk, static_cast<int>(points.rows()) - begin),
                 [&](int i) { distances[begin + i] = scene.closest(points.row(begin + i)).distance; });
  }
  return distances;
}

std::vector<std::uint8_t> visible_vertices(const Vertices &vertices, const Faces &faces, const CameraRig &cameras,
                                           double tolerance) {
  if (!(tolerance >= 0))
    throw std::invalid_argument("visible_vertices: expected a tolerance of at least 0 m, found " + options::to_text(tolerance));
  std::vector<std::uint8_t> visible(vertices.rows(), 0);
  for (const Camera &camera : cameras) {
    const FaceBuffer buffer = rasterize(vertices, faces, camera);
    for (Eigen::Index v = 0; v < vertices.rows(); ++v) {
      const double depth = camera.depth(vertices.row(v));
      if (visible[v] || !(depth > 0))
        continue;
      visible[v] = depth <= farthest_around(buffer, camera.project(vertices.row(v))) + tolerance;
    }
  }
  return visible;
}

} // namespace doublet
