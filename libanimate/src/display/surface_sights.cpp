#include "surface_sights.h"

#include "doublet/core/parts/colour_histogram.h"
#include "silhouette_depth.h"

#include <algorithm>
#include <functional>

namespace doublet::detail {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr int kRim = 3; // pixels on a silhouette's rim that are mixed with what is behind

/// Is the pixel in the silhouette, away from its rim? Without one everything is.
bool inside_silhouette(const View &view, const Vector2d &pixel) {
  if (view.depth.empty())
    return true;
  const auto x = std::lround(pixel.x()), y = std::lround(pixel.y());
  return view.depth[static_cast<std::size_t>(y * view.image->width + x)] > kRim;
}

/// Is the whole neighbourhood of the pixel on a surface that is not in front of `depth`, and away from the background?
bool visible(const FaceBuffer &buffer, const Vector2d &pixel, double depth, double margin) {
  const int x = static_cast<int>(std::lround(pixel.x())), y = static_cast<int>(std::lround(pixel.y()));
  if (x < kSightRadius || y < kSightRadius || x >= buffer.width - kSightRadius || y >= buffer.height - kSightRadius)
    return false;
  for (const auto &[dx, dy] : {std::pair{0, 0}, {kSightRadius, 0}, {-kSightRadius, 0}, {0, kSightRadius}, {0, -kSightRadius}})
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

} // namespace

std::array<Vector3d, kPoints> points_of_a_face() {
  std::array<Vector3d, kPoints> points;
  for (int i = 0, n = 0; i < kAlong; ++i)
    for (int k = 0; i + k < kAlong; ++k)
      points[n++] = (Vector3d(i, k, kAlong - 1 - i - k).array() + 1.0 / 3) / kAlong;
  return points;
}

Vector3f bilinear(const Image &image, const Vector2d &pixel) {
  const int x0 = static_cast<int>(pixel.x()), y0 = static_cast<int>(pixel.y());
  const auto a = static_cast<float>(pixel.x() - x0), b = static_cast<float>(pixel.y() - y0);
  Vector3f colour;
  for (int c = 0; c < 3; ++c)
    colour[c] = (1 - b) * ((1 - a) * image.at(x0, y0, c) + a * image.at(x0 + 1, y0, c)) +
                b * ((1 - a) * image.at(x0, y0 + 1, c) + a * image.at(x0 + 1, y0 + 1, c));
  return colour;
}

SurfaceSights::SurfaceSights(const Mesh &mesh, const std::vector<std::uint8_t> &valid, const CameraRig &cameras,
                             const std::vector<Image> &images, const std::vector<Image> &masks, const TextureOptions &options)
    : mesh_(mesh), valid_(valid), options_(options), normals_(vertex_normals(mesh.vertices, mesh.faces)) {
  const std::vector<Image> silhouettes = without_screen(images, masks, options.screen_margin);
  for (std::size_t c = 0; c < cameras.size(); ++c)
    if (!images[c].empty()) {
      const bool masked = c < silhouettes.size() && !silhouettes[c].empty();
      views_.push_back({static_cast<int>(c), &cameras[c], &images[c],
                        masked ? silhouette_depth(silhouettes[c]) : std::vector<int>(),
                        rasterize(mesh.vertices, mesh.faces, cameras[c], valid)});
    }
}

std::shared_ptr<const LabelColours> SurfaceSights::keep_apart(const std::vector<SurfaceLabel> &face_labels,
                                                              std::shared_ptr<const LabelColours> colours,
                                                              const Context &context) {
  const bool both = std::adjacent_find(face_labels.begin(), face_labels.end(), std::not_equal_to<>()) != face_labels.end();
  if (!both || options_.label_margin <= 0)
    return nullptr;
  for (View &view : views_)
    view.colours = colour_bins(*view.image, context);
  face_labels_ = &face_labels;
  tracked_ = colours != nullptr;
  if (!colours) {
    std::vector<std::vector<int>> seen(face_labels.size());
    parallel_for(context, static_cast<int>(seen.size()), [&](int f) { seen[f] = certain_colours(f, face_labels); });
    colours = std::make_shared<LabelColours>(mesh_, face_labels, seen, context);
  }
  return label_colours_ = std::move(colours);
}

float SurfaceSights::colour_at(int f, const Vector3d &barycentric, Vector3f &colour) const {
  float sum = 0;
  colour.setZero();
  for_sights(f, barycentric, [&](const Sight &sight) {
    const auto weight = static_cast<float>(std::pow(sight.facing, options_.facing_power));
    colour += weight * bilinear(*sight.view.image, sight.pixel);
    sum += weight;
  });
  if (sum > 0)
    colour /= sum;
  if (const float most = colour.maxCoeff(); most > 255) // by a rounding
    colour *= 255 / most;
  return sum;
}

std::optional<Sight> SurfaceSights::seen_by(const View &view, const Vector3d &point, const Vector3d &normal) const {
  const double facing = normal.dot((view.camera->centre() - point).normalized());
  const double depth = view.camera->depth(point);
  if (!(facing > options_.grazing) || !(depth > 0.05))
    return std::nullopt;
  const Vector2d pixel = view.camera->project(point);
  // Within the pixels looked at, a slanted surface comes nearer by their size on it.
  const double slope = std::sqrt(std::max(0.0, 1 - facing * facing)) / facing;
  const double margin = options_.depth_margin + kSightRadius * slope * depth / view.camera->K(0, 0);
  if (visible(view.buffer, pixel, depth, margin) && inside_silhouette(view, pixel) &&
      !near_an_edge(view.buffer, pixel, depth, margin, options_.edge_margin * view.camera->K(0, 0) / depth))
    return Sight{view, pixel, depth, facing};
  return std::nullopt;
}

/// Bins of what cameras see of the face where the other label is nowhere near.
std::vector<int> SurfaceSights::certain_colours(int f, const std::vector<SurfaceLabel> &face_labels) const {
  std::vector<int> bins;
  for (const Vector3d &at : points_of_a_face())
    if (drawn(f))
      for_all_sights(f, at, [&](const Sight &sight) {
        if (other_label_near(sight, face_labels, f, options_.label_margin, 0) < 0)
          bins.push_back(sight.view.colours[sight.nearest_pixel()]);
      });
  return bins;
}

/// Is there, or within the rim, a colour that is rare on the face's own label and usual on the other's surface beside it?
bool SurfaceSights::shows_the_other_label(int f, const Sight &sight) const {
  constexpr double kApart = 0.03; // m: closer, they touch, and a label may end elsewhere
  if (!label_colours_)
    return false;
  const bool is_body = (*face_labels_)[f] == SurfaceLabel::Body;
  if (tracked_ && is_body && label_colours_->rare(f, sight.view.colours[sight.nearest_pixel()]))
    return true;
  if (tracked_)
    return other_label_near(sight, *face_labels_, f, options_.label_margin, kApart) >= 0;
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

} // namespace doublet::detail
