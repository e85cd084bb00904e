#include "doublet/fit/garment_trial.h"

#include "optimizer_checks.h"

#include <algorithm>
#include <array>

namespace doublet {
namespace {

constexpr int kBestOf = 4; // the mean is over the lowest of so many: one sample's energy is chaotic

/// Van der Corput's sequence: the digits of `i` in `base`, mirrored at the point; in (0, 1) for i > 0.
double radical_inverse(int i, int base) {
  double value = 0, digit = 1;
  for (; i > 0; i /= base) {
    digit /= base;
    value += digit * (i % base);
  }
  return value;
}

} // namespace

MatrixRM trial_samples(const ParameterSpace &space, int count) {
  constexpr std::array<int, 6> kPrimes{2, 3, 5, 7, 11, 13}; // one a parameter of a material
  MatrixRM samples(count, space.size());
  for (int s = 0; s < count; ++s)
    for (int i = 0; i < space.size(); ++i)
      samples(s, i) = space.names[i] == "k_stretch" ? 1.0 : radical_inverse(s + 1, kPrimes.at(i));
  return samples;
}

Eigen::VectorXd trial_energy(MaterialObjective &objective, int materials, const Context &context) {
  require(materials >= kBestOf,
          "trial_energy: materials: expected at least " + std::to_string(kBestOf) + ", found " + std::to_string(materials));
  const MatrixRM samples = trial_samples(objective.space(), materials).replicate(1, objective.part_count());
  MatrixRM energies = objective.evaluate(samples, context);
  const Eigen::Index lowest = materials / kBestOf;
  for (auto region : energies.colwise())
    std::nth_element(region.begin(), region.begin() + lowest - 1, region.end());
  return energies.topRows(lowest).colwise().mean().transpose();
}

} // namespace doublet
