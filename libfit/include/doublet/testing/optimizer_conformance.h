#pragma once
// What every Optimizer must do, for those who write their own: call it in a test of any framework and expect an empty list.

#include "doublet/fit/minimise.h"
#include "doublet/options/options.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace doublet::testing {

/// One sentence for each rule that the optimisers of make(dimension, seed) break: samples have `dimension` columns and are
/// finite, the same seed gives the same samples, a paraboloid in the box is minimised and the search ends, result() has the best
/// sample, energies in the wrong number or not finite are refused.
inline std::vector<std::string> optimizer_violations(const OptimizerFactory &make) {
  constexpr int kDimension = 3, kMostGenerations = 5000;
  const auto energies_of = [](const MatrixRM &samples) {
    return Eigen::VectorXd((samples.array() - 0.6).square().rowwise().sum());
  };
  std::vector<std::string> broken;
  try {
    const auto optimizer = make(kDimension, 7), twin = make(kDimension, 7);
    double best = 1e300;
    int generations = 0;
    for (; generations < kMostGenerations && !optimizer->stop(); ++generations) {
      const MatrixRM samples = optimizer->ask();
      if (samples.rows() == 0 || samples.cols() != kDimension || !samples.allFinite())
        return {"ask() must return finite samples (S, " + std::to_string(kDimension) + "), found (" +
                std::to_string(samples.rows()) + ", " + std::to_string(samples.cols()) + ")"};
      if (twin->ask() != samples)
        return {"the same seed gives other samples"};
      best = std::min(best, energies_of(samples).minCoeff());
      optimizer->tell(samples, energies_of(samples));
      twin->tell(samples, energies_of(samples));
    }
    if (generations == kMostGenerations)
      broken.push_back("the search does not end: stop() is false after " + std::to_string(generations) + " generations");
    const OptimizerResult result = optimizer->result();
    if (result.best_energy != best)
      broken.push_back("result().best_energy is " + options::to_text(result.best_energy) + ", the lowest told was " +
                       options::to_text(best));
    if (result.answer.size() != kDimension || !((result.answer.array() - 0.6).abs() < 0.1).all())
      broken.push_back("the answer is not within 0.1 of the minimum of a paraboloid");
    const auto other = make(kDimension, 7);
    const MatrixRM samples = other->ask();
    const auto refused = [&](const Eigen::VectorXd &energies, const std::string &what) {
      try {
        other->tell(samples, energies);
        broken.push_back(what + " are not refused");
      } catch (const std::exception &) { // of whatever kind: Python has its own
      }
    };
    refused(Eigen::VectorXd::Zero(samples.rows() + 1), "more energies than samples");
    refused(Eigen::VectorXd::Constant(samples.rows(), std::numeric_limits<double>::infinity()), "energies that are not finite");
  } catch (const std::exception &error) {
    broken.push_back(std::string("the optimiser threw: ") + error.what());
  }
  return broken;
}

} // namespace doublet::testing
