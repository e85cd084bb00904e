#include "doublet/animate/renderer.h"

#include "doublet/animate/parts/image_file.h"
#include "doublet/core/error.h"
#include "doublet/core/rasterizer.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>

namespace doublet {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kShadowCell = 0.03; // m
constexpr double kShadowBlur = 0.09; // m

void require_mesh(const RenderMesh &mesh, std::size_t index) {
  const auto check = [&](bool good, const std::string &what) {
    if (!good)
      throw std::invalid_argument("render: mesh " + std::to_string(index) + ": " + what);
  };
  check(mesh.vertices.allFinite(), "the vertices must be finite");
  check(mesh.faces.rows() == 0 || (mesh.faces.minCoeff() >= 0 && mesh.faces.maxCoeff() < mesh.vertices.rows()),
        "a face names a vertex that is not there");
  check(mesh.face_valid.empty() || static_cast<Eigen::Index>(mesh.face_valid.size()) == mesh.faces.rows(),
        "face_valid must be one a face");
  check(mesh.colours.allFinite() && mesh.colour.allFinite(), "the colours must be finite");
  check(mesh.colours.rows() == 0 || mesh.colours.rows() == mesh.vertices.rows(), "colours must be one a vertex");
  check(!mesh.texture ||
            (!mesh.texture->empty() && mesh.texture->channels == 3 && mesh.texcoords.rows() == 3 * mesh.faces.rows()),
        "a texture needs 3 channels and 3 texcoords a face");
}

/// Bilinear, clamped at the borders; R G B in [0, 1].
Vector3f sample_texture(const Image &image, double u, double v) {
  const double x = std::clamp(u * image.width - 0.5, 0.0, image.width - 1.0),
               y = std::clamp(v * image.height - 0.5, 0.0, image.height - 1.0);
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const auto a = static_cast<float>(x - x0), b = static_cast<float>(y - y0);
  const std::size_t row = 3 * static_cast<std::size_t>(image.width), right = x0 + 1 < image.width ? 3 : 0,
                    below = y0 + 1 < image.height ? row : 0;
  const std::uint8_t *at = image.data.data() + y0 * row + 3 * static_cast<std::size_t>(x0);
  const auto texel = [](const std::uint8_t *p) { return Vector3f(p[2], p[1], p[0]); };
  return ((1 - b) * ((1 - a) * texel(at) + a * texel(at + right)) +
          b * ((1 - a) * texel(at + below) + a * texel(at + below + right))) /
         255.0f;
}

/// How much of the sky the meshes hide from each spot of the floor: their footprint, blurred, stronger where they are low.
class FloorShadow {
public:
  FloorShadow(const std::vector<RenderMesh> &meshes, double floor) {
    Vector3d low = Vector3d::Constant(1e30), high = -low;
    for (const RenderMesh &mesh : meshes)
      if (mesh.vertices.rows() > 0) {
        low = low.cwiseMin(Vector3d(mesh.vertices.colwise().minCoeff()));
        high = high.cwiseMax(Vector3d(mesh.vertices.colwise().maxCoeff()));
      }
    if (low.x() > high.x() || (high - low).maxCoeff() > 50)
      return;
    const double margin = 4 * kShadowBlur;
    x0_ = low.x() - margin;
    z0_ = low.z() - margin;
    nx_ = static_cast<int>((high.x() - low.x() + 2 * margin) / kShadowCell) + 1;
    nz_ = static_cast<int>((high.z() - low.z() + 2 * margin) / kShadowCell) + 1;
    cells_.assign(static_cast<std::size_t>(nx_) * nz_, 0.0f);
    for (const RenderMesh &mesh : meshes)
      for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
        const double height = std::max(mesh.vertices(v, 1) - floor, 0.0);
        const auto dark = static_cast<float>(std::exp(-height / 0.7)); // a contact is dark, a head 1.7 m up hardly
        float &cell = cells_[index(mesh.vertices(v, 0), mesh.vertices(v, 2))];
        cell = std::max(cell, dark);
      }
    for (int pass = 0; pass < 3; ++pass) { // three box filters are near enough to a Gaussian
      blur(1, nx_, nx_, nz_);
      blur(nx_, nz_, 1, nx_);
    }
  }
  float at(double x, double z) const {
    const double i = (x - x0_) / kShadowCell - 0.5, k = (z - z0_) / kShadowCell - 0.5;
    if (cells_.empty() || !(i >= 0) || !(k >= 0) || i >= nx_ - 1 || k >= nz_ - 1)
      return 0;
    const int i0 = static_cast<int>(i), k0 = static_cast<int>(k);
    const auto a = static_cast<float>(i - i0), b = static_cast<float>(k - k0);
    const float *c = &cells_[static_cast<std::size_t>(k0) * nx_ + i0];
    return (1 - b) * ((1 - a) * c[0] + a * c[1]) + b * ((1 - a) * c[nx_] + a * c[nx_ + 1]);
  }

private:
  std::size_t index(double x, double z) const {
    return static_cast<std::size_t>((z - z0_) / kShadowCell) * nx_ + static_cast<std::size_t>((x - x0_) / kShadowCell);
  }
  /// Box filter along `length` cells `stride` apart, for `lines` lines `next` apart.
  void blur(std::size_t stride, int length, std::size_t next, int lines) {
    const int r = static_cast<int>(kShadowBlur / kShadowCell);
    std::vector<float> line(length);
    for (int l = 0; l < lines; ++l) {
      float *start = cells_.data() + l * next;
      for (int i = 0; i < length; ++i)
        line[i] = start[i * stride];
      for (int i = 0; i < length; ++i) {
        float sum = 0;
        for (int k = std::max(0, i - r); k <= std::min(length - 1, i + r); ++k)
          sum += line[k];
        start[i * stride] = sum / (2 * r + 1);
      }
    }
  }
  double x0_ = 0, z0_ = 0;
  int nx_ = 0, nz_ = 0;
  std::vector<float> cells_;
};

/// Distance-dependent smooth step around a line every half metre.
float grid_line(double value) {
  const double d = std::abs(value - 0.5 * std::floor(2 * value + 0.5));
  return d > 0.03 ? 0.0f : static_cast<float>(std::exp(-d * d / (2 * 0.006 * 0.006)));
}

/// Rays of a camera, whose length along its axis is 1. Of a pinhole camera they are linear in the pixel.
class Rays {
public:
  explicit Rays(const Camera &camera) : camera_(camera), distorted_(camera.distorted()) {
    const Vector3d corner = pinhole(0, 0);
    origin_ = corner.cast<float>();
    dx_ = (pinhole(1, 0) - corner).cast<float>();
    dy_ = (pinhole(0, 1) - corner).cast<float>();
  }
  Vector3f at(float x, float y) const {
    if (!distorted_)
      return origin_ + x * dx_ + y * dy_;
    const Vector3d direction = camera_.ray_direction({x, y});
    return (direction / camera_.R.row(2).dot(direction)).cast<float>();
  }

private:
  Vector3d pinhole(double x, double y) const {
    const double v = (y - camera_.K(1, 2)) / camera_.K(1, 1), u = (x - camera_.K(0, 2) - camera_.K(0, 1) * v) / camera_.K(0, 0);
    return camera_.R.transpose() * Vector3d(u, v, 1);
  }
  const Camera &camera_;
  bool distorted_;
  Vector3f origin_, dx_, dy_;
};

/// The part of the image in which a mesh is: a z-buffer of the whole image is mostly empty.
struct Window {
  int x0 = 0, y0 = 0, width = 0, height = 0;
};

Window window_of(const Vertices &vertices, const Camera &camera) {
  const Window whole{0, 0, camera.width, camera.height};
  if (vertices.rows() == 0 || camera.distorted())
    return whole;
  Eigen::Vector2d low(1e30, 1e30), high = -low;
  for (Eigen::Index v = 0; v < vertices.rows(); ++v) {
    const Vector3d point = vertices.row(v);
    if (camera.depth(point) < 0.1)
      return whole;
    const Eigen::Vector2d pixel = camera.project(point);
    low = low.cwiseMin(pixel), high = high.cwiseMax(pixel);
  }
  const auto bound = [](double value, int size) { return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(size))); };
  Window window{bound(low.x() - 1, camera.width), bound(low.y() - 1, camera.height), 0, 0};
  window.width = std::max(1, bound(high.x() + 2, camera.width) - window.x0);
  window.height = std::max(1, bound(high.y() + 2, camera.height) - window.y0);
  if (window.x0 == camera.width || window.y0 == camera.height)
    return {0, 0, 1, 1};
  return window;
}

Camera cropped(Camera camera, const Window &window) {
  camera.K(0, 2) -= window.x0, camera.K(1, 2) -= window.y0;
  camera.width = window.width, camera.height = window.height;
  return camera;
}

struct Layer {
  Window window;
  FaceBuffer buffer;
  std::vector<Vector3f> corners; ///< from the eye
  std::vector<Vector3f> normals;

  int face_at(int x, int y) const { return inside(x, y) ? buffer.face_at(x - window.x0, y - window.y0) : -1; }
  float depth_at(int x, int y) const { return buffer.depth_at(x - window.x0, y - window.y0); }
  /// Or beside it by a pixel of the image.
  bool near(int x, int y) const {
    return x + 2 >= window.x0 && y + 2 >= window.y0 && x <= window.x0 + window.width && y <= window.y0 + window.height;
  }
  bool inside(int x, int y) const {
    return x >= window.x0 && y >= window.y0 && x < window.x0 + window.width && y < window.y0 + window.height;
  }
};

/// What samples of a pixel see: a face of a mesh, or nothing (mesh -1).
struct Seen {
  int mesh = -1, face = -1;
  bool operator==(const Seen &) const = default;
};

class Painter {
public:
  Painter(const std::vector<RenderMesh> &meshes, const Camera &camera, const RenderOptions &options)
      : meshes_(meshes), rays_(camera), eye_(camera.centre()), options_(options), sky_(options.background.cast<float>()),
        light_(options.light_direction.normalized().cast<float>()),
        shadow_(options.floor ? meshes : std::vector<RenderMesh>{}, options.floor_height) {
    for (const RenderMesh &mesh : meshes) {
      const Window window = window_of(mesh.vertices, camera);
      Layer layer{window, rasterize(mesh.vertices, mesh.faces, cropped(camera, window), mesh.face_valid), {}, {}};
      const Vertices normals = vertex_normals(mesh.vertices, valid_faces(mesh.faces, mesh.face_valid));
      for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) {
        layer.corners.push_back((mesh.vertices.row(v).transpose() - eye_).cast<float>());
        layer.normals.push_back(normals.row(v).cast<float>());
      }
      layers_.push_back(std::move(layer));
    }
  }

  /// Each pixel is the mean of samples x samples of the fine image. Samples that see one face share its colour half way between
  /// them, and the ground, which is smooth, is worked out once for all that see it. Faces are painted in their order, in which
  /// their corners and their part of the texture lie in memory.
  Image picture(int width, int height, int samples) const {
    Image image(width, height, 3);
    Painting painting;
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        if (!gather(x, y, samples, painting, image))
          set_pixel(image, y * width + x, middle_behind(x, y, samples));
    for (const Glimpse &glimpse : in_order_of_faces(painting.glimpses))
      painting.sums[glimpse.sum] += glimpse.share * surface(glimpse.seen, glimpse.x, glimpse.y);
    for (std::size_t k = 0; k < painting.sums.size(); ++k)
      set_pixel(image, painting.pixels[k], painting.sums[k] / static_cast<float>(samples * samples));
    return image;
  }

private:
  /// What some samples of a pixel see, at their middle.
  struct Glimpse {
    Seen seen;
    int sum = 0; ///< of Painting::sums
    float x = 0, y = 0, share = 0;
  };
  struct Painting {
    std::vector<Glimpse> glimpses;
    std::vector<Vector3f> sums; ///< of the samples of each pixel that sees a mesh
    std::vector<int> pixels;    ///< which that is
  };

  /// False if a pixel sees no mesh.
  bool gather(int x, int y, int samples, Painting &painting, const Image &image) const {
    if (std::none_of(layers_.begin(), layers_.end(), [&](const Layer &layer) { return layer.near(samples * x, samples * y); }))
      return false;
    const std::size_t first = painting.glimpses.size();
    const int sum = static_cast<int>(painting.sums.size());
    int empty = 0;
    for (int s = 0; s < samples * samples; ++s) {
      const int fx = samples * x + s % samples, fy = samples * y + s / samples;
      const Seen here = nearest(fx, fy);
      if (here.mesh < 0) {
        ++empty;
        continue;
      }
      auto glimpse = painting.glimpses.begin() + static_cast<std::ptrdiff_t>(first);
      while (glimpse != painting.glimpses.end() && !(glimpse->seen == here))
        ++glimpse;
      if (glimpse == painting.glimpses.end())
        glimpse = painting.glimpses.insert(glimpse, {here, sum, 0, 0, 0});
      glimpse->x += static_cast<float>(fx), glimpse->y += static_cast<float>(fy), glimpse->share += 1;
    }
    if (painting.glimpses.size() == first)
      return false;
    for (std::size_t k = first; k < painting.glimpses.size(); ++k)
      painting.glimpses[k].x /= painting.glimpses[k].share, painting.glimpses[k].y /= painting.glimpses[k].share;
    painting.sums.push_back(Vector3f::Zero());
    if (empty > 0)
      painting.sums.back() = static_cast<float>(empty) * middle_behind(x, y, samples);
    painting.pixels.push_back(y * image.width + x);
    return true;
  }

  std::vector<Glimpse> in_order_of_faces(const std::vector<Glimpse> &glimpses) const {
    std::vector<std::size_t> bases{0}; // of each mesh's faces
    for (const RenderMesh &mesh : meshes_)
      bases.push_back(bases.back() + static_cast<std::size_t>(mesh.faces.rows()));
    std::vector<std::size_t> next(bases.back() + 1);
    for (const Glimpse &glimpse : glimpses)
      ++next[bases[glimpse.seen.mesh] + glimpse.seen.face + 1];
    std::partial_sum(next.begin(), next.end(), next.begin());
    std::vector<Glimpse> ordered(glimpses.size());
    for (const Glimpse &glimpse : glimpses)
      ordered[next[bases[glimpse.seen.mesh] + glimpse.seen.face]++] = glimpse;
    return ordered;
  }

  static void set_pixel(Image &image, int pixel, const Vector3f &rgb) {
    std::uint8_t *at = image.data.data() + 3 * static_cast<std::size_t>(pixel);
    for (int c = 0; c < 3; ++c)
      at[c] = static_cast<std::uint8_t>(std::clamp(rgb[2 - c] * 255.0f + 0.5f, 0.0f, 255.0f));
  }

  Seen nearest(int x, int y) const {
    Seen best;
    float depth = std::numeric_limits<float>::infinity();
    for (std::size_t m = 0; m < layers_.size(); ++m) {
      const int face = layers_[m].face_at(x, y);
      if (face >= 0 && layers_[m].depth_at(x, y) < depth) {
        depth = layers_[m].depth_at(x, y);
        best = {static_cast<int>(m), face};
      }
    }
    return best;
  }

  /// What lies behind all meshes in the middle of a pixel.
  Vector3f middle_behind(int x, int y, int samples) const {
    const float middle = 0.5f * static_cast<float>(samples - 1);
    return options_.floor ? ground(rays_.at(static_cast<float>(samples * x) + middle, static_cast<float>(samples * y) + middle))
                          : sky_;
  }

  Vector3f surface(const Seen &seen, float x, float y) const {
    const RenderMesh &mesh = meshes_[seen.mesh];
    const Layer &layer = layers_[seen.mesh];
    const int *v = mesh.faces.data() + 3 * static_cast<Eigen::Index>(seen.face);
    const Vector3f &p0 = layer.corners[v[0]], &p1 = layer.corners[v[1]], &p2 = layer.corners[v[2]];
    const Vector3f ray = rays_.at(x, y), flat = (p1 - p0).cross(p2 - p0);
    // Volumes of the tetrahedra that the ray spans with each side: their shares are the coordinates.
    Vector3f b(ray.dot(p1.cross(p2)), ray.dot(p2.cross(p0)), ray.dot(p0.cross(p1)));
    b = (std::abs(b.sum()) < 1e-18f ? Vector3f::Constant(1.0f / 3) : Vector3f(b / b.sum())).cwiseMax(0);
    b /= std::max(b.sum(), 1e-12f);
    const bool inside = flat.dot(ray) > 0; // the inner side of cloth
    Vector3f n = b[0] * layer.normals[v[0]] + b[1] * layer.normals[v[1]] + b[2] * layer.normals[v[2]];
    n = (inside ? -n : n).normalized();
    if (!n.allFinite())
      n = Vector3f::UnitY();
    const auto light = static_cast<float>(options_.light);
    const float sky = 0.65f + 0.35f * n.y(), key = std::max(0.0f, n.dot(light_));
    const float shade = (1 - light) * sky * 1.6f + light * (0.35f + 0.85f * key);
    return colour_of(mesh, seen.face, b) * (inside ? 0.6f * shade : shade);
  }

  static Vector3f mix(const Vertices &values, const int *v, const Vector3f &b) {
    Vector3f sum = Vector3f::Zero();
    for (int k = 0; k < 3; ++k)
      sum += b[k] * values.row(v[k]).transpose().cast<float>();
    return sum;
  }

  static Vector3f colour_of(const RenderMesh &mesh, int face, const Vector3f &b) {
    if (mesh.texture) {
      double u = 0, v = 0;
      for (int k = 0; k < 3; ++k) {
        u += b[k] * mesh.texcoords(3 * face + k, 0);
        v += b[k] * mesh.texcoords(3 * face + k, 1);
      }
      return sample_texture(*mesh.texture, u, v);
    }
    return mesh.colours.rows() > 0 ? mix(mesh.colours, mesh.faces.data() + 3 * static_cast<Eigen::Index>(face), b)
                                   : Vector3f(mesh.colour.cast<float>());
  }

  Vector3f ground(const Vector3f &ray) const {
    const float length = ray.norm();
    if (ray.y() > -1e-3f * length)
      return sky_;
    const float s = static_cast<float>(options_.floor_height - eye_.y()) / ray.y();
    if (!(s > 0))
      return sky_;
    const double x = eye_.x() + s * ray.x(), z = eye_.z() + s * ray.z();
    const float fade = std::exp(-s * length / 12); // into the background with distance
    const float line = std::max(grid_line(x), grid_line(z));
    const Vector3f floor = sky_ * ((0.86f - 0.10f * line) * (1 - std::min(0.75f, 1.6f * shadow_.at(x, z))));
    return fade * floor + (1 - fade) * sky_;
  }

  const std::vector<RenderMesh> &meshes_;
  Rays rays_;
  Vector3d eye_;
  const RenderOptions &options_;
  Vector3f sky_, light_;
  FloorShadow shadow_;
  std::vector<Layer> layers_;
};

} // namespace

void RenderOptions::validate() const {
  options::check(*this);
  if (!(light_direction.norm() > 0))
    options::throw_invalid("RenderOptions: light_direction", "a direction", "a vector of length 0");
}

Image render(const std::vector<RenderMesh> &meshes, const Camera &camera, const RenderOptions &options) {
  options.validate();
  validate_camera(camera, "render");
  for (std::size_t m = 0; m < meshes.size(); ++m)
    require_mesh(meshes[m], m);
  const int samples = options.supersample ? 2 : 1;
  const Camera fine = camera.resized(samples * camera.width, samples * camera.height);
  return Painter(meshes, fine, options).picture(camera.width, camera.height, samples);
}

Camera orbit_camera(const Vector3d &target, double radius, double azimuth, double elevation, int width, int height) {
  if (!(radius > 0) || width <= 0 || height <= 0)
    throw std::invalid_argument("orbit_camera: radius, width and height must be positive");
  if (!target.allFinite() || !std::isfinite(radius) || !std::isfinite(azimuth) || !std::isfinite(elevation))
    throw std::invalid_argument("orbit_camera: target, radius and angles must be finite");
  const double half_angle = 15 * M_PI / 180, distance = radius / std::sin(half_angle);
  const Vector3d from = target + distance * Vector3d(std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
                                                     std::cos(azimuth) * std::cos(elevation));
  const Vector3d z = (target - from).normalized();
  Vector3d x = z.cross(Vector3d::UnitY());
  x = x.norm() > 1e-9 ? Vector3d(x.normalized()) : Vector3d::UnitX();
  Camera camera;
  camera.name = "orbit";
  camera.width = width;
  camera.height = height;
  const double focal = 0.5 * std::min(width, height) / std::tan(half_angle);
  camera.K << focal, 0, 0.5 * (width - 1), 0, focal, 0.5 * (height - 1), 0, 0, 1;
  camera.R << x.transpose(), z.cross(x).transpose(), z.transpose();
  camera.t = -camera.R * from;
  return camera;
}

CharacterRenderer::CharacterRenderer(const Character &character) {
  validate_character(character);
  coarse_.vertices = character.actor.mesh.vertices;
  coarse_.faces = character.actor.mesh.faces;
  coarse_.face_valid = character.actor.face_valid;
  high_.vertices = character.high.vertices;
  high_.faces = character.high.faces;
  high_.face_valid = character.high_valid;
  if (!character.texture.empty()) {
    high_.texcoords = character.texcoords;
    high_.texture = std::make_shared<const Image>(decode_image(character.texture));
  }
  body_.vertices = character.body.vertices;
  body_.faces = character.body.faces;
  body_.face_valid = character.body_shown;
  body_.colour = character.body_colour.array().pow(1 / 2.2); // the pictures are sRGB
}

std::vector<RenderMesh> CharacterRenderer::meshes(const Vertices &surface, const Vertices &high, const Vertices &body) const {
  std::vector<RenderMesh> meshes;
  const auto add = [&](const RenderMesh &rest, const Vertices &vertices, const char *what) {
    if (vertices.rows() != rest.vertices.rows())
      throw std::invalid_argument(std::string("CharacterRenderer: ") + what + " has " + std::to_string(vertices.rows()) +
                                  " vertices, the character " + std::to_string(rest.vertices.rows()));
    meshes.push_back(rest);
    meshes.back().vertices = vertices;
  };
  if (high.rows() > 0)
    add(high_, high, "high");
  else
    add(coarse_, surface, "surface");
  if (body.rows() > 0)
    add(body_, body, "body");
  return meshes;
}

Image CharacterRenderer::render(const Vertices &surface, const Vertices &high, const Vertices &body, const Camera &camera,
                                const RenderOptions &options) const {
  return doublet::render(meshes(surface, high, body), camera, options);
}

} // namespace doublet
