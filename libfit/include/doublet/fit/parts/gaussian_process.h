#pragma once
// Regression of a noisy function of few variables: Rasmussen, Williams, "Gaussian Processes for Machine Learning", MIT Press
// 2006, ch. 2 and 5. Matern covariance (nu = 5/2) with one length scale per axis, constant mean, uniform noise.

#include "doublet/core/types.h"

#include <Eigen/Cholesky>
#include <cmath>

namespace doublet {

class GaussianProcess {
public:
  /// values (N) at points (N, n) in [0, 1], N >= 2. `logs` (n + 2): initial logarithms of the length scales and of the variances
  /// of function and noise; empty = the mean of their prior. `steps`: of their optimisation, 0 = they are used as given.
  GaussianProcess(const MatrixRM &points, const Eigen::VectorXd &values, const Eigen::VectorXd &logs, int steps);

  const Eigen::VectorXd &logs() const { return logs_; }
  Eigen::VectorXd lengths() const { return logs_.head(points_.cols()).array().exp(); } ///< (n)
  double noise() const { return std::exp(0.5 * logs_[points_.cols() + 1]); } ///< standard deviation of the noise of a value

  /// (M) posterior mean of the function, without noise, at points (M, n).
  Eigen::VectorXd mean(const MatrixRM &at) const;
  /// The mean at one point (n), and its gradient (n).
  double mean(const Eigen::VectorXd &at, Eigen::VectorXd &gradient) const;
  /// A minimum of the mean in the box, searched from `start` (n), whose last `fixed` coordinates are kept.
  Eigen::VectorXd minimum(const Eigen::VectorXd &start, int fixed = 0) const;
  /// (M) mean and (M, M) covariance of the function at points (M, n).
  void posterior(const MatrixRM &at, Eigen::VectorXd &mean, Eigen::MatrixXd &covariance) const;

  /// Negative log probability of `values` and of the parameters `logs` (n + 2), up to a constant, and its gradient.
  static double misfit(const MatrixRM &points, const Eigen::VectorXd &values, const Eigen::VectorXd &logs,
                       Eigen::VectorXd &gradient);

private:
  MatrixRM points_;
  Eigen::VectorXd logs_, weights_; // K^-1 (values - level)
  double level_ = 0;
  Eigen::LLT<Eigen::MatrixXd> factor_;
};

} // namespace doublet
