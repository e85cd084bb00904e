// log colour = log albedo of the patch + spherical function of the normal: a linear model with a constant a patch, which
// subtracting the patch's mean takes out.

#include "doublet/animate/parts/irradiance.h"

#include "doublet/core/parts/quantile.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace doublet {
namespace {

using Basis = Eigen::Matrix<double, 8, 1>;
using Coefficients = Eigen::Matrix<double, 8, 3>;

/// All but the constant.
Basis basis(const Eigen::Vector3d &n) {
  Basis b;
  b << n.x(), n.y(), n.z(), n.x() * n.y(), n.y() * n.z(), n.z() * n.x(), n.x() * n.x() - n.y() * n.y(), 3 * n.z() * n.z() - 1;
  return b;
}

void require_points(const ShadedPoints &p) {
  const auto n = p.normals.rows();
  if (p.colours.rows() != n || p.weights.size() != n || static_cast<Eigen::Index>(p.patches.size()) != n)
    throw std::invalid_argument("estimate_irradiance: expected as many colours, weights and patches as normals, " +
                                std::to_string(n) + ", found " + std::to_string(p.colours.rows()) + ", " +
                                std::to_string(p.weights.size()) + " and " + std::to_string(p.patches.size()));
  if (n > 0 && !(p.colours.minCoeff() > 0))
    throw std::invalid_argument("estimate_irradiance: colours: expected above 0, found " + std::to_string(p.colours.minCoeff()));
}

/// (N, C) values less the weighted mean of their patch.
MatrixRM within_patches(const MatrixRM &values, const std::vector<int> &patches, const Eigen::VectorXd &weights) {
  const int count = *std::max_element(patches.begin(), patches.end()) + 1;
  MatrixRM mean = MatrixRM::Zero(count, values.cols());
  Eigen::VectorXd sum = Eigen::VectorXd::Constant(count, 1e-30);
  for (Eigen::Index i = 0; i < values.rows(); ++i) {
    mean.row(patches[i]) += weights[i] * values.row(i);
    sum[patches[i]] += weights[i];
  }
  MatrixRM centred = values;
  for (Eigen::Index i = 0; i < values.rows(); ++i)
    centred.row(i) -= mean.row(patches[i]) / sum[patches[i]];
  return centred;
}

/// Weighted least squares of y (N, 3) over x (N, 8), drawn a little towards 0.
Coefficients solve(const MatrixRM &x, const MatrixRM &y, const Eigen::VectorXd &weights) {
  constexpr double kPrior = 1e-3; // of the weights' sum
  const MatrixRM weighted = weights.asDiagonal() * x;
  Eigen::Matrix<double, 8, 8> normal = weighted.transpose() * x;
  normal.diagonal().array() += kPrior * weights.sum() + 1e-30;
  return normal.ldlt().solve(weighted.transpose() * y);
}

Coefficients robust_fit(const MatrixRM &shape, const MatrixRM &logs, const ShadedPoints &points) {
  constexpr int kIterations = 15;
  constexpr double kNarrow = 0.15, kShrinks = 0.75; // the last scale of the Geman-McClure weights; from 1 in steps
  Coefficients solution = Coefficients::Zero();
  Eigen::VectorXd weights = points.weights;
  for (int k = 0; k < kIterations; ++k) {
    const MatrixRM x = within_patches(shape, points.patches, weights), y = within_patches(logs, points.patches, weights);
    const double scale = std::max(kNarrow, std::pow(kShrinks, k));
    const Eigen::VectorXd squared = (y - x * solution).rowwise().squaredNorm() / (3 * scale * scale);
    weights = points.weights.array() / (1 + squared.array()).square();
    solution = solve(x, y, weights);
  }
  return solution;
}

} // namespace

Eigen::Vector3d Irradiance::at(const Eigen::Vector3d &normal) const {
  Eigen::Matrix<double, 9, 1> b;
  b << 1, basis(normal);
  const Eigen::Vector3d light = (coefficients.transpose() * b).array().exp();
  return light.cwiseMax(lowest).cwiseMin(1);
}

Irradiance estimate_irradiance(const ShadedPoints &points) {
  constexpr double kTail = 0.01; // of the points: what is brighter or darker is not trusted
  require_points(points);
  const Eigen::Index n = points.normals.rows();
  Irradiance light;
  if (n == 0)
    return light;
  MatrixRM shape(n, 8);
  for (Eigen::Index i = 0; i < n; ++i)
    shape.row(i) = basis(points.normals.row(i)).transpose();
  const Coefficients solution = robust_fit(shape, points.colours.array().log().matrix(), points);
  const MatrixRM logs = shape * solution;
  for (int c = 0; c < 3; ++c) {
    const std::vector<double> values(logs.col(c).begin(), logs.col(c).end());
    const double highest = quantile(values, 1 - kTail);
    light.coefficients.col(c) << -highest, solution.col(c);
    light.lowest[c] = std::exp(quantile(values, kTail) - highest);
  }
  return light;
}

} // namespace doublet
