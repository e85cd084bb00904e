#pragma once
// Samples that go through all windows together. They may be raced: those that fall behind are stopped on the way.

#include "rollouts.h"

namespace doublet::fit {

/// What is known about its samples so far.
struct Samples {
  std::vector<std::vector<pbd::Material>> materials; ///< [S][R]
  std::vector<Terms> terms;                          ///< [S]
  std::vector<std::uint8_t> stopped;                 ///< [S]
  MatrixRM ratio;                                    ///< (S, R) to the sample in the middle, when it was stopped
};

class Race {
public:
  /// margin > 0: in eight parts, after each but the last of which a sample is stopped whose energy is more than 1 + margin times
  /// that of the sample in the middle, in every region; 0 = all run to the end.
  Race(const ObservedFrames &frames, const FrameEnergy &frame_energy, const Rollouts &all, const std::vector<Window> &cut,
       double margin)
      : observed_(frames), energy_(frame_energy), rollouts_(all), windows_(cut), margin_(margin) {}

  /// Throws std::invalid_argument unless there is a material in its box for each region of each sample.
  Samples make_samples(const std::vector<std::vector<pbd::Material>> &materials) const;
  /// E_fit (S, R).
  MatrixRM run(Samples &samples, const Context &context) const;

private:
  void split(std::span<Rollout> rollouts, const Window &window, int from, int to, int threads, std::vector<Group> &groups) const;
  void run_groups(std::span<Group> groups, const Context &context) const;
  void stop_hopeless(Samples &samples, const std::vector<std::uint8_t> &counts) const;
  MatrixRM final_energies(const Samples &samples, const std::vector<std::uint8_t> &counts) const;

  const ObservedFrames &observed_;
  const FrameEnergy &energy_;
  const Rollouts &rollouts_;
  const std::vector<Window> &windows_;
  double margin_;
};

} // namespace doublet::fit
