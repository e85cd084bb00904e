#pragma once
// Width of the SIMD registers in which our solver steps simulations: only for tests and benchmarks, no result depends on it.

#include "doublet/pbd/cloth_solver.h"

namespace doublet::pbd::detail {

/// ClothSolver::create in registers of one width. Throws std::invalid_argument unless `lanes` is one of supported_lanes().
std::unique_ptr<ClothSolver> create_with_lanes(std::shared_ptr<const ClothModel> model, int lanes);
/// Ascending, of 1, 4, 8 (AVX2) and 16 (AVX-512).
std::vector<int> supported_lanes();

} // namespace doublet::pbd::detail
