#pragma once
// The simulation of groups of samples through a motion, or through windows of it, measured frame by frame.

#include "frame_energy.h"

namespace doublet::fit {

/// Frames that are simulated in one go.
struct Window {
  int start = 0;                      ///< from the captured surface
  int first = 0, end = 0;             ///< frames that count
  std::vector<CharacterState> states; ///< at the start, [widths]
};

/// Rollouts that go through a window side by side.
struct Group {
  const Window *window;
  std::span<Rollout> rollouts;
};

/// The windows (start, first and end alone) that the options cut so many frames into.
std::vector<Window> cut_windows(int frame_count, const EnergyOptions &options);

class Rollouts {
public:
  Rollouts(const ObservedFrames &frames, const FrameEnergy &frame_energy, CpuTimes &cpu_times);

  /// The state at the start of a window, at every width: that of the captured surface, at the speed that it has there; at rest at
  /// the first frame of the motion.
  std::vector<CharacterState> states_at(int start, const MeshSequence &surface) const;
  void start(Group &group) const;
  /// Simulates frames [from, to) of the window, and measures those that count.
  void advance(Group &group, int from, int to) const;

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
