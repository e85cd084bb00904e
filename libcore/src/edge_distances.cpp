#include "doublet/core/parts/edge_distances.h"

namespace doublet {

Eigen::VectorXd edge_distances(const Vertices &vertices, const std::vector<std::vector<int>> &neighbours,
                               const std::vector<int> &sources, double limit) {
  Eigen::VectorXd distances = Eigen::VectorXd::Constant(vertices.rows(), std::numeric_limits<double>::infinity());
  for (int v : sources)
    distances[v] = 0;
  propagate_along_edges(vertices, neighbours, sources, limit, [&](int v) -> double & { return distances[v]; });
  return distances;
}

} // namespace doublet
