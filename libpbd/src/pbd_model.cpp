#include "pbd_model.h"

#include "constraint_order.h"
#include "face_tree.h"
#include "knots.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>
#include <queue>
#include <stdexcept>

namespace doublet::pbd {
namespace {

constexpr int kPatchFaces = 8;  ///< at most
constexpr double kMaxSpan = 12; ///< mean edges, see LaneModel::largest_extent

/// Undirected edge -> the faces beside it with the vertex opposite, in face order. Ordered map: the same on every platform.
using EdgeMap = std::map<std::array<int, 2>, std::vector<int>>;
EdgeMap opposite_vertices(const std::vector<Triangle> &faces) {
  EdgeMap edges;
  for (const Triangle &face : faces)
    for (int k = 0; k < 3; ++k) {
      const int a = face.v[k], b = face.v[(k + 1) % 3];
      edges[{std::min(a, b), std::max(a, b)}].push_back(face.v[(k + 2) % 3]);
    }
  return edges;
}

/// Edges between each vertex and the nearest vertex that does not move freely; 0 everywhere if there is none.
std::vector<int> rings_from_attachment(const EdgeMap &edges, const std::vector<float> &weights) {
  const int n = static_cast<int>(weights.size());
  std::vector<std::vector<int>> neighbours(n);
  for (const auto &[edge, unused] : edges) {
    neighbours[edge[0]].push_back(edge[1]);
    neighbours[edge[1]].push_back(edge[0]);
  }
  std::vector<int> ring(n, -1);
  std::queue<int> front;
  for (int i = 0; i < n; ++i)
    if (weights[i] == 0) {
      ring[i] = 0;
      front.push(i);
    }
  for (; !front.empty(); front.pop())
    for (int j : neighbours[front.front()])
      if (ring[j] < 0) {
        ring[j] = ring[front.front()] + 1;
        front.push(j);
      }
  std::replace(ring.begin(), ring.end(), -1, 0);
  return ring;
}

template <class Constraint>
std::vector<Constraint> in_spread_order(const std::vector<Constraint> &natural, const std::vector<int> &vertices, int arity,
                                        const std::vector<int> &ring, int gap) {
  std::vector<int> levels(natural.size());
  for (size_t i = 0; i < natural.size(); ++i)
    for (int k = 0; k < arity; ++k)
      levels[i] += ring[vertices[i * arity + k]];
  for (int &level : levels)
    level /= arity; // mean ring of its vertices
  std::vector<Constraint> ordered;
  ordered.reserve(natural.size());
  for (int i : spread_order(vertices, arity, levels, static_cast<int>(ring.size()), gap))
    ordered.push_back(natural[i]);
  return ordered;
}

void set_slot(StretchBlock &block, int slot, const StretchConstraint &stretch) {
  for (int k = 0; k < 2; ++k) {
    block.v[k][slot] = stretch.v[k];
    block.share[k][slot] = stretch.share[k];
  }
  block.length[slot] = stretch.length;
}
void set_slot(BendBlock &block, int slot, const BendConstraint &bend) {
  for (int k = 0; k < 4; ++k) {
    block.v[k][slot] = bend.v[k];
    block.w[k][slot] = bend.w[k];
  }
  block.cos[slot] = bend.cos;
  block.sin[slot] = bend.sin;
  block.floor[slot] = bend.floor;
  block.response[slot] = bend.response;
}

/// Constraints on the spare vertices behind the last. They are a metre apart.
StretchConstraint idle_stretch(int vertex_count) {
  return {{vertex_count, vertex_count + 1}, {0, 0}, 1};
}
BendConstraint idle_bend(int vertex_count) {
  BendConstraint idle{};
  for (int k = 0; k < 4; ++k)
    idle.v[k] = vertex_count + k;
  idle.cos = idle.floor = idle.response = 1;
  return idle;
}

template <class Block, class Constraint>
std::vector<Block> in_blocks(const std::vector<Constraint> &constraints, const Constraint &idle, int vertex_count) {
  std::vector<Block> blocks;
  std::vector<size_t> last_block(vertex_count, std::numeric_limits<size_t>::max()); // that holds the vertex
  for (const Constraint &constraint : constraints) {
    const bool shares = std::any_of(std::begin(constraint.v), std::end(constraint.v),
                                    [&](int v) { return !blocks.empty() && last_block[v] == blocks.size() - 1; });
    if (blocks.empty() || blocks.back().count == kBlock || shares) {
      blocks.emplace_back();
      for (int slot = 0; slot < kBlock; ++slot)
        set_slot(blocks.back(), slot, idle);
    }
    set_slot(blocks.back(), blocks.back().count++, constraint);
    for (int v : constraint.v)
      last_block[v] = blocks.size() - 1;
  }
  return blocks;
}

/// Of the way to the target, when a whole frame keeps `clothness` of it. Shared evenly, a load would pull the vertex 1 / substeps
/// as far: under one, g, it comes to rest g h^2 kept / (1 - kept) from the target, h s a substep. Compliance keeps that distance.
double kept_in_substep(double clothness, const ClothOptions &options) {
  if (options.stiffness == Stiffness::Sweeps)
    return std::pow(clothness, 1.0 / options.substeps);
  const double ratio = options.substeps * options.substeps * clothness;
  return ratio / (ratio + 1 - clothness);
}

/// The largest over-relaxation w that n sweeps bear. A constraint by itself is left with (1 - w)^n of its error, and where w is
/// beyond the best, so are all, turned by any phase (Young 1954). Velocities are backward differences: a step predicts twice the
/// last error minus the one before and leaves the share r of that, z^2 = r (2 z - 1), which grows once r lies below -1/3. And
/// that r of a compliant constraint's force is missing or too much: 1/16 at most.
double most_over_relaxation(int sweeps) {
  return 1 + std::pow(1.0 / 16, 1.0 / sweeps);
}

} // namespace

PbdModel::PbdModel(std::shared_ptr<const ClothModel> cloth) : cloth_(std::move(cloth)) {
  for (Eigen::Index f = 0; f < cloth_->faces().rows(); ++f)
    faces_.push_back({{cloth_->faces()(f, 0), cloth_->faces()(f, 1), cloth_->faces()(f, 2)}});
  weights_.assign(cloth_->inverse_masses().begin(), cloth_->inverse_masses().end());
  set_constraints(cloth_->rest());
  set_followers(cloth_->clothness());
  vertex_order_.resize(vertex_count());
  std::iota(vertex_order_.begin(), vertex_order_.end(), 0);
  if (options().self_collision)
    set_tree(cloth_->rest());
  set_arrays();
  if (options().self_collision && options().edge_collision)
    set_resting_knots(cloth_->rest());
}

void PbdModel::set_constraints(const Vertices &rest) {
  const EdgeMap edges = opposite_vertices(faces_);
  const Eigen::VectorXd &w = cloth_->inverse_masses();
  std::vector<StretchConstraint> stretches;
  std::vector<BendConstraint> bends;
  std::vector<int> stretch_vertices, bend_vertices;
  for (const auto &[edge, opposite] : edges) {
    const auto [a, b] = edge;
    const double sum = w[a] + w[b];
    if (sum > 0) {
      const Eigen::Vector3d along = (rest.row(b) - rest.row(a)).transpose();
      stretches.push_back(
          {{a, b}, {static_cast<float>(w[a] / sum), static_cast<float>(w[b] / sum)}, static_cast<float>(along.norm())});
      stretch_vertices.insert(stretch_vertices.end(), {a, b});
    }
    for (size_t k = 0; k + 1 < opposite.size(); ++k) { // a non-manifold edge bends between consecutive faces
      const std::array<int, 4> v{a, b, opposite[k], opposite[k + 1]};
      const double largest = std::max({w[v[0]], w[v[1]], w[v[2]], w[v[3]]});
      if (largest == 0 || v[2] == v[3])
        continue;
      const auto x = [&](int i) { return Vec3<double>{rest(v[i], 0), rest(v[i], 1), rest(v[i], 2)}; };
      BendConstraint c{};
      for (int i = 0; i < 4; ++i) {
        c.v[i] = v[i];
        c.w[i] = static_cast<float>(w[v[i]] / largest);
      }
      const BendTerms<double> at_rest = bend_terms<double>(x(0), x(1), x(2), x(3), {c.w[0], c.w[1], c.w[2], c.w[3], 1, 0, 0, 0});
      const double angle = options().rest_curvature * bend_value(at_rest);
      c.cos = static_cast<float>(std::cos(angle));
      c.sin = static_cast<float>(std::sin(angle));
      // Never 0: faces too small to bend have no gradient, and 0 / 0 would not leave them alone. 1 belongs to faces a metre high.
      c.floor = static_cast<float>(std::max(1.0, 0.25 * at_rest.ee * (1 / at_rest.nn1 + 1 / at_rest.nn2)));
      c.response = lane_max(static_cast<float>(at_rest.sum / at_rest.scale), c.floor);
      bends.push_back(c);
      bend_vertices.insert(bend_vertices.end(), v.begin(), v.end());
    }
  }
  const std::vector<int> ring = rings_from_attachment(edges, weights_);
  const int n = vertex_count();
  stretch_blocks_ =
      in_blocks<StretchBlock>(in_spread_order(stretches, stretch_vertices, 2, ring, kStretchGap), idle_stretch(n), n);
  bend_blocks_ = in_blocks<BendBlock>(in_spread_order(bends, bend_vertices, 4, ring, kBendGap), idle_bend(n), n);
}

void PbdModel::set_followers(const Eigen::VectorXd &clothness) {
  for (int i = 0; i < vertex_count(); ++i) {
    if (clothness[i] == 1)
      continue;
    if (clothness[i] > 0) { // the sweeps of a substep share what it removes of the way to the target
      const double kept = kept_in_substep(clothness[i], options());
      const double share = 1 - std::pow(kept, 1.0 / options().iterations);
      blends_.push_back({i, static_cast<int>(followers_.size()), static_cast<float>(share)});
    }
    followers_.push_back(i);
  }
}

void PbdModel::set_tree(const Vertices &rest) {
  std::vector<Vec3f> points;
  const Eigen::RowVector3d origin = rest.colwise().mean();
  for (int i = 0; i < rest.rows(); ++i) {
    const Eigen::RowVector3d p = rest.row(i) - origin;
    points.push_back({static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
  }
  nodes_ = build_tree(points, faces_);
  quads_ = build_quads(nodes_);
  vertex_order_ = vertices_in_order(nodes_, faces_, vertex_count());
  edges_ = edges_in_order(nodes_, faces_);
  if (options().edge_collision) {
    patches_ = build_patches(nodes_, faces_, edges_, vertex_count(), kPatchFaces);
    resting_edges_ = edges_closer_than(points, faces_, nodes_, edges_, static_cast<float>(options().self_thickness));
  }
  resting_pairs_ = pairs_closer_than(points, faces_, nodes_, static_cast<float>(options().self_thickness));
}

/// Of a captured garment; nothing would ever bring that apart.
void PbdModel::set_resting_knots(const Vertices &rest) {
  Array<Point> points;
  points.resize(vertex_count());
  const Eigen::RowVector3d origin = rest.colwise().mean();
  for (int i = 0; i < vertex_count(); ++i) {
    const Eigen::RowVector3f p = (rest.row(i) - origin).cast<float>();
    points[i] = Vec3f{p[0], p[1], p[2]};
  }
  LaneModel by_face = arrays_;
  by_face.edge_collision = false;
  Knots<float> knots;
  knots.find(by_face, points);
  for (int i = 0; i < vertex_count(); ++i)
    if (knots.at(i))
      resting_knots_.push_back(i);
  arrays_.resting_knots = resting_knots_.data();
  arrays_.resting_knot_count = static_cast<int>(resting_knots_.size());
}

void PbdModel::set_arrays() {
  const auto size = [](const auto &v) { return static_cast<int>(v.size()); };
  LaneModel &a = arrays_;
  a.vertex_count = vertex_count();
  a.faces = faces_.data(), a.face_count = size(faces_);
  a.weights = weights_.data();
  a.mass = 0;
  for (float weight : weights_)
    if (weight > 0)
      a.mass += 1 / weight;
  a.stretch_blocks = stretch_blocks_.data(), a.stretch_block_count = size(stretch_blocks_);
  a.bend_blocks = bend_blocks_.data(), a.bend_block_count = size(bend_blocks_);
  a.blends = blends_.data(), a.blend_count = size(blends_);
  a.followers = followers_.data(), a.follower_count = size(followers_);
  a.face_tree = {nodes_.data(), size(nodes_), quads_.data(), size(quads_)};
  a.patch_nodes = patches_.nodes.data(), a.patch_node_count = size(patches_.nodes);
  a.patches = patches_.patches.data(), a.patch_count = size(patches_.patches);
  a.patch_faces = patches_.faces.data(), a.vertex_order = vertex_order_.data();
  for (int k = 0; k < 2; ++k)
    a.edge_ends[k] = edges_.ends[k].data();
  for (int k = 0; k < 3; ++k)
    a.patch_corners[k] = patches_.corners[k].data();
  a.patch_near = patches_.near.data(), a.patch_near_count = size(patches_.near), a.patch_bridges = patches_.bridges.data();
  a.edges = edges_.edges.data(), a.edge_count = size(edges_.edges);
  a.resting_edges = resting_edges_.data(), a.resting_edge_count = size(resting_edges_);
  a.resting_pairs = resting_pairs_.data(), a.resting_pair_count = size(resting_pairs_);
  a.iterations = options().iterations;
  a.over_relaxation = static_cast<float>(std::min(options().over_relaxation, most_over_relaxation(options().iterations)));
  a.thickness = static_cast<float>(options().thickness);
  a.self_thickness = static_cast<float>(options().self_thickness);
  a.restitution = static_cast<float>(options().restitution);
  double sum = 0, longest = 0;
  int count = 0;
  for (const StretchBlock &block : stretch_blocks_) {
    for (int k = 0; k < block.count; ++k) {
      sum += block.length[k];
      longest = std::max(longest, static_cast<double>(block.length[k]));
    }
    count += block.count;
  }
  const double mean = sum / std::max(1, count);
  a.largest_extent = static_cast<float>(std::max(kMaxSpan * mean, 2 * longest) + 48 * options().self_thickness);
  a.self_collision = options().self_collision;
  a.edge_collision = options().edge_collision;
  a.compliant = options().stiffness == Stiffness::Compliance;
}

} // namespace doublet::pbd
