#pragma once
// Interacting simulated annealing: a global minimiser for energies with many minima (Gall, Potthoff, Schnoerr, Rosenhahn &
// Seidel, "Interacting and annealing particle filters", JMIV 28, 2007; Gall, Rosenhahn & Seidel 2008 for human pose).

#include <Eigen/Core>
#include <cstdint>
#include <functional>

namespace doublet {

struct ParticleAnnealingOptions {
  int particles = 100; ///< energies an iteration
  int iterations = 10;
  double coldness = 10; ///< beta_t = coldness (t + 1)^power; a difference in energy of 1 / beta_t makes a particle e times rarer
  double power = 0.7;   ///< Gall et al. 2007, Sect. 5.2
  double spread = 0.4;  ///< share of the particles' covariance with which they are moved after each selection (ibid., alpha)
  std::uint64_t seed = 1;
  void validate() const;
};

struct ParticleAnnealingResult {
  Eigen::VectorXd best; ///< (D) the lowest particle ever seen
  double energy = 0;
  int evaluations = 0;
};

/// Energies (n) of n samples (n, D), one a row; finite. Called from the calling thread, once an iteration.
using SampleEnergies = std::function<Eigen::VectorXd(const Eigen::MatrixXd &samples)>;

/// Minimises over the box [lower, upper] (D, +-infinity allowed), beginning with particles around `start`, normal with the
/// standard deviations `deviation` (D, > 0); `start` itself is one of them, so that the result is never worse. Deterministic.
/// Throws std::invalid_argument if sizes differ, a deviation is not positive, or the number of energies is wrong.
ParticleAnnealingResult anneal(const SampleEnergies &energies, const Eigen::VectorXd &start, const Eigen::VectorXd &deviation,
                               const Eigen::VectorXd &lower, const Eigen::VectorXd &upper,
                               const ParticleAnnealingOptions &options = {});

} // namespace doublet
