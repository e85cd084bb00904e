#pragma once
// Black-box minimisation over the box [0, 1]^n in generations: ask for samples, tell their energies.

#include "doublet/core/types.h"

#include <cstdint>
#include <memory>
#include <string>

namespace doublet {

/// Where an optimiser stands.
struct OptimizerResult {
  Eigen::VectorXd answer;     ///< (n) what the method returns: CMA-ES the distribution's mean, annealing the best sample
  Eigen::VectorXd best;       ///< (n) best sample told so far
  double best_energy = 0;     ///< its energy; meaningless while evaluations == 0
  Eigen::VectorXd deviations; ///< (n) standard deviation of the search along each axis
  int evaluations = 0, generations = 0;
  std::string stop_reason; ///< empty while running
};

/// The swap point. Samples may leave the box: the caller clamps them and adds the penalty (see minimise()).
class Optimizer {
public:
  virtual ~Optimizer() = default;
  /// (S, n) the next generation. Asking again before telling gives another draw.
  virtual MatrixRM ask() = 0;
  /// samples (S, n) as asked, energies (S), finite, lower is better. Throws std::invalid_argument on wrong sizes or non-finite
  /// energies.
  virtual void tell(const MatrixRM &samples, const Eigen::VectorXd &energies) = 0;
  virtual bool stop() const = 0;
  virtual OptimizerResult result() const = 0;
  /// The exact state as text, valid between tell() and ask(). An optimiser that cannot be saved returns "": its runs cannot be
  /// resumed.
  virtual std::string save() const { return {}; }
  /// Continues as the optimiser that was saved would have, to the same bits. Throws Error if the text is no such state.
  virtual void restore(const std::string &state);
};

/// Covariance matrix adaptation, Hansen, "The CMA Evolution Strategy: A Tutorial" (arXiv:1604.00772), Sect. A, standard
/// parameters without negative weights: weighted recombination, cumulation, rank-one and rank-mu update, cumulative step-size
/// adaptation.
struct CmaEsOptions {
  int population = 0;                ///< lambda; 0 = 4 + floor(3 ln n), Hansen's default (8 for n = 5, 9 for n = 6)
  double initial_mean = 0.5;         ///< along every axis: the centre of the box
  double initial_sigma = 0.3;        ///< along every axis: one box is about +-1.7 sigma
  int max_evaluations = 512;         ///< the paper's; no generation begins at or beyond it
  double smallest_deviation = 0.025; ///< stop when all standard deviations are below it (the paper's)
  /// Stop when neither the best nor the median energies of the generations have changed by more than this share of them: over the
  /// last twenty, the median of the later ten against that of the earlier ten. After "TolFun" and "Stagnation" of the tutorial's
  /// Appendix B.3, but ready within the paper's 512 evaluations. Below the noise of a chaotic energy the search only wanders:
  /// with 3 % of noise on a quadratic in five parameters it ends after 289 evaluations instead of 359, 0.1 % higher. 0 = never.
  double stagnation = 0.02;
  std::uint64_t seed = 1;
  void validate() const; ///< throws std::invalid_argument naming option, range and value
};
std::unique_ptr<Optimizer> create_cma_es(int dimension, const CmaEsOptions &options = {});

/// Simulated annealing (Kirkpatrick et al. 1983; the paper's comparison): independent Metropolis chains under one geometric
/// cooling schedule, Gaussian steps that shrink with the temperature, reflected at the box.
struct AnnealingOptions {
  int chains = 4;                   ///< samples a generation
  int max_evaluations = 2048;       ///< the schedule's length; the paper: 2-4 times those of CMA-ES
  double initial_step = 0.3;        ///< standard deviation of a step at the start, in box units
  double final_step = 0.025;        ///< and at the end
  double initial_temperature = 0.3; ///< as a fraction of the first generation's mean energy
  double final_temperature = 1e-3;  ///< likewise
  std::uint64_t seed = 1;
  void validate() const;
};
std::unique_ptr<Optimizer> create_simulated_annealing(int dimension, const AnnealingOptions &options = {});

} // namespace doublet
