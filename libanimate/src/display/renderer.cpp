#include "doublet/animate/renderer.h"

#include "area_vectors.h"
#include "backdrop.h"
#include "doublet/animate/parts/image_file.h"
#include "doublet/core/error.h"
#include "doublet/core/rasterizer.h"
#include "texture_pyramid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <numeric>
#include <utility>

namespace doublet {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using Eigen::Vector4f;

using detail::Backdrop, detail::PictureRays, detail::TexturePyramid, detail::four;

void require_mesh(const RenderMesh &mesh, const Vertices &vertices, std::size_t index) {
  const auto check = [&](bool good, const std::string &what) {
    if (!good)
      throw std::invalid_argument("render: mesh " + std::to_string(index) + ": " + what);
  };
  check(vertices.allFinite(), "the vertices must be finite");
  check(mesh.faces.rows() == 0 || (mesh.faces.minCoeff() >= 0 && mesh.faces.maxCoeff() < vertices.rows()),
        "a face names a vertex that is not there");
  check(mesh.face_valid.empty() || static_cast<Eigen::Index>(mesh.face_valid.size()) == mesh.faces.rows(),
        "face_valid must be one per face");
  check(mesh.colours.allFinite() && mesh.colour.allFinite(), "the colours must be finite");
  check(mesh.colours.rows() == 0 || mesh.colours.rows() == vertices.rows(), "colours must be one per vertex");
  check(!mesh.texture ||
            (!mesh.texture->empty() && mesh.texture->channels == 3 && mesh.texcoords.rows() == 3 * mesh.faces.rows()),
        "a texture needs 3 channels and 3 texcoords per face");
}

std::shared_ptr<const TexturePyramid> pyramid_of(const RenderMesh &mesh) {
  return mesh.texture && !mesh.texture->empty() && mesh.texture->channels == 3
             ? std::make_shared<const TexturePyramid>(*mesh.texture)
             : nullptr; // none, or one that require_mesh() refuses
}

/// A mesh of a picture.
struct Drawn {
  const RenderMesh *mesh;
  const Vertices *vertices;                      ///< in the place of the mesh's
  std::shared_ptr<const TexturePyramid> texture; ///< null = none
  Eigen::Index first_vertex = 0, first_face = 0; ///< among those of all meshes
};

/// All meshes as one, for a z-buffer that they share.
struct Scene {
  explicit Scene(std::vector<Drawn> meshes) : parts(std::move(meshes)) {
    Eigen::Index vertex_count = 0, face_count = 0;
    for (Drawn &part : parts) {
      part.first_vertex = std::exchange(vertex_count, vertex_count + part.vertices->rows());
      part.first_face = std::exchange(face_count, face_count + part.mesh->faces.rows());
    }
    vertices.resize(vertex_count, 3);
    faces.resize(face_count, 3);
    shown.assign(static_cast<std::size_t>(face_count), 1);
    for (const Drawn &part : parts) {
      vertices.middleRows(part.first_vertex, part.vertices->rows()) = *part.vertices;
      faces.middleRows(part.first_face, part.mesh->faces.rows()) = part.mesh->faces.array() + static_cast<int>(part.first_vertex);
      std::copy(part.mesh->face_valid.begin(), part.mesh->face_valid.end(), shown.begin() + part.first_face);
    }
  }
  const Drawn &part_of(int face) const {
    std::size_t p = 0;
    while (p + 1 < parts.size() && face >= parts[p + 1].first_face)
      ++p;
    return parts[p];
  }

  std::vector<Drawn> parts;
  Vertices vertices;
  Faces faces;
  Mask shown;
};

/// A face as its pixels ask for it.
struct Facet {
  std::array<Vector4f, 3> shares;  ///< times x, y, z of a ray: how much of each corner is where it meets the face
  std::array<Vector4f, 3> normals; ///< towards the side that is seen
  std::array<Vector4f, 3> colours; ///< R G B of the corners, or u v if there is a texture
  const TexturePyramid *texture = nullptr;
  int level = 0;       ///< of the texture
  bool inside = false; ///< the inner side of cloth is seen
};

/// At barycentric coordinates of the corners.
inline Vector4f mix(const std::array<Vector4f, 3> &values, const Vector4f &b) {
  return b[0] * values[0] + b[1] * values[1] + b[2] * values[2];
}

/// Each pixel is the mean of samples x samples of the camera's.
template <int samples> class Painter {
public:
  Painter(const Scene &scene, const Camera &camera, const RenderOptions &options)
      : scene_(scene), camera_(camera), rays_(camera), eye_(camera.centre()), options_(options),
        sky_(four(options.background.cast<float>())), light_(four(options.light_direction.normalized().cast<float>())),
        seen_(rasterize_window(scene.vertices, scene.faces, camera, scene.shown, samples - 1)),
        facet_of_(static_cast<std::size_t>(scene.faces.rows()), -1) {
    find_vertices();
    facets_.reserve(facet_of_.size() / 2); // a surface hides its other side
  }

  Image picture() {
    Image image(camera_.width / samples, camera_.height / samples, 3);
    std::vector<const Vertices *> meshes;
    for (const Drawn &part : scene_.parts)
      meshes.push_back(part.vertices);
    Backdrop backdrop(meshes, camera_, options_);
    const float middle = 0.5f * static_cast<float>(samples - 1);
    for (int y = 0; y < image.height; ++y) {
      const Eigen::ArrayXf &behind =
          backdrop.row(middle, static_cast<float>(samples), static_cast<float>(samples * y) + middle, image.width);
      fill_row(&image.at(0, y), behind);
      paint_row(&image.at(0, y), y, behind);
    }
    return image;
  }

private:
  using Samples = std::array<int, samples * samples>; ///< of a pixel: the face that each sees, -1 = none

  struct Vertex {
    Vector4f from_eye, normal;
  };
  /// What some samples of a pixel see, at their middle.
  struct Glimpse {
    int face, count;
    float x, y; ///< sums
  };

  void find_vertices() {
    Vertices normals;
    detail::sum_area_vectors(scene_.vertices, scene_.faces, normals, scene_.shown);
    vertices_.resize(static_cast<std::size_t>(normals.rows()));
    for (Eigen::Index v = 0; v < normals.rows(); ++v) {
      vertices_[v].from_eye = four((scene_.vertices.row(v).transpose() - eye_).cast<float>());
      vertices_[v].normal = four(normals.row(v).cast<float>()).normalized(); // none stays none
    }
  }

  void fill_row(std::uint8_t *to, const Eigen::ArrayXf &behind) const {
    const float blue = 255 * sky_[2], green = 255 * sky_[1], red = 255 * sky_[0]; // within [0, 255], and so is a part of them
    const float *from = behind.data();
    for (Eigen::Index x = 0; x < behind.size(); ++x, to += 3) {
      const float bright = from[x];
      to[0] = static_cast<std::uint8_t>(bright * blue + 0.5f);
      to[1] = static_cast<std::uint8_t>(bright * green + 0.5f);
      to[2] = static_cast<std::uint8_t>(bright * red + 0.5f);
    }
  }

  /// What stands before the backdrop.
  void paint_row(std::uint8_t *row, int y, const Eigen::ArrayXf &behind) {
    // A pixel that is in part outside the window is empty: so wide is its margin.
    const int left = (seen_.x + samples - 1) / samples, right = (seen_.x + seen_.buffer.width) / samples;
    const int top = samples * y - seen_.y;
    if (top < 0 || top + samples > seen_.buffer.height)
      return;
    const std::size_t width = static_cast<std::size_t>(seen_.buffer.width);
    const int *first = &seen_.buffer.face[top * width] + samples * left - seen_.x;
    for (int x = left; x < right; ++x, first += samples) {
      Samples faces;
      for (int line = 0; line < samples; ++line)
        std::copy_n(first + line * width, samples, faces.begin() + line * samples);
      if (std::accumulate(faces.begin(), faces.end(), -1, std::bit_and<>()) != -1) // few pixels
        set_pixel(row + 3 * x, colour(faces, x, y, behind[x] * sky_));
    }
  }

  /// Samples that see one face, or faces beside it, share its colour half way between them.
  Vector4f colour(const Samples &faces, int x, int y, const Vector4f &behind) {
    std::array<Glimpse, samples * samples> glimpses;
    int kinds = 0, seen = 0;
    for (int sample = 0; sample < samples * samples; ++sample) {
      const int face = faces[sample];
      if (face < 0)
        continue;
      ++seen;
      int k = 0;
      while (k < kinds && !goes_on(glimpses[k].face, face))
        ++k;
      if (k == kinds)
        glimpses[kinds++] = {face, 0, 0, 0};
      glimpses[k].x += static_cast<float>(sample % samples), glimpses[k].y += static_cast<float>(sample / samples);
      ++glimpses[k].count;
    }
    const auto left = static_cast<float>(samples * x), top = static_cast<float>(samples * y);
    Vector4f sum = static_cast<float>(samples * samples - seen) * behind;
    for (int k = 0; k < kinds; ++k) {
      const auto count = static_cast<float>(glimpses[k].count);
      sum += count * surface(facet(glimpses[k].face), left + glimpses[k].x / count, top + glimpses[k].y / count);
    }
    return sum * (1.0f / (samples * samples));
  }

  /// Is this the same smooth surface, seen from the same side?
  bool goes_on(int face, int other) {
    if (face == other)
      return true;
    const int *v = scene_.faces.data() + 3 * static_cast<Eigen::Index>(face),
              *w = scene_.faces.data() + 3 * static_cast<Eigen::Index>(other);
    bool meet = false; // without a jump for each, which no processor could foresee
    for (int i = 0; i < 3; ++i)
      meet |= (v[i] == w[0]) | (v[i] == w[1]) | (v[i] == w[2]);
    if (!meet)
      return false;
    const bool inside = facet(face).inside;
    return facet(other).inside == inside;
  }

  static void set_pixel(std::uint8_t *to, const Vector4f &rgb) {
    const Vector4f levels = (rgb * 255 + Vector4f::Constant(0.5f)).cwiseMax(0).cwiseMin(255);
    for (int c = 0; c < 3; ++c)
      to[c] = static_cast<std::uint8_t>(levels[2 - c]);
  }

  /// Made when the first pixel asks for it.
  const Facet &facet(int face) {
    if (facet_of_[face] < 0) {
      facet_of_[face] = static_cast<int>(facets_.size());
      facets_.push_back(made(face));
    }
    return facets_[facet_of_[face]];
  }
  Facet made(int face) const {
    const Drawn &part = scene_.part_of(face);
    const int *v = scene_.faces.data() + 3 * static_cast<Eigen::Index>(face);
    std::array<Vector3f, 3> corners; // from the eye
    Facet facet;
    for (int k = 0; k < 3; ++k)
      corners[k] = vertices_[v[k]].from_eye.template head<3>();
    // Volumes of the tetrahedra that the ray spans with each side: their shares are the coordinates.
    Eigen::Matrix3f across;
    for (int k = 0; k < 3; ++k)
      across.row(k) = corners[(k + 1) % 3].cross(corners[(k + 2) % 3]).transpose();
    const float volume = across.row(0).dot(corners[0]);
    facet.inside = volume > 0;
    for (int axis = 0; axis < 3; ++axis)
      facet.shares[axis] = four((facet.inside ? 1 : -1) * across.col(axis));
    for (int k = 0; k < 3; ++k)
      facet.normals[k] = facet.inside ? Vector4f(-vertices_[v[k]].normal) : vertices_[v[k]].normal;
    const Eigen::Index in_part = face - part.first_face;
    if (!part.texture) {
      for (int k = 0; k < 3; ++k)
        facet.colours[k] =
            four(part.mesh->colours.rows() > 0 ? Vector3f(part.mesh->colours.row(v[k] - part.first_vertex).cast<float>())
                                               : Vector3f(part.mesh->colour.cast<float>()));
      return facet;
    }
    facet.texture = part.texture.get();
    for (int k = 0; k < 3; ++k)
      facet.colours[k] << part.mesh->texcoords.row(3 * in_part + k).cast<float>().transpose(), 0, 0;
    facet.level = facet.texture->level_for(texels_of(facet) / std::max(pixels_of(corners, volume), 1e-6f));
    return facet;
  }
  /// Twice the area in the texture.
  static float texels_of(const Facet &facet) {
    const Vector4f a = facet.colours[1] - facet.colours[0], b = facet.colours[2] - facet.colours[0];
    return std::abs(a.x() * b.y() - a.y() * b.x()) * static_cast<float>(facet.texture->width()) *
           static_cast<float>(facet.texture->height());
  }
  /// Twice the area in the picture, of a face whose corners from the eye span `volume`.
  float pixels_of(const std::array<Vector3f, 3> &corners, float volume) const {
    const Vector3f forward = camera_.R.row(2).cast<float>();
    const float depths = corners[0].dot(forward) * corners[1].dot(forward) * corners[2].dot(forward),
                focal = static_cast<float>(camera_.K(0, 0) * camera_.K(1, 1));
    return std::abs(volume) * focal / (depths * static_cast<float>(samples * samples));
  }

  Vector4f surface(const Facet &facet, float x, float y) const {
    Vector4f b = mix(facet.shares, rays_.at(x, y)).cwiseMax(0);
    b = b.sum() > 1e-18f ? b : Vector4f(1, 1, 1, 0);
    const Vector4f n = mix(facet.normals, b);
    const float squared = n.squaredNorm();
    // Of no normal at all: up.
    const Vector4f unit = squared > 0 ? Vector4f(n * (1 / std::sqrt(squared))) : Vector4f(Vector4f::UnitY());
    const auto light = static_cast<float>(options_.light);
    const float sky = 0.65f + 0.35f * unit.y(), key = std::max(0.0f, unit.dot(light_));
    const float shade = (1 - light) * sky * 1.6f + light * (0.35f + 0.85f * key);
    return (facet.inside ? 0.6f * shade : shade) * colour_at(facet, mix(facet.colours, b) * (1 / b.sum()));
  }
  static Vector4f colour_at(const Facet &facet, const Vector4f &at) {
    return facet.texture ? facet.texture->sample(facet.level, at[0], at[1]) : at;
  }

  const Scene &scene_;
  const Camera &camera_;
  PictureRays rays_;
  Vector3d eye_;
  const RenderOptions &options_;
  Vector4f sky_, light_;
  FaceWindow seen_;
  std::vector<Vertex> vertices_;
  std::vector<Facet> facets_; ///< those that are seen ...
  std::vector<int> facet_of_; ///< ... and which of them each face has; -1 = none yet
};

Image picture_of(const std::vector<Drawn> &meshes, const Camera &camera, const RenderOptions &options) {
  options.validate();
  validate_camera(camera, "render");
  for (std::size_t m = 0; m < meshes.size(); ++m)
    require_mesh(*meshes[m].mesh, *meshes[m].vertices, m);
  if (!options.supersample)
    return Painter<1>(Scene(meshes), camera, options).picture();
  return Painter<2>(Scene(meshes), camera.resized(2 * camera.width, 2 * camera.height), options).picture();
}

} // namespace

void RenderOptions::validate() const {
  options::check(*this);
  if (!(light_direction.norm() > 0))
    options::throw_invalid("RenderOptions: light_direction", "a direction", "a vector of length 0");
}

Image render(const std::vector<RenderMesh> &meshes, const Camera &camera, const RenderOptions &options) {
  std::vector<Drawn> drawn;
  for (const RenderMesh &mesh : meshes)
    drawn.push_back({&mesh, &mesh.vertices, pyramid_of(mesh)});
  return picture_of(drawn, camera, options);
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
    texture_ = pyramid_of(high_);
  }
  body_.vertices = character.body.vertices;
  body_.faces = character.body.faces;
  body_.face_valid = character.body_shown;
  body_.colour = character.body_colour.array().pow(1 / 2.2); // the pictures are sRGB
}

void CharacterRenderer::require_frame(const Vertices &surface, const Vertices &high, const Vertices &body) const {
  const auto require = [](const RenderMesh &rest, const Vertices &vertices, const char *what) {
    if (vertices.rows() != rest.vertices.rows())
      throw std::invalid_argument(std::string("CharacterRenderer: ") + what + " has " + std::to_string(vertices.rows()) +
                                  " vertices, the character " + std::to_string(rest.vertices.rows()));
  };
  if (high.rows() > 0)
    require(high_, high, "high");
  else
    require(coarse_, surface, "surface");
  if (body.rows() > 0)
    require(body_, body, "body");
}

std::vector<RenderMesh> CharacterRenderer::meshes(const Vertices &surface, const Vertices &high, const Vertices &body) const {
  require_frame(surface, high, body);
  std::vector<RenderMesh> meshes{high.rows() > 0 ? high_ : coarse_};
  meshes[0].vertices = high.rows() > 0 ? high : surface;
  if (body.rows() > 0) {
    meshes.push_back(body_);
    meshes[1].vertices = body;
  }
  return meshes;
}

Image CharacterRenderer::render(const Vertices &surface, const Vertices &high, const Vertices &body, const Camera &camera,
                                const RenderOptions &options) const {
  require_frame(surface, high, body);
  std::vector<Drawn> drawn{high.rows() > 0 ? Drawn{&high_, &high, texture_} : Drawn{&coarse_, &surface, nullptr}};
  if (body.rows() > 0)
    drawn.push_back({&body_, &body, nullptr});
  return picture_of(drawn, camera, options);
}

} // namespace doublet
