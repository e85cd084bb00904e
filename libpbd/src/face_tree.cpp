#include "face_tree.h"

#include "face_boxes.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <numeric>
#include <set>
#include <utility>

namespace doublet::pbd {
namespace {

struct Builder {
  std::vector<Vec3f> centres;
  std::vector<int> order; ///< of the faces
  std::vector<TreeNode> nodes;

  void add(int first, int last) { // faces order[first..last)
    const auto node = nodes.size();
    nodes.push_back({0, last - first == 1 ? order[first] : -1});
    if (last - first > 1) {
      const int middle = (first + last) / 2;
      split(first, middle, last);
      add(first, middle);
      add(middle, last);
    }
    nodes[node].skip = static_cast<int>(nodes.size());
  }
  void split(int first, int middle, int last) {
    Box<float> box{centres[order[first]], centres[order[first]]};
    for (int i = first; i < last; ++i)
      box = united(box, {centres[order[i]], centres[order[i]]});
    const Vec3f size = box.hi - box.lo;
    float Vec3f::*const axis = size.x >= size.y && size.x >= size.z ? &Vec3f::x : size.y >= size.z ? &Vec3f::y : &Vec3f::z;
    std::nth_element(order.begin() + first, order.begin() + middle, order.begin() + last, [&](int a, int b) {
      const float ca = centres[a].*axis, cb = centres[b].*axis;
      return ca < cb || (ca == cb && a < b);
    });
    // Which faces are on which side is settled; in what order they lie there is the library's choice.
    std::sort(order.begin() + first, order.begin() + middle);
    std::sort(order.begin() + middle, order.begin() + last);
  }
};

int add_quad(const std::vector<TreeNode> &nodes, int at, std::vector<QuadNode> &quads) {
  std::vector<int> children;
  const auto add_children_of = [&](int node) {
    if (nodes[node].face >= 0)
      children.push_back(node);
    else
      children.insert(children.end(), {node + 1, nodes[node + 1].skip});
  };
  add_children_of(at);
  if (nodes[at].face < 0) {
    const std::vector<int> two = std::move(children);
    children.clear();
    for (int child : two)
      add_children_of(child);
  }
  const auto index = quads.size();
  quads.push_back({{-1, -1, -1, -1}, {}});
  for (size_t k = 0; k < children.size(); ++k) {
    const int face = nodes[children[k]].face, next = face >= 0 ? ~face : add_quad(nodes, children[k], quads);
    quads[index].node[k] = children[k];
    quads[index].next[k] = next;
  }
  return static_cast<int>(index);
}

float triangle_distance(Vec3f q, Vec3f a, Vec3f b, Vec3f c) {
  const Vec3f w = barycentric(q, a, b, c);
  if (w.x >= 0 && w.y >= 0 && w.z >= 0) {
    const Vec3f r = q - (w.x * a + w.y * b + w.z * c);
    return lane_sqrt(dot(r, r));
  }
  return lane_sqrt(lane_min(segment_distance2(q, a, b), lane_min(segment_distance2(q, b, c), segment_distance2(q, c, a))));
}

} // namespace

std::vector<TreeNode> build_tree(const std::vector<Vec3f> &points, const std::vector<Triangle> &faces) {
  Builder builder;
  for (const Triangle &f : faces)
    builder.centres.push_back((1.0f / 3) * (points[f.v[0]] + points[f.v[1]] + points[f.v[2]]));
  builder.order.resize(faces.size());
  std::iota(builder.order.begin(), builder.order.end(), 0);
  builder.nodes.reserve(2 * faces.size());
  builder.add(0, static_cast<int>(faces.size()));
  return builder.nodes;
}

std::vector<QuadNode> build_quads(const std::vector<TreeNode> &nodes) {
  std::vector<QuadNode> quads;
  add_quad(nodes, 0, quads);
  return quads;
}

std::vector<int> vertices_in_order(const std::vector<TreeNode> &nodes, const std::vector<Triangle> &faces, int vertex_count) {
  std::vector<int> order;
  std::vector<char> known(vertex_count, 0);
  for (const TreeNode &node : nodes)
    for (int k = 0; k < 3 && node.face >= 0; ++k)
      if (const int v = faces[node.face].v[k]; !known[v]) {
        known[v] = 1;
        order.push_back(v);
      }
  return order;
}

OrderedEdges edges_in_order(const std::vector<TreeNode> &nodes, const std::vector<Triangle> &faces) {
  std::map<std::pair<int, int>, int> known;
  OrderedEdges all;
  all.first.resize(faces.size());
  all.counts.resize(faces.size());
  for (const TreeNode &node : nodes) {
    if (node.face < 0)
      continue;
    all.first[node.face] = static_cast<int>(all.edges.size());
    for (int k = 0; k < 3; ++k) {
      const auto [a, b] = std::minmax(faces[node.face].v[k], faces[node.face].v[(k + 1) % 3]);
      const int opposite = faces[node.face].v[(k + 2) % 3];
      const auto [at, is_new] = known.insert({{a, b}, static_cast<int>(all.edges.size())});
      if (is_new) {
        all.edges.push_back({a, b, {opposite, -1}});
        ++all.counts[node.face];
      } else if (all.edges[at->second].wings[1] < 0) {
        all.edges[at->second].wings[1] = opposite;
      }
    }
  }
  for (const Edge &edge : all.edges) {
    all.ends[0].push_back(edge.a);
    all.ends[1].push_back(edge.b);
  }
  for (std::vector<int> &list : all.ends)
    list.insert(list.end(), kSpareInList, -1);
  return all;
}

namespace {

/// Does a way lead from each of the faces to each other by common vertices?
bool are_connected(const std::vector<Triangle> &faces, std::vector<int> left) {
  std::vector<int> reached{left.back()};
  left.pop_back();
  for (size_t at = 0; at < reached.size(); ++at) {
    const auto touches = [&](int f) {
      const auto &v = faces[f].v, &w = faces[reached[at]].v;
      return std::find_first_of(v, v + 3, w, w + 3) != v + 3;
    };
    const auto rest = std::stable_partition(left.begin(), left.end(), [&](int f) { return !touches(f); });
    reached.insert(reached.end(), rest, left.end());
    left.erase(rest, left.end());
  }
  return left.empty();
}

struct PatchBuilder {
  const std::vector<TreeNode> &from;
  int most;
  PatchedTree &to;

  int faces_below(int node) const { return (from[node].skip - node + 1) / 2; } // of n leaves there are 2 n - 1 nodes
  void add(int node) {
    const size_t at = to.nodes.size();
    to.nodes.push_back({0, -1});
    if (faces_below(node) <= most) {
      to.nodes[at].face = static_cast<int>(to.patches.size());
      Patch patch{};
      patch.node = static_cast<int>(at);
      patch.first_face = static_cast<int>(to.faces.size());
      for (int i = node; i < from[node].skip; ++i)
        if (from[i].face >= 0)
          to.faces.push_back(from[i].face);
      patch.face_count = static_cast<int>(to.faces.size()) - patch.first_face;
      to.patches.push_back(patch);
    } else {
      add(node + 1);
      add(from[node + 1].skip);
    }
    to.nodes[at].skip = static_cast<int>(to.nodes.size());
  }
};

/// [patch] those that share an edge with it.
std::vector<std::set<int>> patches_beside(const PatchedTree &tree, const std::vector<Triangle> &faces) {
  std::map<std::pair<int, int>, std::set<int>> patches_of;
  for (size_t i = 0; i < tree.patches.size(); ++i)
    for (int k = 0; k < tree.patches[i].face_count; ++k) {
      const int *v = faces[tree.faces[tree.patches[i].first_face + k]].v;
      for (int e = 0; e < 3; ++e)
        patches_of[std::minmax(v[e], v[(e + 1) % 3])].insert(static_cast<int>(i));
    }
  std::vector<std::set<int>> beside(tree.patches.size());
  for (const auto &[edge, meet] : patches_of)
    for (const int i : meet)
      for (const int j : meet)
        if (i != j)
          beside[i].insert(j);
  return beside;
}

/// patches_of: [vertex] the patches that have it
void add_near_patches(const std::vector<std::vector<int>> &patches_of, const std::vector<Triangle> &faces, PatchedTree &tree) {
  std::vector<std::set<int>> next(tree.patches.size());
  for (const std::vector<int> &meet : patches_of)
    for (const int i : meet)
      next[i].insert(meet.begin(), meet.end());
  const std::vector<std::set<int>> beside = patches_beside(tree, faces);
  for (size_t i = 0; i < tree.patches.size(); ++i) {
    const int self = static_cast<int>(i);
    std::set<int> near;
    for (const int j : next[i])
      near.insert(next[j].upper_bound(self), next[j].end());
    tree.patches[i].first_near = static_cast<int>(tree.near.size());
    tree.patches[i].near_count = static_cast<int>(near.size());
    for (const int j : near) {
      const auto first = static_cast<int>(tree.bridges.size());
      if (beside[i].count(j))
        tree.bridges.push_back(self);
      else
        std::set_intersection(beside[i].begin(), beside[i].end(), beside[j].begin(), beside[j].end(),
                              std::back_inserter(tree.bridges));
      tree.near.push_back({j, first, static_cast<int>(tree.bridges.size()) - first});
    }
  }
}

} // namespace

PatchedTree build_patches(const std::vector<TreeNode> &nodes, const std::vector<Triangle> &faces, const OrderedEdges &edges,
                          int vertex_count, int most) {
  PatchedTree out;
  PatchBuilder{nodes, most, out}.add(0);
  for (size_t k = 0; k < out.corners.size(); ++k) {
    for (const int f : out.faces)
      out.corners[k].push_back(faces[f].v[k]);
    out.corners[k].insert(out.corners[k].end(), kSpareInList, -1);
  }
  std::vector<std::vector<int>> patches_of(vertex_count); // ascending
  int vertices = 0;
  for (size_t i = 0; i < out.patches.size(); ++i) {
    Patch &patch = out.patches[i];
    const std::vector<int> own(out.faces.begin() + patch.first_face, out.faces.begin() + patch.first_face + patch.face_count);
    patch.connected = are_connected(faces, own);
    patch.first_vertex = vertices;
    patch.first_edge = edges.first[own.front()];
    for (const int f : own) {
      patch.edge_count += edges.counts[f];
      for (const int v : faces[f].v) {
        if (patches_of[v].empty())
          ++vertices;
        if (patches_of[v].empty() || patches_of[v].back() != static_cast<int>(i))
          patches_of[v].push_back(static_cast<int>(i));
      }
    }
    patch.vertex_count = vertices - patch.first_vertex;
  }
  add_near_patches(patches_of, faces, out);
  return out;
}

namespace {

std::vector<Box<float>> boxes_of(const std::vector<Vec3f> &points, const std::vector<Triangle> &faces,
                                 const std::vector<TreeNode> &nodes) {
  std::vector<Box<float>> boxes(nodes.size());
  refit(nodes.data(), static_cast<int>(nodes.size()), boxes.data(), [&](int f) {
    Box<float> box{points[faces[f].v[0]], points[faces[f].v[0]]};
    for (int v : faces[f].v)
      box = united(box, {points[v], points[v]});
    return box;
  });
  return boxes;
}

std::uint64_t pair_of(int i, int j) {
  return static_cast<std::uint64_t>(i) << 32 | static_cast<std::uint32_t>(j);
}

} // namespace

std::vector<std::uint64_t> pairs_closer_than(const std::vector<Vec3f> &points, const std::vector<Triangle> &faces,
                                             const std::vector<TreeNode> &nodes, float distance) {
  const int count = static_cast<int>(nodes.size());
  const std::vector<Box<float>> boxes = boxes_of(points, faces, nodes);
  std::vector<std::uint64_t> close;
  const Vec3f reach{distance, distance, distance};
  for (int q = 0; q < static_cast<int>(points.size()); ++q)
    for_each_overlap(nodes.data(), count, boxes.data(), Box<float>{points[q] - reach, points[q] + reach}, [&](int f, bool) {
      const auto [a, b, c] = faces[f].v;
      if (q != a && q != b && q != c && triangle_distance(points[q], points[a], points[b], points[c]) < distance)
        close.push_back(pair_of(q, f));
    });
  std::sort(close.begin(), close.end());
  return close;
}

std::vector<std::uint64_t> edges_closer_than(const std::vector<Vec3f> &points, const std::vector<Triangle> &faces,
                                             const std::vector<TreeNode> &nodes, const OrderedEdges &all, float distance) {
  const std::vector<Box<float>> boxes = boxes_of(points, faces, nodes);
  const Vec3f reach{distance, distance, distance};
  std::vector<std::uint64_t> close;
  for (int i = 0; i < static_cast<int>(all.edges.size()); ++i) {
    const int a = all.edges[i].a, b = all.edges[i].b;
    const Box<float> box{low(points[a], points[b]) - reach, high(points[a], points[b]) + reach};
    for_each_overlap(nodes.data(), static_cast<int>(nodes.size()), boxes.data(), box, [&](int f, bool) {
      for (int j = std::max(all.first[f], i + 1); j < all.first[f] + all.counts[f]; ++j) {
        const int c = all.edges[j].a, d = all.edges[j].b;
        if (a != c && a != d && b != c && b != d &&
            segments_distance2(points[a], points[b], points[c], points[d]) < distance * distance)
          close.push_back(pair_of(i, j));
      }
    });
  }
  std::sort(close.begin(), close.end());
  return close;
}

} // namespace doublet::pbd
