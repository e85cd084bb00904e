#include "rollouts.h"

#include <algorithm>
#include <utility>

namespace doublet::fit {

std::vector<Window> cut_windows(int frame_count, const EnergyOptions &options) {
  const int count = options.window > 0 ? std::max(1, frame_count / options.window) : 1;
  std::vector<Window> windows;
  for (int w = 0; w < count; ++w) {
    const int first = frame_count * w / count, end = frame_count * (w + 1) / count;
    windows.push_back({std::max(0, first - (first > 0 ? options.window_lead : 0)), first, end, {}});
  }
  return windows;
}

Rollouts::Rollouts(const ObservedFrames &frames, const FrameEnergy &frame_energy, CpuTimes &cpu_times)
    : observed_(frames), energy_(frame_energy), times_(cpu_times) {
  const Vertices &rest = frames.simulator->actor().mesh.vertices;
  farthest_ = (rest.colwise().maxCoeff() - rest.colwise().minCoeff()).norm();
}

/// A region that has exploded is put back on the skinned surface, so that it cannot spoil the views of the others, and
/// goes on with the default material, so that it does not explode again.
void Rollouts::put_back(Rollout &rollout, const PosedFrame &frame) const {
  for (int r = 0; r < observed_.regions(); ++r) {
    if (!rollout.exploded[r])
      continue;
    const std::vector<int> &vertices = observed_.simulator->regions()[r].vertex_from_cloth;
    for (std::size_t i = 0; i < vertices.size(); ++i)
      rollout.state.regions[r].positions.row(static_cast<Eigen::Index>(i)) = frame.skinned.row(vertices[i]);
    rollout.state.regions[r].velocities.setZero();
    rollout.materials[r] = {};
  }
}

void Rollouts::check_explosion(Rollout &rollout, const PosedFrame &frame) const {
  for (int r = 0; r < observed_.regions(); ++r) {
    const std::vector<int> &vertices = observed_.simulator->regions()[r].vertex_from_cloth;
    const Vertices &positions = rollout.state.regions[r].positions;
    for (std::size_t i = 0; i < vertices.size() && !rollout.exploded[r]; ++i) {
      const double distance = (positions.row(static_cast<Eigen::Index>(i)) - frame.skinned.row(vertices[i])).norm();
      rollout.exploded[r] = !(distance <= farthest_); // NaN is not
    }
  }
  put_back(rollout, frame);
}

/// Cloth that stops being finite stays where it was, and has exploded; while it is still
/// settling the sample's other regions, too, never came to rest.
void Rollouts::step(std::span<Rollout> group, const PosedFrame &from, const PosedFrame &to, bool settling) const {
  for (int r = 0; r < observed_.regions(); ++r)
    for (int width = 0; width < static_cast<int>(observed_.widths.size()); ++width) {
      std::vector<Rollout *> alike;
      std::vector<CharacterState *> states;
      std::vector<const std::vector<pbd::Material> *> materials;
      for (Rollout &rollout : group)
        if (rollout.widths[r] == width) {
          alike.push_back(&rollout);
          states.push_back(&rollout.state);
          materials.push_back(&rollout.materials);
        }
      if (alike.empty())
        continue;
      for (int failed : observed_.widths[width]->step_region(r, states, from, to, materials, observed_.dt))
        if (settling)
          alike[failed]->exploded.assign(observed_.regions(), 1);
        else
          alike[failed]->exploded[r] = 1;
    }
}

std::vector<CharacterState> Rollouts::states_at(int start, const MeshSequence &surface) const {
  std::vector<CharacterState> states;
  for (const CharacterSimulator *simulator : observed_.widths)
    states.push_back(state_at(*simulator, start, surface));
  return states;
}

CharacterState Rollouts::state_at(const CharacterSimulator &simulator, int start, const MeshSequence &surface) const {
  if (start == 0 && simulator.has_rest_shape())
    return simulator.start(observed_.lead_in_poses.front());
  CharacterState state = simulator.start(observed_.frames[start], &surface.frames[start]);
  if (start == 0)
    return state;
  const int after = std::min(start + 1, observed_.frame_count() - 1);
  const Vertices velocities = (surface.frames[after] - surface.frames[start - 1]) / ((after - start + 1) * observed_.dt);
  for (int r = 0; r < observed_.regions(); ++r) {
    const std::vector<int> &vertices = simulator.regions()[r].vertex_from_cloth;
    for (std::size_t i = 0; i < vertices.size(); ++i)
      state.regions[r].velocities.row(static_cast<Eigen::Index>(i)) = velocities.row(vertices[i]);
  }
  return state;
}

void Rollouts::start(const Window &window, std::span<Rollout> some) const {
  Stopwatch watch;
  for (Rollout &rollout : some) {
    rollout.state = window.states.front();
    for (int r = 0; r < observed_.regions(); ++r)
      rollout.state.regions[r] = window.states[rollout.widths[r]].regions[r];
    rollout.exploded.assign(observed_.regions(), 0);
  }
  if (window.start == 0) {
    for (std::size_t i = 1; i < observed_.lead_in_poses.size(); ++i)
      step(some, observed_.lead_in_poses[i - 1], observed_.lead_in_poses[i], true);
    for (int i = 0; i < observed_.options.settle_frames; ++i)
      step(some, observed_.frames[0], observed_.frames[0], true);
    for (Rollout &rollout : some)
      for (pbd::ClothState &region : rollout.state.regions)
        region.velocities.setZero();
  }
  watch.lap(&EnergyTimes::simulate);
  times_.add(watch);
}

void Rollouts::advance(Group &group, int first, int count) const {
  Stopwatch watch;
  const std::span<Rollout> some = group.rollouts.subspan(first, count);
  for (int t = group.simulated.from; t < group.simulated.to; ++t) {
    if (t > group.window->start)
      step(some, observed_.frames[t - 1], observed_.frames[t], false);
    for (Rollout &rollout : some)
      check_explosion(rollout, observed_.frames[t]);
    energy_.take(some, first, t, group.simulated.at(t));
  }
  watch.lap(&EnergyTimes::simulate);
  times_.add(watch);
}

void Rollouts::measure(const Group &group, int from, int to) const {
  from = std::max(from, group.window->first);
  if (from >= to)
    return;
  std::vector<Terms *> terms;
  for (const Rollout &rollout : group.rollouts)
    terms.push_back(rollout.terms);
  Measure tools(observed_.topology, std::move(terms), observed_.cameras.size());
  if (from > group.window->start)
    energy_.find(group.measured.at(from - 1), from - 1, tools);
  for (int t = from; t < to; ++t)
    energy_.measure(group.measured.at(t), t, tools);
  times_.add(tools.watch);
}

} // namespace doublet::fit
