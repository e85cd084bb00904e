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

} // namespace DOUBLET_PBD_ISA
} // namespace doublet::pbd
