#pragma once
// What the captured cloth shows: the features that lie on it and the part of the measured contour that is its outline. Decided
// once, so that every sample is compared with the same.

#include "cloth_view.h"
#include "doublet/fit/material_objective.h"

namespace doublet::fit {

/// Features of one camera that are matched from one frame to the next, and where the captured cloth has them.
struct CapturedFeatures {
  std::vector<FeatureMatch> matches;
  std::vector<int> face;      ///< [matches] of the captured cloth under it in the earlier frame, -1 = none
  std::vector<float> weight;  ///< [matches][3] of the corners, sum not 1
  std::vector<float> largest; ///< [matches] what it costs at most, pixels^2
  int count() const { return static_cast<int>(matches.size()); }
  std::size_t bytes() const { return matches.size() * (sizeof(FeatureMatch) + sizeof(int) + 4 * sizeof(float)); }
};

/// Measured contour that is the outline of the captured cloth, about one point a coarse pixel.
struct CapturedContour {
  std::vector<float> x, y; ///< pixels, sorted by region
  std::vector<int> first;  ///< [R + 1] the first point of each region
  int count() const { return static_cast<int>(x.size()); }
  std::size_t bytes() const { return x.size() * 2 * sizeof(float) + first.size() * sizeof(int); }
};

/// What one camera shows of the captured cloth at one frame.
struct CapturedView {
  CapturedFeatures features; ///< matched from the frame before
  CapturedContour contour;
  std::vector<std::uint8_t> rims; ///< [R] 1 = there is a rim of the region in it
};

/// The cloth's part of a whole surface (V, 3) into every lane of the view.
void place_surface(const ClothTopology &topology, const Vertices &surface, ClothView &view);

/// The captured cloth in front of a camera. `others`: what is not cloth, in the same frame.
class CapturedCloth {
public:
  CapturedCloth(const CharacterSimulator &simulator, const ClothTopology &topology, const EnergyOptions &options)
      : simulator_(&simulator), topology_(&topology), options_(&options), view_(topology, 1) {}
  /// before, now (V, 3): captured in the frames from which and to which the matches go. With fixed_correspondences, those that
  /// lie on the captured cloth alone.
  CapturedFeatures features(const CoarseCamera &camera, const Vertices &before, const CoarseBuffer &others, const Vertices &now,
                            const std::vector<FeatureMatch> &matches);
  /// [R]
  std::vector<std::uint8_t> rims(const CoarseCamera &camera, const Vertices &surface, const CoarseBuffer &others);
  CapturedContour contour(const CoarseCamera &camera, const Vertices &surface, const CoarseBuffer &others,
                          const std::vector<Eigen::Vector2f> &measured) const;

private:
  int region_count() const { return static_cast<int>(simulator_->regions().size()); }

  const CharacterSimulator *simulator_;
  const ClothTopology *topology_;
  const EnergyOptions *options_;
  ClothView view_;
};

} // namespace doublet::fit
