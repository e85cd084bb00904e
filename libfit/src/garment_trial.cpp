#include "doublet/fit/garment_trial.h"

#include "doublet/options/options.h"

#include "optimizer_checks.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace doublet {
namespace {

constexpr int kBestOf = 4;          // the mean is over the lowest of so many: one sample's energy is chaotic
constexpr double kRaceMargin = 0.1; // of the race: half of the samples is beyond what counts

/// Van der Corput's sequence: the digits of `i` in `base`, mirrored at the point; in (0, 1) for i > 0.
double radical_inverse(int i, int base) {
  double value = 0, digit = 1;
  for (; i > 0; i /= base) {
    digit /= base;
    value += digit * (i % base);
  }
  return value;
}

void require_materials(int count, const std::string &what) {
  require(count >= kBestOf && count <= 4096,
          what + ": expected a number in [" + std::to_string(kBestOf) + ", 4096], found " + std::to_string(count));
}

} // namespace

MatrixRM trial_samples(const ParameterSpace &space, int count, int share) {
  constexpr std::array<int, 6> kPrimes{2, 3, 5, 7, 11, 13}; // one a parameter of a material
  space.validate();
  require_materials(count, "trial_samples: count");
  require(share >= 0 && share <= 100000,
          "trial_samples: share: expected a number in [0, 100000], found " + std::to_string(share));
  MatrixRM samples(count, space.size());
  for (int s = 0; s < count; ++s)
    for (int i = 0; i < space.size(); ++i)
      samples(s, i) = space.names[i] == "k_stretch" ? 1.0 : radical_inverse(share * count + s + 1, kPrimes.at(i));
  return samples;
}

Eigen::VectorXd trial_energy(const MaterialObjective &objective, int materials, const Context &context) {
  require_materials(materials, "trial_energy: materials");
  const MatrixRM samples = trial_samples(objective.space(), materials).replicate(1, objective.part_count());
  MatrixRM energies = objective.race(samples, kRaceMargin, context);
  const Eigen::Index lowest = materials / kBestOf;
  for (auto region : energies.colwise())
    std::nth_element(region.begin(), region.begin() + lowest - 1, region.end());
  return energies.topRows(lowest).colwise().mean().transpose();
}

std::size_t chosen_garment(const std::vector<double> &energies, const TrialOptions &trial) {
  trial.validate();
  require(!energies.empty(), "chosen_garment: energies: expected at least one, found none");
  for (double energy : energies)
    require(std::isfinite(energy), "chosen_garment: energies: expected finite numbers, found " + options::shown(energy, 4));
  const auto cheapest = std::min_element(energies.begin(), energies.end());
  return *cheapest < (1 - trial.margin) * energies[0] ? static_cast<std::size_t>(cheapest - energies.begin()) : 0;
}

double garment_energy(const CharacterSimulator &simulator, const ReferencePerformance &performance,
                      const Observations &observations, const TrialOptions &trial, const EnergyOptions &energy,
                      const ParameterSpace &space, const Context &context) {
  trial.validate();
  if (simulator.regions().empty())
    return 0;
  const MaterialObjective objective(simulator, performance, observations, energy, space, context);
  return trial_energy(objective, trial.materials, context).sum();
}

} // namespace doublet
