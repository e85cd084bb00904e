#pragma once
// What the solver's loops read: the model as plain arrays. Shared by files compiled for different instruction sets, so it holds
// data alone (see lane.h): no function, no initialiser, no class of the standard library.

#include <cstdint>

namespace doublet::pbd {

struct Triangle {
  int v[3];
};
struct StretchConstraint {
  int v[2];
  float share[2]; ///< w_0 / (w_0 + w_1), w_1 / (w_0 + w_1)
  float length;   ///< m
};
struct BendConstraint {
  int v[4];       ///< edge 0-1, opposite vertices 2 and 3
  float w[4];     ///< inverse masses divided by the largest of the four
  float cos, sin; ///< of the rest angle
  float floor;    ///< see bend_response, 1/m^2
  float response; ///< sum of w_i |g_i|^2 at rest, 1/m^2
};
inline constexpr int kBlock = 8; ///< constraints
/// Constraints in a row of the order that share no vertex, so that they may be projected side by side. Where the order does not
/// offer so many, the rest are idle ones on the spare vertices behind the last (see kSpareVertices), with no mass to move.
struct StretchBlock {
  int count;              ///< of those that are not idle
  int v[2][kBlock];       ///< [end][stretch]
  float share[2][kBlock]; ///< [end][stretch]
  float length[kBlock];
};
struct BendBlock {
  int count;
  int v[4][kBlock];   ///< [corner][bend]
  float w[4][kBlock]; ///< [corner][bend]
  float cos[kBlock], sin[kBlock], floor[kBlock], response[kBlock];
};
inline constexpr int kSpareVertices = 4; ///< after the model's own, in every array of positions: the corners of a flat square

inline constexpr int kSpareInList = 8; ///< values of lists that are read a row at a time

struct BlendConstraint {
  int vertex, follower; ///< the same vertex, as an index into `followers`
  float stiffness;      ///< in every iteration: 1 - delta^(1 / iterations)
};
struct Edge {
  int a, b;
  int wings[2]; ///< the vertices opposite in two faces beside it; -1: none
};
/// Tree of boxes over the faces, in the order of a walk from the root: the children of an inner node i are i + 1 and
/// nodes[i + 1].skip.
struct TreeNode {
  int skip; ///< the first node behind this one's descendants
  int face; ///< of a leaf; -1: inner node
};

/// The same tree with up to four children a node, again in the order of the walk; the first is the root.
struct QuadNode {
  int node[4]; ///< whose box it has, an index into the nodes; -1: no child
  int next[4]; ///< of an inner node its quad, of a leaf ~face
};

/// One way through a tree, and the other.
struct BoxTree {
  const TreeNode *nodes;
  int node_count;
  const QuadNode *quads;
  int quad_count;
};

/// A later patch that shares a vertex with a patch, or with one that shares a vertex with it. Its bridges: the patches that share
/// an edge with each of the two; the first of the two alone where these share an edge.
struct NearPatch {
  int patch;
  int first_bridge, bridge_count; ///< in patch_bridges
};
/// A few faces that lie together (see patches.h): all of a node of the tree. A vertex or an edge belongs to the first patch that
/// has it.
struct Patch {
  int node;                       ///< of the tree of patches
  int first_face, face_count;     ///< in patch_faces
  int first_vertex, vertex_count; ///< in vertex_order
  int first_edge, edge_count;     ///< in edges
  int first_near, near_count;     ///< in patch_near, ascending
  bool connected;                 ///< by common vertices
};

struct LaneModel {
  int vertex_count, face_count, stretch_block_count, bend_block_count, blend_count, follower_count, edge_count, patch_count;
  const Triangle *faces;
  const int *vertex_order; ///< all vertices as the faces of the tree have them: neighbours lie together
  const float *weights;    ///< [vertex] inverse masses
  float mass;              ///< of all vertices that move
  const StretchBlock *stretch_blocks;
  const BendBlock *bend_blocks;
  const BlendConstraint *blends;
  const int *followers; ///< vertices of clothness < 1
  BoxTree face_tree;
  const TreeNode *patch_nodes; ///< the same tree, down to the patches alone
  int patch_node_count;
  const Edge *edges;                  ///< in the order of the tree: neighbours ask the same boxes
  const std::uint64_t *resting_pairs; ///< sorted (vertex << 32 | face) that never collide
  int resting_pair_count;
  const Patch *patches; ///< where edges collide, else none; in the order of the tree
  const int *patch_faces, *patch_bridges;
  const NearPatch *patch_near;
  int patch_near_count;
  const int *edge_ends[2];            ///< the ends of each edge once more, a list of the first and one of the second
  const int *patch_corners[3];        ///< the same of the corners of patch_faces; all five with kSpareInList behind the last
  const std::uint64_t *resting_edges; ///< sorted (edge << 32 | later edge) that never collide
  int resting_edge_count;
  const int *resting_knots; ///< vertices where the rest shape passes through itself; where edges collide
  int resting_knot_count;
  int iterations;
  float over_relaxation, thickness, self_thickness, restitution;
  float largest_extent; ///< m, see SelfCollision
  bool self_collision, edge_collision, compliant;
};

} // namespace doublet::pbd
