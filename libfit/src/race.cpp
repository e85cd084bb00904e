#include "race.h"

#include "optimizer_checks.h"

#include <algorithm>

namespace doublet::fit {
namespace {

constexpr int kLargestGroup = 16; // samples that the solver steps side by side
constexpr int kSmallestGroup = 4; // below which a group is not worth a thread of its own
constexpr int kStages = 8;        // of a race, between which hopeless samples are stopped

/// The last of those that CMA-ES selects from a population, of which `values` are the lowest.
double middle(std::vector<double> values, std::size_t population) {
  const std::size_t last = std::max<std::size_t>(1, population / 2) - 1; // that CMA-ES selects
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(last), values.end());
  return values[last];
}

} // namespace

Samples Race::make_samples(const std::vector<std::vector<pbd::Material>> &materials) const {
  for (const auto &sample : materials) {
    require(static_cast<int>(sample.size()) == observed_.regions(), "MaterialObjective: materials: expected " +
                                                                        std::to_string(observed_.regions()) +
                                                                        ", one a region, found " + std::to_string(sample.size()));
    for (const pbd::Material &material : sample)
      pbd::validate(material);
  }
  Samples samples;
  samples.materials = materials;
  samples.terms.assign(materials.size(), Terms(observed_.regions(), std::vector<FrameTerms>(observed_.frames.size())));
  samples.stopped.assign(materials.size(), 0);
  samples.ratio.resize(static_cast<Eigen::Index>(materials.size()), observed_.regions());
  return samples;
}

/// The samples that are still running, in as few groups as fill the registers, but not fewer than threads.
void Race::split(std::span<Rollout> rollouts, const Window &window, int from, int to, int threads,
                 std::vector<Group> &groups) const {
  const int count = static_cast<int>(rollouts.size());
  int parts = (count + kLargestGroup - 1) / kLargestGroup;
  if (windows_.size() == 1) // several keep the threads busy by themselves
    parts = std::max(parts, std::min(threads, (count + kSmallestGroup - 1) / kSmallestGroup));
  for (int g = 0; g < parts; ++g) {
    const int first = count * g / parts, last = count * (g + 1) / parts;
    groups.push_back({&window, rollouts.subspan(first, last - first), from, to});
  }
}

/// Runs groups of one stage, all threads on a few of them at a time.
void Race::run_groups(std::span<Group> groups, const Context &context) const {
  const std::size_t batch = windows_.size() == 1 ? groups.size() : 2 * static_cast<std::size_t>(context.thread_count());
  for (std::size_t i = 0; i < groups.size(); i += batch) {
    const auto some = groups.subspan(i, std::min(batch, groups.size() - i));
    int longest = 0;
    for (const Group &group : some)
      longest = std::max(longest, group.to - group.from);
    for (int done = 0; done < longest; done += kFramesPerChunk) {
      context.check_cancelled();
      parallel_for(context, static_cast<int>(some.size()), [&](int g) {
        Group &group = some[g];
        if (done == 0 && group.from == group.window->start)
          rollouts_.start(group);
        rollouts_.advance(group, std::min(group.from + done, group.to), std::min(group.from + done + kFramesPerChunk, group.to));
      });
    }
  }
}

void Race::stop_hopeless(Samples &samples, const std::vector<std::uint8_t> &counts) const {
  const std::size_t count = samples.stopped.size();
  std::vector<std::uint8_t> hopeless = samples.stopped;
  for (std::uint8_t &h : hopeless)
    h = !h;
  for (int r = 0; r < observed_.regions(); ++r) {
    std::vector<double> running;
    for (std::size_t s = 0; s < count; ++s)
      if (!samples.stopped[s])
        running.push_back(energy_.mean(samples.terms[s], r, counts));
    const double reference = middle(running, count);
    for (std::size_t s = 0; s < count; ++s)
      if (!samples.stopped[s]) {
        const double energy = energy_.mean(samples.terms[s], r, counts);
        samples.ratio(static_cast<Eigen::Index>(s), r) = energy / reference;
        hopeless[s] &= energy > (1 + margin_) * reference;
      }
  }
  for (std::size_t s = 0; s < count; ++s)
    samples.stopped[s] |= hopeless[s];
}

MatrixRM Race::run(Samples &samples, const Context &context) const {
  const int stages = margin_ > 0 ? kStages : 1, count = static_cast<int>(samples.stopped.size());
  const bool whole = static_cast<int>(windows_.size()) >= stages; // windows are run one stage each; else each over all stages
  std::vector<std::uint8_t> counts(observed_.frames.size(), 0);   // frames measured so far
  std::vector<std::vector<Rollout>> rollouts(windows_.size());
  for (int stage = 0; stage < stages; ++stage) {
    std::vector<Group> groups;
    for (std::size_t w = 0; w < windows_.size(); ++w) {
      const Window &window = windows_[w];
      const int length = window.end - window.start;
      int from = window.start, to = window.end;
      if (!whole)
        from = window.start + length * stage / stages, to = window.start + length * (stage + 1) / stages;
      else if (static_cast<int>(w) % stages != stage)
        continue;
      if (from == window.start && rollouts[w].empty())
        for (int s = 0; s < count; ++s)
          rollouts[w].push_back({s, samples.materials[s], {}, {}, &samples.terms[s]});
      std::erase_if(rollouts[w], [&](const Rollout &rollout) { return samples.stopped[rollout.sample]; });
      split(rollouts[w], window, from, to, context.thread_count(), groups);
      for (int t = std::max(from, window.first); t < to; ++t)
        counts[t] = 1;
    }
    run_groups(groups, context);
    if (whole)
      rollouts.assign(windows_.size(), {});
    if (stage + 1 < stages)
      stop_hopeless(samples, counts);
  }
  return final_energies(samples, counts);
}

MatrixRM Race::final_energies(const Samples &samples, const std::vector<std::uint8_t> &counts) const {
  const std::size_t count = samples.stopped.size();
  MatrixRM result(static_cast<Eigen::Index>(count), observed_.regions());
  for (int r = 0; r < observed_.regions(); ++r) {
    std::vector<double> finished;
    for (std::size_t s = 0; s < count; ++s)
      if (!samples.stopped[s])
        finished.push_back(result(static_cast<Eigen::Index>(s), r) = energy_.mean(samples.terms[s], r, counts));
    for (std::size_t s = 0; s < count; ++s)
      if (samples.stopped[s])
        result(static_cast<Eigen::Index>(s), r) = samples.ratio(static_cast<Eigen::Index>(s), r) * middle(finished, count);
  }
  return result;
}

} // namespace doublet::fit
