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

constexpr float kAside = 0.002f;    ///< m that a vertex may leave its way through a frame before the tree is asked again ...
constexpr float kAstray = 0.2f;     ///< ... and the share of that way
constexpr float kRounded = 1e-5f;   ///< m
constexpr float kCrossing = 0.01f; ///< squared sine of the angle up to which two edges are parallel: vertices collide there

/// Finds the contacts of the cloth with itself for a step from x to p: vertices that would come nearer to a face than the
/// thickness, on the side on which they started (so that nothing passes through), or are within a thickness of doing so; and
/// likewise edges. A pair that starts closer than the thickness is opened at most by `opening` in this step. Where the cloth has
/// passed through itself the side says nothing, and a contact would hold the knot together: there are none, unless edges collide,
/// too, and Knots moves it apart. Work is bounded: a vertex that moves, or a face that spans, more than the model's largest_extent
/// (cloth that has exploded) is left out.
///
/// The tree is asked once a frame for the pairs that can meet while every vertex keeps to a box around its way through the frame,
/// and again when one has left it; pairs are told apart in each step. What is found is what find_afresh() finds, in that order.
template <class T> class SelfCollision {
public:
  /// At the start of a frame.
  void forget() { known_ = false; }
  /// horizon: how many steps like this one the frame has left, with this one.
  template <class Points>
  void find(const LaneModel &m, const Points &x, const Points &p, T opening, float horizon, const Knots<T> &knots,
            Array<SelfContact<T>> &contacts, Array<EdgeContact<T>> &edge_contacts) {
    const Vec3<T> drift = common_motion(m, x, p);
    if (!known_ || !keeps_to_boxes(m, x, p, drift))
      known_ = collect(m, x, p, drift, horizon);
    if (!known_) {
      find_afresh(m, x, p, opening, knots, contacts, edge_contacts);
      return;
    }
    contacts.clear();
    edge_contacts.clear();
    set_paths(m, x, p, drift);
    const T margin(2 * m.self_thickness);
    face_boxes_.resize(m.face_count);
    for (int f = 0; f < m.face_count; ++f)
      face_boxes_[f] = grown(box_of(paths_, m.faces[f]), margin);
    for (const Pair &pair : vertex_faces_) {
      const auto lanes = overlap(paths_[pair.i], face_boxes_[pair.j]);
      if (any(lanes))
        add_contact(m, x, p, pair.i, pair.j, opening, lanes, knots, contacts);
    }
    const auto everywhere = T(0) <= T(0);
    for (const Pair &pair : edge_edges_)
      add_edges(m, x, p, pair.i, pair.j, opening, everywhere, edge_contacts);
    since_ += drift;
  }

  /// The same from the tree alone.
  template <class Points>
  void find_afresh(const LaneModel &m, const Points &x, const Points &p, T opening, const Knots<T> &knots,
                   Array<SelfContact<T>> &contacts, Array<EdgeContact<T>> &edge_contacts) {
    contacts.clear();
    edge_contacts.clear();
    set_paths(m, x, p, common_motion(m, x, p));
    const T margin(2 * m.self_thickness), largest(m.largest_extent);
    boxes_.refit(m, [&](int f) { return bounded(grown(box_of(paths_, m.faces[f]), margin), largest); });
    for (int q = 0; q < m.vertex_count; ++q)
      boxes_.for_each_overlap(m, bounded(paths_[q], largest), [&](int f, auto lanes) {
        if (!has_corner(m.faces[f], q))
          add_contact(m, x, p, q, f, opening, lanes, knots, contacts);
      });
    for (int i = 0; m.edge_collision && i < m.edge_count; ++i)
      boxes_.for_each_overlap(m, bounded(box_of(paths_, m.edges[i]), largest), [&](int f, auto lanes) {
        for_each_later_edge(m, i, f, [&](int j) { add_edges(m, x, p, i, j, opening, lanes, edge_contacts); });
      });
  }

private:
  struct Pair { int i, j; };

  static Box<T> grown(const Box<T> &box, T by) {
    const Vec3<T> grow{by, by, by};
    return {box.lo - grow, box.hi + grow};
  }
  static Box<T> box_of(const Array<Box<T>> &boxes, const Triangle &f) {
    return united(united(boxes[f.v[0]], boxes[f.v[1]]), boxes[f.v[2]]);
  }
  static Box<T> box_of(const Array<Box<T>> &boxes, const Edge &e) { return united(boxes[e.a], boxes[e.b]); }
  static bool has_corner(const Triangle &f, int vertex) { return f.v[0] == vertex || f.v[1] == vertex || f.v[2] == vertex; }
  /// Calls visit(j) for the edges behind edge i that the face stands for and that share no vertex with it.
  template <class Visit> static void for_each_later_edge(const LaneModel &m, int i, int f, Visit &&visit) {
    const Edge &e = m.edges[i];
    const int first = m.first_edges[f], last = first + m.edge_counts[f];
    for (int j = first > i ? first : i + 1; j < last; ++j) {
      const Edge &other = m.edges[j];
      if (other.a != e.a && other.a != e.b && other.b != e.a && other.b != e.b)
        visit(j);
    }
  }

  /// It brings nobody together and is left out of the boxes.
  template <class Points> static Vec3<T> common_motion(const LaneModel &m, const Points &x, const Points &p) {
    Vec3<T> drift{T(0), T(0), T(0)};
    for (int i = 0; i < m.vertex_count; ++i)
      drift += p[i] - x[i];
    return T(1.0f / static_cast<float>(m.vertex_count)) * drift;
  }
  template <class Points> void set_paths(const LaneModel &m, const Points &x, const Points &p, const Vec3<T> &drift) {
    paths_.resize(m.vertex_count);
    for (int i = 0; i < m.vertex_count; ++i) {
      const Vec3<T> end = p[i] - drift;
      paths_[i] = {low<T>(x[i], end), high<T>(x[i], end)};
    }
  }

  template <class Points> bool keeps_to_boxes(const LaneModel &m, const Points &x, const Points &p, const Vec3<T> &drift) const {
    for (int i = 0; i < m.vertex_count; ++i) {
      const Vec3<T> start = x[i] - since_, end = (p[i] - drift) - since_;
      if (any(!inside(start, ways_[i])) || any(!inside(end, ways_[i])))
        return false;
    }
    return true;
  }
  static auto inside(const Vec3<T> &q, const Box<T> &b) {
    return (b.lo.x <= q.x) & (q.x <= b.hi.x) & (b.lo.y <= q.y) & (q.y <= b.hi.y) & (b.lo.z <= q.z) & (q.z <= b.hi.z);
  }

  /// The boxes of all vertices and the pairs that can meet in them. False where one is too large, or not a number: the cloth has
  /// exploded.
  template <class Points> bool collect(const LaneModel &m, const Points &x, const Points &p, const Vec3<T> &drift, float horizon) {
    since_ = Vec3<T>{T(0), T(0), T(0)};
    ways_.resize(m.vertex_count);
    for (int i = 0; i < m.vertex_count; ++i) {
      const Vec3<T> way = T(horizon) * ((p[i] - drift) - x[i]), end = x[i] + way;
      const T size = lane_max(lane_abs(way.x), lane_max(lane_abs(way.y), lane_abs(way.z)));
      ways_[i] = grown({low<T>(x[i], end), high<T>(x[i], end)}, mul_add(T(kAstray), size, T(kAside)));
    }
    const T margin = T(2 * m.self_thickness + kRounded), largest(m.largest_extent);
    auto fits = T(0) <= T(0);
    boxes_.refit(m, [&](int f) {
      const Box<T> box = grown(box_of(ways_, m.faces[f]), margin);
      const Vec3<T> size = box.hi - box.lo;
      fits = fits & (size.x <= largest) & (size.y <= largest) & (size.z <= largest);
      return box;
    });
    if (any(!fits))
      return false;
    vertex_faces_.clear();
    for (int q = 0; q < m.vertex_count; ++q)
      boxes_.for_each_overlap(m, ways_[q], [&](int f, auto) {
        if (!has_corner(m.faces[f], q))
          vertex_faces_.push_back({q, f});
      });
    edge_edges_.clear();
    if (m.edge_collision)
      collect_edges(m, margin);
    return true;
  }
  void collect_edges(const LaneModel &m, T margin) {
    centres_.resize(m.vertex_count);
    radii_.resize(m.vertex_count);
    for (int i = 0; i < m.vertex_count; ++i) {
      const Vec3<T> half = T(0.5f) * (ways_[i].hi - ways_[i].lo);
      centres_[i] = ways_[i].lo + half;
      radii_[i] = lane_sqrt(dot(half, half));
    }
    for (int i = 0; i < m.edge_count; ++i) {
      const Edge &e = m.edges[i];
      const Box<T> box = grown(box_of(ways_, e), margin);
      const T reach = margin + lane_max(radii_[e.a], radii_[e.b]);
      boxes_.for_each_overlap(m, box_of(ways_, e), [&](int f, auto) {
        for_each_later_edge(m, i, f, [&](int j) {
          const Edge &o = m.edges[j];
          const auto lanes = overlap(box, box_of(ways_, o));
          if (!any(lanes))
            return;
          const T most = reach + lane_max(radii_[o.a], radii_[o.b]);
          if (any(lanes & (segments_distance2(centres_[e.a], centres_[e.b], centres_[o.a], centres_[o.b]) <= most * most)))
            edge_edges_.push_back({i, j});
        });
      });
    }
  }

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
    if (!m.edge_collision)
      lanes = lanes & !(knots.at(q) | knots.at(a) | knots.at(b) | knots.at(c));
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
                           lane_min(thickness, h0 + opening),
                           T(0),
                           T(0)};
    contact.inverse_sum = contact_response(contact);
    contacts.push_back(contact);
  }

  template <class Points, class M>
  void add_edges(const LaneModel &m, const Points &x, const Points &p, int i, int j, T opening, M lanes,
                 Array<EdgeContact<T>> &contacts) {
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
            (dot(apart, apart) <= T(4) * thickness * thickness);
    if (!any(lanes) || is_among(m.resting_edges, m.resting_edge_count, i, j))
      return;
    EdgeContact<T> contact{a,
                           b,
                           c,
                           d,
                           w[a],
                           w[b],
                           w[c],
                           w[d],
                           select(lanes, T(1), T(0)),
                           si,
                           ti,
                           side_end,
                           lane_min(thickness, h0 + opening),
                           T(0),
                           T(0)};
    contact.inverse_sum = contact_response(contact);
    contacts.push_back(contact);
  }

  FaceBoxes<T> boxes_;
  Array<Box<T>> paths_, face_boxes_; ///< of the vertices in this step without the common motion; of the faces, with the margin
  // As long as they are known:
  bool known_ = false;
  Vec3<T> since_;                          ///< the common motion since then
  Array<Box<T>> ways_;                     ///< to which the vertices keep, without it
  Array<Vec3<T>> centres_;                 ///< of these
  Array<T> radii_;                         ///< of the spheres around these
  Array<Pair> vertex_faces_, edge_edges_; ///< that can meet, in the order of find_afresh()
};

} // namespace DOUBLET_PBD_ISA
} // namespace doublet::pbd
