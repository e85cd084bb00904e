#pragma once
// Black-box minimisation over the box [0, 1]^n in generations: ask for samples, tell their energies.

#include "doublet/core/types.h"
#include "doublet/options/options.h"

#include <cstdint>
#include <memory>
#include <string>

namespace doublet {

/// The state of a search.
struct OptimizerResult {
  Eigen::VectorXd answer;     ///< (n) what the method returns: CMA-ES the distribution's mean, annealing the best sample
  Eigen::VectorXd best;       ///< (n) best sample so far
  double best_energy = 0;     ///< its energy; meaningless while evaluations == 0
  Eigen::VectorXd deviations; ///< (n) standard deviation of the search along each axis
  int evaluations = 0, generations = 0;
  std::string stop_reason; ///< why the search stopped, as text for people; empty while running
};

/// The swap point. Samples may leave the box: the caller clamps them and adds the penalty (see minimise()).
/// Threads: one call at a time, whichever thread makes it.
class Optimizer {
public:
  virtual ~Optimizer() = default;
  /// (S, n) the next generation. A second call before tell() draws other samples.
  virtual MatrixRM ask() = 0;
  /// samples (S, n) from ask(), energies (S), finite, lower is better. Throws std::invalid_argument on wrong sizes or non-finite
  /// energies.
  virtual void tell(const MatrixRM &samples, const Eigen::VectorXd &energies) = 0;
  virtual bool stop() const = 0;
  virtual OptimizerResult result() const = 0;
  /// The exact state as text, valid between tell() and ask(). An optimiser that does not support this returns "": its runs cannot
  /// be resumed.
  virtual std::string save() const { return {}; }
  /// Continues as the saved optimiser would have, with the same bits. Throws Error if the text is not a valid state.
  virtual void restore(const std::string &state);
};

/// Covariance matrix adaptation, Hansen, "The CMA Evolution Strategy: A Tutorial" (arXiv:1604.00772), Sect. A, standard
/// parameters without negative weights: weighted recombination, cumulation, rank-one and rank-mu update, cumulative step-size
/// adaptation.
struct CmaEsOptions {
  int population = 0;
  double initial_mean = 0.5;
  double initial_sigma = 0.3;
  int max_evaluations = 512;
  double min_deviation = 0.025;
  /// Over the last twenty generations, the median of the later ten against that of the earlier ten. After "TolFun" and
  /// "Stagnation" of the tutorial's Appendix B.3, but effective within the paper's 512 evaluations. Below the noise of a chaotic
  /// energy the search only wanders: with 3 % of noise on a quadratic in five parameters it ends after 289 evaluations instead of
  /// 359, at an energy 0.1 % higher.
  double stagnation = 0.02;
  std::uint64_t seed = 1;
  static constexpr auto describe() {
    using namespace options;
    using O = CmaEsOptions;
    return Description{
        "CmaEsOptions",
        option(&O::population, "population", at_least(0), "", "Number of samples per generation; 0 = Hansen's 4 + floor(3 ln n)",
               "8 for n = 5, 9 for n = 6"),
        option(&O::initial_mean, "initial_mean", Range{}, "", "Mean at the start along every axis; 0.5 = the centre of the box"),
        option(&O::initial_sigma, "initial_sigma", above(0), "", "Standard deviation at the start along every axis",
               "At 0.3 the box is about +-1.7 standard deviations"),
        option(&O::max_evaluations, "max_evaluations", at_least(1), "",
               "No generation begins at or beyond this number of evaluations", "512 is the paper's"),
        option(&O::min_deviation, "min_deviation", at_least(0), "",
               "The search stops when all standard deviations are below this", "0.025 is the paper's"),
        option(&O::stagnation, "stagnation", at_least(0), "",
               "The search stops when best and median energies change by less than this share; 0 = never"),
        option(&O::seed, "seed", at_least(0), "", "Seed of the random numbers"),
    };
  }
  void validate() const; ///< throws std::invalid_argument naming option, range and value
};
/// Throws std::invalid_argument for wrong options or a dimension below 1.
std::unique_ptr<Optimizer> create_cma_es(int dimension, const CmaEsOptions &options = {});

/// Bayesian optimisation of an energy that is expensive and noisy: a Gaussian process over all samples so far averages the noise
/// and says where the minimum may lie; every sample of a generation is the minimum of one function drawn from it (Thompson
/// sampling: Hernandez-Lobato et al., "Parallel and distributed Thompson sampling", ICML 2017), so that samples are distributed
/// like the minimum. Energies are transformed to asinh((E - a) / s), where a is the first quartile of all so far, and s the
/// difference between their median and minimum: linear for low energies, logarithmic far above.
struct BayesianOptions {
  int population = 32;
  int max_evaluations = 512;
  double min_gain = 0.02;
  double min_expected_gain = 0.005;
  int levels = 0;
  std::uint64_t seed = 1;
  MatrixRM first;
  static constexpr auto describe() {
    using namespace options;
    using O = BayesianOptions;
    return Description{
        "BayesianOptions",
        option(&O::population, "population", Range{4, 4096}, "", "Number of samples per generation",
               "Two groups of 16 fill the SIMD lanes of two threads"),
        option(&O::max_evaluations, "max_evaluations", at_least(1), "",
               "No generation begins at or beyond this number of evaluations"),
        option(&O::min_gain, "min_gain", at_least(0), "",
               "The search stops when four generations have gained less than this share of the energy; 0 = never"),
        option(&O::min_expected_gain, "min_expected_gain", above(0), "",
               "To stop, it must also expect, twice in a row, to gain less than this share; large = no condition"),
        option(&O::levels, "levels", Range{0, 64}, "",
               "Number of evenly spaced values of the last coordinate, if above 1; otherwise it is continuous",
               "Groups of 16 samples share a value; the search samples the values next to the answer's before it stops"),
        option(&O::seed, "seed", at_least(0), "", "Seed of the random numbers"),
        not_serialised(&O::first, "first", "(K, n), K >= 4, the first generation; empty = 2 `population` evenly spread points"),
    };
  }
  void validate() const; ///< throws std::invalid_argument naming option, range and value
};
std::unique_ptr<Optimizer> create_bayesian(int dimension, const BayesianOptions &options = {});

/// Simulated annealing (Kirkpatrick et al. 1983; the paper's comparison): independent Metropolis chains under one geometric
/// cooling schedule, Gaussian steps that shrink with the temperature, reflected at the box.
struct AnnealingOptions {
  int chains = 4;
  int max_evaluations = 2048;
  double initial_step = 0.3;
  double final_step = 0.025;
  double initial_temperature = 0.3;
  double final_temperature = 1e-3;
  std::uint64_t seed = 1;
  static constexpr auto describe() {
    using namespace options;
    using O = AnnealingOptions;
    return Description{
        "AnnealingOptions",
        option(&O::chains, "chains", at_least(1), "", "Number of chains, which is the number of samples per generation"),
        option(&O::max_evaluations, "max_evaluations", at_least(1), "", "Length of the cooling schedule in evaluations",
               "The paper needs 2 to 4 times as many as with CMA-ES"),
        option(&O::initial_step, "initial_step", above(0), "", "Standard deviation of a step at the start, in box units"),
        option(&O::final_step, "final_step", above(0), "", "Standard deviation of a step at the end, in box units"),
        option(&O::initial_temperature, "initial_temperature", above(0), "",
               "Temperature at the start, as a share of the first generation's mean energy"),
        option(&O::final_temperature, "final_temperature", above(0), "",
               "Temperature at the end, as a share of the first generation's mean energy"),
        option(&O::seed, "seed", at_least(0), "", "Seed of the random numbers"),
    };
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
};
std::unique_ptr<Optimizer> create_simulated_annealing(int dimension, const AnnealingOptions &options = {});

} // namespace doublet
