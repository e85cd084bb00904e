#include "doublet/core/rasterizer.h"

#include "draw_face.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>

namespace doublet {

namespace {

using detail::ScreenVertex, detail::floor_pixel, detail::ceil_pixel, detail::kSubpixelBits;

constexpr double kNear = 0.05;     // m
constexpr double kFarOut = 524288; // pixels: larger coordinates would overflow the edge functions

/// Beyond this squared radius (normalised image plane) the radial distortion polynomial folds back into the image.
double fold_radius_squared(const Camera &camera) {
  const auto &k = camera.distortion;
  for (double r = 0; r < 10; r += 0.01) {
    const double r2 = r * r;
    if (1 + r2 * (3 * k[0] + r2 * (5 * k[1] + r2 * 7 * k[4])) <= 0)
      return r2;
  }
  return std::numeric_limits<double>::infinity();
}

/// As std::llround() of a coordinate in subpixels, without a call.
std::int64_t to_subpixels(double pixel) {
  const double scaled = pixel * (1 << kSubpixelBits);
  const auto whole = static_cast<std::int64_t>(scaled);
  const double rest = scaled - static_cast<double>(whole);
  return whole + (rest >= 0.5) - (rest <= -0.5);
}

std::vector<ScreenVertex> project_all(const Vertices &vertices, const Camera &camera) {
  const bool distorted = camera.distorted();
  const double fold = distorted ? fold_radius_squared(camera) : std::numeric_limits<double>::infinity();
  const Eigen::Matrix2d focal = camera.K.topLeftCorner<2, 2>();
  const Eigen::Vector2d middle = camera.K.topRightCorner<2, 1>();
  std::vector<ScreenVertex> out(vertices.rows());
  for (Eigen::Index v = 0; v < vertices.rows(); ++v) {
    const Eigen::Vector3d point = vertices.row(v);
    const Eigen::Vector3d in_camera = camera.R * point + camera.t;
    if (!(in_camera.z() >= kNear) || !(in_camera.head<2>().squaredNorm() < fold * in_camera.z() * in_camera.z()))
      continue;
    // Camera::project() without turning the point a second time.
    const Eigen::Vector2d pixel = distorted
                                      ? camera.project(point)
                                      : Eigen::Vector2d(focal * Eigen::Vector2d(in_camera.head<2>() / in_camera.z()) + middle);
    if (!(pixel.cwiseAbs().maxCoeff() < kFarOut))
      continue;
    out[v] = {to_subpixels(pixel.x()), to_subpixels(pixel.y()), 1 / in_camera.z(), true};
  }
  return out;
}

void require_drawable(const Vertices &vertices, const Faces &faces, const Camera &camera, const Mask &face_valid) {
  if (camera.width <= 0 || camera.height <= 0)
    throw std::invalid_argument("rasterize: camera '" + camera.name + "' has no image size");
  if (!face_valid.empty() && static_cast<Eigen::Index>(face_valid.size()) != faces.rows())
    throw std::invalid_argument("rasterize: expected " + std::to_string(faces.rows()) + " entries in face_valid, found " +
                                std::to_string(face_valid.size()));
  if (faces.rows() > 0 && (faces.minCoeff() < 0 || faces.maxCoeff() >= vertices.rows()))
    throw std::invalid_argument("rasterize: a face has a corner outside the " + std::to_string(vertices.rows()) + " vertices");
  validate_camera(camera, "rasterize");
}

FaceBuffer drawn(const std::vector<ScreenVertex> &screen, const Faces &faces, const Mask &face_valid, int width, int height) {
  FaceBuffer buffer;
  buffer.width = width;
  buffer.height = height;
  buffer.face.assign(static_cast<std::size_t>(width) * height, -1);
  buffer.depth.assign(buffer.face.size(), std::numeric_limits<float>::infinity());
  for (int f = 0; f < faces.rows(); ++f) {
    if (!face_valid.empty() && !face_valid[f])
      continue;
    const ScreenVertex &a = screen[faces(f, 0)], &b = screen[faces(f, 1)], &c = screen[faces(f, 2)];
    if (a.drawable && b.drawable && c.drawable)
      detail::draw_face(buffer, f, a, b, c);
  }
  return buffer;
}

} // namespace

FaceBuffer rasterize(const Vertices &vertices, const Faces &faces, const Camera &camera, const Mask &face_valid) {
  require_drawable(vertices, faces, camera, face_valid);
  return drawn(project_all(vertices, camera), faces, face_valid, camera.width, camera.height);
}

FaceWindow rasterize_window(const Vertices &vertices, const Faces &faces, const Camera &camera, const Mask &face_valid,
                            int margin) {
  require_drawable(vertices, faces, camera, face_valid);
  std::vector<ScreenVertex> screen = project_all(vertices, camera);
  Eigen::AlignedBox2i box;
  for (const ScreenVertex &v : screen)
    if (v.drawable) {
      box.extend(Eigen::Vector2i(floor_pixel(v.x) - margin, floor_pixel(v.y) - margin));
      box.extend(Eigen::Vector2i(ceil_pixel(v.x) + margin, ceil_pixel(v.y) + margin));
    }
  box = box.intersection({Eigen::Vector2i::Zero(), Eigen::Vector2i(camera.width - 1, camera.height - 1)});
  if (box.isEmpty())
    return {};
  for (ScreenVertex &v : screen) {
    v.x -= static_cast<std::int64_t>(box.min().x()) << kSubpixelBits;
    v.y -= static_cast<std::int64_t>(box.min().y()) << kSubpixelBits;
  }
  const Eigen::Vector2i size = box.sizes() + Eigen::Vector2i::Ones();
  return {drawn(screen, faces, face_valid, size.x(), size.y()), box.min().x(), box.min().y()};
}

Eigen::Vector3d barycentric_at(const Vertices &vertices, const Faces &faces, int f, const Camera &camera,
                               const Eigen::Vector2d &pixel) {
  const Eigen::Vector3d centre = camera.centre(), direction = camera.ray_direction(pixel);
  const Eigen::Vector3d a = vertices.row(faces(f, 0)).transpose() - centre;
  const Eigen::Vector3d b = vertices.row(faces(f, 1)).transpose() - centre;
  const Eigen::Vector3d c = vertices.row(faces(f, 2)).transpose() - centre;
  // Volumes of the tetrahedra that the ray spans with each side: their shares are the coordinates.
  const Eigen::Vector3d volumes(direction.dot(b.cross(c)), direction.dot(c.cross(a)), direction.dot(a.cross(b)));
  const double sum = volumes.sum();
  if (std::abs(sum) < 1e-18)
    return Eigen::Vector3d::Constant(1.0 / 3);
  return volumes / sum;
}

Image silhouette(const FaceBuffer &buffer) {
  Image mask(buffer.width, buffer.height, 1);
  std::transform(buffer.face.begin(), buffer.face.end(), mask.data.begin(), [](int f) { return f >= 0 ? 255 : 0; });
  return mask;
}

double mask_iou(const Image &a, const Image &b) {
  if (a.width != b.width || a.height != b.height || a.channels != 1 || b.channels != 1)
    throw std::invalid_argument("mask_iou: expected two masks of one size, found " + std::to_string(a.width) + " x " +
                                std::to_string(a.height) + " and " + std::to_string(b.width) + " x " + std::to_string(b.height));
  std::size_t both = 0, any = 0;
  for (std::size_t i = 0; i < a.data.size(); ++i) {
    both += a.data[i] > 0 && b.data[i] > 0;
    any += a.data[i] > 0 || b.data[i] > 0;
  }
  return any ? static_cast<double>(both) / any : 1;
}

} // namespace doublet
