#include "handles.h"

#include "doublet/core/parts/boundary_loops.h"
#include "doublet/core/parts/disjoint_sets.h"
#include "surface_piece.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <queue>

namespace doublet::detail {
namespace {

constexpr double kNoWay = std::numeric_limits<double>::infinity();

using Loop = std::vector<int>; // of vertices, the last beside the first

struct Neighbour {
  int vertex, edge;
};

/// A surface with a face behind each loop of its boundary, which closes it.
class ClosedSurface {
public:
  explicit ClosedSurface(const Mesh &mesh) : topology_(edge_topology(mesh.faces)), around_(mesh.vertices.rows()) {
    std::vector<int> behind(mesh.vertices.rows(), -1); // of boundary vertices
    face_count_ = static_cast<int>(mesh.faces.rows());
    for (const Loop &loop : boundary_loops(mesh.faces)) {
      for (int v : loop)
        behind[v] = face_count_;
      ++face_count_;
    }
    for (std::size_t e = 0; e < topology_.edges.size(); ++e) {
      const int a = topology_.edges[e][0], b = topology_.edges[e][1];
      for (int side = 0; side < 2; ++side)
        if (topology_.edge_faces[e][side] < 0)
          topology_.edge_faces[e][side] = behind[a];
      around_[a].push_back({b, static_cast<int>(e)});
      around_[b].push_back({a, static_cast<int>(e)});
      lengths_.push_back((mesh.vertices.row(a) - mesh.vertices.row(b)).norm());
    }
    for (int v : behind)
      inside_.push_back(v < 0);
  }

  /// The shortest loop through `root` that does not part the surface and keeps off its boundary, if it is shorter than `limit` m,
  /// which becomes its length; else none. Erickson & Whittlesey, Greedy optimal homotopy and homology generators, SODA 2005.
  Loop shortest_loop(int root, double &limit) const {
    const Tree tree = shortest_ways(root);
    std::vector<std::pair<double, int>> loops; // that an edge closes with the ways to its ends; the longest first
    for (std::size_t e = 0; e < topology_.edges.size(); ++e) {
      const int a = topology_.edges[e][0], b = topology_.edges[e][1];
      if (tree.edge[a] == static_cast<int>(e) || tree.edge[b] == static_cast<int>(e))
        continue;
      const double length = inside_[a] && inside_[b] ? tree.way[a] + tree.way[b] + lengths_[e] : kNoWay;
      loops.emplace_back(-length, static_cast<int>(e));
    }
    std::sort(loops.begin(), loops.end());
    DisjointSets faces(face_count_); // across edges that the ways do not use; what would join them once more closes a loop
    Loop best;
    for (const auto &[minus_length, e] : loops) {
      if (faces.unite(topology_.edge_faces[e][0], topology_.edge_faces[e][1]) || -minus_length >= limit)
        continue;
      limit = -minus_length;
      best = loop_over(tree, e);
    }
    return best;
  }

private:
  struct Tree {
    std::vector<double> way;     ///< [vertex] m
    std::vector<int> from, edge; ///< [vertex] before it on the way, over that edge; -1 at the root
  };
  /// None leads along the boundary.
  Tree shortest_ways(int root) const {
    const std::size_t count = around_.size();
    Tree tree{std::vector<double>(count, kNoWay), std::vector<int>(count, -1), std::vector<int>(count, -1)};
    using Entry = std::pair<double, int>;
    std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
    tree.way[root] = 0;
    queue.push({0, root});
    while (!queue.empty()) {
      const auto [way, v] = queue.top();
      queue.pop();
      if (way > tree.way[v] || !inside_[v])
        continue;
      for (const Neighbour &next : around_[v])
        if (const double there = way + lengths_[next.edge]; there < tree.way[next.vertex]) {
          tree.way[next.vertex] = there;
          tree.from[next.vertex] = v;
          tree.edge[next.vertex] = next.edge;
          queue.push({there, next.vertex});
        }
    }
    return tree;
  }
  /// The edge and the ways to its ends, but for what these have in common.
  Loop loop_over(const Tree &tree, int edge) const {
    std::array<Loop, 2> ways; // from the edge back to the root
    for (int k = 0; k < 2; ++k)
      for (int v = topology_.edges[edge][k]; v >= 0; v = tree.from[v])
        ways[k].push_back(v);
    while (ways[0].size() > 1 && ways[1].size() > 1 && ways[0][ways[0].size() - 2] == ways[1][ways[1].size() - 2]) {
      ways[0].pop_back();
      ways[1].pop_back();
    }
    Loop loop(ways[0].rbegin(), ways[0].rend());
    loop.insert(loop.end(), ways[1].begin(), ways[1].end() - 1);
    return loop;
  }

  EdgeTopology topology_; ///< faces of edges: the mesh's, and behind them those that close it
  int face_count_ = 0;
  std::vector<std::vector<Neighbour>> around_; ///< [vertex]
  std::vector<double> lengths_;                ///< [edge] m
  std::vector<char> inside_;                   ///< [vertex] 0 = on the boundary
};

/// Over all vertices; none if it would be longer than `longest` m.
Loop shortest_loop(const Mesh &mesh, double longest) {
  const ClosedSurface surface(mesh);
  Loop best;
  for (int root = 0; root < mesh.vertices.rows(); ++root)
    if (Loop loop = surface.shortest_loop(root, longest); !loop.empty())
      best = std::move(loop);
  return best;
}

/// Appends a fan around the middle of a loop, in whose direction its faces run.
void close(Mesh &mesh, const Loop &loop) {
  const Eigen::Index vertices = mesh.vertices.rows(), faces = mesh.faces.rows(), count = static_cast<Eigen::Index>(loop.size());
  Eigen::RowVector3d middle = Eigen::RowVector3d::Zero();
  for (int v : loop)
    middle += mesh.vertices.row(v) / static_cast<double>(count);
  mesh.vertices.conservativeResize(vertices + 1, 3);
  mesh.vertices.row(vertices) = middle;
  mesh.faces.conservativeResize(faces + count, 3);
  for (Eigen::Index i = 0; i < count; ++i)
    mesh.faces.row(faces + i) << loop[i], loop[(i + 1) % count], static_cast<int>(vertices);
}

/// Cut along a loop inside the surface; each of the two edges is closed.
Mesh cut_along(Mesh mesh, const Loop &loop) {
  std::map<std::array<int, 2>, int> left; // [a, b]: the face that has the edge in this direction
  for (int f = 0; f < mesh.faces.rows(); ++f)
    for (int k = 0; k < 3; ++k)
      left[{mesh.faces(f, k), mesh.faces(f, (k + 1) % 3)}] = f;
  const int count = static_cast<int>(loop.size()), before = static_cast<int>(mesh.vertices.rows());
  Loop copies;
  Faces faces = mesh.faces;
  for (int i = 0; i < count; ++i) {
    const int v = loop[i], last = loop[(i + count - 1) % count];
    copies.push_back(before + i);
    for (int to = loop[(i + 1) % count]; to != last;) { // the faces to the left of the loop get the copy
      const int f = left.at({v, to});
      int k = 0;
      while (mesh.faces(f, k) != v)
        ++k;
      faces(f, k) = copies.back();
      to = mesh.faces(f, (k + 2) % 3);
    }
  }
  mesh.faces = faces;
  mesh.vertices.conservativeResize(before + count, 3);
  for (int i = 0; i < count; ++i)
    mesh.vertices.row(before + i) = mesh.vertices.row(loop[i]);
  std::reverse(copies.begin(), copies.end());
  close(mesh, copies);
  close(mesh, loop);
  return mesh;
}

} // namespace

int genus(const Mesh &mesh) {
  int pieces = 0;
  vertex_components(mesh.faces, static_cast<int>(mesh.vertices.rows()), &pieces);
  std::vector<char> used(mesh.vertices.rows(), 0);
  for (const int v : mesh.faces.reshaped())
    used[v] = 1;
  const auto vertices = static_cast<int>(std::count(used.begin(), used.end(), 1));
  const auto edges = static_cast<int>(edge_topology(mesh.faces).edges.size());
  const auto loops = static_cast<int>(boundary_loops(mesh.faces).size());
  return (2 * pieces - loops - (vertices - edges + static_cast<int>(mesh.faces.rows()))) / 2; // Euler
}

Mesh with_closed_loops(Mesh mesh, const std::vector<std::vector<int>> &loops) {
  for (Loop loop : loops) {
    std::reverse(loop.begin(), loop.end()); // against the faces around it
    close(mesh, loop);
  }
  return mesh;
}

Mesh without_handles(const Mesh &mesh, double longest) {
  Mesh result = mesh;
  const int handles = genus(mesh);
  if (handles > 0) // pieces that touch at vertices count for some, too
    require_manifold(mesh, "garment");
  for (int left = handles; left > 0; --left) {
    const Loop loop = shortest_loop(result, longest);
    if (loop.empty())
      break;
    result = cut_along(std::move(result), loop);
  }
  return result;
}

} // namespace doublet::detail
