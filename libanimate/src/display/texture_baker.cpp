// Atlas: the image is a grid of square cells; two triangles share a cell, one below its diagonal and one above. Inside a cell a
// border of one pixel belongs to each triangle, so that bilinear sampling never leaves it.

#include "doublet/animate/texture_baker.h"

#include "doublet/animate/display_surface.h"
#include "doublet/animate/parts/image_file.h"
#include "doublet/animate/parts/irradiance.h"
#include "doublet/core/error.h"
#include "doublet/core/parts/colour_histogram.h"
#include "doublet/core/rasterizer.h"
#include "garment_part.h"
#include "hidden_skin.h"
#include "label_colours.h"
#include "silhouette_depth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

namespace doublet {
namespace {

using detail::kGamma;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr int kAround = 2; // pixels around a sample that must see the same surface
constexpr int kRim = 3;    // pixels on a silhouette's rim that are mixed with what is behind
constexpr int kAlong = 4, kPoints = kAlong * (kAlong + 1) / 2;

struct Atlas {
  int size, cell, columns;

  Atlas(int pixels, Eigen::Index faces) : size(pixels) {
    const double cells = std::max<double>(1, (faces + 1) / 2);
    columns = static_cast<int>(std::ceil(std::sqrt(cells)));
    cell = size / columns;
    if (cell < 6)
      throw std::invalid_argument("TextureOptions.size must give every triangle a cell of 6 pixels; " + std::to_string(faces) +
                                  " triangles need " + std::to_string(6 * columns) + ", found " + std::to_string(size));
  }
  Vector2d cell_origin(int f) const { return {(f / 2 % columns) * cell, (f / 2 / columns) * cell}; }
  /// Corner k of face f in pixels (pixel centres at .5). Odd faces lie in the upper right half, turned by 180 degrees.
  Vector2d corner(int f, int k) const {
    const double near = 1.5, far = cell - 3.5; // legs leave a pixel of border on every side of both triangles
    const std::array<Vector2d, 3> lower{Vector2d(near, near), Vector2d(far, near), Vector2d(near, far)};
    const Vector2d c = f % 2 == 0 ? lower[k] : Vector2d(Vector2d(cell, cell) - lower[k]);
    return cell_origin(f) + c;
  }
};

struct View {
  const Camera *camera;
  const Image *image;
  std::vector<int> depth; ///< inside the silhouette, px; empty = there is none
  FaceBuffer buffer;
  std::vector<std::uint16_t> colours = {}; ///< colour_bin() of every pixel; empty = labels do not matter
};

/// Is the pixel in the silhouette, away from its rim? Without one everything is.
bool inside_silhouette(const View &view, const Vector2d &pixel) {
  if (view.depth.empty())
    return true;
  const auto x = std::lround(pixel.x()), y = std::lround(pixel.y());
  return view.depth[static_cast<std::size_t>(y * view.image->width + x)] > kRim;
}

Vector3f sample(const Image &image, const Vector2d &pixel) {
  const int x0 = static_cast<int>(pixel.x()), y0 = static_cast<int>(pixel.y());
  const auto a = static_cast<float>(pixel.x() - x0), b = static_cast<float>(pixel.y() - y0);
  Vector3f colour;
  for (int c = 0; c < 3; ++c)
    colour[c] = (1 - b) * ((1 - a) * image.at(x0, y0, c) + a * image.at(x0 + 1, y0, c)) +
                b * ((1 - a) * image.at(x0, y0 + 1, c) + a * image.at(x0 + 1, y0 + 1, c));
  return colour;
}

/// Is the whole neighbourhood of the pixel on a surface that is not in front of `depth`, and away from the background?
bool visible(const FaceBuffer &buffer, const Vector2d &pixel, double depth, double margin) {
  const int x = static_cast<int>(std::lround(pixel.x())), y = static_cast<int>(std::lround(pixel.y()));
  if (x < kAround || y < kAround || x >= buffer.width - kAround || y >= buffer.height - kAround)
    return false;
  for (const auto &[dx, dy] : {std::pair{0, 0}, {kAround, 0}, {-kAround, 0}, {0, kAround}, {0, -kAround}})
    if (buffer.face_at(x + dx, y + dy) < 0 || buffer.depth_at(x + dx, y + dy) < depth - margin)
      return false;
  return true;
}

/// Does a surface lie `around` pixels away, at such a pixel (index into the buffer)?
template <class Test> bool surrounded_by(const FaceBuffer &buffer, const Vector2d &pixel, double around, const Test &test) {
  constexpr double kDiagonal = 0.70710678;
  constexpr std::array<std::array<double, 2>, 8> kCircle{{{1, 0},
                                                          {kDiagonal, kDiagonal},
                                                          {0, 1},
                                                          {-kDiagonal, kDiagonal},
                                                          {-1, 0},
                                                          {-kDiagonal, -kDiagonal},
                                                          {0, -1},
                                                          {kDiagonal, -kDiagonal}}};
  for (const auto &[dx, dy] : kCircle) {
    const int x = static_cast<int>(std::lround(pixel.x() + around * dx)),
              y = static_cast<int>(std::lround(pixel.y() + around * dy));
    if (x >= 0 && y >= 0 && x < buffer.width && y < buffer.height && buffer.face_at(x, y) >= 0 &&
        test(static_cast<std::size_t>(y) * buffer.width + x))
      return true;
  }
  return false;
}

/// Is something well in front of `depth` within `around` pixels, or well behind it within the rim? Its edge, or that of the
/// surface itself, may have been there: surfaces are not exactly known.
bool near_an_edge(const FaceBuffer &buffer, const Vector2d &pixel, double depth, double margin, double around) {
  constexpr double kWell = 0.05; // m
  return surrounded_by(buffer, pixel, around, [&](std::size_t at) { return buffer.depth[at] < depth - kWell; }) ||
         surrounded_by(buffer, pixel, kRim, [&](std::size_t at) { return buffer.depth[at] > depth + margin + kWell; });
}

/// Barycentric coordinates of a triangular grid, half a step away from the edges.
std::array<Vector3d, kPoints> points_of_a_face() {
  std::array<Vector3d, kPoints> points;
  for (int i = 0, n = 0; i < kAlong; ++i)
    for (int k = 0; i + k < kAlong; ++k)
      points[n++] = (Vector3d(i, k, kAlong - 1 - i - k).array() + 1.0 / 3) / kAlong;
  return points;
}

/// A surface point as a camera sees it.
struct Sight {
  const View &view;
  Vector2d pixel;
  double depth, facing; ///< m; cosine between normal and ray

  std::size_t nearest_pixel() const { return std::lround(pixel.y()) * view.image->width + std::lround(pixel.x()); }
};

/// The nearest face seen around the sight of face f, within `reach` (m), that has the other label and is so far (m) in front or
/// behind; -1 = there is none.
int other_label_near(const Sight &sight, const std::vector<SurfaceLabel> &face_labels, int f, double reach, double apart) {
  constexpr int kRings = 5;
  const FaceBuffer &buffer = sight.view.buffer;
  int found = -1;
  const auto is_other = [&](std::size_t at) {
    const bool other = face_labels[buffer.face[at]] != face_labels[f] && std::abs(buffer.depth[at] - sight.depth) >= apart;
    found = other ? buffer.face[at] : -1;
    return other;
  };
  const double pixels = reach * sight.view.camera->K(0, 0) / sight.depth;
  for (int ring = 1; ring <= kRings; ++ring)
    if (surrounded_by(buffer, sight.pixel, pixels * ring / kRings, is_other))
      break;
  return found;
}

/// (height * width) colour_bin() of every pixel.
std::vector<std::uint16_t> colour_bins(const Image &image, const Context &context) {
  std::vector<std::uint16_t> bins(static_cast<std::size_t>(image.width) * image.height);
  parallel_for(context, image.height, [&](int y) {
    for (int x = 0; x < image.width; ++x)
      bins[static_cast<std::size_t>(y) * image.width + x] = static_cast<std::uint16_t>(
          colour_bin({double(image.at(x, y, 0)), double(image.at(x, y, 1)), double(image.at(x, y, 2))}));
  });
  return bins;
}

class Baker {
public:
  Baker(const Mesh &mesh, const std::vector<std::uint8_t> &valid, const CameraRig &cameras, const std::vector<Image> &images,
        const std::vector<Image> &masks, const TextureOptions &options)
      : mesh_(mesh), valid_(valid), options_(options), normals_(vertex_normals(mesh.vertices, mesh.faces)) {
    const std::vector<Image> silhouettes = detail::without_screen(images, masks, options.screen_margin);
    for (std::size_t c = 0; c < cameras.size(); ++c)
      if (!images[c].empty()) {
        const bool masked = c < silhouettes.size() && !silhouettes[c].empty();
        views_.push_back({&cameras[c], &images[c], masked ? detail::silhouette_depth(silhouettes[c]) : std::vector<int>(),
                          rasterize(mesh.vertices, mesh.faces, cameras[c], valid)});
      }
  }

  bool drawn(int f) const { return valid_.empty() || valid_[f]; }
  const Vertices &normals() const { return normals_; }

  /// From now on colours are divided by this light.
  void divide_by(const Irradiance &light) {
    gains_.resize(normals_.rows(), 3);
    for (Eigen::Index v = 0; v < gains_.rows(); ++v)
      gains_.row(v) = light.at(normals_.row(v)).array().pow(-1 / kGamma).transpose();
  }

  /// From now on cameras do not count where they see the colour of what has the other label beside it.
  void keep_apart(const std::vector<SurfaceLabel> &face_labels, const Context &context) {
    const bool both = std::adjacent_find(face_labels.begin(), face_labels.end(), std::not_equal_to<>()) != face_labels.end();
    if (!both || options_.label_margin <= 0)
      return;
    for (View &view : views_)
      view.colours = colour_bins(*view.image, context);
    std::vector<std::vector<int>> seen(face_labels.size());
    parallel_for(context, static_cast<int>(seen.size()), [&](int f) { seen[f] = certain_colours(f, face_labels); });
    face_labels_ = &face_labels;
    label_colours_.emplace(mesh_, face_labels, seen, context);
  }

  /// B G R of the surface point, and its weight; 0 = seen by no camera.
  float colour_at(int f, const Vector3d &barycentric, Vector3f &colour) const {
    float sum = 0;
    colour.setZero();
    for_sights(f, barycentric, [&](const Sight &sight) {
      if (shows_the_other_label(f, sight))
        return;
      const auto weight = static_cast<float>(std::pow(sight.facing, options_.facing_power));
      colour += weight * sample(*sight.view.image, sight.pixel);
      sum += weight;
    });
    if (sum > 0)
      colour = colour.cwiseProduct(gain_at(f, barycentric)) / sum;
    if (const float most = colour.maxCoeff(); most > 255) // brighter than white: the normal is not that exact, the hue is
      colour *= 255 / most;
    return sum;
  }

private:
  /// Visits the sights of the surface point that count.
  template <class Visit> void for_sights(int f, const Vector3d &barycentric, const Visit &visit) const {
    Vector3d point = Vector3d::Zero(), normal = Vector3d::Zero();
    for (int k = 0; k < 3; ++k) {
      point += barycentric[k] * mesh_.vertices.row(mesh_.faces(f, k)).transpose();
      normal += barycentric[k] * normals_.row(mesh_.faces(f, k)).transpose();
    }
    normal.normalize();
    for (const View &view : views_) {
      const double facing = normal.dot((view.camera->centre() - point).normalized());
      const double depth = view.camera->depth(point);
      if (!(facing > options_.grazing) || !(depth > 0.05))
        continue;
      const Vector2d pixel = view.camera->project(point);
      // Within the pixels looked at, a slanted surface comes nearer by their size on it.
      const double slope = std::sqrt(std::max(0.0, 1 - facing * facing)) / facing;
      const double margin = options_.depth_margin + kAround * slope * depth / view.camera->K(0, 0);
      if (visible(view.buffer, pixel, depth, margin) && inside_silhouette(view, pixel) &&
          !near_an_edge(view.buffer, pixel, depth, margin, options_.edge_margin * view.camera->K(0, 0) / depth))
        visit(Sight{view, pixel, depth, facing});
    }
  }

  /// Bins of what cameras see of the face where the other label is nowhere near.
  std::vector<int> certain_colours(int f, const std::vector<SurfaceLabel> &face_labels) const {
    std::vector<int> bins;
    for (const Vector3d &at : points_of_a_face())
      if (drawn(f))
        for_sights(f, at, [&](const Sight &sight) {
          if (other_label_near(sight, face_labels, f, options_.label_margin, 0) < 0)
            bins.push_back(sight.view.colours[sight.nearest_pixel()]);
        });
    return bins;
  }

  /// Is there, or within the rim, a colour that is rare on the face's own label and usual on the other's surface beside it?
  bool shows_the_other_label(int f, const Sight &sight) const {
    constexpr double kApart = 0.03; // m: closer, they touch, and a label may end elsewhere
    if (!label_colours_)
      return false;
    std::optional<int> other;
    const auto is_the_others = [&](std::size_t at) {
      const int bin = sight.view.colours[at];
      if (!label_colours_->rare(f, bin))
        return false;
      if (!other)
        other = other_label_near(sight, *face_labels_, f, options_.label_margin, kApart);
      return *other >= 0 && label_colours_->likelier(bin, *other, f);
    };
    return is_the_others(sight.nearest_pixel()) || surrounded_by(sight.view.buffer, sight.pixel, kRim, is_the_others);
  }

  Vector3f gain_at(int f, const Vector3d &barycentric) const {
    if (gains_.rows() == 0)
      return Vector3f::Ones();
    Vector3d gain = Vector3d::Zero();
    for (int k = 0; k < 3; ++k)
      gain += barycentric[k] * gains_.row(mesh_.faces(f, k)).transpose();
    return gain.cast<float>();
  }

  const Mesh &mesh_;
  const std::vector<std::uint8_t> &valid_;
  const TextureOptions &options_;
  Vertices normals_, gains_; ///< (V, 3); gains of the 8-bit B G R, none = 1
  std::vector<View> views_;
  const std::vector<SurfaceLabel> *face_labels_ = nullptr;
  std::optional<detail::LabelColours> label_colours_; ///< none = labels do not matter
};

struct VertexColours {
  Vertices colours; ///< (V, 3) B G R
  std::vector<std::uint8_t> known;
};

/// Of the vertices that a camera sees; grey elsewhere.
VertexColours seen_colours(const Mesh &mesh, const Baker &baker) {
  const auto n = static_cast<std::size_t>(mesh.vertices.rows());
  VertexColours seen{Vertices::Constant(mesh.vertices.rows(), 3, 128), std::vector<std::uint8_t>(n, 0)};
  for (int f = 0; f < mesh.faces.rows(); ++f)
    for (int k = 0; k < 3 && baker.drawn(f); ++k) {
      const int v = mesh.faces(f, k);
      Vector3f colour;
      if (!seen.known[v] && baker.colour_at(f, Vector3d::Unit(k), colour) > 0) {
        seen.known[v] = 1;
        seen.colours.row(v) = colour.cast<double>();
      }
    }
  return seen;
}

/// The light that the images were taken in; albedo is taken to be the same within a hand's breadth, but for what stands out.
Irradiance estimated_light(const Mesh &mesh, const Baker &baker) {
  constexpr double kPatch = 0.12, kDarkest = 5; // m; of 255: darker is noise
  const VertexColours seen = seen_colours(mesh, baker);
  const Eigen::VectorXd areas = vertex_areas(mesh.vertices, mesh.faces);
  std::vector<int> chosen;
  for (int v = 0; v < mesh.vertices.rows(); ++v)
    if (seen.known[v] && seen.colours.row(v).minCoeff() > kDarkest)
      chosen.push_back(v);
  ShadedPoints points;
  points.normals = baker.normals()(chosen, Eigen::all);
  points.colours = (seen.colours(chosen, Eigen::all).array() / 255).pow(kGamma);
  points.weights = areas(chosen);
  std::map<std::array<int, 3>, int> patches;
  for (int v : chosen) {
    const Eigen::RowVector3i cell = (mesh.vertices.row(v) / kPatch).array().floor().cast<int>();
    points.patches.push_back(patches.try_emplace({cell.x(), cell.y(), cell.z()}, static_cast<int>(patches.size())).first->second);
  }
  return estimate_irradiance(points);
}

/// (V, 3); vertices that no camera sees take the mean of their neighbours, ring by ring.
Vertices vertex_colours(const Mesh &mesh, const Baker &baker) {
  const int n = static_cast<int>(mesh.vertices.rows());
  auto [colours, known] = seen_colours(mesh, baker);
  const auto neighbours = vertex_neighbours(mesh.faces, n);
  std::vector<int> front;
  for (int v = 0; v < n; ++v)
    if (!known[v])
      front.push_back(v);
  for (bool grew = true; grew && !front.empty();) {
    std::vector<int> later, now;
    const std::vector<std::uint8_t> before = known;
    for (int v : front) {
      Vector3d sum = Vector3d::Zero();
      int count = 0;
      for (int w : neighbours[v])
        if (before[w]) {
          sum += colours.row(w).transpose();
          ++count;
        }
      if (count > 0) {
        colours.row(v) = sum / count;
        now.push_back(v);
      } else {
        later.push_back(v);
      }
    }
    for (int v : now)
      known[v] = 1;
    grew = !now.empty();
    front = std::move(later);
  }
  return colours;
}

/// Texels of face f with their barycentric coordinates, border included (clamped to the triangle).
template <class Visit> void for_texels(const Atlas &atlas, int f, const Visit &visit) {
  const Vector2d a = atlas.corner(f, 0), ab = atlas.corner(f, 1) - a, ac = atlas.corner(f, 2) - a;
  const Vector2d origin = atlas.cell_origin(f);
  for (int y = 0; y < atlas.cell; ++y)
    for (int x = 0; x < atlas.cell; ++x) {
      if ((x + y < atlas.cell - 1) != (f % 2 == 0) && x + y != atlas.cell - 1)
        continue; // the other triangle's half
      const Vector2d p = origin + Vector2d(x + 0.5, y + 0.5) - a;
      Vector3d b(0, p.dot(ab) / ab.squaredNorm(), p.dot(ac) / ac.squaredNorm()); // legs are perpendicular
      b[0] = 1 - b[1] - b[2];
      b = b.cwiseMax(0);
      b /= b.sum();
      visit(static_cast<int>(origin.x()) + x, static_cast<int>(origin.y()) + y, b);
    }
}

void require_length(const std::string &who, const std::string &what, std::size_t found, Eigen::Index expected) {
  if (static_cast<Eigen::Index>(found) != expected)
    throw std::invalid_argument(who + ": " + what + " has " + std::to_string(found) + " entries, expected " +
                                std::to_string(expected));
}

void require_inputs(const std::string &who, const Mesh &mesh, const std::vector<std::uint8_t> &valid, const CameraRig &cameras,
                    const std::vector<Image> &images, const std::vector<Image> &masks) {
  require_usable(mesh, who + ": mesh");
  if (!valid.empty())
    require_length(who, "face_valid", valid.size(), mesh.faces.rows());
  for (const Camera &camera : cameras)
    validate_camera(camera, who);
  if (images.size() != cameras.size())
    throw std::invalid_argument(who + ": expected one image a camera, found " + std::to_string(images.size()) + " for " +
                                std::to_string(cameras.size()));
  for (std::size_t c = 0; c < images.size(); ++c)
    if (!images[c].empty() &&
        (images[c].channels != 3 || images[c].width != cameras[c].width || images[c].height != cameras[c].height))
      throw std::invalid_argument(who + ": the image of camera '" + cameras[c].name + "' must be " +
                                  std::to_string(cameras[c].width) + " x " + std::to_string(cameras[c].height) +
                                  " with 3 channels, found " + std::to_string(images[c].width) + " x " +
                                  std::to_string(images[c].height) + " with " + std::to_string(images[c].channels));
  for (std::size_t c = 0; c < masks.size(); ++c)
    if (masks.size() != cameras.size() || (!masks[c].empty() && (masks[c].channels != 1 || masks[c].width != cameras[c].width ||
                                                                 masks[c].height != cameras[c].height)))
      throw std::invalid_argument(who + ": expected no masks or one a camera with 1 channel and the camera's size, found " +
                                  std::to_string(masks.size()) + " masks, the one of camera " + std::to_string(c) + " being " +
                                  std::to_string(masks[c].width) + " x " + std::to_string(masks[c].height));
}

/// How much a colour (B G R) looks like the hidden body's, in light or in shadow: 1 = very, 0 = a shoe, a sock.
double likeness(const Vector3d &bgr, const Vector3d &skin) {
  constexpr double kChroma = 0.08, kLight = 1.0; // of the channels' shares, summed; of the logarithm of the brightness
  const double sum = bgr.sum() + 1, skin_sum = skin.sum() + 1;
  const double chroma = (bgr / sum - skin / skin_sum).cwiseAbs().sum() / kChroma, light = std::log(sum / skin_sum) / kLight;
  return std::exp(-chroma * chroma - light * light);
}

/// Skin goes over into the hidden body's colour towards the seam where the body goes on; what is darker there is in the
/// garment's shadow. Where the body is of the same surface, what is not like it (a stocking) goes on there and over into it.
/// `away` (VH) as of detail::from_the_seam().
void fade_into_hidden(const Character &c, const std::vector<double> &away, BakedTexture &baked) {
  constexpr double kReach = 0.10, kWhole = 0.02; // m
  const Vector3d skin = 255 * c.body_colour.reverse().array().pow(1 / kGamma).matrix();
  const Atlas atlas(baked.image.width, c.high.faces.rows());
  const std::vector<std::uint8_t> hidden = hidden_faces(c);
  for (int f = 0; f < c.high.faces.rows(); ++f) {
    const Vector3d corners(away[c.high.faces(f, 0)], away[c.high.faces(f, 1)], away[c.high.faces(f, 2)]);
    if ((!(corners.maxCoeff() < kReach) && !hidden[f]) || !c.high_valid[f])
      continue;
    for_texels(atlas, f, [&](int x, int y, const Vector3d &b) {
      Vector3d colour(baked.image.at(x, y, 0), baked.image.at(x, y, 1), baked.image.at(x, y, 2));
      const double near = std::clamp((kReach - b.dot(corners.cwiseMin(kReach))) / (kReach - kWhole), 0.0, 1.0);
      const double share = near * near * (3 - 2 * near), alike = likeness(colour, skin);
      colour += (hidden[f] ? 1 - share * (1 - alike) : share * alike) * (skin - colour);
      for (int k = 0; k < 3; ++k)
        baked.image.at(x, y, k) = static_cast<std::uint8_t>(std::clamp(colour[k] + 0.5, 0.0, 255.0));
    });
  }
}

/// (FH) the garment's own faces, or those of cloth.
std::vector<SurfaceLabel> labels_of(const Character &c, const DisplaySurface &display) {
  std::vector<SurfaceLabel> labels(static_cast<std::size_t>(c.high.faces.rows()), SurfaceLabel::Body);
  if (c.garment_subdivisions >= 0) {
    std::fill(labels.begin() + detail::garment_part(c).skin_faces, labels.end(), SurfaceLabel::Garment);
    return labels;
  }
  const MatrixRM clothness = display.sample(c.segmentation.clothness);
  for (Eigen::Index f = 0; f < c.high.faces.rows(); ++f)
    if (clothness(c.high.faces.row(f), 0).mean() > 0.5)
      labels[f] = SurfaceLabel::Garment;
  return labels;
}

} // namespace

BakedTexture bake_texture(const Mesh &mesh, const std::vector<std::uint8_t> &face_valid, const CameraRig &cameras,
                          const std::vector<Image> &images, const std::vector<Image> &masks,
                          const std::vector<SurfaceLabel> &face_labels, const TextureOptions &options, const Context &context) {
  options.validate();
  require_inputs("bake_texture", mesh, face_valid, cameras, images, masks);
  if (!face_labels.empty())
    require_length("bake_texture", "face_labels", face_labels.size(), mesh.faces.rows());
  const Atlas atlas(options.size, mesh.faces.rows());
  Baker baker(mesh, face_valid, cameras, images, masks, options);
  baker.keep_apart(face_labels, context);
  if (options.albedo)
    baker.divide_by(estimated_light(mesh, baker));
  const Vertices fallback = vertex_colours(mesh, baker);
  const Eigen::VectorXd areas = face_areas(mesh.vertices, mesh.faces);
  const int faces = static_cast<int>(mesh.faces.rows());
  BakedTexture baked;
  baked.image = Image(options.size, options.size, 3, 128);
  baked.texcoords.resize(3 * faces, 2);
  Eigen::VectorXd seen = Eigen::VectorXd::Zero(faces);
  const auto bake_face = [&](int f) {
    int texels = 0, covered = 0;
    for_texels(atlas, f, [&](int x, int y, const Vector3d &b) {
      Vector3f colour;
      ++texels;
      if (baker.drawn(f) && baker.colour_at(f, b, colour) > 0) {
        ++covered;
      } else {
        colour.setZero();
        for (int k = 0; k < 3; ++k)
          colour += static_cast<float>(b[k]) * fallback.row(mesh.faces(f, k)).transpose().cast<float>();
      }
      for (int c = 0; c < 3; ++c)
        baked.image.at(x, y, c) = static_cast<std::uint8_t>(std::clamp(colour[c] + 0.5f, 0.0f, 255.0f));
    });
    seen[f] = static_cast<double>(covered) / texels;
    for (int k = 0; k < 3; ++k)
      baked.texcoords.row(3 * f + k) = atlas.corner(f, k) / options.size;
  };
  const int chunk = 2000; // pairs of faces share a cell's diagonal: one task does both
  for (int first = 0; first < faces; first += chunk) {
    context.report_progress("texture", static_cast<double>(first) / faces);
    const int count = std::min(chunk, faces - first);
    parallel_for(context, (count + 1) / 2, [&](int pair) {
      for (int f = first + 2 * pair; f < std::min(first + 2 * pair + 2, faces); ++f)
        bake_face(f);
    });
  }
  double drawn = 0, covered = 0;
  for (int f = 0; f < faces; ++f)
    if (baker.drawn(f)) {
      drawn += areas[f];
      covered += areas[f] * seen[f];
    }
  baked.seen_fraction = drawn > 0 ? covered / drawn : 0;
  context.report_progress("texture", 1.0);
  return baked;
}

Vertices sample_colours(const Mesh &mesh, const std::vector<std::uint8_t> &face_valid, const CameraRig &cameras,
                        const std::vector<Image> &images, const std::vector<Image> &masks, const TextureOptions &options,
                        const Context &context) {
  options.validate();
  require_inputs("sample_colours", mesh, face_valid, cameras, images, masks);
  const Baker baker(mesh, face_valid, cameras, images, masks, options);
  const int faces = static_cast<int>(mesh.faces.rows());
  Vertices colours = Vertices::Constant(kPoints * faces, 3, std::numeric_limits<double>::quiet_NaN());
  parallel_for(context, faces, [&](int f) {
    int row = kPoints * f;
    for (const Vector3d &at : points_of_a_face()) {
      Vector3f colour;
      if (baker.drawn(f) && baker.colour_at(f, at, colour) > 0)
        colours.row(row) = colour.cast<double>().transpose();
      ++row;
    }
  });
  return colours;
}

double texture_character(Character &character, const Vertices &surface, const CameraRig &cameras,
                         const std::vector<Image> &images, const std::vector<Image> &masks, const TextureOptions &options,
                         const Context &context) {
  const DisplaySurface display(character);
  const Mesh posed{display.apply(surface), character.high.faces};
  BakedTexture baked =
      bake_texture(posed, character.high_valid, cameras, images, masks, labels_of(character, display), options, context);
  const std::vector<double> away = detail::beyond_free_edges(character);
  if (detail::find_hidden_colour(character, away, baked) && options.albedo)
    fade_into_hidden(character, detail::from_the_seam(character, away), baked);
  character.texcoords = std::move(baked.texcoords);
  character.texture = encode_jpeg(baked.image);
  return baked.seen_fraction;
}

} // namespace doublet
