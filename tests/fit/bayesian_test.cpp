#include "doublet/core/parts/normal_generator.h"
#include "doublet/fit/optimizer.h"
#include "doublet/fit/parts/even_points.h"
#include "doublet/fit/parts/gaussian_process.h"
#include "doublet/fit/posterior.h"
#include "fit/functions.h"

#include <gtest/gtest.h>

#include <set>

namespace doublet {
namespace {

using namespace testing;

/// A bowl in five parameters, of which the last hardly counts, with ripples and multiplicative noise; its minimum is 100.
struct Noisy {
  double noise;
  NormalGenerator random;
  Noisy(double share, std::uint64_t seed) : noise(share), random(seed) {}
  static double clean(const Eigen::VectorXd &x) {
    const double weights[] = {6, 2, 1.5, 8, 0.1}, lowest[] = {0.2, 0.1, 0.3, 1.0, 0.5};
    double bowl = 0;
    for (int i = 0; i < 5; ++i)
      bowl += weights[i] * std::pow(x[i] - lowest[i], 2);
    return 100 * std::exp(bowl) + 8 * (1 - std::cos(20 * (x[0] - 0.2))) + 8 * (1 - std::cos(15 * (x[2] - 0.3)));
  }
  double operator()(const Eigen::VectorXd &x) { return clean(x) * (1 + noise * random.normal()); }
};

int evaluations_of(Optimizer &search, Noisy &energy) {
  while (!search.stop())
    one_generation(search, [&](const Eigen::VectorXd &x) { return energy(x); });
  return search.result().evaluations;
}

void expect_ends_near_the_minimum_from_seeds(std::uint64_t first, std::uint64_t last) {
  const int seeds = static_cast<int>(last - first + 1);
  for (double noise : {0.0, 0.03}) {
    int near = 0, evaluations = 0;
    for (std::uint64_t seed = first; seed <= last; ++seed) {
      BayesianOptions options;
      options.seed = seed;
      const auto search = create_bayesian(5, options);
      Noisy energy(noise, seed);
      evaluations += evaluations_of(*search, energy);
      near += Noisy::clean(search->result().answer) < 105;
    }
    std::printf("noise %.2f: %d of %d within 5 %%, %d evaluations\n", noise, near, seeds, evaluations / seeds);
    EXPECT_EQ(near, seeds);
    EXPECT_LT(evaluations, 320 * seeds);
  }
}

TEST(Bayesian, EndsNearTheMinimumOfANoisyEnergy) {
  expect_ends_near_the_minimum_from_seeds(1, 2);
}
TEST(SlowBayesian, EndsNearTheMinimumOfANoisyEnergyFromEverySeed) {
  expect_ends_near_the_minimum_from_seeds(3, 10);
}

TEST(Bayesian, GoesOnWhileItGainsOrExpectsToGain) {
  const auto evaluations = [](double min_gain, double min_expected_gain) {
    BayesianOptions options;
    options.min_gain = min_gain;
    options.min_expected_gain = min_expected_gain;
    options.max_evaluations = 288;
    Noisy energy(0.03, 1);
    return evaluations_of(*create_bayesian(5, options), energy);
  };
  EXPECT_EQ(evaluations(1e9, 1e9), 224); // four generations after the first that went anywhere in particular
  EXPECT_EQ(evaluations(1e9, 1e-9), 288);
  EXPECT_EQ(evaluations(0, 1e9), 288);
}

TEST(Bayesian, GroupsOfAGenerationShareALevel) {
  BayesianOptions options;
  options.levels = 4;
  const auto search = create_bayesian(5, options);
  const auto lowest_at_a_third = [](const Eigen::VectorXd &x) { return 1 + (x.array() - 1.0 / 3).square().sum(); };
  for (int generation = 0; generation < 4; ++generation) {
    const MatrixRM samples = search->ask();
    for (Eigen::Index i = 0; i < samples.rows(); ++i) {
      EXPECT_NEAR(std::remainder(3 * samples(i, 4), 1), 0, 1e-12);
      if (generation > 0) {
        EXPECT_EQ(samples(i, 4), samples(i / 16 * 16, 4)) << i;
      }
    }
    search->tell(samples, energies_of(samples, lowest_at_a_third));
  }
  EXPECT_NEAR(search->result().answer[4], 1.0 / 3, 1e-12);
  EXPECT_NEAR(search->result().answer[0], 1.0 / 3, 0.05);
}

TEST(Bayesian, AValleyThatMovesWithTheLevelIsFollowed) {
  const auto lowest_at_the_third = [](const Eigen::VectorXd &x) {
    const double level = 4 * x[4] - 3, a = x[0] - 0.9 + 0.05 * level, b = x[1] - 0.7 - 0.05 * level;
    return 5 + 3 * level * level + 300 * (std::hypot(a, 0.01) + std::hypot(b, 0.01) - 0.02) + 20 * std::pow(x[2] - 0.5, 2) +
           5 * std::pow(x[3] - 0.2, 2);
  };
  for (const std::uint64_t seed : {4, 5}) { // which go elsewhere first
    BayesianOptions options;
    options.levels = 5;
    options.seed = seed;
    const auto search = create_bayesian(5, options);
    while (!search->stop())
      one_generation(*search, lowest_at_the_third);
    EXPECT_EQ(search->result().answer[4], 0.75) << seed;
  }
}

/// Before it stops it looks beside the answer's level, for as long as that finds more than is missing there.
TEST(Bayesian, LevelsBesideTheAnswerAreLookedAt) {
  const auto lower_and_elsewhere_beside = [](const Eigen::VectorXd &x) {
    const bool beside = x[4] == 0.75;
    const Eigen::Array4d minimum = beside ? Eigen::Array4d(0.55, 0.2, 0.7, 0.7) : Eigen::Array4d(0.9, 0.05, 0.6, 0.8);
    const Eigen::Array4d off = x.head(4).array() - minimum, weights(10, 10, 200, 40);
    return (beside ? 4 : 12 + 8 * std::fabs(4 * x[4] - 2)) + (weights * off.square()).sum();
  };
  BayesianOptions options;
  options.levels = 5;
  for (options.seed = 1; options.seed <= 4; ++options.seed) {
    const auto search = create_bayesian(5, options);
    std::vector<double> levels;
    while (!search->stop()) {
      const MatrixRM samples = search->ask();
      for (Eigen::Index i = 0; i < samples.rows(); ++i)
        levels.push_back(samples(i, 4));
      search->tell(samples, energies_of(samples, lower_and_elsewhere_beside));
    }
    const double answer = search->result().answer[4];
    EXPECT_EQ(answer, 0.75) << options.seed;
    for (const double beside : {answer - 0.25, answer + 0.25})
      EXPECT_GT(std::count(levels.begin(), levels.end(), beside), 16) << options.seed;
  }
}

TEST(Bayesian, GoesOnToTheSameBits) {
  BayesianOptions options;
  options.population = 8;
  const auto sphere = [](const Eigen::VectorXd &x) { return 1 + sphere_function(x); };
  auto whole = create_bayesian(3, options), stopped = create_bayesian(3, options);
  for (int generation = 0; generation < 6; ++generation) {
    one_generation(*whole, sphere);
    one_generation(*stopped, sphere);
    auto resumed = create_bayesian(3, options);
    resumed->restore(stopped->save());
    stopped = std::move(resumed);
    EXPECT_EQ(stopped->result().answer, whole->result().answer) << generation;
  }
  EXPECT_THROW(create_bayesian(4, options)->restore(whole->save()), std::runtime_error);
}

TEST(Bayesian, AGenerationIsAsLargeAsItIsAskedToBe) {
  BayesianOptions options;
  options.population = 640;
  options.first = even_points(8, 2);
  const auto search = create_bayesian(2, options);
  one_generation(*search, sphere_function);
  EXPECT_EQ(search->ask().rows(), 640);
}

TEST(Bayesian, HowLowTheEnergiesAreDoesNotMatter) {
  const auto answer = [](double offset, double unit) {
    BayesianOptions options;
    options.min_gain = 0;
    options.max_evaluations = 128;
    const auto search = create_bayesian(2, options);
    while (!search->stop())
      one_generation(*search, [&](const Eigen::VectorXd &x) { return offset + unit * sphere_function(x); });
    return search->result().answer;
  };
  EXPECT_LT((answer(-1000, 1) - Eigen::Vector2d(0.2, 0.2)).norm(), 0.03);
  EXPECT_LT((answer(0, 1e6) - Eigen::Vector2d(0.2, 0.2)).norm(), 0.03);
}

struct Known {
  MatrixRM points = even_points(60, 3);
  Eigen::VectorXd values;
  Known() : values(points.rows()) {
    NormalGenerator random(5);
    for (Eigen::Index i = 0; i < points.rows(); ++i)
      values[i] = std::sin(4 * points(i, 0)) + points(i, 1) * points(i, 1) + 0.01 * random.normal();
  }
};

TEST(GaussianProcess, GradientsAreThoseOfFiniteDifferences) {
  const Known known;
  Eigen::VectorXd logs(5), gradient, unused;
  logs << -0.5, 0.2, 0.7, -1, -5;
  GaussianProcess::misfit(known.points, known.values, logs, gradient);
  constexpr double kStep = 1e-5;
  for (int i = 0; i < 5; ++i) {
    Eigen::VectorXd up = logs, down = logs;
    up[i] += kStep, down[i] -= kStep;
    const double slope = (GaussianProcess::misfit(known.points, known.values, up, unused) -
                          GaussianProcess::misfit(known.points, known.values, down, unused)) /
                         (2 * kStep);
    EXPECT_NEAR(gradient[i], slope, 1e-4 * std::max(1.0, std::fabs(slope))) << i;
  }
  const GaussianProcess process(known.points, known.values, logs, 0);
  const Eigen::Vector3d at(0.3, 0.6, 0.2);
  process.mean(at, gradient);
  for (int i = 0; i < 3; ++i) {
    Eigen::Vector3d up = at, down = at;
    up[i] += kStep, down[i] -= kStep;
    EXPECT_NEAR(gradient[i], (process.mean(up, unused) - process.mean(down, unused)) / (2 * kStep), 1e-6) << i;
  }
  EXPECT_NEAR(process.mean(at, gradient), process.mean(MatrixRM(at.transpose()))[0], 1e-10);
}

TEST(GaussianProcess, AveragesTheNoiseAndFindsWhatDoesNotCount) {
  const Known known;
  const GaussianProcess process(known.points, known.values, {}, 60);
  const MatrixRM elsewhere = even_points(40, 3, 60);
  const Eigen::VectorXd mean = process.mean(elsewhere);
  Eigen::VectorXd posterior;
  Eigen::MatrixXd covariance;
  process.posterior(elsewhere, posterior, covariance);
  EXPECT_LT((posterior - mean).cwiseAbs().maxCoeff(), 1e-9);
  double off = 0;
  for (Eigen::Index i = 0; i < elsewhere.rows(); ++i)
    off = std::max(off, std::fabs(mean[i] - std::sin(4 * elsewhere(i, 0)) - std::pow(elsewhere(i, 1), 2)));
  EXPECT_LT(off, 0.05);
  EXPECT_GT(process.lengths()[2], 2 * process.lengths()[0]);
  EXPECT_NEAR(process.noise(), 0.01, 0.006);
  EXPECT_GT(covariance.diagonal().minCoeff(), 0);
}

/// Of a quadratic the Gibbs posterior is normal: variance = temperature / (2 weight), the temperature being twice the noise.
TEST(Posterior, OfAQuadraticIsNormal) {
  const MatrixRM samples = even_points(300, 3);
  Eigen::VectorXd energies(samples.rows());
  NormalGenerator random(1);
  for (Eigen::Index i = 0; i < samples.rows(); ++i)
    energies[i] = 10 + 200 * std::pow(samples(i, 0) - 0.4, 2) + 50 * std::pow(samples(i, 1) - 0.6, 2) + 0.01 * random.normal();
  PosteriorOptions options;
  options.noise = 1;
  options.draws = 1000;
  const Posterior posterior = posterior_of(samples, energies, options);
  EXPECT_NEAR(posterior.draws.col(0).mean(), 0.4, 0.02);
  EXPECT_NEAR(posterior.draws.col(1).mean(), 0.6, 0.02);
  const double within = 2 * 1.645; // 90 % of a normal distribution, in standard deviations
  EXPECT_NEAR(posterior.interval(0, 1) - posterior.interval(0, 0), within * std::sqrt(2 / 400.0), 0.04);
  EXPECT_NEAR(posterior.interval(1, 1) - posterior.interval(1, 0), within * std::sqrt(2 / 100.0), 0.08);
  EXPECT_GT(posterior.interval(2, 1) - posterior.interval(2, 0), 0.8); // what does not count may be anything
  EXPECT_NEAR(posterior.correlation(0, 1), 0, 0.15);
  EXPECT_NEAR(posterior.correlation(0, 0), 1, 1e-9);
}

TEST(Posterior, FewDrawsAreInsideTheBoxToo) {
  const MatrixRM samples = even_points(200, 2);
  Eigen::VectorXd energies(samples.rows());
  for (Eigen::Index i = 0; i < samples.rows(); ++i)
    energies[i] = 10 + 5000 * (samples.row(i) - Eigen::RowVector2d(0.5, 0.4)).squaredNorm();
  PosteriorOptions options;
  options.noise = 1;
  for (const int draws : {1, 5, 10}) {
    options.draws = draws;
    const Posterior posterior = posterior_of(samples, energies, options);
    EXPECT_GT(posterior.interval.col(0).minCoeff(), 0.2) << draws;
    EXPECT_LT(posterior.interval.col(1).maxCoeff(), 0.8) << draws;
  }
}

TEST(Posterior, TellsWhatMakesUpForWhat) {
  const MatrixRM samples = even_points(200, 2);
  Eigen::VectorXd energies(samples.rows());
  for (Eigen::Index i = 0; i < samples.rows(); ++i)
    energies[i] = 5 + 100 * std::pow(samples(i, 0) + samples(i, 1) - 1, 2);
  PosteriorOptions options;
  options.noise = 0.1;
  EXPECT_LT(posterior_of(samples, energies, options).correlation(0, 1), -0.9);
  EXPECT_THROW(posterior_of(samples, energies.head(3)), std::invalid_argument);
  energies[0] = std::nan("");
  EXPECT_THROW(posterior_of(samples, energies), std::invalid_argument);
}

TEST(Posterior, LevelsAreDrawnAsOftenAsTheyAreLikely) {
  MatrixRM samples = even_points(240, 2);
  Eigen::VectorXd energies(samples.rows());
  for (Eigen::Index i = 0; i < samples.rows(); ++i) {
    samples(i, 1) = (i % 3) / 2.0;
    energies[i] = 10 + 20 * std::pow(samples(i, 0) - 0.5, 2) + 4 * std::pow(samples(i, 1), 2);
  }
  PosteriorOptions options;
  options.noise = 1;
  options.levels = 3;
  options.draws = 1000;
  const Posterior posterior = posterior_of(samples, energies, options);
  std::set<double> levels(posterior.draws.col(1).begin(), posterior.draws.col(1).end());
  EXPECT_LE(levels.size(), 3u);
  const double lowest = (posterior.draws.col(1).array() == 0).cast<double>().mean();
  EXPECT_NEAR(lowest, 1 / (1 + std::exp(-0.5) + std::exp(-2.0)), 0.08);
}

/// Where the energy is low it is the same for all of the second coordinate below 0.6, but the search has looked only above 0.4;
/// from elsewhere the process knows that the coordinate may count.
TEST(Posterior, IntervalsReachWhereTheSearchHadNoReasonToLook) {
  const auto low = [](const auto &x) { return std::fabs(x[0] - 0.5) < 0.25; };
  const auto energy = [&](const auto &x) {
    const double above = std::max(0.0, x[1] - 0.6);
    return 10 + 300 * std::pow(x[0] - 0.5, 2) + 200 * above * above + (low(x) ? 0 : 10 * std::sin(9 * x[1]));
  };
  MatrixRM samples(0, 2);
  const auto add = [&](const auto &sample) {
    samples.conservativeResize(samples.rows() + 1, 2);
    samples.bottomRows(1) = sample;
  };
  const MatrixRM everywhere = even_points(120, 2);
  for (const auto &sample : everywhere.rowwise())
    if (!low(sample) || sample[1] > 0.4)
      add(sample);
  PosteriorOptions options;
  options.noise = 0.5;
  const auto posterior = [&] {
    Eigen::VectorXd energies(samples.rows());
    for (Eigen::Index i = 0; i < samples.rows(); ++i)
      energies[i] = energy(samples.row(i));
    return posterior_of(samples, energies, options);
  };
  const Posterior before = posterior();
  EXPECT_GT(before.interval(1, 0), 0.2);

  const MatrixRM beyond = beyond_intervals(before, Eigen::Vector2d(0.5, 0.55), 2, 16);
  for (const auto &sample : beyond.rowwise())
    add(sample);
  const Posterior after = posterior();
  EXPECT_LT(after.interval(1, 0), 0.1);
  EXPECT_GT(after.interval(1, 1), 0.5);
  EXPECT_GT(after.interval(0, 0), 0.35); // what does count is known as well as it was
  EXPECT_LT(after.interval(0, 1), 0.65);
}

TEST(Posterior, SamplesBeyondIntervalsMoveOneCoordinateOutwards) {
  Posterior posterior;
  posterior.draws = even_points(40, 3);
  posterior.interval.resize(3, 2);
  posterior.interval << 0.3, 0.6, 0, 0.9, 0.2, 0.8;
  const Eigen::Vector3d answer(0.4, 0.5, 0.5);
  const MatrixRM samples = beyond_intervals(posterior, answer, 2, 20);
  const double expected[][2] = {{0, 0.2}, {0, 0.6 + 0.4 / 3}, {1, 0.9 + 0.1 / 3}}; // axis, value; the lower end of axis 1 is at 0
  for (int i = 0; i < 3; ++i) {
    Eigen::Vector3d moved = answer;
    moved[static_cast<int>(expected[i][0])] = expected[i][1];
    EXPECT_NEAR((samples.row(i).transpose() - moved).norm(), 0, 1e-12) << i;
  }
  EXPECT_EQ(samples(3, 0), 0); // draws, all the way
  EXPECT_EQ(samples(4, 0), 1);
  EXPECT_EQ(samples(5, 1), 1);
  EXPECT_EQ(samples.row(3).tail(2), posterior.draws.row(3).tail(2));
  EXPECT_EQ(samples.bottomRows(8), posterior.draws.middleRows(12, 8)); // nothing is left beyond
  EXPECT_TRUE((samples.array() >= 0 && samples.array() <= 1).all());
  EXPECT_THROW(beyond_intervals(posterior, answer, 2, 41), std::invalid_argument);
  EXPECT_THROW(beyond_intervals(posterior, answer, 4, 20), std::invalid_argument);
  EXPECT_THROW(beyond_intervals(posterior, answer.head(2), 2, 20), std::invalid_argument);
}

} // namespace
} // namespace doublet
