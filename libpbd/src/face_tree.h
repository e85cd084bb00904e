#pragma once
// The tree that finds what the cloth is near to (see self_collision.h), as far as it is the model's.

#include "kernels.h"
#include "lane_model.h"

#include <array>
#include <vector>

namespace doublet::pbd {

/// Faces halved again and again at the median of their centres, across the longest side of the box of those.
std::vector<TreeNode> build_tree(const std::vector<Vec3f> &points, const std::vector<Triangle> &faces);

std::vector<QuadNode> build_quads(const std::vector<TreeNode> &nodes);

/// Each once, as the tree comes to its faces: of face f those are counts[f] from first[f] on.
struct OrderedEdges {
  std::vector<Edge> edges;
  std::array<std::vector<int>, 2> ends; ///< see LaneModel::edge_ends
  std::vector<int> first, counts;
};
/// All vertices, in the order in which the leaves of the tree have them first.
std::vector<int> vertices_in_order(const std::vector<TreeNode> &nodes, const std::vector<Triangle> &faces, int vertex_count);

OrderedEdges edges_in_order(const std::vector<TreeNode> &nodes, const std::vector<Triangle> &faces);

/// The tree cut off where a node has no more than `most` faces, see Patch.
struct PatchedTree {
  std::vector<TreeNode> nodes; ///< of a leaf, `face` is the patch
  std::vector<Patch> patches;
  std::vector<int> faces, bridges;
  std::vector<NearPatch> near;
  std::array<std::vector<int>, 3> corners; ///< see LaneModel::patch_corners
};
PatchedTree build_patches(const std::vector<TreeNode> &nodes, const std::vector<Triangle> &faces, const OrderedEdges &edges,
                          int vertex_count, int most);

/// Sorted (vertex << 32 | face) of all pairs closer than `distance`, a face's own vertices left out.
std::vector<std::uint64_t> pairs_closer_than(const std::vector<Vec3f> &points, const std::vector<Triangle> &faces,
                                             const std::vector<TreeNode> &nodes, float distance);

/// Sorted (edge << 32 | later edge) of all pairs closer than `distance` that share no vertex.
std::vector<std::uint64_t> edges_closer_than(const std::vector<Vec3f> &points, const std::vector<Triangle> &faces,
                                             const std::vector<TreeNode> &nodes, const OrderedEdges &edges, float distance);

} // namespace doublet::pbd
