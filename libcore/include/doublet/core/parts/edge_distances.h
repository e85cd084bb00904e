#pragma once
// Shortest paths along the edges of a mesh (Dijkstra 1959).

#include "doublet/core/mesh.h"

#include <functional>
#include <limits>
#include <queue>
#include <utility>
#include <vector>

namespace doublet {

/// Propagates distances from `starts`, up to `limit` (m). `distance(v)`: reference to the distance of a vertex, initially 0 at
/// `starts` and infinity elsewhere. `neighbours` from vertex_neighbours().
template <class Distance>
void propagate_along_edges(const Vertices &vertices, const std::vector<std::vector<int>> &neighbours,
                           const std::vector<int> &starts, double limit, const Distance &distance) {
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (int v : starts)
    queue.push({0.0, v});
  while (!queue.empty()) {
    const auto [d, v] = queue.top();
    queue.pop();
    if (d > distance(v))
      continue;
    for (int n : neighbours[v]) {
      const double next = d + (vertices.row(v) - vertices.row(n)).norm();
      if (next <= limit && next < distance(n)) {
        distance(n) = next;
        queue.push({next, n});
      }
    }
  }
}

/// (V) m, length of the shortest path along edges to the nearest of `sources`; infinity beyond `limit` and if there is no path.
Eigen::VectorXd edge_distances(const Vertices &vertices, const std::vector<std::vector<int>> &neighbours,
                               const std::vector<int> &sources, double limit = std::numeric_limits<double>::infinity());

} // namespace doublet
