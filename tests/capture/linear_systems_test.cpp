// What the estimators solve their systems with, against Eigen's dense matrices.
#include "../../libcapture/src/tracking/preconditioner.h"
#include "../../libcapture/src/weighted_rows.h"

#include <Eigen/Cholesky>

#include <gtest/gtest.h>
#include <random>

using namespace doublet;
using detail::Preconditioner;
using detail::WeightedRows;

namespace {

Eigen::MatrixXd random(int rows, int columns, unsigned seed) {
  std::mt19937 engine(seed);
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(engine); });
}

/// A positive definite matrix that is mostly empty, of a random graph.
Eigen::MatrixXd sparse_matrix(int n, unsigned seed) {
  std::mt19937 engine(seed);
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n);
  for (int e = 0; e < 3 * n; ++e) {
    const int i = static_cast<int>(engine() % n), j = static_cast<int>(engine() % n);
    const double weight = 0.1 + static_cast<double>(engine() % 100);
    matrix(i, i) += weight, matrix(j, j) += weight;
    matrix(i, j) -= weight, matrix(j, i) -= weight;
  }
  matrix.diagonal().array() += 0.5;
  return matrix;
}

} // namespace

/// Of fewer rows than a block, of whole blocks, and of a block and a bit.
TEST(WeightedRows, AreTheNormalEquations) {
  constexpr int kUnknowns = 11;
  for (const int count : {0, 1, 127, 128, 129, 256, 1000}) {
    const Eigen::MatrixXd rows = random(count, kUnknowns, 1);
    const Eigen::VectorXd residuals = random(count, 1, 2), weights = random(count, 1, 3).array().square();
    const Eigen::MatrixXd first = random(kUnknowns, kUnknowns, 4);
    Eigen::MatrixXd hessian = first;
    Eigen::VectorXd gradient = Eigen::VectorXd::Ones(kUnknowns);
    WeightedRows sum(hessian, gradient);
    for (int i = 0; i < count; ++i)
      sum.add(rows.row(i).transpose(), residuals[i], weights[i]);
    sum.finish();
    const Eigen::MatrixXd expected = first + rows.transpose() * weights.asDiagonal() * rows;
    const Eigen::VectorXd expected_gradient =
        Eigen::VectorXd::Ones(kUnknowns) + rows.transpose() * weights.cwiseProduct(residuals);
    const double scale = 1e-13 * (1 + count);
    for (int i = 0; i < kUnknowns; ++i)
      for (int j = 0; j < kUnknowns; ++j)
        EXPECT_NEAR(hessian(i, j), j <= i ? expected(i, j) : first(i, j), scale) << count << ": " << i << ", " << j;
    EXPECT_LT((gradient - expected_gradient).cwiseAbs().maxCoeff(), scale) << count;
  }
}

/// finish() may come in between, and again.
TEST(WeightedRows, AreAddedOnce) {
  Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(2, 2);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(2);
  WeightedRows sum(hessian, gradient);
  sum.add(Eigen::Vector2d(1, 2), 3, 4);
  sum.finish();
  sum.finish();
  sum.add(Eigen::Vector2d(0, 1), 1, 0); // of no weight
  sum.add(Eigen::Vector2d(5, 0), -1, 4);
  sum.finish();
  EXPECT_EQ(hessian(0, 0), 4 + 100);
  EXPECT_EQ(hessian(1, 0), 8);
  EXPECT_EQ(hessian(1, 1), 16);
  EXPECT_EQ(gradient, Eigen::Vector2d(12 - 20, 24));
}

TEST(Preconditioner, SolvesAsADenseMatrix) {
  for (const int n : {1, 2, 60, 300}) {
    const Eigen::MatrixXd matrix = sparse_matrix(n, 5);
    const Vertices right = random(n, 3, 6);
    Preconditioner preconditioner;
    preconditioner.analyze(matrix.sparseView());
    ASSERT_TRUE(preconditioner.factorize(matrix.sparseView()));
    const Vertices expected = matrix.ldlt().solve(Eigen::MatrixXd(right));
    EXPECT_LT((preconditioner.solve(right) - expected).norm(), 1e-10 * expected.norm()) << n;
  }
}

/// Other numbers at the same places.
TEST(Preconditioner, IsAnalysedOnceAndFactorisedAnew) {
  Eigen::MatrixXd matrix = sparse_matrix(80, 7);
  const Vertices right = random(80, 3, 8);
  Preconditioner preconditioner;
  preconditioner.analyze(matrix.sparseView());
  for (const double more : {0.0, 3.0}) {
    matrix.diagonal().array() += more;
    ASSERT_TRUE(preconditioner.factorize(matrix.sparseView()));
    const Vertices expected = matrix.ldlt().solve(Eigen::MatrixXd(right));
    EXPECT_LT((preconditioner.solve(right) - expected).norm(), 1e-10 * expected.norm()) << more;
  }
}

TEST(Preconditioner, TellsASingularMatrix) {
  Eigen::MatrixXd matrix = sparse_matrix(20, 9);
  matrix.row(7).setZero();
  matrix.col(7).setZero();
  Eigen::SparseMatrix<double> sparse = matrix.sparseView();
  sparse.coeffRef(7, 7) = 0;
  Preconditioner preconditioner;
  preconditioner.analyze(sparse);
  EXPECT_FALSE(preconditioner.factorize(sparse));
}
