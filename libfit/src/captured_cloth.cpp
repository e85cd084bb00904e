#include "captured_cloth.h"

#include "doublet/core/rasterizer.h"
#include "doublet/fit/parts/distance_field.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace doublet::fit {
namespace {

constexpr int kRest = ClothTopology::kNoCloth, kBackground = -2; // beside the numbers of the regions

/// What is seen at each coarse pixel: a region, kRest or kBackground.
std::vector<int> seen_regions(const RiggedMesh &actor, const ClothTopology &topology, const CoarseCamera &camera,
                              const Vertices &surface, const CoarseBuffer &others) {
  const FaceBuffer buffer =
      rasterize(surface, actor.mesh.faces, camera.camera.resized(camera.width, camera.height), actor.face_valid);
  const std::vector<int> region_of = topology.region_of_faces();
  std::vector<int> result(buffer.face.size(), kBackground);
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const int face = buffer.face_at(x, y);
      const float in_front = others.at(x, y);
      int &seen = result[static_cast<std::size_t>(y) * camera.width + x];
      if (in_front > 0)
        seen = kRest;
      if (face >= 0 && !(in_front > 1.f / buffer.depth_at(x, y)))
        seen = region_of[face];
    }
  return result;
}

/// (height, width) 1 = not background, but with background beside it.
std::vector<std::uint8_t> outline_of(const std::vector<int> &seen, int width, int height) {
  std::vector<std::uint8_t> result(seen.size(), 0);
  for (int y = 1; y + 1 < height; ++y)
    for (int x = 1; x + 1 < width; ++x) {
      const int *p = &seen[static_cast<std::size_t>(y) * width + x];
      const bool beside = p[-1] == kBackground || p[1] == kBackground || p[-width] == kBackground || p[width] == kBackground;
      result[static_cast<std::size_t>(y) * width + x] = *p != kBackground && beside;
    }
  return result;
}

} // namespace

void place_surface(const ClothTopology &topology, const Vertices &surface, ClothView &view) {
  float *to = view.positions().data();
  const int lanes = view.lanes();
  for (int v = 0; v < topology.vertex_count(); ++v)
    for (int k = 0; k < 3; ++k, to += lanes)
      std::fill_n(to, lanes, static_cast<float>(surface(topology.vertices[v], k)));
}

/// A feature costs no more than feature_cap, so that a mismatch cannot rule. One that the captured cloth carries to within
/// feature_cap of where it is seen is no mismatch: if it moves further than that, it may cost what standing still would, and half
/// the cap more, so that moving the wrong way is worse than not moving.
CapturedFeatures CapturedCloth::features(const CoarseCamera &camera, const Vertices &before, const CoarseBuffer &others,
                                         const Vertices &now, const std::vector<FeatureMatch> &matches) {
  LocatedFeatures located;
  place_surface(*topology_, before, view_);
  view_.set_camera(camera);
  view_.locate(matches, others, located);
  place_surface(*topology_, now, view_);
  const std::vector<float> unlimited(located.count, std::numeric_limits<float>::max());
  const std::vector<float> &residual = view_.squared_errors(located, unlimited);
  const float cap = static_cast<float>(options_->feature_cap) * larger_side(camera.camera);
  const int lanes = view_.lanes();
  CapturedFeatures result;
  for (int i = 0; i < located.count; ++i) {
    const int at = i * lanes, face = located.face[at];
    if (face < 0 && options_->fixed_correspondences)
      continue;
    const FeatureMatch &match = matches[located.match[i]];
    const bool confirmed = face >= 0 && residual[at] <= cap * cap;
    const float moved = confirmed && options_->speed_dependent_cap ? (match.current - match.previous).norm() + cap / 2 : 0.f;
    result.matches.push_back(match);
    result.face.push_back(face);
    for (int k = 0; k < 3; ++k)
      result.weight.push_back(located.weight[3 * at + k * lanes]);
    result.largest.push_back(std::pow(std::max(cap, moved), 2.f));
  }
  return result;
}

/// Measured contour that lies closer to the outline of the captured cloth than to that of the rest of the character, and no
/// further from it than the longest rim distance: one point a coarse pixel.
CapturedContour CapturedCloth::contour(const CoarseCamera &camera, const Vertices &surface, const CoarseBuffer &others,
                                       const std::vector<Eigen::Vector2f> &measured) const {
  const int width = camera.width, height = camera.height;
  const std::vector<int> seen = seen_regions(simulator_->actor(), *topology_, camera, surface, others);
  const std::vector<int> nearest = nearest_seed(width, height, outline_of(seen, width, height));
  const double farthest = options_->rim_cap * std::max(width, height);
  std::vector<std::uint8_t> taken(seen.size(), 0);
  std::vector<std::vector<Eigen::Vector2f>> points(region_count());
  for (const Eigen::Vector2f &point : measured) {
    const int x = std::clamp(static_cast<int>(std::lround(camera.coarse_x(point.x()))), 0, width - 1);
    const int y = std::clamp(static_cast<int>(std::lround(camera.coarse_y(point.y()))), 0, height - 1);
    const std::size_t pixel = static_cast<std::size_t>(y) * width + x;
    const int rim = nearest[pixel];
    if (taken[pixel] || rim < 0 || seen[rim] < 0 || std::hypot(rim % width - x, rim / width - y) > farthest)
      continue;
    taken[pixel] = 1;
    points[seen[rim]].push_back(point);
  }
  CapturedContour result;
  for (const std::vector<Eigen::Vector2f> &region : points) {
    result.first.push_back(result.count());
    for (const Eigen::Vector2f &point : region)
      result.x.push_back(point.x()), result.y.push_back(point.y());
  }
  result.first.push_back(result.count());
  return result;
}

std::vector<std::uint8_t> CapturedCloth::rims(const CoarseCamera &camera, const Vertices &surface, const CoarseBuffer &others) {
  place_surface(*topology_, surface, view_);
  view_.set_camera(camera);
  std::vector<Rim> found;
  view_.outline(others, found);
  std::vector<std::uint8_t> result(region_count(), 0);
  for (const Rim &rim : found)
    result[topology_->region[rim.vertex]] = 1;
  return result;
}

} // namespace doublet::fit
