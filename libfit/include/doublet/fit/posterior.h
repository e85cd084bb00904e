#pragma once
// Posterior over the answer of a minimisation, from samples of its noisy energy.

#include "doublet/core/types.h"

#include <cstdint>

namespace doublet {

/// Draws from a Gibbs posterior (Bissiri, Holmes, Walker, "A general framework for updating belief distributions", JRSS B 78(5),
/// 2016) over the box, density ~ exp(-energy / temperature), where the energy is that of a Gaussian process over all samples. The
/// temperature is proportional to the noise of an energy (kTemperature, measured on videos of known materials, see
/// docs/material-estimation.md): the video, too, shows only one of many motions that its material could have made, so that
/// answers whose energies differ by less than the noise cannot be distinguished.
struct Posterior {
  MatrixRM draws;              ///< (D, n) box units
  MatrixRM interval;           ///< (n, 2) the shortest interval with 90 % of the draws
  Eigen::MatrixXd correlation; ///< (n, n) of the draws; 0 in rows and columns of parameters that do not vary
};

struct PosteriorOptions {
  double noise = 0; ///< standard deviation of an energy at the answer, energy units; that of the process is used if it is larger
  int levels = 0;   ///< above 1: number of evenly spaced values of the last coordinate
  int draws = 256;  ///< number of draws
  std::uint64_t seed = 1;
};

/// samples (N, n) in [0, 1], energies (N), N >= 2. Throws std::invalid_argument for other sizes, numbers that are not finite, or
/// options beyond [0, 1000] levels and [1, 100000] draws.
Posterior posterior_of(const MatrixRM &samples, const Eigen::VectorXd &energies, const PosteriorOptions &options = {});

/// (count, n) box units: samples to be evaluated before the intervals of a posterior are trusted. Where a search has no samples,
/// the process reverts to the mean energy, so that an interval ends where the samples end. Returns the answer (n) and draws,
/// moved along one of the first `axes` coordinates beyond the ends of its interval, by a third of the distance to the bound of
/// the box and by all of it; then unchanged draws. Throws std::invalid_argument for an answer of another size, more axes than
/// coordinates, or more samples than draws.
MatrixRM beyond_intervals(const Posterior &posterior, const Eigen::VectorXd &answer, int axes, int count);

} // namespace doublet
