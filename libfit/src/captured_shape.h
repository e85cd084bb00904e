#pragma once
// The captured cloth as a surface in space, and how far from it the simulated cloth is.

#include "cloth_view.h"
#include "doublet/rays/ray_scene.h"

#include <optional>

namespace doublet::fit {

/// The vertices (indices into `topology.vertices`) whose distance is asked for: evenly spread, for neighbours tell the same.
std::vector<int> probes_of(const ClothTopology &topology);

/// Of one frame. Empty until it is given a surface.
class CapturedShape {
public:
  CapturedShape() = default;
  /// surface (V, 3): of the whole character, captured.
  CapturedShape(const CharacterSimulator &simulator, const ClothTopology &topology, const std::vector<CoarseCamera> &cameras,
                const Vertices &surface);
  bool has(int region) const { return region < static_cast<int>(scenes_.size()) && scenes_[region]; }
  /// From the point to the captured cloth of the region, squared; in pixels of a camera at mean distance.
  double squared_distance(int region, const Eigen::Vector3d &point) const;

private:
  std::vector<std::optional<RayScene>> scenes_; ///< [R]
  double pixels_per_metre_ = 0;
};

} // namespace doublet::fit
