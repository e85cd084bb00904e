#include "surface_patches.h"

#include "doublet/core/parts/connected_sets.h"
#include "doublet/core/parts/edge_distances.h"
#include "doublet/core/parts/invalid_faces.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <stdexcept>
#include <string>

namespace doublet::detail {
namespace {

/// (V) which connected set of invalid faces a vertex touches, -1 = none.
Eigen::VectorXi holes(const Faces &faces, const std::vector<std::uint8_t> &face_valid, int vertex_count) {
  std::vector<std::uint8_t> invalid;
  std::transform(face_valid.begin(), face_valid.end(), std::back_inserter(invalid), std::logical_not<>());
  int count = 0;
  return invalid.empty() ? Eigen::VectorXi::Constant(vertex_count, -1)
                         : vertex_components(valid_faces(faces, invalid), vertex_count, &count);
}

/// Cloth that `patches` leave out joins the nearest of them along the cloth.
void share_out(const Surface &surface, const std::vector<char> &cloth, std::vector<Patch> &patches) {
  std::vector<std::vector<int>> ways = surface.neighbours;
  for (std::vector<int> &around : ways)
    std::erase_if(around, [&](int v) { return !cloth[v]; });
  Eigen::VectorXd nearest = Eigen::VectorXd::Constant(surface.size(), std::numeric_limits<double>::infinity());
  std::vector<int> owner(surface.size(), -1);
  for (std::size_t p = 0; p < patches.size(); ++p) {
    const Eigen::VectorXd way = edge_distances(surface.vertices, ways, patches[p].members);
    for (int i = 0; i < surface.size(); ++i)
      if (way[i] < nearest[i]) {
        nearest[i] = way[i];
        owner[i] = static_cast<int>(p);
      }
  }
  for (int i = 0; i < surface.size(); ++i)
    if (owner[i] >= 0 && nearest[i] > 0) {
      patches[owner[i]].members.push_back(i);
      patches[owner[i]].area += surface.areas[i];
    }
}

} // namespace

Surface surface_of(const Mesh &pose, const std::vector<std::uint8_t> &face_valid) {
  const int n = static_cast<int>(pose.vertices.rows());
  if (!face_valid.empty() && static_cast<long>(face_valid.size()) != pose.faces.rows())
    throw std::invalid_argument("face_valid: expected " + std::to_string(pose.faces.rows()) + " entries, one per face, found " +
                                std::to_string(face_valid.size()));
  const std::vector<std::uint8_t> scanned = extend_invalid_faces(pose, face_valid);
  const Faces faces = valid_faces(pose.faces, scanned);
  const Eigen::VectorXi hole = holes(pose.faces, scanned, n);
  std::vector<char> seam(n);
  std::transform(hole.begin(), hole.end(), seam.begin(), [](int h) { return h >= 0; });
  return {pose.vertices, faces, vertex_areas(pose.vertices, faces), vertex_neighbours(faces, n), std::move(seam), hole};
}

std::vector<Patch> connected_patches(const Surface &surface, const std::vector<char> &chosen) {
  std::vector<Patch> patches;
  for (std::vector<int> &members : connected_sets(surface.neighbours, chosen)) {
    const double area = surface.areas(members).sum();
    patches.push_back({std::move(members), area});
  }
  std::stable_sort(patches.begin(), patches.end(), [](const Patch &a, const Patch &b) { return a.area > b.area; });
  return patches;
}

void merge_small(const Surface &surface, const std::vector<char> &member, double smallest, std::vector<char> &kinds) {
  for (char kind : {0, 1}) {
    const auto borders = [&](int v) {
      return std::any_of(surface.neighbours[v].begin(), surface.neighbours[v].end(),
                         [&](int w) { return member[w] && kinds[w] != kind; });
    };
    for (const Patch &patch : connected_patches(surface, choose(surface, [&](int v) { return member[v] && kinds[v] == kind; })))
      if (patch.area < smallest && std::any_of(patch.members.begin(), patch.members.end(), borders))
        for (int v : patch.members)
          kinds[v] = static_cast<char>(1 - kind);
  }
}

Eigen::VectorXd snapped(const Eigen::VectorXd &values) {
  constexpr double kSnap = 0.05;
  return values.unaryExpr(
      [](double value) { return std::isfinite(value) ? std::clamp((value - kSnap) / (1 - 2 * kSnap), 0.0, 1.0) : 0.0; });
}

std::vector<char> borders_of_regions(const Surface &surface, const Segmentation &segmentation) {
  const Eigen::VectorXi &region = segmentation.region;
  return choose(surface, [&](int v) {
    return region[v] >= 0 && std::any_of(surface.neighbours[v].begin(), surface.neighbours[v].end(),
                                         [&](int w) { return region[w] >= 0 && region[w] != region[v]; });
  });
}

void label_regions(const Surface &surface, const std::vector<char> &parting, Segmentation &result, double smallest) {
  const std::vector<char> cloth = choose(surface, [&](int i) { return result.clothness[i] > 0; });
  std::vector<char> inner = cloth;
  for (std::size_t i = 0; i < parting.size(); ++i)
    inner[i] = inner[i] && !parting[i];
  std::vector<Patch> patches = connected_patches(surface, inner);
  const auto cut_off = [&](int v) {
    return std::any_of(surface.neighbours[v].begin(), surface.neighbours[v].end(), [&](int w) { return cloth[w] && !inner[w]; });
  };
  const auto crumb = [&](const Patch &patch) {
    return patch.area < smallest && std::any_of(patch.members.begin(), patch.members.end(), cut_off);
  };
  if (!patches.empty()) // the largest stays
    patches.erase(std::remove_if(patches.begin() + 1, patches.end(), crumb), patches.end());
  share_out(surface, cloth, patches);
  std::stable_sort(patches.begin(), patches.end(), [](const Patch &a, const Patch &b) { return a.area > b.area; });
  result.region = Eigen::VectorXi::Constant(surface.size(), -1);
  result.region_count = static_cast<int>(patches.size());
  for (int r = 0; r < result.region_count; ++r)
    for (int i : patches[r].members)
      result.region[i] = r;
  for (int i = 0; i < surface.size(); ++i)
    if (result.region[i] < 0) // a patch of parting vertices alone belongs to nothing
      result.clothness[i] = 0;
}

} // namespace doublet::detail
