#pragma once
// The energy of a frame (eq. 6 and 7, the measured contour and the captured surface), of a group of samples side by side, and of
// all frames (eq. 8).

#include "observed_frames.h"

#include <span>
#include <utility>

namespace doublet::fit {

/// One sample on its way through a window.
struct Rollout {
  std::vector<pbd::Material> materials; ///< [R]
  std::vector<int> widths;              ///< [R] index of the rest shape
  CharacterState state;
  std::vector<std::uint8_t> exploded; ///< [R]
  Terms *terms = nullptr;             ///< of the sample
};

/// A group of rollouts at one frame, as it is measured.
struct Snapshot {
  std::vector<float> positions;       ///< [D][3][lanes] world, m
  std::vector<std::uint8_t> exploded; ///< [S][R]
};

/// What measures a group of rollouts, one in each lane.
struct Measure {
  Stopwatch watch;
  std::vector<Terms *> terms; ///< [S] of the samples
  ClothView view;
  std::vector<LocatedFeatures> located;    ///< [cameras]
  std::vector<std::vector<float>> largest; ///< [cameras][located features] what each costs at most, pixels^2
  std::vector<Rim> rims;
  std::vector<float> squared; ///< of contour points, pixels^2
  Measure(const ClothTopology &topology, std::vector<Terms *> samples, std::size_t cameras)
      : terms(std::move(samples)), view(topology, static_cast<int>(terms.size())), located(cameras), largest(cameras) {}
};

class FrameEnergy {
public:
  explicit FrameEnergy(const ObservedFrames &frames) : observed_(frames) {}

  /// Room for a group of so many samples.
  Snapshot snapshot(int samples) const;
  /// Rollouts [first, first + some.size()) of a group; those that end it fill the lanes beyond, too.
  void take(std::span<const Rollout> some, int first, int t, Snapshot &snapshot) const;
  /// Where the features of a frame lie, for measuring the next.
  void find(const Snapshot &snapshot, int t, Measure &measure) const;
  /// Into the terms of the samples.
  void measure(const Snapshot &snapshot, int t, Measure &measure) const;
  /// Surfaces in the place of a simulation: one sample that never explodes.
  Terms surface_terms(const std::vector<Vertices> &surfaces) const;
  /// Eq. (8): each term over the frames in which there is something to compare.
  double mean(const Terms &terms, int region) const;
  /// (R)
  std::vector<double> mean(const Terms &terms) const;

private:
  void measure_view(int t, Measure &measure) const;
  void measure_rims(int t, std::size_t c, Measure &measure) const;
  void measure_contour(int t, std::size_t c, Measure &measure) const;
  void measure_features(int t, std::size_t c, Measure &measure) const;
  void measure_surface(int t, Measure &measure) const;
  void locate(int t, std::size_t c, Measure &measure) const;
  void place_missed(const CapturedFeatures &features, LocatedFeatures &located, int lanes) const;
  void finish(Terms &sample, const std::uint8_t *exploded, int t) const;

  const ObservedFrames &observed_;
};

} // namespace doublet::fit
