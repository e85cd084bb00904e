#pragma once
// Interacting simulated annealing: a global minimiser for energies with many minima (Gall, Potthoff, Schnoerr, Rosenhahn &
// Seidel, "Interacting and annealing particle filters", JMIV 28, 2007; Gall, Rosenhahn & Seidel 2008 for human pose).

#include "doublet/options/options.h"

#include <Eigen/Core>
#include <cstdint>
#include <functional>

namespace doublet {

struct ParticleAnnealingOptions {
  int particles = 100;
  int iterations = 10;
  double coldness = 10;
  double power = 0.7;
  double covariance_share = 0.4;
  std::uint64_t seed = 1;
  static constexpr auto describe() {
    using namespace options;
    using O = ParticleAnnealingOptions;
    return Description{
        "ParticleAnnealingOptions",
        option(&O::particles, "particles", at_least(2), "",
               "Number of particles, which is the number of energies computed per iteration"),
        option(&O::iterations, "iterations", at_least(1), "", "Number of selections and moves",
               "100 particles and 10 iterations take 0.5 s per lost limb"),
        option(&O::coldness, "coldness", above(0), "", "Scale of the schedule, beta_t = coldness (t + 1)^power",
               "A difference in energy of 1 / beta_t makes a particle e times rarer"),
        option(&O::power, "power", at_least(0), "", "Power of the schedule (Gall et al. 2007, Sect. 5.2)"),
        option(&O::covariance_share, "covariance_share", Range{0, 1, Open::Below}, "",
               "Share of the particles' covariance with which they move after a selection (ibid., alpha)"),
        option(&O::seed, "seed", at_least(0), "", "Seed of the random numbers"),
    };
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
};

struct ParticleAnnealingResult {
  Eigen::VectorXd best; ///< (D) the sample with the lowest energy of all iterations
  double energy = 0;
  int evaluations = 0;
};

/// Energies (n), finite, of n samples (n, D), one per row. Called from the calling thread, once per iteration.
using SampleEnergies = std::function<Eigen::VectorXd(const Eigen::MatrixXd &samples)>;

/// Minimises over the box [lower, upper] (D, +-infinity allowed). The first particles are drawn from a normal distribution around
/// `start` with the standard deviations `deviation` (D, > 0); `start` itself is one of them, so that the result is never worse.
/// Deterministic. Throws std::invalid_argument if sizes differ, a deviation is not positive, or the number of energies is wrong.
ParticleAnnealingResult anneal(const SampleEnergies &energies, const Eigen::VectorXd &start, const Eigen::VectorXd &deviation,
                               const Eigen::VectorXd &lower, const Eigen::VectorXd &upper,
                               const ParticleAnnealingOptions &options = {});

} // namespace doublet
