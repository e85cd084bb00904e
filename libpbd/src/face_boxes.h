#pragma once
// A tree of boxes over the faces, built once with the model and refitted whenever it is asked; each box has its own bounds in
// every lane, so that simulations that hang in different places do not spoil each other's search.

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
template <class T> inline Box<T> grown(const Box<T> &box, T by) {
  const Vec3<T> grow{by, by, by};
  return {box.lo - grow, box.hi + grow};
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
/// Squared distance of q to the segment (a, b).
template <class T> inline T segment_distance2(const Vec3<T> &q, const Vec3<T> &a, const Vec3<T> &b) {
  const Vec3<T> e = b - a, d = q - a;
  const T t = lane_min(lane_max(dot(d, e) / lane_max(dot(e, e), T(1e-30f)), T(0)), T(1));
  const Vec3<T> r = d - t * e;
  return dot(r, r);
}
/// Of the segments (a, b) and (c, d).
template <class T> inline T segments_distance2(const Vec3<T> &a, const Vec3<T> &b, const Vec3<T> &c, const Vec3<T> &d) {
  const Vec3<T> u = b - a, v = d - c, r = c - a;
  const T uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), ur = dot(u, r), vr = dot(v, r), det = uu * vv - uv * uv;
  const T inverse = T(1) / lane_max(det, T(1e-30f)), s = (vv * ur - uv * vr) * inverse, t = (uv * ur - uu * vr) * inverse;
  const Vec3<T> way = mul_add(t, v, c) - mul_add(s, u, a);
  const auto between = (det > T(0)) & (s >= T(0)) & (s <= T(1)) & (t >= T(0)) & (t <= T(1));
  const T ends = lane_min(lane_min(segment_distance2(a, c, d), segment_distance2(b, c, d)),
                          lane_min(segment_distance2(c, a, b), segment_distance2(d, a, b)));
  return select(between, lane_min(dot(way, way), ends), ends);
}
/// Sets box[node] of the whole tree; leaf(face): the face's box.
template <class T, class Leaf> inline void refit(const TreeNode *nodes, int count, Box<T> *box, Leaf &&leaf) {
  for (int i = count - 1; i >= 0; --i)
    box[i] = nodes[i].face >= 0 ? leaf(nodes[i].face) : united(box[i + 1], box[nodes[i + 1].skip]);
}
/// Calls found(face, lanes) for every leaf from node `first` on whose box overlaps `query` in some of the lanes, in the order of
/// the tree.
template <class T, class Found>
inline void for_each_overlap(const TreeNode *nodes, int count, const Box<T> *box, const Box<T> &query, Found &&found,
                             int first = 0) {
  for (int i = first; i < count;) {
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

/// The boxes of a tree's leaves, faces as a rule, for many questions.
template <class T> class FaceBoxes {
public:
  /// leaf(face): the face's box.
  template <class Leaf> void refit(const BoxTree &tree, Leaf &&leaf) {
    boxes_.resize(tree.node_count);
    DOUBLET_PBD_ISA::refit<T>(tree.nodes, tree.node_count, boxes_.data(), leaf);
  }
  /// Calls found(face, lanes) for every face whose box overlaps `query` in some of the lanes, in the order of the tree.
  template <class Found> void for_each_overlap(const BoxTree &tree, const Box<T> &query, Found &&found) const {
    DOUBLET_PBD_ISA::for_each_overlap<T>(tree.nodes, tree.node_count, boxes_.data(), query, found);
  }

private:
  Array<Box<T>> boxes_; ///< of each node
};

/// For one simulation the boxes of four nodes are compared side by side: every comparison ends in a jump that nobody can
/// foretell.
template <> class FaceBoxes<float> {
public:
  template <class Leaf> void refit(const BoxTree &tree, Leaf &&leaf) {
    boxes_.resize(tree.node_count);
    DOUBLET_PBD_ISA::refit<float>(tree.nodes, tree.node_count, boxes_.data(), leaf);
    quads_.resize(tree.quad_count);
    for (int i = 0; i < tree.quad_count; ++i)
      for (int k = 0; k < 4; ++k)
        quads_[i].set(k, tree.quads[i].node[k] >= 0 ? boxes_[tree.quads[i].node[k]] : nothing());
  }
  template <class Found> void for_each_overlap(const BoxTree &tree, const Box<float> &query, Found &&found) const {
    int waiting[64], count = 1; // four a level, and as many levels as quads of 2^31 faces have
    waiting[0] = 0;
    while (count > 0) {
      const int at = waiting[--count];
      if (at < 0) {
        found(~at, true);
        continue;
      }
      const QuadNode &quad = tree.quads[at];
      const int overlaps = quads_[at].overlap(query);
      for (int k = 3; k >= 0; --k) // the last goes below the first
        if (overlaps >> k & 1)
          waiting[count++] = quad.next[k];
    }
  }

private:
  struct Quad {
    Pack<4> lo[3], hi[3];
    void set(int k, const Box<float> &box) {
      lo[0].lanes[k] = box.lo.x, lo[1].lanes[k] = box.lo.y, lo[2].lanes[k] = box.lo.z;
      hi[0].lanes[k] = box.hi.x, hi[1].lanes[k] = box.hi.y, hi[2].lanes[k] = box.hi.z;
    }
    int overlap(const Box<float> &q) const {
      return lane_bits((Pack<4>(q.lo.x) <= hi[0]) & (lo[0] <= Pack<4>(q.hi.x)) & (Pack<4>(q.lo.y) <= hi[1]) &
                       (lo[1] <= Pack<4>(q.hi.y)) & (Pack<4>(q.lo.z) <= hi[2]) & (lo[2] <= Pack<4>(q.hi.z)));
    }
  };
  static Box<float> nothing() { return {{1e30f, 1e30f, 1e30f}, {-1e30f, -1e30f, -1e30f}}; }

  Array<Box<float>> boxes_; ///< of each node
  Array<Quad> quads_;
};

} // namespace DOUBLET_PBD_ISA
} // namespace doublet::pbd
