#pragma once
// The solution of one sparse system for three right-hand sides.

#include "doublet/core/types.h"

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

namespace doublet::detail {

/// A factorised sparse matrix, applied backwards to all three columns at once: the factor is read once, not three times.
class Preconditioner {
public:
  using Sparse = Eigen::SparseMatrix<double>;
  void analyze(const Sparse &matrix) { ldlt_.analyzePattern(matrix); }
  /// False: the matrix is singular.
  bool factorize(const Sparse &matrix) {
    ldlt_.factorize(matrix);
    return ldlt_.info() == Eigen::Success;
  }

  Vertices solve(const Vertices &right) const {
    const Sparse &lower = ldlt_.matrixL().nestedExpression(); // below the diagonal, which is 1
    const auto &place = ldlt_.permutationP().indices();
    const auto n = static_cast<int>(right.rows());
    Rows x(n, 4);
    for (int i = 0; i < n; ++i)
      x.row(place[i]) << right(i, 0), right(i, 1), right(i, 2), 0;
    for (int j = 0; j < n; ++j) {
      const Eigen::RowVector4d known = x.row(j);
      for (Sparse::InnerIterator entry(lower, j); entry; ++entry)
        x.row(entry.row()) -= entry.value() * known;
    }
    x.array().colwise() /= ldlt_.vectorD().array();
    for (int j = n - 1; j >= 0; --j) {
      Eigen::RowVector4d sum = x.row(j);
      for (Sparse::InnerIterator entry(lower, j); entry; ++entry)
        sum -= entry.value() * x.row(entry.row());
      x.row(j) = sum;
    }
    Vertices solution(n, 3);
    for (int i = 0; i < n; ++i)
      solution.row(i) = x.row(place[i]).head<3>();
    return solution;
  }

private:
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>; // the fourth number fills a register
  Eigen::SimplicialLDLT<Sparse> ldlt_;
};

} // namespace doublet::detail
