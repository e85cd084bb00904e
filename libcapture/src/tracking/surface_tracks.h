#pragma once
// Texture features with their places on the surface.

#include "feature_map.h"
#include "take_measurements.h"

#include <vector>

namespace doublet::detail {

/// Those that the frame before shows on the surface that was tracked there, and those of the map of the start.
class SurfaceTracks {
public:
  SurfaceTracks(const TrackingJob &job, const TrackingOrder &order, const TakeMeasurements &measured, CaptureSummary &summary);

  /// Features seen at the frame before t, lifted onto the surface there: what find() begins with.
  void lift(int t);
  /// The lifted ones, and the mapped ones around where this pose (D) with `offset` (V, 3) would put them.
  std::vector<SurfaceTrack> find(const Eigen::VectorXd &dofs, const Vertices &offset, int t);
  /// Of what find() has found, what the map has; kept for the second pass by remember().
  std::vector<SurfaceTrack> mapped(const std::vector<SurfaceTrack> &found) const;
  void remember(int t, std::vector<SurfaceTrack> mapped) { mapped_[t] = std::move(mapped); }

  /// The surface that was tracked at the frame at hand; returns the mean overlap of its silhouettes with the masks.
  double take(const Vertices &surface, const ViewTiming &timing);
  /// Features of the frame at hand, posed by `blend`, become the map.
  void map(const Transforms &blend);
  const Vertices &surface() const { return surface_; }
  const std::vector<FaceBuffer> &visible() const { return visible_; } ///< [cameras] of that surface
  void go_back_to(Vertices surface, std::vector<FaceBuffer> visible);

private:
  const TrackingJob &job_;
  const TrackingOrder &order_;
  const TakeMeasurements &measured_;
  CaptureSummary &summary_;
  FeatureMap map_;
  std::vector<SurfaceTrack> lifted_;
  std::vector<std::vector<SurfaceTrack>> mapped_; // by frame index: features that the map has found
  Vertices surface_;
  ViewTiming timing_; // of that surface
  std::vector<FaceBuffer> visible_;
};

} // namespace doublet::detail
