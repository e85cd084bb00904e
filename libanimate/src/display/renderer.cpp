#include "doublet/animate/renderer.h"

#include "doublet/animate/parts/image_file.h"
#include "doublet/core/error.h"
#include "doublet/core/rasterizer.h"

#include <algorithm>
#include <cmath>
#include <memory>

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
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y), x1 = std::min(x0 + 1, image.width - 1),
            y1 = std::min(y0 + 1, image.height - 1);
  const auto a = static_cast<float>(x - x0), b = static_cast<float>(y - y0);
  Vector3f colour;
  for (int c = 0; c < 3; ++c)
    colour[2 - c] = (1 - b) * ((1 - a) * image.at(x0, y0, c) + a * image.at(x1, y0, c)) +
                    b * ((1 - a) * image.at(x0, y1, c) + a * image.at(x1, y1, c));
  return colour / 255.0f;
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
  const double d = std::abs(value - 0.5 * std::round(value / 0.5));
  return d > 0.03 ? 0.0f : static_cast<float>(std::exp(-d * d / (2 * 0.006 * 0.006)));
}

struct Layer {
  FaceBuffer buffer;
  Vertices normals;
};

class Painter {
public:
  Painter(const std::vector<RenderMesh> &meshes, const Camera &camera, const RenderOptions &options)
      : meshes_(meshes), camera_(camera), options_(options), light_(options.light_direction.normalized().cast<float>()),
        shadow_(options.floor ? meshes : std::vector<RenderMesh>{}, options.floor_height) {
    for (const RenderMesh &mesh : meshes)
      layers_.push_back({rasterize(mesh.vertices, mesh.faces, camera, mesh.face_valid),
                         vertex_normals(mesh.vertices, valid_faces(mesh.faces, mesh.face_valid))});
  }

  /// Mean of samples x samples of the fine image; the ground, which is smooth, is worked out once for all samples that see it.
  Vector3f pixel(int x, int y, int samples) const {
    Vector3f sum = Vector3f::Zero();
    int empty = 0;
    for (int s = 0; s < samples * samples; ++s) {
      const int fx = samples * x + s % samples, fy = samples * y + s / samples;
      const int mesh = nearest(fx, fy);
      if (mesh < 0)
        ++empty;
      else
        sum += surface(mesh, fx, fy);
    }
    if (empty > 0)
      sum += static_cast<float>(empty) * behind(samples * x + 0.5 * (samples - 1), samples * y + 0.5 * (samples - 1));
    return sum / static_cast<float>(samples * samples);
  }

private:
  int nearest(int x, int y) const {
    int best = -1;
    float depth = std::numeric_limits<float>::infinity();
    for (std::size_t m = 0; m < layers_.size(); ++m)
      if (layers_[m].buffer.face_at(x, y) >= 0 && layers_[m].buffer.depth_at(x, y) < depth) {
        depth = layers_[m].buffer.depth_at(x, y);
        best = static_cast<int>(m);
      }
    return best;
  }

  Vector3f behind(double x, double y) const {
    return options_.floor ? ground(x, y) : Vector3f(options_.background.cast<float>());
  }

  Vector3f surface(int m, int x, int y) const {
    const RenderMesh &mesh = meshes_[m];
    const int f = layers_[m].buffer.face_at(x, y);
    Vector3d b = barycentric_at(mesh.vertices, mesh.faces, f, camera_, {x, y}).cwiseMax(0);
    b /= std::max(b.sum(), 1e-12);
    Vector3d normal = Vector3d::Zero(), point = Vector3d::Zero();
    Vector3f colour = mesh.colour.cast<float>();
    if (mesh.colours.rows() > 0)
      colour.setZero();
    double u = 0, v = 0;
    for (int k = 0; k < 3; ++k) {
      const int i = mesh.faces(f, k);
      normal += b[k] * layers_[m].normals.row(i).transpose();
      point += b[k] * mesh.vertices.row(i).transpose();
      if (mesh.colours.rows() > 0)
        colour += static_cast<float>(b[k]) * mesh.colours.row(i).transpose().cast<float>();
      if (mesh.texture) {
        u += b[k] * mesh.texcoords(3 * f + k, 0);
        v += b[k] * mesh.texcoords(3 * f + k, 1);
      }
    }
    if (mesh.texture)
      colour = sample_texture(*mesh.texture, u, v);
    const Vector3d to_eye = camera_.centre() - point;
    const Vector3d flat = (mesh.vertices.row(mesh.faces(f, 1)) - mesh.vertices.row(mesh.faces(f, 0)))
                              .cross(mesh.vertices.row(mesh.faces(f, 2)) - mesh.vertices.row(mesh.faces(f, 0)));
    const bool inside = flat.dot(to_eye) < 0; // the inner side of cloth
    Vector3f n = (inside ? -normal : normal).normalized().cast<float>();
    if (!n.allFinite())
      n = Vector3f::UnitY();
    const auto light = static_cast<float>(options_.light);
    const float sky = 0.65f + 0.35f * n.y(), key = std::max(0.0f, n.dot(light_));
    const float shade = (1 - light) * sky * 1.6f + light * (0.35f + 0.85f * key);
    return colour * (inside ? 0.6f * shade : shade);
  }

  Vector3f ground(double x, double y) const {
    const Vector3f sky = options_.background.cast<float>();
    const Vector3d eye = camera_.centre(), ray = camera_.ray_direction({x, y});
    if (ray.y() > -1e-3)
      return sky;
    const double s = (options_.floor_height - eye.y()) / ray.y();
    if (!(s > 0))
      return sky;
    const Vector3d p = eye + s * ray;
    const auto fade = static_cast<float>(std::exp(-s / 12)); // into the background with distance
    const float line = std::max(grid_line(p.x()), grid_line(p.z()));
    const Vector3f floor = sky * (0.86f - 0.10f * line) * (1 - std::min(0.75f, 1.6f * shadow_.at(p.x(), p.z())));
    return fade * floor + (1 - fade) * sky;
  }

  const std::vector<RenderMesh> &meshes_;
  const Camera &camera_;
  const RenderOptions &options_;
  Vector3f light_;
  FloorShadow shadow_;
  std::vector<Layer> layers_;
};

std::uint8_t to_byte(float value) {
  return static_cast<std::uint8_t>(std::clamp(value * 255.0f + 0.5f, 0.0f, 255.0f));
}

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
  const Painter painter(meshes, fine, options);
  Image image(camera.width, camera.height, 3);
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const Vector3f sum = painter.pixel(x, y, samples);
      for (int c = 0; c < 3; ++c)
        image.at(x, y, c) = to_byte(sum[2 - c]);
    }
  return image;
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
