#pragma once
// The cloth against itself: which vertices come near which faces. A tree of boxes over the faces, built once with the model and
// refitted in every step; each box has its own bounds in every lane, so that simulations that hang in different places do not
// spoil each other's search.

#include "kernels.h"
#include "lane_array.h"
#include "pack.h"

namespace doublet::pbd {
inline namespace DOUBLET_PBD_ISA {

template <class T> struct Box { Vec3<T> lo, hi; };

template <class T> inline Vec3<T> low(const Vec3<T> &a, const Vec3<T> &b) {
  return {lane_min(a.x, b.x), lane_min(a.y, b.y), lane_min(a.z, b.z)};
}
template <class T> inline Vec3<T> high(const Vec3<T> &a, const Vec3<T> &b) {
  return {lane_max(a.x, b.x), lane_max(a.y, b.y), lane_max(a.z, b.z)};
}
template <class T> inline Box<T> united(const Box<T> &a, const Box<T> &b) {
  return {low(a.lo, b.lo), high(a.hi, b.hi)};
}
template <class T> inline auto overlap(const Box<T> &a, const Box<T> &b) {
  return (a.lo.x <= b.hi.x) & (b.lo.x <= a.hi.x) & (a.lo.y <= b.hi.y) & (b.lo.y <= a.hi.y) & (a.lo.z <= b.hi.z) &
         (b.lo.z <= a.hi.z);
}
/// Of one simulation: six comparisons in two. What the fourth lanes hold is compared with what it cannot but be within.
inline bool overlap(const Box<float> &a, const Box<float> &b) {
  static_assert(sizeof a == 6 * sizeof(float));
  const float far = 3e38f;
  const Pack<4> hi(Pack<4>::Lanes{a.hi.x, a.hi.y, a.hi.z, far}), lo(Pack<4>::Lanes{-far, a.lo.x, a.lo.y, a.lo.z});
  return !any(!((Pack<4>::load(&b.lo.x) <= hi) & (lo <= Pack<4>::load(&b.lo.z))));
}
/// `box` where it is at most `largest` wide, else one that overlaps nothing.
template <class T> inline Box<T> bounded(const Box<T> &box, T largest) {
  const Vec3<T> size = box.hi - box.lo;
  const auto fits = (size.x <= largest) & (size.y <= largest) & (size.z <= largest);
  const T far(1e30f);
  return {select(fits, box.lo, Vec3<T>{far, far, far}), select(fits, box.hi, Vec3<T>{-far, -far, -far})};
}

/// Barycentric coordinates of the foot of q on the plane of (a, b, c).
template <class T> inline Vec3<T> barycentric(const Vec3<T> &q, const Vec3<T> &a, const Vec3<T> &b, const Vec3<T> &c) {
  const Vec3<T> u = b - a, v = c - a, d = q - a;
  const T uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), du = dot(d, u), dv = dot(d, v);
  const T inverse = T(1) / lane_max(uu * vv - uv * uv, T(1e-30f));
  const T s = (vv * du - uv * dv) * inverse, t = (uu * dv - uv * du) * inverse;
  return {T(1) - s - t, s, t};
}
/// Height of q over the plane of (a, b, c), m.
template <class T> inline T height(const Vec3<T> &q, const Vec3<T> &a, const Vec3<T> &b, const Vec3<T> &c) {
  const Vec3<T> n = cross(b - a, c - a);
  return dot(q - a, n) / lane_max(lane_sqrt(dot(n, n)), T(1e-12f));
}

/// Sets box[node] of the whole tree; leaf(face): the face's box.
template <class T, class Leaf> inline void refit(const TreeNode *nodes, int count, Box<T> *box, Leaf &&leaf) {
  for (int i = count - 1; i >= 0; --i)
    box[i] = nodes[i].face >= 0 ? leaf(nodes[i].face) : united(box[i + 1], box[nodes[i + 1].skip]);
}
/// Calls found(face, lanes) for every leaf whose box overlaps `query` in some of the lanes, in the order of the tree.
template <class T, class Found>
inline void for_each_overlap(const TreeNode *nodes, int count, const Box<T> *box, const Box<T> &query, Found &&found) {
  for (int i = 0; i < count;) {
    const auto lanes = overlap(query, box[i]);
    if (!any(lanes)) {
      i = nodes[i].skip;
      continue;
    }
    if (nodes[i].face >= 0)
      found(nodes[i].face, lanes);
    ++i;
  }
}

inline bool rests_together(const LaneModel &m, int vertex, int face) {
  const std::uint64_t key = static_cast<std::uint64_t>(vertex) << 32 | static_cast<std::uint32_t>(face);
  int first = 0, last = m.resting_pair_count;
  while (first < last) {
    const int middle = (first + last) / 2;
    if (m.resting_pairs[middle] < key)
      first = middle + 1;
    else
      last = middle;
  }
  return first < m.resting_pair_count && m.resting_pairs[first] == key;
}

/// Finds the contacts of the cloth with itself for a step from x to p: vertices that would come nearer to a face than the
/// thickness, on the side on which they started (so that nothing passes through), or are within a thickness of doing so. A pair
/// that starts closer than the thickness is opened at most by `opening` in this step. Work is bounded: a vertex that moves, or a
/// face that spans, more than the model's largest_extent (cloth that has exploded) is left out.
template <class T> class SelfCollision {
public:
  template <class Points>
  void find(const LaneModel &m, const Points &x, const Points &p, T opening, Array<SelfContact<T>> &contacts) {
    contacts.clear();
    // Common motion brings nobody together: leave it out of the boxes.
    Vec3<T> drift{T(0), T(0), T(0)};
    for (int i = 0; i < m.vertex_count; ++i)
      drift += p[i] - x[i];
    drift = T(1.0f / static_cast<float>(m.vertex_count)) * drift;
    const auto path = [&](int i) {
      const Vec3<T> end = p[i] - drift;
      return Box<T>{low<T>(x[i], end), high<T>(x[i], end)};
    };

    const T margin(2 * m.self_thickness), largest(m.largest_extent);
    boxes_.resize(m.node_count);
    refit<T>(m.nodes, m.node_count, boxes_.data(), [&](int f) {
      const int *v = m.faces[f].v;
      const Box<T> box = united(united(path(v[0]), path(v[1])), path(v[2]));
      const Vec3<T> grow{margin, margin, margin};
      return bounded(Box<T>{box.lo - grow, box.hi + grow}, largest);
    });
    for (int q = 0; q < m.vertex_count; ++q)
      for_each_overlap<T>(m.nodes, m.node_count, boxes_.data(), bounded(path(q), largest), [&](int f, auto lanes) {
        const int *v = m.faces[f].v;
        if (v[0] != q && v[1] != q && v[2] != q)
          add_contact(m, x, p, q, f, opening, lanes, contacts);
      });
  }

private:
  template <class Points, class M>
  void add_contact(const LaneModel &m, const Points &x, const Points &p, int q, int f, T opening, M lanes,
                   Array<SelfContact<T>> &contacts) {
    const int a = m.faces[f].v[0], b = m.faces[f].v[1], c = m.faces[f].v[2];
    const float *w = m.weights;
    const T thickness(m.self_thickness);
    const T start = height<T>(x[q], x[a], x[b], x[c]);
    const T side = select(start < T(0), T(-1), T(1));
    const T h0 = side * start, h1 = side * height<T>(p[q], p[a], p[b], p[c]);
    lanes = lanes & (h1 <= T(2) * thickness);
    if (!any(lanes) || w[q] + w[a] + w[b] + w[c] == 0)
      return;
    // Where on the face: at the moment the vertex comes within the thickness, else at the end.
    const T share = lane_min(lane_max((h0 - thickness) / (h0 - h1), T(0)), T(1));
    const T t = select((h1 < thickness) & (h0 > h1), share, T(1));
    const auto at = [&](int i) { return x[i] + t * (p[i] - x[i]); };
    const Vec3<T> foot = barycentric<T>(at(q), at(a), at(b), at(c));
    lanes = lanes & (foot.x >= T(0)) & (foot.y >= T(0)) & (foot.z >= T(0));
    if (!any(lanes) || rests_together(m, q, f))
      return;
    SelfContact<T> contact{q,
                           a,
                           b,
                           c,
                           w[q],
                           w[a],
                           w[b],
                           w[c],
                           select(lanes, T(1), T(0)),
                           foot.x,
                           foot.y,
                           foot.z,
                           side,
                           lane_min(thickness, h0 + opening),
                           T(0),
                           T(0)};
    contact.inverse_sum = contact_response(contact);
    contacts.push_back(contact);
  }

  Array<Box<T>> boxes_; ///< of each node
};

} // namespace DOUBLET_PBD_ISA
} // namespace doublet::pbd
