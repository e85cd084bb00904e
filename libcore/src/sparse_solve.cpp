#include "doublet/core/parts/sparse_solve.h"

#include "doublet/core/error.h"

#include <Eigen/SparseCholesky>

namespace doublet {

Eigen::MatrixXd solve_symmetric(const std::vector<Eigen::Triplet<double>> &entries, const Eigen::MatrixXd &right,
                                const std::string &problem) {
  Eigen::SparseMatrix<double> matrix(right.rows(), right.rows());
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
  if (solver.info() == Eigen::Success)
    if (Eigen::MatrixXd solution = solver.solve(right); solution.allFinite())
      return solution;
  throw Error(problem + ": expected equations with one solution, found none (degenerate triangles?)");
}

} // namespace doublet
