#pragma once
// Texture features with a known place on the surface: seen in one frame, found again in every later one, so that tracking does
// not drift.

#include "doublet/capture/feature_tracker.h"
#include "doublet/capture/pose_optimizer.h"

namespace doublet {

/// tracker.match with its answer checked: trackers may come from outside. Throws Error if an index is out of range.
std::vector<std::pair<int, int>> checked_match(const FeatureTracker &tracker, const Features &previous, const Features &current,
                                               double reach);

class FeatureMap {
public:
  /// Lifts the features of one view onto `surface` (V, 3), posed by `blend`; `visible` = rasterize() of it in the camera.
  void add(const Features &features, const RiggedMesh &actor, const PosedSurface &surface, const Camera &camera,
           const FaceBuffer &visible);

  /// Finds the map's features among those of a view, `reach` pixels around where `expected` puts them, for directions of view
  /// within 40 degrees of the one they were seen from. Const calls are safe from many threads.
  std::vector<SurfaceTrack> find(const Features &features, const FeatureTracker &tracker, const RiggedMesh &actor,
                                 const PosedSurface &expected, int view, const Camera &camera, double reach) const;

  int size() const { return static_cast<int>(entries_.size()); }

private:
  struct Entry {
    SurfacePoint surface;
    Eigen::Vector3d seen_from; // unit, rest pose of the surface: from the point to the camera
    Eigen::RowVectorXd descriptor;
  };
  std::vector<Entry> entries_;
};

/// The surface point seen at a pixel; face = -1 where there is none, on invalid or overstretched faces, and where the surface is
/// seen edge-on.
SurfacePoint lift(const Eigen::Vector2d &pixel, const Vertices &surface, const RiggedMesh &actor, const Camera &camera,
                  const FaceBuffer &visible);

} // namespace doublet
