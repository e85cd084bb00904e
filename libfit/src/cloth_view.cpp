#include "cloth_view.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <utility>

namespace doublet::fit {
namespace {

constexpr int kViewMargin = 2;  // coarse pixels around the cloth, so that the background beside the outline is there to be seen
constexpr int kGridCells = 128; // along the larger side of an image
/// What is not cloth hides it only from this far in front, m: coarse depths are those of pixel centres, and the cloth lies on the
/// body.
constexpr float kInFront = 0.01f;

using HalfEdge = std::pair<int, int>;

int floor_int(float value) {
  const int whole = static_cast<int>(value);
  return whole - (value < static_cast<float>(whole));
}
int ceil_int(float value) {
  return -floor_int(-value);
}
float set_back(float inverse_depth) {
  return inverse_depth / (1.f + kInFront * inverse_depth);
}

Lens lens_of(const Camera &camera) {
  Lens lens{};
  for (int i = 0; i < 9; ++i)
    lens.R[i] = static_cast<float>(camera.R(i / 3, i % 3));
  for (int i = 0; i < 3; ++i)
    lens.t[i] = static_cast<float>(camera.t[i]);
  for (int i = 0; i < 5; ++i)
    lens.k[i] = static_cast<float>(camera.distortion[i]);
  lens.fx = static_cast<float>(camera.K(0, 0)), lens.skew = static_cast<float>(camera.K(0, 1));
  lens.cx = static_cast<float>(camera.K(0, 2));
  lens.fy = static_cast<float>(camera.K(1, 1)), lens.cy = static_cast<float>(camera.K(1, 2));
  lens.distorted = camera.distorted();
  return lens;
}

/// (V) the region in which a vertex is free, -1 = none, and its row there.
std::vector<std::pair<int, int>> free_places(const CharacterSimulator &simulator) {
  std::vector<std::pair<int, int>> result(simulator.actor().mesh.vertices.rows(), {-1, -1});
  for (std::size_t r = 0; r < simulator.regions().size(); ++r) {
    const ClothRegion &region = simulator.regions()[r];
    for (std::size_t i = 0; i < region.vertex_from_cloth.size(); ++i)
      if (region.model->inverse_masses()[static_cast<Eigen::Index>(i)] > 0)
        result[region.vertex_from_cloth[i]] = {static_cast<int>(r), static_cast<int>(i)};
  }
  return result;
}

/// Pairs of half-edges that run against each other, and the others alone. `valid`: half-edges of the valid faces of M, by its
/// vertices.
std::vector<ClothEdge> cloth_edges(const ClothTopology &topology, const std::map<HalfEdge, int> &valid) {
  std::map<HalfEdge, int> open; // its face
  std::vector<ClothEdge> edges;
  const auto alone = [&](HalfEdge edge, int face) {
    const HalfEdge twin{topology.vertices[edge.second], topology.vertices[edge.first]};
    edges.push_back({edge.first, edge.second, face, -1, valid.count(twin) == 0});
  };
  for (int f = 0; f < topology.face_count(); ++f)
    for (int k = 0; k < 3; ++k) {
      const HalfEdge edge{topology.corners[3 * f + k], topology.corners[3 * f + (k + 1) % 3]};
      if (const auto twin = open.find({edge.second, edge.first}); twin != open.end()) {
        edges.push_back({edge.second, edge.first, twin->second, f, false});
        open.erase(twin);
      } else if (!open.emplace(edge, f).second) {
        alone(edge, f);
      }
    }
  for (const auto &[edge, face] : open)
    alone(edge, face);
  return edges;
}

const LaneKernels *fastest_kernels(int samples) {
  const int width = samples <= 4 ? 0 : samples <= 8 ? 1 : 2;
#ifdef __x86_64__
  if (__builtin_cpu_supports("avx512f") && avx512_kernels(width))
    return avx512_kernels(width);
  if (__builtin_cpu_supports("avx2") && avx2_kernels(width))
    return avx2_kernels(width);
#endif
  return baseline_kernels(width);
}

} // namespace

int lanes_for(int samples) {
  return fastest_kernels(samples)->lanes;
}

std::vector<int> ClothTopology::region_of_faces() const {
  std::vector<int> result(face_is_cloth.size(), kNoCloth);
  std::size_t next = 0; // the faces of the cloth are in the order of M
  for (std::size_t f = 0; f < result.size(); ++f)
    if (face_is_cloth[f])
      result[f] = face_region[next++];
  return result;
}

ClothTopology cloth_topology(const CharacterSimulator &simulator) {
  const RiggedMesh &actor = simulator.actor();
  const Faces &faces = actor.mesh.faces;
  const std::vector<std::pair<int, int>> places = free_places(simulator);
  ClothTopology result;
  result.face_is_cloth.assign(faces.rows(), 0);
  std::vector<int> local(actor.mesh.vertices.rows(), -1);
  std::map<HalfEdge, int> valid;
  for (int f = 0; f < faces.rows(); ++f) {
    if (!actor.face_valid[f])
      continue;
    int region = -1;
    for (int k = 0; k < 3; ++k) {
      ++valid[{faces(f, k), faces(f, (k + 1) % 3)}];
      region = std::max(region, places[faces(f, k)].first);
    }
    if (region < 0)
      continue;
    result.face_is_cloth[f] = 1;
    result.face_region.push_back(region);
    for (int k = 0; k < 3; ++k) {
      const int v = faces(f, k);
      if (local[v] < 0) {
        local[v] = result.vertex_count();
        result.vertices.push_back(v);
        result.region.push_back(places[v].first);
        result.row.push_back(places[v].second);
      }
      result.corners.push_back(local[v]);
    }
  }
  result.edges = cloth_edges(result, valid);
  return result;
}

CoarseCamera::CoarseCamera(const Camera &c, int larger_side) : camera(c), lens(lens_of(c)) {
  const double factor = std::min(1.0, larger_side / static_cast<double>(std::max(c.width, c.height)));
  width = std::max(1, static_cast<int>(std::lround(c.width * factor)));
  height = std::max(1, static_cast<int>(std::lround(c.height * factor)));
  scale_x = static_cast<float>(width) / static_cast<float>(c.width);
  scale_y = static_cast<float>(height) / static_cast<float>(c.height);
}

ClothView::ClothView(const ClothTopology &topology, int samples, const LaneKernels *kernels)
    : topology_(&topology), samples_(samples), kernels_(kernels ? kernels : fastest_kernels(samples)) {
  const std::size_t size = static_cast<std::size_t>(topology.vertex_count()) * 3 * lanes();
  positions_.resize(size);
  image_.resize(size);
  facing_.assign(static_cast<std::size_t>(topology.face_count() + 1) * lanes(), 0);
  rim_.resize(topology.vertex_count());
}

void ClothView::set_camera(const CoarseCamera &camera) {
  camera_ = &camera;
  kernels_->project(camera.lens, topology_->vertex_count(), positions_.data(), image_.data(), box_.data());
  kernels_->turn(topology_->face_count(), topology_->corners.data(), image_.data(), facing_.data());
}

/// False if there is no cloth in the image.
bool ClothView::coarse_box() {
  const auto [x0, y0, x1, y1] = box_;
  x0_ = std::max(-kViewMargin, floor_int(camera_->coarse_x(x0)) - kViewMargin);
  y0_ = std::max(-kViewMargin, floor_int(camera_->coarse_y(y0)) - kViewMargin);
  width_ = std::min(camera_->width + kViewMargin, ceil_int(camera_->coarse_x(x1)) + kViewMargin + 1) - x0_;
  height_ = std::min(camera_->height + kViewMargin, ceil_int(camera_->coarse_y(y1)) + kViewMargin + 1) - y0_;
  return width_ > 0 && height_ > 0;
}

/// The number of layers changes by `layers` from above the edge to below it, where it runs to the right, and by as many back
/// where it runs to the left. A column belongs to one of two edges that meet in it.
void ClothView::add_edge(const ClothEdge &edge, int lane, int layers) {
  const float *a = &image_[(static_cast<std::size_t>(edge.a) * 3) * lanes() + lane];
  const float *b = &image_[(static_cast<std::size_t>(edge.b) * 3) * lanes() + lane];
  float ax = camera_->coarse_x(a[0]), ay = camera_->coarse_y(a[lanes()]);
  float bx = camera_->coarse_x(b[0]), by = camera_->coarse_y(b[lanes()]);
  if (ax > bx) {
    std::swap(ax, bx), std::swap(ay, by);
    layers = -layers;
  }
  const int first = std::max(x0_, floor_int(ax) + 1), last = std::min(x0_ + width_ - 1, floor_int(bx));
  if (first > last)
    return;
  const float slope = (by - ay) / (bx - ax);
  std::uint8_t *buffer = &layers_[static_cast<std::size_t>(lane) * width_ * height_];
  for (int x = first; x <= last; ++x) {
    const int y = std::max(y0_, ceil_int(ay + (static_cast<float>(x) - ax) * slope));
    if (y < y0_ + height_)
      buffer[(y - y0_) * width_ + (x - x0_)] += static_cast<std::uint8_t>(layers);
  }
}

/// How many faces lie over a pixel: only folds (where a front face meets a back face) and borders change it, so they are all that
/// is drawn, and each column is summed up from above. (Appel 1967, "The notion of quantitative invisibility", has the idea.)
void ClothView::count_layers() {
  layers_.assign(static_cast<std::size_t>(samples_) * width_ * height_, 0);
  rim_edges_.clear();
  constexpr int kWord = 4; // lanes compared at once
  for (const ClothEdge &edge : topology_->edges) {
    const signed char *left = &facing_[static_cast<std::size_t>(edge.left) * lanes()];
    const signed char *right =
        &facing_[static_cast<std::size_t>(edge.right < 0 ? topology_->face_count() : edge.right) * lanes()];
    for (int word = 0; word < lanes(); word += kWord) {
      if (std::memcmp(left + word, right + word, kWord) == 0)
        continue;
      for (int lane = word; lane < std::min(word + kWord, samples_); ++lane) {
        const int layers = left[lane] - right[lane];
        if (layers == 0)
          continue;
        add_edge(edge, lane, layers);
        if (edge.right >= 0 || edge.hem)
          rim_edges_.push_back({edge.a, edge.b, lane, edge.left, layers > 0});
      }
    }
  }
  for (int lane = 0; lane < samples_; ++lane) {
    std::uint8_t *above = &layers_[static_cast<std::size_t>(lane) * width_ * height_];
    for (int y = 1; y < height_; ++y, above += width_)
      for (int x = 0; x < width_; ++x)
        above[width_ + x] = static_cast<std::uint8_t>(above[width_ + x] + above[x]);
  }
}

void ClothView::mask_others(const CoarseBuffer &others) {
  covered_.assign(static_cast<std::size_t>(width_) * height_, 1);
  const int left = std::max(x0_, 0), right = std::min(x0_ + width_, camera_->width);
  for (int y = std::max(y0_, 0); y < std::min(y0_ + height_, camera_->height); ++y)
    for (int x = left; x < right; ++x)
      covered_[static_cast<std::size_t>(y - y0_) * width_ + (x - x0_)] = others.at(x, y) > 0;
}

/// Whether the pixel beside the middle of an edge, on the side away from the cloth, is background. It is the next one in the row
/// or column that the edge crosses more steeply.
bool ClothView::on_outline(const RimEdge &edge) const {
  const float *a = &image_[(static_cast<std::size_t>(edge.a) * 3) * lanes() + edge.lane];
  const float *b = &image_[(static_cast<std::size_t>(edge.b) * 3) * lanes() + edge.lane];
  const float ax = camera_->coarse_x(a[0]), ay = camera_->coarse_y(a[lanes()]);
  const float dx = camera_->coarse_x(b[0]) - ax, dy = camera_->coarse_y(b[lanes()]) - ay;
  const float middle_x = ax + 0.5f * dx, middle_y = ay + 0.5f * dy;
  const float out_x = edge.cloth_below ? dy : -dy, out_y = edge.cloth_below ? -dx : dx;
  int x, y;
  if (std::fabs(dx) > std::fabs(dy)) {
    x = floor_int(middle_x + 0.5f);
    const float at = middle_y + (static_cast<float>(x) - middle_x) * dy / dx;
    y = out_y > 0 ? floor_int(at) + 1 : ceil_int(at) - 1;
  } else if (dy != 0) {
    y = floor_int(middle_y + 0.5f);
    const float at = middle_x + (static_cast<float>(y) - middle_y) * dx / dy;
    x = out_x > 0 ? floor_int(at) + 1 : ceil_int(at) - 1;
  } else {
    return false;
  }
  if (x < x0_ || y < y0_ || x >= x0_ + width_ || y >= y0_ + height_)
    return false;
  const std::size_t i = static_cast<std::size_t>(y - y0_) * width_ + (x - x0_);
  return !(layers_[static_cast<std::size_t>(edge.lane) * width_ * height_ + i] | covered_[i]);
}

void ClothView::outline(const CoarseBuffer &others, std::vector<Rim> &result) {
  result.clear();
  outline_edges_.clear();
  if (!coarse_box())
    return;
  count_layers();
  mask_others(others);
  std::fill(rim_.begin(), rim_.end(), std::uint16_t{0});
  for (const RimEdge &edge : rim_edges_) {
    if (!on_outline(edge))
      continue;
    for (int v : {edge.a, edge.b})
      rim_[v] = static_cast<std::uint16_t>(rim_[v] | (1u << edge.lane));
    const float *a = &image_[static_cast<std::size_t>(edge.a) * 3 * lanes() + edge.lane];
    const float *b = &image_[static_cast<std::size_t>(edge.b) * 3 * lanes() + edge.lane];
    if (a[2 * lanes()] > 0 && b[2 * lanes()] > 0) // both can be drawn
      outline_edges_.push_back({edge.lane, topology_->face_region[edge.face], {a[0], a[lanes()], b[0], b[lanes()]}});
  }
  const float right = static_cast<float>(camera_->camera.width - 1), bottom = static_cast<float>(camera_->camera.height - 1);
  for (int v = 0; v < topology_->vertex_count(); ++v) {
    if (rim_[v] == 0 || topology_->region[v] < 0)
      continue;
    const float *p = &image_[static_cast<std::size_t>(v) * 3 * lanes()];
    for (int lane = 0; lane < samples_; ++lane) {
      if (!(rim_[v] >> lane & 1))
        continue;
      const float x = p[lane], y = p[lanes() + lane];
      if (x < 0 || y < 0 || x > right || y > bottom)
        continue;
      const float in_front = others.at(floor_int(camera_->coarse_x(x) + 0.5f), floor_int(camera_->coarse_y(y) + 0.5f));
      if (set_back(in_front) < p[2 * lanes() + lane])
        result.push_back({lane, v, x, y});
    }
  }
}

void ClothView::approach(int region, int count, const float *x, const float *y, float largest,
                         std::vector<float> &squared) const {
  squared.assign(static_cast<std::size_t>(samples_) * count, largest);
  for (const OutlineEdge &edge : outline_edges_)
    if (edge.region == region)
      kernels_->approach(count, x, y, edge.segment, &squared[static_cast<std::size_t>(edge.lane) * count]);
}

/// Into the cells of a grid that starts at the image's corner, but has only the cells where there is cloth in any lane; the
/// others come last. Whatever the lanes, those that lie on the cloth are in the same order.
void ClothView::sort_features(const std::vector<FeatureMatch> &matches) {
  const int x0 = floor_int(box_[0]), y0 = floor_int(box_[1]), x1 = ceil_int(box_[2]), y1 = ceil_int(box_[3]);
  const int cell = std::max(1, std::max(camera_->camera.width, camera_->camera.height) / kGridCells);
  const int column = std::max(0, x0) / cell, row = std::max(0, y0) / cell;
  grid_.cell = cell;
  grid_.x0 = column * cell, grid_.y0 = row * cell;
  grid_.width = std::max(0, std::min(camera_->camera.width, x1) / cell + 1 - column);
  grid_.height = std::max(0, std::min(camera_->camera.height, y1) / cell + 1 - row);
  first_.assign(static_cast<std::size_t>(grid_.width) * grid_.height + 2, 0);
  cell_.clear();
  for (const FeatureMatch &match : matches) {
    const float x = match.previous.x() - static_cast<float>(grid_.x0), y = match.previous.y() - static_cast<float>(grid_.y0);
    const bool inside =
        x >= 0 && y >= 0 && x < static_cast<float>(grid_.width * cell) && y < static_cast<float>(grid_.height * cell);
    cell_.push_back(inside ? static_cast<int>(y) / cell * grid_.width + static_cast<int>(x) / cell : -1);
    if (inside)
      ++first_[cell_.back() + 2];
  }
  for (std::size_t i = 2; i < first_.size(); ++i)
    first_[i] += first_[i - 1];
  order_.resize(matches.size());
  int outside = first_.back();
  for (std::size_t i = 0; i < matches.size(); ++i)
    order_[cell_[i] >= 0 ? first_[cell_[i] + 1]++ : outside++] = static_cast<int>(i); // a cell ends where the next starts
  grid_.first = first_.data();
  const int pitch = grid_.width + 1;
  before_.assign(static_cast<std::size_t>(grid_.height + 1) * pitch, 0);
  for (int r = 0; r < grid_.height; ++r)
    for (int c = 0; c < grid_.width; ++c) {
      const int row_start = first_[static_cast<std::size_t>(r) * grid_.width];
      before_[static_cast<std::size_t>(r + 1) * pitch + c + 1] = before_[static_cast<std::size_t>(r) * pitch + c + 1] +
                                                                 first_[static_cast<std::size_t>(r) * grid_.width + c + 1] -
                                                                 row_start;
    }
  grid_.before = before_.data();
}

void ClothView::locate(const std::vector<FeatureMatch> &matches, const CoarseBuffer &others, LocatedFeatures &result) {
  sort_features(matches);
  result.count = static_cast<int>(order_.size());
  result.match = order_;
  const std::size_t size = static_cast<std::size_t>(result.count) * lanes();
  result.seen_x.resize(result.count), result.seen_y.resize(result.count);
  feature_x_.resize(result.count), feature_y_.resize(result.count);
  nearest_.resize(size);
  result.face.assign(size, -1);
  result.weight.assign(3 * size, 1.f);
  for (int i = 0; i < result.count; ++i) {
    const FeatureMatch &match = matches[order_[i]];
    feature_x_[i] = match.previous.x(), feature_y_[i] = match.previous.y();
    result.seen_x[i] = match.current.x(), result.seen_y[i] = match.current.y();
    const float in_front = set_back(
        others.at(floor_int(camera_->coarse_x(feature_x_[i]) + 0.5f), floor_int(camera_->coarse_y(feature_y_[i]) + 0.5f)));
    std::fill_n(&nearest_[static_cast<std::size_t>(i) * lanes()], lanes(), in_front);
  }
  grid_.x = feature_x_.data(), grid_.y = feature_y_.data();
  kernels_->locate(grid_, topology_->face_count(), topology_->corners.data(), image_.data(), facing_.data(),
                   {nearest_.data(), result.face.data(), result.weight.data()});
}

const std::vector<float> &ClothView::squared_errors(const LocatedFeatures &located, const std::vector<float> &largest) {
  squared_.resize(static_cast<std::size_t>(located.count) * lanes());
  kernels_->squared_errors(camera_->lens, located.count, located.seen_x.data(), located.seen_y.data(), topology_->corners.data(),
                           positions_.data(), located.face.data(), located.weight.data(), largest.data(), squared_.data());
  return squared_;
}

} // namespace doublet::fit
