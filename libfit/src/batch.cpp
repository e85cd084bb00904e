#include "batch.h"

#include "optimizer_checks.h"

#include <algorithm>

namespace doublet::fit {
namespace {

constexpr int kLargestGroup = 16; // samples that the solver steps side by side
constexpr int kSmallestGroup = 4; // below which a group is not worth a thread of its own

} // namespace

void Batch::check(const std::vector<std::vector<pbd::Material>> &materials) const {
  for (const auto &sample : materials) {
    require(static_cast<int>(sample.size()) == observed_.regions(), "MaterialObjective: materials: expected " +
                                                                        std::to_string(observed_.regions()) +
                                                                        ", one a region, found " + std::to_string(sample.size()));
    for (const pbd::Material &material : sample)
      pbd::validate(material);
  }
}

/// As few groups as fill the registers, but not fewer than threads.
std::vector<Group> Batch::split(std::span<Rollout> rollouts, const Window &window, int threads) const {
  const int count = static_cast<int>(rollouts.size());
  int parts = (count + kLargestGroup - 1) / kLargestGroup;
  if (windows_.size() == 1) // several keep the threads busy by themselves
    parts = std::max(parts, std::min(threads, (count + kSmallestGroup - 1) / kSmallestGroup));
  std::vector<Group> groups;
  for (int g = 0; g < parts; ++g) {
    const int first = count * g / parts, last = count * (g + 1) / parts;
    groups.push_back({&window, rollouts.subspan(first, last - first)});
  }
  return groups;
}

/// All threads on a few of the groups at a time.
void Batch::run_groups(std::span<Group> groups, const Context &context) const {
  const std::size_t batch = windows_.size() == 1 ? groups.size() : 2 * static_cast<std::size_t>(context.thread_count());
  for (std::size_t i = 0; i < groups.size(); i += batch) {
    const auto some = groups.subspan(i, std::min(batch, groups.size() - i));
    int longest = 0;
    for (const Group &group : some)
      longest = std::max(longest, group.window->end - group.window->start);
    for (int done = 0; done < longest; done += kFramesPerChunk) {
      context.throw_if_cancelled();
      parallel_for(context, static_cast<int>(some.size()), [&](int g) {
        Group &group = some[g];
        const int start = group.window->start, end = group.window->end;
        if (done == 0)
          rollouts_.start(group);
        rollouts_.advance(group, std::min(start + done, end), std::min(start + done + kFramesPerChunk, end));
      });
    }
  }
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
    for (const Group &group : split(rollouts[w], windows_[w], context.thread_count()))
      groups.push_back(group);
  }
  run_groups(groups, context);
  MatrixRM energies(static_cast<Eigen::Index>(count), observed_.regions());
  for (std::size_t s = 0; s < count; ++s) {
    const std::vector<double> means = energy_.mean(samples.terms[s]);
    energies.row(static_cast<Eigen::Index>(s)) = Eigen::RowVectorXd::Map(means.data(), observed_.regions());
  }
  return energies;
}

} // namespace doublet::fit
