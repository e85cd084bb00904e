#include "caught_cloth.h"

#include "doublet/core/context.h"
#include "doublet/core/parts/self_intersection.h"

#include <algorithm>
#include <numeric>

namespace doublet::detail {
namespace {

constexpr double kFewCrossing = 0.005;        // a share of the cloth's faces that may stay
constexpr double kAllKnotted = 0.15;          // share of the edges
constexpr double kProxyThrough = kAllKnotted; // as bad
constexpr std::size_t kWatched = 64;          // edges of a region

/// Does the segment pass through any of the surfaces?
bool through_any(const Eigen::Vector3d &p, const Eigen::Vector3d &q, const std::vector<Mesh> &surfaces) {
  return std::any_of(surfaces.begin(), surfaces.end(), [&](const Mesh &surface) { return crosses_surface(p, q, surface); });
}

} // namespace

CaughtCloth::CaughtCloth(const Character &character, const CharacterSimulator &simulator)
    : skeleton_(character.actor.skeleton), simulator_(simulator) {
  std::vector<Mesh> scan; // [region] in its pose
  for (const ClothRegion &region : simulator.regions()) {
    const std::vector<Eigen::Vector2i> all = edge_topology(region.model->faces()).edges;
    edges_.emplace_back();
    for (std::size_t i = 0; i < kWatched; ++i)
      edges_.back().push_back(all[i * all.size() / kWatched]);
    scan.push_back({character.actor.mesh.vertices(region.vertex_from_cloth, Eigen::all), region.model->faces()});
  }
  for (int j = 0; j < skeleton_.joint_count(); ++j)
    if (const int parent = skeleton_.joints[j].parent;
        parent >= 0 && !through_any(skeleton_.joints[parent].rest, skeleton_.joints[j].rest, scan))
      bones_.push_back(j);
}

bool CaughtCloth::is_caught(const CharacterState &cloth, const PosedFrame &posed, std::vector<Mesh> &surfaces) const {
  surfaces.resize(cloth.regions.size());
  int knotted = 0, all = 0;
  for (std::size_t r = 0; r < surfaces.size(); ++r) {
    surfaces[r].vertices = cloth.regions[r].positions;
    if (surfaces[r].faces.rows() == 0)
      surfaces[r].faces = simulator_.regions()[r].model->faces();
    knotted += crossing_edges(surfaces[r], edges_[r]);
    all += static_cast<int>(edges_[r].size());
  }
  if (static_cast<double>(knotted) / std::max(all, 1) > kAllKnotted)
    return true;
  const auto place = [&](int joint) { return posed.world_from_rest[joint] * skeleton_.joints[joint].rest; };
  return std::any_of(bones_.begin(), bones_.end(),
                     [&](int joint) { return through_any(place(skeleton_.joints[joint].parent), place(joint), surfaces); });
}

double CaughtCloth::faults_of(const CharacterState &cloth, const PosedFrame &posed) const {
  Context context;
  context.threads = 1;
  double faults = 0;
  for (std::size_t r = 0; r < cloth.regions.size(); ++r) {
    const Mesh mesh{cloth.regions[r].positions, simulator_.regions()[r].model->faces()};
    const std::vector<std::uint8_t> crossing = self_intersecting_faces(mesh, context);
    const double share = std::accumulate(crossing.begin(), crossing.end(), 0.0) / static_cast<double>(crossing.size());
    faults += share > kFewCrossing ? share : 0;
    faults +=
        kProxyThrough * static_cast<double>(std::count_if(posed.capsules.begin(), posed.capsules.end(),
                                                          [&](const Capsule &c) { return crosses_surface(c.p0, c.p1, mesh); }));
  }
  return faults;
}

} // namespace doublet::detail
