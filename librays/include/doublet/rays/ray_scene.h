#pragma once
// Rays and closest points against one mesh (Embree behind it).

#include "doublet/core/mesh.h"

#include <memory>
#include <optional>

namespace doublet {

struct RayHit {
  int face = -1;
  double distance = 0;         ///< m along the unit direction
  Eigen::Vector3d barycentric; ///< of the face's three corners, sums to one
};

struct ClosestPoint {
  int face = -1;
  Eigen::Vector3d point;       ///< m
  Eigen::Vector3d barycentric; ///< of the face's three corners
  double distance = 0;         ///< m, unsigned
};

/// Immutable and thread-safe; copies share one scene. Calls throw std::invalid_argument for NaN and values beyond 1e18.
class RayScene {
public:
  /// Faces with face_valid[f] == 0 are ignored (empty = all are valid). Throws Error if the mesh is not usable(), extends beyond
  /// 1e18 m, or has no valid face.
  explicit RayScene(const Mesh &mesh, const Mask &face_valid = {});
  /// First hit of origin + s * direction (unit), s in (min_distance, max_distance).
  std::optional<RayHit> cast(const Eigen::Vector3d &origin, const Eigen::Vector3d &direction, double min_distance = 0,
                             double max_distance = 1e30) const;
  bool occluded(const Eigen::Vector3d &from, const Eigen::Vector3d &to, double margin = 1e-4) const;
  ClosestPoint closest(const Eigen::Vector3d &point) const;

private:
  struct Impl;
  std::shared_ptr<const Impl> impl_;
};

} // namespace doublet
