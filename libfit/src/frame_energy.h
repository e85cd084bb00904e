#pragma once
// The energy of a frame (eq. 6 and 7, the measured contour and the captured surface), of a group of samples side by side, and of
// all frames (eq. 8).

#include "observed_frames.h"

#include <span>

namespace doublet::fit {

/// One sample on its way through a window.
struct Rollout {
  std::vector<pbd::Material> materials; ///< [R]
  std::vector<int> widths;              ///< [R] index of the rest shape
  CharacterState state;
  std::vector<std::uint8_t> exploded; ///< [R]
  Terms *terms = nullptr;             ///< of the sample
};

/// What measures a group of rollouts, one in each lane.
struct Measure {
  Stopwatch watch;
  ClothView view;
  std::vector<LocatedFeatures> located;    ///< [cameras]
  std::vector<std::vector<float>> largest; ///< [cameras][located features] what each costs at most, pixels^2
  std::vector<Rim> rims;
  std::vector<float> squared; ///< of contour points, pixels^2
  Measure(const ClothTopology &topology, std::size_t samples, std::size_t cameras)
      : view(topology, static_cast<int>(samples)), located(cameras), largest(cameras) {}
};

class FrameEnergy {
public:
  explicit FrameEnergy(const ObservedFrames &frames) : observed_(frames) {}

  /// The cloth of all samples into the lanes of the view.
  void place(std::span<Rollout> group, int t, ClothView &view) const;
  /// The features alone, of a frame that does not count.
  void find(std::span<Rollout> group, int t, Measure &measure) const;
  /// What is in the view, into the terms of the group.
  void measure(std::span<Rollout> group, int t, Measure &measure) const;
  /// Surfaces in the place of a simulation: one sample that never explodes.
  Terms surface_terms(const std::vector<Vertices> &surfaces) const;
  /// Eq. (8): each term over the frames in which there is something to compare.
  double mean(const Terms &terms, int region) const;
  /// (R)
  std::vector<double> mean(const Terms &terms) const;

private:
  void measure_rims(std::span<Rollout> group, int t, std::size_t c, Measure &measure) const;
  void measure_contour(std::span<Rollout> group, int t, std::size_t c, Measure &measure) const;
  void measure_features(std::span<Rollout> group, int t, std::size_t c, Measure &measure) const;
  void measure_surface(std::span<Rollout> group, int t, Measure &measure) const;
  void locate(int t, std::size_t c, Measure &measure) const;
  void place_missed(const CapturedFeatures &features, LocatedFeatures &located, int lanes) const;
  void finish(Rollout &rollout, int t) const;

  const ObservedFrames &observed_;
};

} // namespace doublet::fit
