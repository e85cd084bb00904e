#pragma once
// Checks that every optimiser makes.

#include "doublet/core/types.h"

#include <stdexcept>
#include <string>

namespace doublet {

inline void require(bool condition, const std::string &message) {
  if (!condition)
    throw std::invalid_argument(message);
}

inline void require_dimension(int dimension, const std::string &who) {
  require(dimension >= 1 && dimension <= 10000, who + ": dimension: expected 1 to 10000, found " + std::to_string(dimension));
}

inline void check_told(const MatrixRM &samples, const Eigen::VectorXd &energies, int dimension, int least) {
  require(samples.cols() == dimension && samples.rows() >= least,
          "tell: samples: expected at least (" + std::to_string(least) + ", " + std::to_string(dimension) + "), found (" +
              std::to_string(samples.rows()) + ", " + std::to_string(samples.cols()) + ")");
  require(energies.size() == samples.rows(),
          "tell: energies: expected " + std::to_string(samples.rows()) + ", found " + std::to_string(energies.size()));
  require(energies.allFinite() && samples.allFinite(),
          "tell: samples and energies: expected finite numbers, found NaN or infinity");
}

} // namespace doublet
