#include "captured_shape.h"

#include <algorithm>
#include <cmath>

namespace doublet::fit {
namespace {

constexpr int kEveryVertex = 7; // about 15 cm of a garment of 1400 vertices; rings of vertices are seldom a multiple of it

/// At the middle of the points (N, 3), mean over the cameras in front of which it is.
double pixels_per_metre(const std::vector<CoarseCamera> &cameras, const Vertices &points) {
  const Eigen::Vector3d middle = points.colwise().mean().transpose();
  double sum = 0;
  int count = 0;
  for (const CoarseCamera &coarse : cameras)
    if (const double depth = coarse.camera.depth(middle); depth > 0.05) {
      sum += 0.5 * (coarse.camera.K(0, 0) + coarse.camera.K(1, 1)) / depth;
      ++count;
    }
  return count > 0 ? sum / count : 0;
}

} // namespace

std::vector<int> probes_of(const ClothTopology &topology) {
  std::vector<int> probes;
  int cloth = 0;
  for (int v = 0; v < topology.vertex_count(); ++v)
    if (topology.region[v] >= 0 && cloth++ % kEveryVertex == 0)
      probes.push_back(v);
  return probes;
}

CapturedShape::CapturedShape(const CharacterSimulator &simulator, const ClothTopology &topology,
                             const std::vector<CoarseCamera> &cameras, const Vertices &surface)
    : pixels_per_metre_(pixels_per_metre(cameras, surface)) {
  const Mesh mesh{surface, simulator.actor().mesh.faces};
  const std::vector<int> region_of = topology.region_of_faces();
  for (int r = 0; r < static_cast<int>(simulator.regions().size()); ++r) {
    std::vector<std::uint8_t> faces;
    for (const int region : region_of)
      faces.push_back(region == r);
    scenes_.emplace_back();
    if (std::find(faces.begin(), faces.end(), 1) != faces.end())
      scenes_.back().emplace(mesh, faces);
  }
}

double CapturedShape::squared_distance(int region, const Eigen::Vector3d &point) const {
  return std::pow(pixels_per_metre_ * scenes_[region]->closest(point).distance, 2);
}

} // namespace doublet::fit
