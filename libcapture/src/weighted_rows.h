#pragma once
// Normal equations of many rows.

#include <Eigen/Core>

#include <cmath>

namespace doublet::detail {

/// Sums weight * row^T row (lower triangle) and weight * residual * row^T. Rows are gathered, and a block of them is one matrix
/// product: several times as fast as an update of rank one for each.
class WeightedRows {
public:
  /// `hessian` (D, D) and `gradient` (D) are added to; they are whole after finish().
  WeightedRows(Eigen::MatrixXd &hessian, Eigen::VectorXd &gradient)
      : hessian_(hessian), gradient_(gradient), block_(hessian.rows(), kRows) {}

  template <class Row> void add(const Row &row, double residual, double weight) {
    gradient_ += (weight * residual) * row;
    block_.col(count_++) = std::sqrt(weight) * row;
    if (count_ == kRows)
      finish();
  }
  void finish() {
    if (count_ == 0)
      return;
    hessian_.selfadjointView<Eigen::Lower>().rankUpdate(block_.leftCols(count_));
    count_ = 0;
  }

private:
  static constexpr int kRows = 128;
  Eigen::MatrixXd &hessian_;
  Eigen::VectorXd &gradient_;
  Eigen::MatrixXd block_;
  int count_ = 0;
};

} // namespace doublet::detail
