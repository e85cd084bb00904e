#pragma once
// How likely every answer of a minimisation is, from samples of its noisy energy.

#include "doublet/core/types.h"

#include <cstdint>

namespace doublet {

/// Draws from a Gibbs posterior (Bissiri, Holmes, Walker, "A general framework for updating belief distributions", JRSS B 78(5),
/// 2016) over the box, density ~ exp(-energy / temperature), the energy that of a Gaussian process over all samples. What is
/// `noise` for an energy is noise for the film, too, which is one motion of many that the same material could have made: answers
/// whose energies differ by less cannot be told apart, and the temperature is in proportion to it (kTemperature, measured on
/// films of known materials, see docs/material-estimation.md).
struct Posterior {
  MatrixRM draws;              ///< (D, n) box units
  MatrixRM interval;           ///< (n, 2) the shortest interval with 90 % of the draws
  Eigen::MatrixXd correlation; ///< (n, n) of the draws; 0 beside what does not vary
};

struct PosteriorOptions {
  double noise = 0; ///< standard deviation of an energy at the answer, energy units; the process' own if that is larger
  int levels = 0;   ///< above 1: the last coordinate takes so many values, evenly spaced
  int draws = 256;  ///< how many
  std::uint64_t seed = 1;
};

/// samples (N, n) in [0, 1], energies (N), N >= 2. Throws std::invalid_argument for other sizes, numbers that are not finite, or
/// options beyond [0, 1000] levels and [1, 100000] draws.
Posterior posterior_of(const MatrixRM &samples, const Eigen::VectorXd &energies, const PosteriorOptions &options = {});

/// (count, n) box units: samples for which the posterior has to be asked before its intervals are believed. Where a search has no
/// reason to look, the process has nothing to go by and takes the energy for as high as elsewhere in the box, so that an interval
/// ends where the samples do. The answer and draws, moved along one of the first `axes` coordinates beyond the end of its
/// interval, a third of the way to the bound of the box and all of it; then draws as they are. answer (n). Throws
/// std::invalid_argument for an answer of another size, more axes than coordinates, or more samples than draws.
MatrixRM beyond_intervals(const Posterior &posterior, const Eigen::VectorXd &answer, int axes, int count);

} // namespace doublet
