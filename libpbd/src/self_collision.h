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

/// Edges (0, 1) and (2, 3) that come together on their way.
template <class T, class M> struct EdgeMeeting {
  M lanes;    ///< in which they do
  T s, t;     ///< where, as fractions of the edges
  T side;     ///< at the end, see EdgeContact
  T distance; ///< at the start, m
};
/// x, p: where the vertices are at the start and at the end.
template <class T, class M>
inline EdgeMeeting<T, M> meeting_of_edges(const Vec3<T> (&x)[4], const Vec3<T> (&p)[4], T thickness, M lanes) {
  const Vec3<T> n0 = cross(x[1] - x[0], x[3] - x[2]), n1 = cross(p[1] - p[0], p[3] - p[2]);
  const T start = dot(x[2] - x[0], n0) / lane_max(lane_sqrt(dot(n0, n0)), T(1e-12f));
  const T end = dot(p[2] - p[0], n1) / lane_max(lane_sqrt(dot(n1, n1)), T(1e-12f));
  const T side = select(start < T(0), T(-1), T(1));
  // Edges that turn past each other's direction turn the normal over, not their order.
  const T side_end = select(dot(n0, n1) < T(0), -side, side);
  const T h0 = side * start, h1 = side_end * end;
  lanes = lanes & (h1 <= T(2) * thickness);
  if (!any(lanes))
    return {lanes, T(0), T(0), side_end, h0};
  // Where on the edges: at the moment they come within the thickness, else at the end.
  const T share = lane_min(lane_max((h0 - thickness) / (h0 - h1), T(0)), T(1));
  const T time = select((h1 < thickness) & (h0 > h1), share, T(1));
  const auto at = [&](int k) { return x[k] + time * (p[k] - x[k]); };
  const Vec3<T> a = at(0), c = at(2), u = at(1) - a, v = at(3) - c, r = c - a;
  const T uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), ur = dot(u, r), vr = dot(v, r), det = uu * vv - uv * uv;
  const T inverse = T(1) / lane_max(det, T(1e-30f)), s = (vv * ur - uv * vr) * inverse, t = (uv * ur - uu * vr) * inverse;
  const Vec3<T> apart = mul_add(t, v, c) - mul_add(s, u, a);
  lanes = lanes & (det > T(kCrossing) * (uu * vv)) & (s >= T(0)) & (s <= T(1)) & (t >= T(0)) & (t <= T(1)) &
          (dot(apart, apart) <= T(4) * thickness * thickness);
  return {lanes, s, t, side_end, h0};
}

/// Vertex 0 and face (1, 2, 3) that come together on their way.
template <class T, class M> struct VertexMeeting {
  M lanes;    ///< in which they do
  Vec3<T> at; ///< where, barycentric coordinates
  T side;     ///< see SelfContact
  T distance; ///< at the start, m
};
template <class T, class M>
inline VertexMeeting<T, M> meeting_of_vertex(const Vec3<T> (&x)[4], const Vec3<T> (&p)[4], T thickness, M lanes) {
  const T start = height(x[0], x[1], x[2], x[3]);
  const T side = select(start < T(0), T(-1), T(1));
  const T h0 = side * start, h1 = side * height(p[0], p[1], p[2], p[3]);
  lanes = lanes & (h1 <= T(2) * thickness);
  if (!any(lanes))
    return {lanes, x[0], side, h0};
  // Where on the face: at the moment the vertex comes within the thickness, else at the end.
  const T share = lane_min(lane_max((h0 - thickness) / (h0 - h1), T(0)), T(1));
  const T time = select((h1 < thickness) & (h0 > h1), share, T(1));
  const auto at = [&](int k) { return x[k] + time * (p[k] - x[k]); };
  const Vec3<T> foot = barycentric(at(0), at(1), at(2), at(3));
  lanes = lanes & (foot.x >= T(0)) & (foot.y >= T(0)) & (foot.z >= T(0));
  return {lanes, foot, side, h0};
}

/// Finds the contacts of the cloth with itself for a step from x to p: vertices that would come nearer to a face than the
/// thickness, on the side on which they started (so that nothing passes through), or are within a thickness of doing so; and
/// likewise edges, if they collide. A pair that starts closer than the thickness is opened at most by `opening` in this step.
/// Where the cloth has passed through itself the side says nothing, and a contact would hold the knot together: there are none.
/// Where edges collide, too, Knots moves the cloth apart, and contacts keep what it has gained: in a knot they open nothing, and
/// strained cloth has none. Work is bounded: a vertex that moves, or a face that spans, more than the model's largest_extent
/// (cloth that has exploded) is left out.
template <class T> class SelfCollision {
public:
  using Places = Array<Place<T>>;

  /// At the start of a frame, see Patches::look_anew().
  void look_anew() { patches_.look_anew(); }
  void find(const LaneModel &m, const Places &x, const Places &p, T opening, const Knots<T> &knots,
            Array<SelfContact<T>> &contacts, Array<EdgeContact<T>> &edge_contacts) {
    contacts.clear();
    edge_contacts.clear();
    find_ways(m, x, p);
    const Search search{m, x, p, opening, knots, contacts, edge_contacts};
    if (m.edge_collision)
      find_by_patches(search);
    else
      find_by_tree(search);
  }

private:
  static constexpr bool kSingle = sizeof(T) == sizeof(float);
  struct Search {
    const LaneModel &m;
    const Places &x, &p;
    T opening;
    const Knots<T> &knots;
    Array<SelfContact<T>> &contacts;
    Array<EdgeContact<T>> &edge_contacts;
  };

  /// Common motion brings nobody together: it is left out of the boxes.
  void find_ways(const LaneModel &m, const Places &x, const Places &p) {
    Vec3<T> drift{T(0), T(0), T(0)};
    for (int i = 0; i < m.vertex_count; ++i)
      drift += p[i] - x[i];
    drift = T(1.0f / static_cast<float>(m.vertex_count)) * drift;
    lo_.resize(m.vertex_count);
    hi_.resize(m.vertex_count);
    for (int i = 0; i < m.vertex_count; ++i) {
      const Vec3<T> end = p[i] - drift;
      lo_[i] = low<T>(x[i], end);
      hi_[i] = high<T>(x[i], end);
    }
  }

  void find_by_tree(const Search &s) {
    const LaneModel &m = s.m;
    const T margin(2 * m.self_thickness), largest(m.largest_extent);
    const auto way = [&](int i) { return Box<T>{lo_[i], hi_[i]}; };
    boxes_.refit(m.face_tree, [&](int f) {
      const int *v = m.faces[f].v;
      return bounded(grown(united(united(way(v[0]), way(v[1])), way(v[2])), margin), largest);
    });
    for (int q = 0; q < m.vertex_count; ++q)
      boxes_.for_each_overlap(m.face_tree, bounded(way(q), largest), [&](int f, auto lanes) { bring_vertex(s, q, f, lanes); });
  }

  void find_by_patches(const Search &s) {
    set_patch_boxes(s.m);
    patches_.find(s.m, s.p, face_boxes_, T(2 * s.m.self_thickness));
    bring_all_vertices(s);
    bring_all_edges(s);
    if constexpr (kSingle)
      meet_in_rows(s);
  }
  void set_patch_boxes(const LaneModel &m) {
    const float reach = 2 * m.self_thickness, largest = m.largest_extent;
    set_boxes(lo_, hi_, m.vertex_count, {m.vertex_order}, Margin{0, largest}, vertex_boxes_);
    set_boxes(lo_, hi_, m.edge_count, m.edge_ends, Margin{0, largest}, edge_boxes_);
    set_boxes(lo_, hi_, m.face_count, m.patch_corners, Margin{reach, largest}, face_boxes_);
  }
  void bring_all_vertices(const Search &s) {
    const Patch *patches = s.m.patches;
    patches_.for_each_pair([&](int i, int j, auto may) {
      bring_vertices(s, patches[i], patches[j], patches_.box(j), may);
      if (i != j)
        bring_vertices(s, patches[j], patches[i], patches_.box(i), may);
    });
  }
  void bring_all_edges(const Search &s) {
    const T reach(2 * s.m.self_thickness);
    patches_.for_each_pair([&](int i, int j, auto may) {
      const Patch &one = s.m.patches[i], &other = s.m.patches[j];
      edge_boxes_.for_each_overlap(one.first_edge, one.first_edge + one.edge_count, patches_.box(j), may, [&](int e, auto near) {
        const int first = i == j ? e + 1 : other.first_edge;
        bring_edges(s, e, first, other.first_edge + other.edge_count, grown(edge_boxes_[e], reach), near);
      });
    });
  }
  /// Those of one patch to the faces of another, which lie within `around`.
  template <class M> void bring_vertices(const Search &s, const Patch &one, const Patch &other, const Box<T> &around, M may) {
    vertex_boxes_.for_each_overlap(one.first_vertex, one.first_vertex + one.vertex_count, around, may, [&](int k, auto near) {
      bring_faces(s, k, other.first_face, other.first_face + other.face_count, near);
    });
  }
  /// To vertex k the faces in [first, last), both in the order of the patches.
  template <class M> void bring_faces(const Search &s, int k, int first, int last, M may) {
    const int q = s.m.vertex_order[k];
    if constexpr (kSingle)
      face_boxes_.for_each_row(first, last, vertex_boxes_[k], [&](int n, int overlaps) {
        add_pairs(q, n, overlaps & ~equal_bits(s.m.patch_corners, n, {q}), vertex_pairs_);
      });
    else
      face_boxes_.for_each_overlap(first, last, vertex_boxes_[k], may,
                                   [&](int n, auto lanes) { bring_vertex(s, q, s.m.patch_faces[n], lanes); });
  }
  /// To edge e those in [first, last), in the box.
  template <class M> void bring_edges(const Search &s, int e, int first, int last, const Box<T> &box, M may) {
    const Edge &edge = s.m.edges[e];
    if constexpr (kSingle)
      edge_boxes_.for_each_row(first, last, box, [&](int o, int overlaps) {
        add_pairs(e, o, overlaps & ~equal_bits(s.m.edge_ends, o, {edge.a, edge.b}), edge_pairs_);
      });
    else
      edge_boxes_.for_each_overlap(first, last, box, may, [&](int o, auto lanes) { bring_edge(s, e, o, lanes); });
  }

  template <class M> void bring_vertex(const Search &s, int q, int f, M lanes) {
    const int *v = s.m.faces[f].v;
    if (v[0] == q || v[1] == q || v[2] == q)
      return;
    const Vec3<T> x[] = {s.x[q], s.x[v[0]], s.x[v[1]], s.x[v[2]]}, p[] = {s.p[q], s.p[v[0]], s.p[v[1]], s.p[v[2]]};
    const auto met = meeting_of_vertex(x, p, T(s.m.self_thickness), lanes);
    if (any(met.lanes))
      add_vertex(s, q, f, met);
  }
  template <class M> void bring_edge(const Search &s, int i, int j, M lanes) {
    const Edge &one = s.m.edges[i], &other = s.m.edges[j];
    if (one.a == other.a || one.a == other.b || one.b == other.a || one.b == other.b)
      return;
    const Vec3<T> x[] = {s.x[one.a], s.x[one.b], s.x[other.a], s.x[other.b]},
                  p[] = {s.p[one.a], s.p[one.b], s.p[other.a], s.p[other.b]};
    const auto met = meeting_of_edges(x, p, T(s.m.self_thickness), lanes);
    if (any(met.lanes))
      add_edges(s, i, j, met);
  }

  /// Of one simulation a row of pairs is looked at side by side.
  void meet_in_rows(const Search &s) {
    const LaneModel &m = s.m;
    const Row thickness(m.self_thickness);
    for_each_row(vertex_pairs_, [&](const IndexPair *row, int count, Mask<kRow> there) {
      Vec3<Row> x[4], p[4];
      for (int k = 0; k < 4; ++k) {
        const auto corner = [&](int l) { return k == 0 ? row[l].i : m.patch_corners[k - 1][row[l].j]; };
        x[k] = gather_row(s.x, count, corner), p[k] = gather_row(s.p, count, corner);
      }
      const auto met = meeting_of_vertex(x, p, thickness, there);
      for_each_bit(lane_bits(met.lanes), [&](int l) {
        const Vec3f at{met.at.x.lanes[l], met.at.y.lanes[l], met.at.z.lanes[l]};
        add_vertex(s, row[l].i, m.patch_faces[row[l].j],
                   VertexMeeting<float, bool>{true, at, met.side.lanes[l], met.distance.lanes[l]});
      });
    });
    for_each_row(edge_pairs_, [&](const IndexPair *row, int count, Mask<kRow> there) {
      Vec3<Row> x[4], p[4];
      for (int k = 0; k < 4; ++k) {
        const auto end = [&](int l) { return m.edge_ends[k % 2][k < 2 ? row[l].i : row[l].j]; };
        x[k] = gather_row(s.x, count, end), p[k] = gather_row(s.p, count, end);
      }
      const auto met = meeting_of_edges(x, p, thickness, there);
      for_each_bit(lane_bits(met.lanes), [&](int l) {
        add_edges(s, row[l].i, row[l].j,
                  EdgeMeeting<float, bool>{true, met.s.lanes[l], met.t.lanes[l], met.side.lanes[l], met.distance.lanes[l]});
      });
    });
    vertex_pairs_.clear();
    edge_pairs_.clear();
  }

  template <class M> static void add_vertex(const Search &s, int q, int f, const VertexMeeting<T, M> &met) {
    const int a = s.m.faces[f].v[0], b = s.m.faces[f].v[1], c = s.m.faces[f].v[2];
    const float *w = s.m.weights;
    const Knots<T> &knots = s.knots;
    const auto in_knot = knots.at(q) | knots.at(a) | knots.at(b) | knots.at(c);
    auto lanes = met.lanes;
    if (s.m.edge_collision)
      lanes = lanes & !(knots.strained(q) | knots.strained(a) | knots.strained(b) | knots.strained(c));
    else
      lanes = lanes & !in_knot;
    if (!any(lanes) || w[q] + w[a] + w[b] + w[c] == 0 || is_among(s.m.resting_pairs, s.m.resting_pair_count, q, f))
      return;
    const T kept = lane_min(T(s.m.self_thickness), select(in_knot, met.distance, met.distance + s.opening));
    SelfContact<T> contact{q,        a,        b,        c,        w[q], w[a], w[b], w[c], select(lanes, T(1), T(0)),
                           met.at.x, met.at.y, met.at.z, met.side, kept, T(0), T(0)};
    contact.inverse_sum = contact_response(contact);
    s.contacts.push_back(contact);
  }
  template <class M> static void add_edges(const Search &s, int i, int j, const EdgeMeeting<T, M> &met) {
    const int a = s.m.edges[i].a, b = s.m.edges[i].b, c = s.m.edges[j].a, d = s.m.edges[j].b;
    const float *w = s.m.weights;
    const Knots<T> &knots = s.knots;
    const auto lanes = met.lanes & !(knots.strained(a) | knots.strained(b) | knots.strained(c) | knots.strained(d));
    if (!any(lanes) || w[a] + w[b] + w[c] + w[d] == 0 || is_among(s.m.resting_edges, s.m.resting_edge_count, i, j))
      return;
    const auto in_knot = knots.at(a) | knots.at(b) | knots.at(c) | knots.at(d);
    const T kept = lane_min(T(s.m.self_thickness), select(in_knot, met.distance, met.distance + s.opening));
    EdgeContact<T> contact{a,     b,     c,        d,    w[a], w[b], w[c], w[d], select(lanes, T(1), T(0)),
                           met.s, met.t, met.side, kept, T(0), T(0)};
    contact.inverse_sum = contact_response(contact);
    s.edge_contacts.push_back(contact);
  }

  Places lo_, hi_; ///< of the box around each vertex's way
  FaceBoxes<T> boxes_;
  Patches<T> patches_;
  BoxList<T> vertex_boxes_, edge_boxes_, face_boxes_; ///< in the order of the patches
  Array<IndexPair> vertex_pairs_, edge_pairs_;        ///< of one simulation: vertex and face, two edges, that are to be looked at
};

} // namespace DOUBLET_PBD_ISA
} // namespace doublet::pbd
