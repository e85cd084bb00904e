#pragma once
// Sparse symmetric systems: heat equilibria, diffusion, membranes.

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <string>
#include <vector>

namespace doublet {

/// (n, k) x of A x = right (n, k), A symmetric and positive definite (n, n), the sum of its entries. Throws Error naming
/// `problem` if it has no finite solution.
Eigen::MatrixXd solve_symmetric(const std::vector<Eigen::Triplet<double>> &entries, const Eigen::MatrixXd &right,
                                const std::string &problem);

} // namespace doublet
