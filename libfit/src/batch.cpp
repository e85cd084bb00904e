#include "batch.h"

#include "optimizer_checks.h"

#include <algorithm>
#include <functional>
#include <utility>

namespace doublet::fit {
namespace {

constexpr int kLargestGroup = 16;                  // samples that are simulated and measured side by side
constexpr int kSmallestPart = 4;                   // of a group, below which it is not worth a thread of its own
constexpr int kFirstRound = 8, kLongestRound = 32; // frames; short while there is nothing to measure yet
constexpr int kFewestMeasured = 4;                 // frames at a time: each time looks features up in the frame before once more
constexpr int kPieces = 4;                         // of what there is to measure, for each thread beside one that simulates

using Jobs = std::vector<std::function<void()>>;

/// Calls run(from, to) for at most `parts` even parts of [begin, end), none of them smaller than `smallest`.
template <class Run> void add_parts(Jobs &jobs, int begin, int end, int parts, int smallest, const Run &run) {
  const int count = end - begin;
  parts = std::clamp(parts, 1, std::max(1, count / smallest));
  for (int p = 0; p < parts && count > 0; ++p)
    jobs.push_back([run, from = begin + count * p / parts, to = begin + count * (p + 1) / parts] { run(from, to); });
}

void run_all(const Jobs &jobs, const Context &context) {
  parallel_for(context, static_cast<int>(jobs.size()), [&](int j) { jobs[j](); });
}

void simulate_next(Group &group) {
  std::swap(group.simulated, group.measured);
  Recording &next = group.simulated;
  next.from = group.measured.to;
  const int frames = std::clamp(2 * (group.measured.to - group.measured.from), kFirstRound, kLongestRound);
  next.to = std::min(next.from + frames, group.window->end);
  if (next.from > group.measured.from)
    next.at(next.from - 1) = group.measured.at(next.from - 1);
}

} // namespace

void Batch::check(const std::vector<std::vector<pbd::Material>> &materials) const {
  for (const auto &sample : materials) {
    require(static_cast<int>(sample.size()) == observed_.regions(),
            "MaterialObjective: materials: expected " + std::to_string(observed_.regions()) + ", one per region, found " +
                std::to_string(sample.size()));
    for (const pbd::Material &material : sample)
      pbd::validate(material);
  }
}

/// As few as fill the registers.
std::vector<Group> Batch::split(std::span<Rollout> rollouts, const Window &window) const {
  const int count = static_cast<int>(rollouts.size()), groups = (count + kLargestGroup - 1) / kLargestGroup;
  std::vector<Group> result;
  for (int g = 0; g < groups; ++g) {
    const int first = count * g / groups, last = count * (g + 1) / groups;
    result.push_back({&window, rollouts.subspan(first, last - first), {}, {}});
  }
  return result;
}

/// Frames are measured while the next ones are simulated. Measuring is half of the work and can be cut anywhere, so that no
/// thread waits for another whose cloth takes longer, and that cloth fills the registers although there are more threads than
/// groups.
void Batch::run_together(std::span<Group> groups, const Context &context) const {
  const int count = static_cast<int>(groups.size()), threads = context.thread_count();
  const auto parts_of_group = [&](int of_all) { return (of_all + count - 1) / count; };
  Jobs starts;
  for (Group &group : groups) {
    const int samples = static_cast<int>(group.rollouts.size());
    for (Recording *recording : {&group.simulated, &group.measured})
      *recording = {group.window->start, group.window->start, {kLongestRound + 1, energy_.snapshot(samples)}};
    add_parts(starts, 0, samples, parts_of_group(threads), kSmallestPart,
              [&](int first, int end) { rollouts_.start(*group.window, group.rollouts.subspan(first, end - first)); });
  }
  run_all(starts, context);
  for (;;) {
    context.throw_if_cancelled();
    Jobs jobs;
    for (Group &group : groups) {
      simulate_next(group);
      if (group.simulated.from < group.simulated.to)
        add_parts(jobs, 0, static_cast<int>(group.rollouts.size()), parts_of_group((threads + 1) / 2), kSmallestPart,
                  [&](int first, int end) { rollouts_.advance(group, first, end - first); });
    }
    for (Group &group : groups)
      add_parts(jobs, group.measured.from, group.measured.to, parts_of_group(kPieces * (threads - 1)), kFewestMeasured,
                [&](int from, int to) { rollouts_.measure(group, from, to); });
    if (jobs.empty())
      break;
    run_all(jobs, context);
  }
  for (Group &group : groups)
    group.simulated = group.measured = {};
}

MatrixRM Batch::run(Samples &samples, const Context &context) const {
  check(samples.materials);
  const std::size_t count = samples.materials.size();
  if (samples.widths.empty())
    samples.widths.assign(count, std::vector<int>(static_cast<std::size_t>(observed_.regions()), 0));
  samples.terms.assign(count, Terms(observed_.regions(), std::vector<FrameTerms>(observed_.frames.size())));
  std::vector<std::vector<Rollout>> rollouts(windows_.size());
  std::vector<Group> groups;
  for (std::size_t w = 0; w < windows_.size(); ++w) {
    for (std::size_t s = 0; s < count; ++s)
      rollouts[w].push_back({samples.materials[s], samples.widths[s], {}, {}, &samples.terms[s]});
    for (const Group &group : split(rollouts[w], windows_[w]))
      groups.push_back(group);
  }
  const std::size_t together = 2 * static_cast<std::size_t>(context.thread_count());
  for (std::size_t g = 0; g < groups.size(); g += together)
    run_together(std::span(groups).subspan(g, std::min(together, groups.size() - g)), context);
  MatrixRM energies(static_cast<Eigen::Index>(count), observed_.regions());
  for (std::size_t s = 0; s < count; ++s) {
    const std::vector<double> means = energy_.mean(samples.terms[s]);
    energies.row(static_cast<Eigen::Index>(s)) = Eigen::RowVectorXd::Map(means.data(), observed_.regions());
  }
  return energies;
}

} // namespace doublet::fit
