#include "doublet/fit/parts/gaussian_process.h"

#include <LBFGSB.h>

#include <functional>
#include <limits>
#include <stdexcept>

namespace doublet {
namespace {

constexpr double kJitter = 1e-8; // of the variance: rounding must not make the covariance indefinite

/// What is believed of the logarithms beforehand, normal: lengths of half a box within a factor of 2.2, values that differ by
/// their own size, noise of a few percent. It keeps a parameter that the points do not tell from running away.
struct Belief {
  Eigen::VectorXd mean, deviation, lower, upper;
  explicit Belief(Eigen::Index n) : mean(n + 2), deviation(n + 2), lower(n + 2), upper(n + 2) {
    const auto set = [](Eigen::VectorXd &v, double length, double function, double noise) {
      v.setConstant(length);
      v.tail(2) << function, noise;
    };
    set(mean, std::log(0.6), std::log(0.5), 2 * std::log(0.03));
    set(deviation, 0.8, 1.5, 1.5);
    set(lower, std::log(0.08), std::log(1e-3), 2 * std::log(0.003));
    set(upper, std::log(5.0), std::log(20.0), 2 * std::log(0.5));
  }
};

/// (N, M) squared distances in units of the lengths.
Eigen::MatrixXd squared_distances(const MatrixRM &a, const MatrixRM &b, const Eigen::VectorXd &lengths) {
  const Eigen::RowVectorXd scale = lengths.cwiseInverse().transpose();
  const MatrixRM p = a.array().rowwise() * scale.array(), q = b.array().rowwise() * scale.array();
  Eigen::MatrixXd squared(p.rows(), q.rows());
  for (Eigen::Index j = 0; j < q.rows(); ++j)
    squared.col(j) = (p.rowwise() - q.row(j)).rowwise().squaredNorm();
  return squared;
}

/// Matern 5/2 of squared distances, variance 1.
Eigen::MatrixXd matern(const Eigen::MatrixXd &squared) {
  const Eigen::ArrayXXd r = (5 * squared.array()).sqrt();
  return ((1 + r + r.square() / 3) * (-r).exp()).matrix();
}

/// Points with their covariance taken apart, and what follows for values.
struct Solved {
  Eigen::LLT<Eigen::MatrixXd> factor;
  double level = 0;        // the mean of least squares
  Eigen::VectorXd weights; // K^-1 (values - level)
  Solved(Eigen::MatrixXd covariance, const Eigen::VectorXd &values) : factor(std::move(covariance)) {
    const Eigen::VectorXd ones = factor.solve(Eigen::VectorXd::Ones(values.size()));
    level = ones.dot(values) / ones.sum();
    weights = factor.solve((values.array() - level).matrix());
  }
};

Eigen::MatrixXd noisy(Eigen::MatrixXd covariance, double noise_variance, double variance) {
  covariance.diagonal().array() += noise_variance + kJitter * variance;
  return covariance;
}

/// Where value(x, gradient) is lowest between bounds (n), as far as so many steps of L-BFGS-B from `start` lead.
Eigen::VectorXd minimised(const std::function<double(const Eigen::VectorXd &, Eigen::VectorXd &)> &value,
                          const Eigen::VectorXd &start, const Eigen::VectorXd &lower, const Eigen::VectorXd &upper, int steps) {
  Eigen::VectorXd best = start;
  double lowest = std::numeric_limits<double>::infinity();
  const auto remembered = [&](const Eigen::VectorXd &x, Eigen::VectorXd &gradient) {
    const double found = value(x, gradient);
    if (found < lowest)
      lowest = found, best = x;
    return found;
  };
  LBFGSpp::LBFGSBParam<double> parameters;
  parameters.max_iterations = steps;
  parameters.epsilon = parameters.epsilon_rel = 1e-4;
  LBFGSpp::LBFGSBSolver<double> solver(parameters);
  Eigen::VectorXd x = start;
  double last = 0;
  try {
    solver.minimize(remembered, x, last, lower, upper);
  } catch (const std::logic_error &) { // it cannot get lower: the best so far is the answer
  } catch (const std::runtime_error &) {
  }
  return best;
}

} // namespace

double GaussianProcess::misfit(const MatrixRM &points, const Eigen::VectorXd &values, const Eigen::VectorXd &logs,
                               Eigen::VectorXd &gradient) {
  const Eigen::Index n = points.cols(), count = values.size();
  const Eigen::VectorXd lengths = logs.head(n).array().exp();
  const double variance = std::exp(logs[n]), noise = std::exp(logs[n + 1]);
  const Eigen::MatrixXd squared = squared_distances(points, points, lengths), function = variance * matern(squared);
  const Solved solved(noisy(function, noise, variance), values);
  const Belief belief(n);
  const Eigen::ArrayXd off = (logs - belief.mean).array() / belief.deviation.array();
  gradient = off / belief.deviation.array();
  if (solved.factor.info() != Eigen::Success)
    return std::numeric_limits<double>::max();
  const Eigen::VectorXd rest = (values.array() - solved.level).matrix();
  const double result =
      0.5 * rest.dot(solved.weights) + solved.factor.matrixLLT().diagonal().array().log().sum() + 0.5 * off.square().sum();
  // d misfit / d K = (K^-1 - w w^T) / 2, eq. (5.9)
  Eigen::MatrixXd slope = solved.factor.solve(Eigen::MatrixXd::Identity(count, count));
  slope.noalias() -= solved.weights * solved.weights.transpose();
  slope *= 0.5;
  const Eigen::ArrayXXd r = (5 * squared.array()).sqrt();
  const Eigen::ArrayXXd along = slope.array() * (variance * 5 / 3) * (1 + r) * (-r).exp(); // times (x_d / length_d)^2
  for (Eigen::Index d = 0; d < n; ++d) {
    const Eigen::ArrayXd x = points.col(d).array() / lengths[d];
    for (Eigen::Index j = 0; j < count; ++j)
      gradient[d] += (along.col(j) * (x - x[j]).square()).sum();
  }
  gradient[n] += (slope.array() * function.array()).sum() + kJitter * variance * slope.trace();
  gradient[n + 1] += noise * slope.trace();
  return result;
}

GaussianProcess::GaussianProcess(const MatrixRM &points, const Eigen::VectorXd &values, const Eigen::VectorXd &logs, int steps)
    : points_(points), logs_(logs) {
  const Eigen::Index n = points.cols();
  const Belief belief(n);
  if (logs_.size() == 0)
    logs_ = belief.mean;
  if (steps > 0)
    logs_ = minimised([&](const Eigen::VectorXd &x, Eigen::VectorXd &g) { return misfit(points, values, x, g); }, logs_,
                      belief.lower, belief.upper, steps);
  const double variance = std::exp(logs_[n]);
  Solved solved(noisy(variance * matern(squared_distances(points, points, lengths())), std::exp(logs_[n + 1]), variance), values);
  factor_ = std::move(solved.factor);
  level_ = solved.level;
  weights_ = std::move(solved.weights);
}

Eigen::VectorXd GaussianProcess::mean(const MatrixRM &at) const {
  const double variance = std::exp(logs_[points_.cols()]);
  return (variance * (matern(squared_distances(at, points_, lengths())) * weights_)).array() + level_;
}

double GaussianProcess::mean(const Eigen::VectorXd &at, Eigen::VectorXd &gradient) const {
  const Eigen::Index n = points_.cols();
  const Eigen::RowVectorXd lengths = this->lengths().transpose();
  const double variance = std::exp(logs_[n]);
  double sum = 0;
  gradient.setZero(n);
  for (Eigen::Index i = 0; i < points_.rows(); ++i) {
    const Eigen::RowVectorXd x = (at.transpose() - points_.row(i)).cwiseQuotient(lengths);
    const double r = std::sqrt(5 * x.squaredNorm()), decay = weights_[i] * variance * std::exp(-r);
    sum += decay * (1 + r + r * r / 3);
    gradient -= decay * 5 / 3 * (1 + r) * x.cwiseQuotient(lengths).transpose();
  }
  return level_ + sum;
}

Eigen::VectorXd GaussianProcess::minimum(const Eigen::VectorXd &start, int fixed) const {
  constexpr int kMinimumSteps = 40;
  const Eigen::Index free = points_.cols() - fixed;
  Eigen::VectorXd at = start, slope;
  const auto value = [&](const Eigen::VectorXd &x, Eigen::VectorXd &gradient) {
    at.head(free) = x;
    const double result = mean(at, slope);
    gradient = slope.head(free);
    return result;
  };
  at.head(free) = Eigen::VectorXd(
      minimised(value, start.head(free), Eigen::VectorXd::Zero(free), Eigen::VectorXd::Ones(free), kMinimumSteps));
  return at;
}

void GaussianProcess::posterior(const MatrixRM &at, Eigen::VectorXd &mean, Eigen::MatrixXd &covariance) const {
  const double variance = std::exp(logs_[points_.cols()]);
  const Eigen::MatrixXd cross = variance * matern(squared_distances(points_, at, lengths())); // (N, M)
  mean = (cross.transpose() * weights_).array() + level_;
  const Eigen::MatrixXd half = factor_.matrixL().solve(cross);
  covariance = variance * matern(squared_distances(at, at, lengths()));
  covariance.noalias() -= half.transpose() * half;
}

} // namespace doublet
