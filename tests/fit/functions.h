#pragma once
// Standard test functions, minimum 0 (Hansen's benchmark set), and the loop that counts evaluations to a target.

#include "doublet/fit/optimizer.h"

#include <cmath>
#include <functional>

namespace doublet::testing {

using Function = std::function<double(const Eigen::VectorXd &)>;

inline double sphere_function(const Eigen::VectorXd &x) {
  return (x.array() - 0.2).square().sum();
}

inline double ellipsoid(const Eigen::VectorXd &x) {
  double sum = 0;
  for (Eigen::Index i = 0; i < x.size(); ++i)
    sum += std::pow(1e6, static_cast<double>(i) / static_cast<double>(x.size() - 1)) * std::pow(x[i] - 0.2, 2);
  return sum;
}

inline double rosenbrock(const Eigen::VectorXd &x) {
  double sum = 0;
  for (Eigen::Index i = 0; i + 1 < x.size(); ++i)
    sum += 100 * std::pow(x[i + 1] - x[i] * x[i], 2) + std::pow(1 - x[i], 2);
  return sum;
}

inline Eigen::VectorXd energies_of(const MatrixRM &samples, const Function &f) {
  Eigen::VectorXd energies(samples.rows());
  for (Eigen::Index i = 0; i < samples.rows(); ++i)
    energies[i] = f(samples.row(i).transpose());
  return energies;
}

inline void one_generation(Optimizer &optimizer, const Function &f) {
  const MatrixRM samples = optimizer.ask();
  optimizer.tell(samples, energies_of(samples, f));
}

/// Evaluations until the best sample is below `target`, or `limit`.
inline int evaluations_to_target(Optimizer &optimizer, const Function &f, double target, int limit) {
  while (optimizer.result().evaluations == 0 ||
         (optimizer.result().best_energy > target && optimizer.result().evaluations < limit))
    one_generation(optimizer, f);
  return optimizer.result().evaluations;
}

} // namespace doublet::testing
