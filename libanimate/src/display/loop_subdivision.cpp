#include "loop_subdivision.h"

#include <algorithm>
#include <array>

namespace doublet::detail {
namespace {

using Weights = Eigen::SparseMatrix<double, Eigen::RowMajor>;

/// The vertex opposite the edge (a, b) in face f.
int opposite(const Faces &faces, int f, const Eigen::Vector2i &edge) {
  for (int k = 0; k < 3; ++k)
    if (faces(f, k) != edge[0] && faces(f, k) != edge[1])
      return faces(f, k);
  return edge[0];
}

/// Of the vertex in the middle of the edge; a repeated corner of a degenerate face has none.
int middle_of(const std::vector<Eigen::Vector2i> &edges, int vertices, int a, int b) {
  if (a == b)
    return a;
  const Eigen::Vector2i wanted(std::min(a, b), std::max(a, b));
  const auto before = [](const Eigen::Vector2i &p, const Eigen::Vector2i &q) { return p[0] != q[0] ? p[0] < q[0] : p[1] < q[1]; };
  return vertices + static_cast<int>(std::lower_bound(edges.begin(), edges.end(), wanted, before) - edges.begin());
}

Subdivision subdivide_once(const Faces &faces, int vertices) {
  const EdgeTopology topology = edge_topology(faces);
  const auto neighbours = vertex_neighbours(faces, vertices);
  std::vector<std::vector<int>> along(vertices); // neighbours along the boundary
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t e = 0; e < topology.edges.size(); ++e) {
    const Eigen::Vector2i &edge = topology.edges[e], &beside = topology.edge_faces[e];
    const int row = vertices + static_cast<int>(e);
    const bool boundary = beside[0] < 0 || beside[1] < 0;
    for (int k = 0; k < 2; ++k) {
      entries.emplace_back(row, edge[k], boundary ? 1.0 / 2 : 3.0 / 8);
      if (boundary)
        along[edge[k]].push_back(edge[1 - k]);
      else
        entries.emplace_back(row, opposite(faces, beside[k], edge), 1.0 / 8);
    }
  }
  for (int v = 0; v < vertices; ++v) {
    const bool inner = along[v].empty() && neighbours[v].size() >= 3, corner = !inner && along[v].size() != 2;
    const std::vector<int> &ring = inner ? neighbours[v] : along[v];
    const double share = corner ? 0 : !inner ? 1.0 / 8 : ring.size() == 3 ? 3.0 / 16 : 3.0 / (8.0 * ring.size());
    entries.emplace_back(v, v, corner ? 1.0 : 1 - share * static_cast<double>(ring.size()));
    for (int w : ring)
      if (!corner)
        entries.emplace_back(v, w, share);
  }
  Subdivision fine{Faces(4 * faces.rows(), 3), Weights(vertices + static_cast<int>(topology.edges.size()), vertices)};
  fine.weights.setFromTriplets(entries.begin(), entries.end());
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    std::array<int, 3> middle; // of the edge from corner k to the next
    for (int k = 0; k < 3; ++k)
      middle[k] = middle_of(topology.edges, vertices, faces(f, k), faces(f, (k + 1) % 3));
    for (int k = 0; k < 3; ++k)
      fine.faces.row(4 * f + k) << faces(f, k), middle[k], middle[(k + 2) % 3];
    fine.faces.row(4 * f + 3) << middle[0], middle[1], middle[2];
  }
  return fine;
}

} // namespace

Subdivision subdivide(const Faces &faces, int vertices, int levels) {
  Subdivision result{faces, Weights(vertices, vertices)};
  result.weights.setIdentity();
  for (int level = 0; level < levels; ++level) {
    Subdivision finer = subdivide_once(result.faces, static_cast<int>(result.weights.rows()));
    result.weights = (finer.weights * result.weights).eval();
    result.faces = std::move(finer.faces);
  }
  return result;
}

} // namespace doublet::detail
