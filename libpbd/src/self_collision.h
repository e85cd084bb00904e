#pragma once
// The cloth against itself: which vertices come near which faces.

#include "knots.h"

namespace doublet::pbd {
inline namespace DOUBLET_PBD_ISA {

/// Height of q over the plane of (a, b, c), m.
template <class T> inline T height(const Vec3<T> &q, const Vec3<T> &a, const Vec3<T> &b, const Vec3<T> &c) {
  const Vec3<T> n = cross(b - a, c - a);
  return dot(q - a, n) / lane_max(lane_sqrt(dot(n, n)), T(1e-12f));
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
/// that starts closer than the thickness is opened at most by `opening` in this step. Where the cloth has passed through itself
/// the side says nothing, and a contact would hold the knot together: there are none. Work is bounded: a vertex that moves, or a
/// face that spans, more than the model's largest_extent (cloth that has exploded) is left out.
template <class T> class SelfCollision {
public:
  template <class Points>
  void find(const LaneModel &m, const Points &x, const Points &p, T opening, const Knots<T> &knots,
            Array<SelfContact<T>> &contacts) {
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
    boxes_.refit(m, [&](int f) {
      const int *v = m.faces[f].v;
      const Box<T> box = united(united(path(v[0]), path(v[1])), path(v[2]));
      const Vec3<T> grow{margin, margin, margin};
      return bounded(Box<T>{box.lo - grow, box.hi + grow}, largest);
    });
    for (int q = 0; q < m.vertex_count; ++q)
      boxes_.for_each_overlap(m, bounded(path(q), largest), [&](int f, auto lanes) {
        const int *v = m.faces[f].v;
        if (v[0] != q && v[1] != q && v[2] != q)
          add_contact(m, x, p, q, f, opening, lanes, knots, contacts);
      });
  }

private:
  template <class Points, class M>
  void add_contact(const LaneModel &m, const Points &x, const Points &p, int q, int f, T opening, M lanes, const Knots<T> &knots,
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
    const auto knotted = knots.at(q) | knots.at(a) | knots.at(b) | knots.at(c);
    lanes = lanes & (foot.x >= T(0)) & (foot.y >= T(0)) & (foot.z >= T(0)) & !knotted;
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

  FaceBoxes<T> boxes_;
};

} // namespace DOUBLET_PBD_ISA
} // namespace doublet::pbd
