#include "doublet/fit/posterior.h"

#include "doublet/core/parts/normal_generator.h"
#include "doublet/fit/parts/gaussian_process.h"
#include "energy_scale.h"
#include "optimizer_checks.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

namespace doublet {
namespace {

using fit::EnergyScale;

constexpr double kTemperature = 2.0; // of the noise
constexpr int kLargest = 512;        // samples of the process, the lowest
constexpr int kThinning = 4;         // rounds from draw to draw
constexpr int kBurnIn = 20;          // rounds
constexpr double kShare = 0.9;       // of the draws, inside the interval
constexpr double kAtBound = 0.02;    // of the box: what is farther from its bound is not at it

/// The lowest energies and their samples.
std::pair<MatrixRM, Eigen::VectorXd> lowest(const MatrixRM &samples, const Eigen::VectorXd &energies) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(energies.size()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return energies[a] < energies[b]; });
  order.resize(std::min<std::size_t>(order.size(), kLargest));
  return {samples(order, Eigen::all), energies(order)};
}

/// Slice sampling, one coordinate after the other (Neal, "Slice sampling", Annals of Statistics 31(3), 2003): the slice begins as
/// the whole box, and shrinks.
class Sampler {
public:
  Sampler(const GaussianProcess &process, const EnergyScale &scale, double temperature, const PosteriorOptions &options,
          const Eigen::VectorXd &start)
      : process_(process), scale_(scale), temperature_(temperature), levels_(options.levels), random_(options.seed), at_(start) {}

  void round() {
    const auto n = static_cast<int>(at_.size());
    for (int j = 0; j < n; ++j)
      if (j == n - 1 && levels_ > 1)
        choose_level();
      else
        slice(j);
  }
  const Eigen::VectorXd &at() const { return at_; }

private:
  double log_density() const { return -scale_.energy(process_.mean(MatrixRM(at_.transpose()))[0]) / temperature_; }

  void slice(int j) {
    const double height = log_density() + std::log(1 - random_.uniform()), here = at_[j];
    for (double low = 0, high = 1; high - low > 1e-6;) {
      at_[j] = low + (high - low) * random_.uniform();
      if (log_density() >= height)
        return;
      (at_[j] < here ? low : high) = at_[j];
    }
    at_[j] = here;
  }

  void choose_level() {
    std::vector<double> logs;
    double &level = at_[at_.size() - 1];
    for (int k = 0; k < levels_; ++k) {
      level = k / (levels_ - 1.0);
      logs.push_back(log_density());
    }
    const double highest = *std::max_element(logs.begin(), logs.end());
    double sum = 0;
    for (double &log : logs)
      sum += log = std::exp(log - highest);
    double left = sum * random_.uniform();
    int k = 0;
    while (k + 1 < levels_ && (left -= logs[k]) >= 0)
      ++k;
    level = k / (levels_ - 1.0);
  }

  const GaussianProcess &process_;
  const EnergyScale &scale_;
  double temperature_;
  int levels_;
  NormalGenerator random_;
  Eigen::VectorXd at_;
};

/// The shortest: where a bound of the box is likely, it is inside. What is nearer to a bound than draws are to each other is at
/// it.
MatrixRM intervals(const MatrixRM &draws) {
  const Eigen::Index count = draws.rows(),
                     inside = std::min<Eigen::Index>(count, std::lround(kShare * static_cast<double>(count)) + 1);
  const double apart = std::min(5.0 / static_cast<double>(count), kAtBound); // few draws do not make the box small
  MatrixRM result(draws.cols(), 2);
  for (Eigen::Index j = 0; j < draws.cols(); ++j) {
    Eigen::VectorXd sorted = draws.col(j);
    std::sort(sorted.begin(), sorted.end());
    Eigen::Index best = 0;
    for (Eigen::Index first = 1; first + inside <= count; ++first)
      if (sorted[first + inside - 1] - sorted[first] < sorted[best + inside - 1] - sorted[best])
        best = first;
    const double low = sorted[best], high = sorted[best + inside - 1];
    result.row(j) << (low < apart ? 0 : low), (high > 1 - apart ? 1 : high);
  }
  return result;
}

Eigen::MatrixXd correlations(const MatrixRM &draws) {
  const MatrixRM off = draws.rowwise() - draws.colwise().mean();
  const Eigen::MatrixXd covariance = off.transpose() * off;
  Eigen::VectorXd scale = covariance.diagonal().cwiseSqrt();
  scale = (scale.array() > 1e-9).select(scale.cwiseInverse(), 0.0);
  return scale.asDiagonal() * covariance * scale.asDiagonal();
}

} // namespace

Posterior posterior_of(const MatrixRM &samples, const Eigen::VectorXd &energies, const PosteriorOptions &options) {
  constexpr int kSteps = 60;
  require(samples.rows() == energies.size() && samples.rows() >= 2 && samples.cols() >= 1,
          "posterior_of: expected as many energies as samples, at least 2, found " + std::to_string(energies.size()) + " and " +
              std::to_string(samples.rows()));
  require(options.noise >= 0 && std::isfinite(options.noise) && options.levels >= 0 && options.levels <= 1000 &&
              options.draws >= 1 && options.draws <= 100000,
          "posterior_of: options: expected a finite noise of at least 0, 0 to 1000 levels and 1 to 100000 draws, found others");
  require(samples.allFinite() && energies.allFinite(), "posterior_of: expected finite numbers, found NaN or infinity");
  const auto [points, values] = lowest(samples, energies);
  const EnergyScale scale = fit::scale_of(values);
  const GaussianProcess process(points, scale.shown(values), {}, kSteps);
  const double noise = std::max({options.noise, process.noise() * scale.unit, 1e-9 * std::fabs(values[0]), 1e-300});
  Sampler sampler(process, scale, kTemperature * noise, options, points.row(0).transpose());
  for (int i = 0; i < kBurnIn; ++i)
    sampler.round();
  Posterior result;
  result.draws.resize(options.draws, samples.cols());
  for (Eigen::Index d = 0; d < options.draws; ++d) {
    for (int i = 0; i < kThinning; ++i)
      sampler.round();
    result.draws.row(d) = sampler.at().transpose();
  }
  result.interval = intervals(result.draws);
  result.correlation = correlations(result.draws);
  return result;
}

MatrixRM beyond_intervals(const Posterior &posterior, const Eigen::VectorXd &answer, int axes, int count) {
  require(answer.size() == posterior.draws.cols() && axes >= 0 && axes <= answer.size() && count >= 0 &&
              count <= posterior.draws.rows(),
          "beyond_intervals: expected an answer of " + std::to_string(posterior.draws.cols()) +
              " numbers, at most as many axes, and at most " + std::to_string(posterior.draws.rows()) + " samples, found " +
              std::to_string(answer.size()) + ", " + std::to_string(axes) + " and " + std::to_string(count));
  struct Move {
    double way; // from the end of the interval to the bound
    bool answer;
  };
  constexpr Move kMoves[] = {{1.0 / 3, true}, {1, false}, {1, true}, {1.0 / 3, false}};
  MatrixRM samples = posterior.draws.topRows(count);
  Eigen::Index row = 0;
  for (const Move &move : kMoves)
    for (int axis = 0; axis < axes; ++axis)
      for (int bound : {0, 1}) {
        const double end = posterior.interval(axis, bound);
        if (std::fabs(bound - end) < kAtBound || row == count)
          continue;
        if (move.answer)
          samples.row(row) = answer.transpose();
        samples(row++, axis) = end + move.way * (bound - end);
      }
  return samples;
}

} // namespace doublet
