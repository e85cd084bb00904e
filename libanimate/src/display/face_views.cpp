#include "face_views.h"

#include "doublet/animate/parts/irradiance.h"
#include "doublet/core/parts/edge_distances.h"
#include "hidden_skin.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

namespace doublet::detail {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3f;

// What a later frame is worth beside the first, where the surface is the scan's: it has been tracked since, and is off by a few
// millimetres.
constexpr float kLater = 0.1f;

const Vector3d kMiddle = Vector3d::Constant(1.0 / 3);

/// The part of an image that the vertices fall into, and what a bilinear sample beside them needs.
ImagePart part_of(const Image &image, const Camera &camera, const Vertices &vertices) {
  constexpr int kMargin = kSightRadius + 2;
  Vector2d low = Vector2d::Constant(1e9), high = -low;
  for (Eigen::Index v = 0; v < vertices.rows(); ++v)
    if (camera.depth(vertices.row(v)) > 0.05) {
      const Vector2d at = camera.project(vertices.row(v));
      low = low.cwiseMin(at);
      high = high.cwiseMax(at);
    }
  const auto within = [](double value, int size) { return static_cast<int>(std::clamp(value, 0.0, double(size))); };
  const int left = within(low.x() - kMargin, image.width), right = within(high.x() + kMargin, image.width),
            top = within(low.y() - kMargin, image.height), bottom = within(high.y() + kMargin, image.height);
  if (right - left < 2 || bottom - top < 2)
    return {};
  ImagePart part{Image(right - left, bottom - top, 3), Vector2d(left, top)};
  for (int y = top; y < bottom; ++y)
    std::copy_n(&image.data[3 * (static_cast<std::size_t>(y) * image.width + left)], 3 * part.image.width,
                &part.image.data[3 * static_cast<std::size_t>(y - top) * part.image.width]);
  return part;
}

/// What the cameras of a frame saw of a face; none = nothing.
std::optional<FaceView> view_of(int f, const SurfaceSights &sights, int frame, double facing_power) {
  FaceView found{frame, 0, Vector3f::Zero(), Vector3f::Zero(), 0, {}};
  float sum = 0;
  std::uint16_t bit = 1;
  for (const Vector3d &at : points_of_a_face()) {
    float best = 0;
    sights.for_sights(f, at, [&](const Sight &sight) {
      const auto weight = static_cast<float>(sight_weight(sight.facing, sight.depth, *sight.view.camera, facing_power));
      found.colour += weight * bilinear(*sight.view.image, sight.pixel);
      sum += weight;
      best = std::max(best, weight);
      auto seen = std::find_if(found.seen.begin(), found.seen.end(),
                               [&](const SeenPoints &points) { return points.camera == sight.view.number; });
      if (seen == found.seen.end())
        seen = found.seen.insert(seen, {sight.view.number, 0});
      seen->points |= bit;
    });
    found.quality += best / kPoints;
    bit = static_cast<std::uint16_t>(bit << 1);
  }
  if (!(sum > 0))
    return std::nullopt;
  found.colour /= sum;
  if (frame > 0)
    found.quality *= kLater;
  return found;
}

/// Points of a face in a frame, as a camera shows them.
ShadedPoints shaded_points(const FilmedFaces &filmed) {
  constexpr double kPatch = 0.12, kDarkest = 5; // m; of 255: darker is noise
  constexpr std::size_t kMost = 150'000;        // a few times what the nine numbers need
  std::size_t count = 0;
  for (const auto &views : filmed.views)
    count += views.size();
  const std::size_t every = 1 + count / kMost;
  const Eigen::VectorXd areas = face_areas(filmed.mesh.vertices, filmed.mesh.faces);
  std::vector<Vector3d> normals, colours;
  std::vector<double> weights;
  ShadedPoints points;
  std::map<std::array<int, 3>, int> patches;
  std::size_t visited = 0;
  for (std::size_t f = 0; f < filmed.views.size(); ++f) {
    const Eigen::RowVector3i corners = filmed.mesh.faces.row(static_cast<Eigen::Index>(f));
    const Vector3d centre = filmed.mesh.vertices({corners[0], corners[1], corners[2]}, Eigen::all).colwise().mean();
    const Eigen::RowVector3i cell = (centre / kPatch).array().floor().cast<int>();
    for (const FaceView &view : filmed.views[f]) {
      if (visited++ % every != 0 || view.colour.minCoeff() <= kDarkest)
        continue;
      const Vertices &around = filmed.frames[view.frame].normals;
      normals.push_back((around.row(corners[0]) + around.row(corners[1]) + around.row(corners[2])).normalized());
      colours.push_back((view.colour.cast<double>().array() / 255).pow(kGamma));
      weights.push_back(areas[static_cast<Eigen::Index>(f)]);
      points.patches.push_back(patches.try_emplace({cell[0], cell[1], cell[2]}, static_cast<int>(patches.size())).first->second);
    }
  }
  const auto n = static_cast<Eigen::Index>(weights.size());
  points.normals.resize(n, 3);
  points.colours.resize(n, 3);
  points.weights = Eigen::Map<const Eigen::VectorXd>(weights.data(), n);
  for (Eigen::Index i = 0; i < n; ++i) {
    points.normals.row(i) = normals[i];
    points.colours.row(i) = colours[i];
  }
  return points;
}

/// The value below which half of the weight lies.
float weighted_median(std::vector<std::pair<float, float>> &values) {
  std::sort(values.begin(), values.end());
  float sum = 0, below = 0;
  for (const auto &[value, weight] : values)
    sum += weight;
  for (const auto &[value, weight] : values)
    if ((below += weight) >= sum / 2)
      return value;
  return values.back().first;
}

/// What most of the views agree on: from their median on, means weighted by how near it they are (Geman-McClure).
Vector3f agreed_colour(const std::vector<FaceView> &views) {
  constexpr int kRounds = 5;
  constexpr float kNear = 25; // of 255
  Vector3f colour;
  std::vector<std::pair<float, float>> values;
  for (int c = 0; c < 3; ++c) {
    values.clear();
    for (const FaceView &view : views)
      values.emplace_back(view.colour[c] + view.level[c], view.quality);
    colour[c] = weighted_median(values);
  }
  for (int round = 0; round < kRounds; ++round) {
    Vector3f sum = Vector3f::Zero();
    float weights = 0;
    for (const FaceView &view : views) {
      const float off = 1 + (view.colour + view.level - colour).squaredNorm() / (kNear * kNear);
      sum += view.quality / (off * off) * (view.colour + view.level);
      weights += view.quality / (off * off);
    }
    colour = sum / weights;
  }
  return colour;
}

/// Faces that were not seen take the mean of those around, ring by ring; grey where there are none.
void fill_unknown(FilmedFaces &filmed) {
  std::vector<std::uint8_t> known = filmed.known;
  std::vector<int> front;
  for (std::size_t f = 0; f < known.size(); ++f)
    if (!known[f])
      front.push_back(static_cast<int>(f));
  for (bool grew = true; grew && !front.empty();) {
    std::vector<int> now, later;
    for (int f : front) {
      Vector3f sum = Vector3f::Zero();
      int count = 0;
      for (int g : filmed.beside[f])
        if (known[g]) {
          sum += filmed.colour[g];
          ++count;
        }
      (count > 0 ? now : later).push_back(f);
      if (count > 0)
        filmed.colour[f] = sum / static_cast<float>(count);
    }
    for (int f : now)
      known[f] = 1;
    grew = !now.empty();
    front = std::move(later);
  }
}

/// Of the faces that a frame shows, smooth along the surface. `off` (F), of which only those faces' values count; `has` (F) all
/// 0, and so again.
template <class T>
void smooth(const FilmedFaces &filmed, const std::vector<ShownFace> &faces, std::vector<T> &off, std::vector<std::uint8_t> &has) {
  constexpr int kRounds = 8; // a few centimetres
  for (const auto &[f, i] : faces)
    has[f] = 1;
  std::vector<T> next(faces.size());
  for (int round = 0; round < kRounds; ++round) {
    for (std::size_t n = 0; n < faces.size(); ++n) {
      T sum = off[faces[n].face];
      int count = 1;
      for (int g : filmed.beside[faces[n].face])
        if (has[g]) {
          sum += off[g];
          ++count;
        }
      next[n] = sum / static_cast<float>(count);
    }
    for (std::size_t n = 0; n < faces.size(); ++n)
      off[faces[n].face] = next[n];
  }
  for (const auto &[f, i] : faces)
    has[f] = 0;
}

/// The levels of one frame: how much the faces it shows differ from the agreed colours.
void find_levels_of(FilmedFaces &filmed, const std::vector<ShownFace> &faces) {
  std::vector<Vector3f> off(filmed.views.size());
  std::vector<std::uint8_t> has(filmed.views.size(), 0);
  for (const auto &[f, i] : faces)
    off[f] = filmed.colour[f] - filmed.views[f][i].colour;
  smooth(filmed, faces, off, has);
  for (const auto &[f, i] : faces)
    filmed.views[f][i].level = off[f];
}

/// How much they still differ from face to face: where the surface has slid, a frame shows the pattern beside its place.
void find_slips_of(FilmedFaces &filmed, const std::vector<ShownFace> &faces) {
  std::vector<float> off(filmed.views.size());
  std::vector<std::uint8_t> has(filmed.views.size(), 0);
  for (const auto &[f, i] : faces)
    off[f] = (filmed.views[f][i].colour + filmed.views[f][i].level - filmed.colour[f]).norm();
  smooth(filmed, faces, off, has);
  for (const auto &[f, i] : faces)
    filmed.views[f][i].slip = off[f];
}

} // namespace

std::vector<std::vector<ShownFace>> faces_of_frames(const FilmedFaces &filmed) {
  std::vector<std::vector<ShownFace>> faces(filmed.frames.size());
  for (std::size_t f = 0; f < filmed.views.size(); ++f)
    for (std::size_t i = 0; i < filmed.views[f].size(); ++i)
      faces[filmed.views[f][i].frame].push_back({static_cast<int>(f), static_cast<int>(i)});
  return faces;
}

Vector3f FilmedFrame::gain(const Faces &faces, int f, const Vector3d &barycentric) const {
  if (gains.rows() == 0)
    return Vector3f::Ones();
  Vector3f sum = Vector3f::Zero();
  for (int k = 0; k < 3; ++k)
    sum += static_cast<float>(barycentric[k]) * gains.row(faces(f, k)).transpose();
  return sum;
}

Vector3d FilmedFrame::point(const Faces &faces, int f, const Vector3d &barycentric) const {
  Vector3d sum = Vector3d::Zero();
  for (int k = 0; k < 3; ++k)
    sum += barycentric[k] * vertices.row(faces(f, k)).transpose();
  return sum;
}

const FaceView *FilmedFaces::view(int face, int frame) const {
  const auto at =
      std::lower_bound(views[face].begin(), views[face].end(), frame, [](const FaceView &a, int b) { return a.frame < b; });
  return at != views[face].end() && at->frame == frame ? &*at : nullptr;
}

Vector3d FilmedFrame::normal(const Faces &faces, int f, const Vector3d &barycentric) const {
  Vector3d sum = Vector3d::Zero();
  for (int k = 0; k < 3; ++k)
    sum += barycentric[k] * normals.row(faces(f, k)).transpose();
  return sum.normalized();
}

double FilmedFrame::inside_at(const Faces &faces, int f, const Vector3d &barycentric, int camera) const {
  double sum = 0;
  for (int k = 0; k < 3; ++k)
    sum += barycentric[k] * inside[camera][faces(f, k)];
  return sum;
}

Vector3f within_white(Vector3f colour) {
  if (const float most = colour.maxCoeff(); most > 255) // the normal is not that exact, the hue is
    colour *= 255 / most;
  return colour;
}

double sight_weight(double facing, double depth, const Camera &camera, double facing_power) {
  const double resolution = camera.K(0, 0) / depth; // px / m
  return std::pow(facing, facing_power) * resolution * resolution;
}

void add_frame(FilmedFaces &filmed, const SurfaceSights &sights, const Vertices &vertices, const std::vector<Image> &images,
               const TextureOptions &options, const Context &context) {
  const int number = static_cast<int>(filmed.frames.size());
  FilmedFrame frame{vertices, sights.normals(), {}, {}, {}};
  for (std::size_t c = 0; c < images.size(); ++c)
    frame.parts.push_back(images[c].empty() ? ImagePart{} : part_of(images[c], filmed.cameras[c], vertices));
  filmed.frames.push_back(std::move(frame));
  parallel_for(context, static_cast<int>(filmed.views.size()), [&](int f) {
    if (!sights.drawn(f))
      return;
    if (std::optional<FaceView> found = view_of(f, sights, number, options.facing_power))
      filmed.views[f].push_back(std::move(*found));
  });
}

float worth(const FaceView &view) {
  constexpr float kOff = 30;  // of 255: so far off in its surroundings, a view shows something else
  constexpr float kSlip = 25; // of 255: so unlike the others, it is of another place
  return view.quality * std::exp(-view.level.squaredNorm() / (kOff * kOff) - view.slip * view.slip / (kSlip * kSlip));
}

void find_insides(FilmedFaces &filmed, const std::vector<std::uint8_t> &valid, const Context &context) {
  constexpr double kBand = 0.02; // m
  const Mesh &mesh = filmed.mesh;
  const int cameras = static_cast<int>(filmed.cameras.size());
  const auto neighbours = vertex_neighbours(mesh.faces, static_cast<int>(mesh.vertices.rows()));
  for (FilmedFrame &frame : filmed.frames)
    frame.inside.resize(filmed.cameras.size());
  parallel_for(context, cameras * static_cast<int>(filmed.frames.size()), [&](int i) {
    const int number = i / cameras, camera = i % cameras;
    const auto shows = [&](int f) {
      const FaceView *view = filmed.view(f, number);
      return view &&
             std::any_of(view->seen.begin(), view->seen.end(), [&](const SeenPoints &seen) { return seen.camera == camera; });
    };
    std::vector<int> border;
    for (int f = 0; f < mesh.faces.rows(); ++f)
      if ((valid.empty() || valid[f]) && !shows(f))
        border.insert(border.end(), {mesh.faces(f, 0), mesh.faces(f, 1), mesh.faces(f, 2)});
    filmed.frames[number].inside[camera] =
        (edge_distances(mesh.vertices, neighbours, border, kBand) / kBand).cwiseMin(1).cast<float>();
  });
}

void divide_light(FilmedFaces &filmed, const Context &context) {
  const Irradiance light = estimate_irradiance(shaded_points(filmed));
  parallel_for(context, static_cast<int>(filmed.frames.size()), [&](int t) {
    FilmedFrame &frame = filmed.frames[t];
    frame.gains.resize(frame.normals.rows(), 3);
    for (Eigen::Index v = 0; v < frame.gains.rows(); ++v)
      frame.gains.row(v) = light.at(frame.normals.row(v)).array().pow(-1 / kGamma).cast<float>().transpose();
  });
  parallel_for(context, static_cast<int>(filmed.views.size()), [&](int f) {
    for (FaceView &view : filmed.views[f]) {
      const FilmedFrame &frame = filmed.frames[view.frame];
      view.colour = within_white(view.colour.cwiseProduct(frame.gain(filmed.mesh.faces, f, kMiddle)));
    }
  });
}

void find_levels(FilmedFaces &filmed, const Context &context) {
  constexpr int kPasses = 4; // what frames agree on depends on their levels: light that only one shows is spread so far
  const std::size_t count = filmed.views.size();
  filmed.colour.assign(count, Vector3f::Constant(128));
  filmed.known.assign(count, 0);
  const auto faces = faces_of_frames(filmed);
  for (int pass = 0; pass < kPasses; ++pass) {
    parallel_for(context, static_cast<int>(count), [&](int f) {
      if (filmed.views[f].empty())
        return;
      filmed.colour[f] = agreed_colour(filmed.views[f]);
      filmed.known[f] = 1;
    });
    parallel_for(context, static_cast<int>(faces.size()), [&](int frame) { find_levels_of(filmed, faces[frame]); });
  }
  parallel_for(context, static_cast<int>(faces.size()), [&](int frame) { find_slips_of(filmed, faces[frame]); });
  fill_unknown(filmed);
}

} // namespace doublet::detail
