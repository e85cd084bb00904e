#pragma once
// Samples that go through all windows of a motion together.

#include "rollouts.h"

namespace doublet::fit {

/// What is simulated, and what is known about it.
struct Samples {
  std::vector<std::vector<pbd::Material>> materials; ///< [S][R]
  std::vector<std::vector<int>> widths;              ///< [S][R] index of the rest shape; empty = the first for all
  std::vector<Terms> terms;                          ///< [S] measured by Batch
};

class Batch {
public:
  Batch(const ObservedFrames &frames, const FrameEnergy &frame_energy, const Rollouts &all, const std::vector<Window> &cut)
      : observed_(frames), energy_(frame_energy), rollouts_(all), windows_(cut) {}

  /// E_fit (S, R). Throws std::invalid_argument unless there is a material in its box for each region of each sample.
  MatrixRM run(Samples &samples, const Context &context) const;

private:
  void check(const std::vector<std::vector<pbd::Material>> &materials) const;
  std::vector<Group> split(std::span<Rollout> rollouts, const Window &window) const;
  void run_together(std::span<Group> groups, const Context &context) const;

  const ObservedFrames &observed_;
  const FrameEnergy &energy_;
  const Rollouts &rollouts_;
  const std::vector<Window> &windows_;
};

} // namespace doublet::fit
