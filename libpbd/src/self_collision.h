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

/// Is (i, j) one of the sorted pairs?
inline bool is_among(const std::uint64_t *pairs, int count, int i, int j) {
  const std::uint64_t key = static_cast<std::uint64_t>(i) << 32 | static_cast<std::uint32_t>(j);
  int first = 0, last = count;
  while (first < last) {
    const int middle = (first + last) / 2;
    if (pairs[middle] < key)
      first = middle + 1;
    else
      last = middle;
  }
  return first < count && pairs[first] == key;
}

constexpr float kCrossing = 0.01f; ///< squared sine of the angle up to which two edges are parallel: vertices collide there

/// Finds the contacts of the cloth with itself for a step from x to p: vertices that would come nearer to a face than the
/// thickness, on the side on which they started (so that nothing passes through), or are within a thickness of doing so; and
/// likewise edges, if they collide. A pair that starts closer than the thickness is opened at most by `opening` in this step.
/// Where the cloth has passed through itself the side says nothing, and a contact would hold the knot together: there are none.
/// Where edges collide, too, Knots moves the cloth apart, and contacts keep what it has gained: in a knot they open nothing, and
/// strained cloth has none. Work is bounded: a vertex that moves, or a face that spans, more than the model's largest_extent
/// (cloth that has exploded) is left out.
template <class T> class SelfCollision {
public:
  template <class Points>
  void find(const LaneModel &m, const Points &x, const Points &p, T opening, const Knots<T> &knots,
            Array<SelfContact<T>> &contacts, Array<EdgeContact<T>> &edge_contacts) {
    contacts.clear();
    edge_contacts.clear();
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
    const auto face_box = [&](int f) {
      const int *v = m.faces[f].v;
      return bounded(grown(united(united(path(v[0]), path(v[1])), path(v[2])), margin), largest);
    };
    const auto bring = [&](int q, int f, auto lanes) {
      const int *v = m.faces[f].v;
      if (v[0] != q && v[1] != q && v[2] != q)
        add_contact(m, x, p, q, f, opening, lanes, knots, contacts);
    };
    if (!m.edge_collision) {
      boxes_.refit(m.face_tree, face_box);
      for (int q = 0; q < m.vertex_count; ++q)
        boxes_.for_each_overlap(m.face_tree, bounded(path(q), largest), [&](int f, auto lanes) { bring(q, f, lanes); });
      return;
    }

    const auto bring_edges = [&](int i, int j, auto lanes) {
      if (!share_a_vertex(m.edges[i], m.edges[j]))
        try_edges(m, x, p, i, j, opening, lanes, knots, edge_contacts);
    };
    find_by_patches(m, p, path, face_box, bring, bring_edges);
  }

  /// Adds the contact of edges i and j in the lanes in which they have one.
  template <class Points, class M>
  static void try_edges(const LaneModel &m, const Points &x, const Points &p, int i, int j, T opening, M lanes,
                        const Knots<T> &knots, Array<EdgeContact<T>> &contacts) {
    const int a = m.edges[i].a, b = m.edges[i].b, c = m.edges[j].a, d = m.edges[j].b;
    const float *w = m.weights;
    const T thickness(m.self_thickness);
    const Vec3<T> n0 = cross<T>(x[b] - x[a], x[d] - x[c]), n1 = cross<T>(p[b] - p[a], p[d] - p[c]);
    const T start = dot<T>(x[c] - x[a], n0) / lane_max(lane_sqrt(dot(n0, n0)), T(1e-12f));
    const T end = dot<T>(p[c] - p[a], n1) / lane_max(lane_sqrt(dot(n1, n1)), T(1e-12f));
    const T side = select(start < T(0), T(-1), T(1));
    // Edges that turn past each other's direction turn the normal over, not their order.
    const T side_end = select(dot(n0, n1) < T(0), -side, side);
    const T h0 = side * start, h1 = side_end * end;
    lanes = lanes & (h1 <= T(2) * thickness);
    if (!any(lanes) || w[a] + w[b] + w[c] + w[d] == 0)
      return;
    const T share = lane_min(lane_max((h0 - thickness) / (h0 - h1), T(0)), T(1));
    const T t = select((h1 < thickness) & (h0 > h1), share, T(1));
    const auto at = [&](int v) { return x[v] + t * (p[v] - x[v]); };
    const Vec3<T> pa = at(a), pc = at(c), u = at(b) - pa, v = at(d) - pc, r = pc - pa;
    const T uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), ur = dot(u, r), vr = dot(v, r), det = uu * vv - uv * uv;
    const T inverse = T(1) / lane_max(det, T(1e-30f)), si = (vv * ur - uv * vr) * inverse, ti = (uv * ur - uu * vr) * inverse;
    const Vec3<T> apart = mul_add(ti, v, pc) - mul_add(si, u, pa);
    lanes = lanes & (det > T(kCrossing) * (uu * vv)) & (si >= T(0)) & (si <= T(1)) & (ti >= T(0)) & (ti <= T(1)) &
            (dot(apart, apart) <= T(4) * thickness * thickness) &
            !(knots.strained(a) | knots.strained(b) | knots.strained(c) | knots.strained(d));
    if (!any(lanes) || is_among(m.resting_edges, m.resting_edge_count, i, j))
      return;
    const auto in_knot = knots.at(a) | knots.at(b) | knots.at(c) | knots.at(d);
    const T kept = lane_min(thickness, select(in_knot, h0, h0 + opening));
    EdgeContact<T> contact{a, b, c, d, w[a], w[b], w[c], w[d], select(lanes, T(1), T(0)), si, ti, side_end, kept, T(0), T(0)};
    contact.inverse_sum = contact_response(contact);
    contacts.push_back(contact);
  }

private:
  /// Calls bring(vertex, face, lanes) and bring_edges(edge, later edge, lanes) for what comes near.
  template <class Points, class Path, class FaceBox, class Bring, class BringEdges>
  void find_by_patches(const LaneModel &m, const Points &p, const Path &path, const FaceBox &face_box, const Bring &bring,
                       const BringEdges &bring_edges) {
    const T margin(2 * m.self_thickness), largest(m.largest_extent);
    vertex_boxes_.resize(m.vertex_count);
    for (int q = 0; q < m.vertex_count; ++q)
      vertex_boxes_[q] = bounded(path(q), largest);
    edge_boxes_.resize(m.edge_count);
    for (int i = 0; i < m.edge_count; ++i)
      edge_boxes_[i] = bounded(united(path(m.edges[i].a), path(m.edges[i].b)), largest);
    face_boxes_.resize(m.face_count);
    for (int f = 0; f < m.face_count; ++f)
      face_boxes_[f] = face_box(f);
    const auto without_margin = [&](int f) { return grown(face_boxes_[f], -margin); };
    patches_.find(m, p, without_margin, margin);
    patches_.for_each_pair([&](int i, int j, auto lanes) {
      bring_vertices(m, m.patches[i], m.patches[j], patches_.box(j), lanes, bring);
      if (i != j)
        bring_vertices(m, m.patches[j], m.patches[i], patches_.box(i), lanes, bring);
    });
    patches_.for_each_pair([&](int i, int j, auto may) {
      const Patch &one = m.patches[i], &other = m.patches[j];
      for (int e = one.first_edge; e < one.first_edge + one.edge_count; ++e) {
        if (!any(may & overlap(edge_boxes_[e], patches_.box(j))))
          continue;
        const Box<T> box = grown(edge_boxes_[e], margin);
        for (int o = i == j ? e + 1 : other.first_edge; o < other.first_edge + other.edge_count; ++o) {
          const auto lanes = may & overlap(box, edge_boxes_[o]);
          if (any(lanes))
            bring_edges(e, o, lanes);
        }
      }
    });
  }
  /// Those of one patch to the faces of another, which lie within `around`.
  template <class M, class Bring>
  void bring_vertices(const LaneModel &m, const Patch &one, const Patch &other, const Box<T> &around, M may,
                      const Bring &bring) const {
    for (int k = 0; k < one.vertex_count; ++k) {
      const int q = m.patch_vertices[one.first_vertex + k];
      if (!any(may & overlap(vertex_boxes_[q], around)))
        continue;
      for (int n = 0; n < other.face_count; ++n) {
        const int f = m.patch_faces[other.first_face + n];
        const auto lanes = may & overlap(vertex_boxes_[q], face_boxes_[f]);
        if (any(lanes))
          bring(q, f, lanes);
      }
    }
  }
  static bool share_a_vertex(const Edge &i, const Edge &j) { return i.a == j.a || i.a == j.b || i.b == j.a || i.b == j.b; }

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
    lanes = lanes & (foot.x >= T(0)) & (foot.y >= T(0)) & (foot.z >= T(0));
    const auto in_knot = knots.at(q) | knots.at(a) | knots.at(b) | knots.at(c);
    if (m.edge_collision)
      lanes = lanes & !(knots.strained(q) | knots.strained(a) | knots.strained(b) | knots.strained(c));
    else
      lanes = lanes & !in_knot;
    if (!any(lanes) || is_among(m.resting_pairs, m.resting_pair_count, q, f))
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
                           lane_min(thickness, select(in_knot, h0, h0 + opening)),
                           T(0),
                           T(0)};
    contact.inverse_sum = contact_response(contact);
    contacts.push_back(contact);
  }

  FaceBoxes<T> boxes_;
  Patches<T> patches_;
  Array<Box<T>> vertex_boxes_, face_boxes_, edge_boxes_;
};

} // namespace DOUBLET_PBD_ISA
} // namespace doublet::pbd
