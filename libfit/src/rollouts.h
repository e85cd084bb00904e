#pragma once
// The simulation of groups of samples through a motion, or through windows of it, and what its frames cost.

#include "frame_energy.h"

namespace doublet::fit {

/// Frames that are simulated in one go.
struct Window {
  int start = 0;                      ///< from the captured surface
  int first = 0, end = 0;             ///< frames that count
  std::vector<CharacterState> states; ///< at the start, [widths]
};

/// Frames of a group, between simulation and measurement.
struct Recording {
  int from = 0, to = 0;            ///< frames
  std::vector<Snapshot> snapshots; ///< of the frame before `from`, then of [from, to)
  const Snapshot &at(int t) const { return snapshots[t - from + 1]; }
  Snapshot &at(int t) { return snapshots[t - from + 1]; }
};

/// Rollouts that go through a window together. Any part of them may be simulated at a time; they are measured side by side.
struct Group {
  const Window *window;
  std::span<Rollout> rollouts;
  Recording simulated, measured; ///< the frames that are simulated now, and those before
};

/// The windows (start, first and end alone) that the options cut so many frames into.
std::vector<Window> cut_windows(int frame_count, const EnergyOptions &options);

class Rollouts {
public:
  Rollouts(const ObservedFrames &frames, const FrameEnergy &frame_energy, CpuTimes &cpu_times);

  /// The state at the start of a window, at every width: that of the captured surface, at the speed that it has there; at rest at
  /// the first frame of the motion.
  std::vector<CharacterState> states_at(int start, const MeshSequence &surface) const;
  void start(const Window &window, std::span<Rollout> some) const;
  /// Simulates rollouts [first, first + count) of the group through the frames of `simulated`.
  void advance(Group &group, int first, int count) const;
  /// Measures those of frames [from, to) that count, out of `measured`.
  void measure(const Group &group, int from, int to) const;

private:
  CharacterState state_at(const CharacterSimulator &simulator, int start, const MeshSequence &surface) const;
  void put_back(Rollout &rollout, const PosedFrame &frame) const;
  void check_explosion(Rollout &rollout, const PosedFrame &frame) const;
  void step(std::span<Rollout> group, const PosedFrame &from, const PosedFrame &to, bool settling) const;

  const ObservedFrames &observed_;
  const FrameEnergy &energy_;
  CpuTimes &times_;
  double farthest_; ///< m: the cloth of a sample that is farther than this from its skinned place has exploded
};

} // namespace doublet::fit
