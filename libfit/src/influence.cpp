#include "doublet/fit/parts/influence.h"

#include "doublet/core/error.h"
#include "doublet/core/parts/quantile.h"
#include "optimizer_checks.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace doublet {
namespace {

constexpr int kProbes = 4;         // values of each parameter
constexpr double kWindow = 0.4;    // of the box, that they span
constexpr int kRepeats = 12;       // of the answer; with five parameters all fill 32 lanes
constexpr double kNowhere = 0.001; // of the box: far below where the search stops

/// (4 n + 12, n) first the probes of every parameter, then the repeats.
MatrixRM probes_around(const Eigen::RowVectorXd &answer) {
  const int n = static_cast<int>(answer.size());
  MatrixRM samples = answer.replicate(kProbes * n + kRepeats, 1);
  for (int i = 0; i < n; ++i) {
    const double low = std::clamp(answer[i] - kWindow / 2, 0.0, 1 - kWindow);
    for (int k = 0; k < kProbes; ++k)
      samples(kProbes * i + k, i) = low + kWindow * (k + 0.5) / kProbes;
  }
  for (int k = 0; k < kRepeats; ++k) {
    double &x = samples(kProbes * n + k, k % n);
    const double step = kNowhere * (1 + k / n) * (k % 2 ? 1 : -1); // no two alike
    x += x + step < 0 || x + step > 1 ? -step : step;
  }
  return samples;
}

Influence influence_of(const Eigen::VectorXd &energies, int n) {
  const auto repeats = energies.tail(kRepeats);
  const double answer = median({repeats.begin(), repeats.end()});
  std::vector<double> away;
  for (const double energy : repeats)
    away.push_back(std::fabs(energy - answer));
  Influence result;
  result.noise = 1.4826 * median(away); // of a normal distribution
  result.change.resize(n);
  for (int i = 0; i < n; ++i)
    result.change[i] = std::sqrt((energies.segment(kProbes * i, kProbes).array() - answer).square().mean());
  std::vector<int> order(n);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return result.change[a] > result.change[b]; });
  result.rank.resize(n);
  for (int k = 0; k < n; ++k)
    result.rank[order[k]] = k + 1;
  return result;
}

} // namespace

std::vector<Influence> measure_influence(Objective &objective, const MatrixRM &answers, const Context &context) {
  const int n = objective.parameter_count(), parts = objective.part_count();
  require(answers.rows() == parts && answers.cols() == n && (answers.array() >= 0).all() && (answers.array() <= 1).all(),
          "measure_influence: answers: expected (" + std::to_string(parts) + ", " + std::to_string(n) +
              ") numbers in [0, 1], found (" + std::to_string(answers.rows()) + ", " + std::to_string(answers.cols()) + ")");
  MatrixRM samples(kProbes * n + kRepeats, static_cast<Eigen::Index>(parts) * n);
  for (int r = 0; r < parts; ++r)
    samples.middleCols(static_cast<Eigen::Index>(r) * n, n) = probes_around(answers.row(r));
  const MatrixRM energies = objective.evaluate(samples, context);
  if (energies.rows() != samples.rows() || energies.cols() != parts || !energies.allFinite())
    throw Error("measure_influence: evaluate: expected (" + std::to_string(samples.rows()) + ", " + std::to_string(parts) +
                ") finite energies, found others");
  std::vector<Influence> result;
  for (int r = 0; r < parts; ++r)
    result.push_back(influence_of(energies.col(r), n));
  return result;
}

} // namespace doublet
