#include "taubin.h"

namespace doublet::detail {

Vertices laplacian(const Vertices &x, const std::vector<std::vector<int>> &neighbours) {
  Vertices result = Vertices::Zero(x.rows(), 3);
  for (Eigen::Index v = 0; v < x.rows(); ++v) {
    for (int w : neighbours[v])
      result.row(v) += x.row(w);
    if (!neighbours[v].empty())
      result.row(v) = result.row(v) / static_cast<double>(neighbours[v].size()) - x.row(v);
  }
  return result;
}

Vertices smoothed(Vertices x, const std::vector<std::vector<int>> &neighbours) {
  constexpr int kSteps = 20;
  for (int i = 0; i < kSteps; ++i) {
    x += 0.5 * laplacian(x, neighbours);
    x -= 0.53 * laplacian(x, neighbours);
  }
  return x;
}

} // namespace doublet::detail
