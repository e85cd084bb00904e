#pragma once
// Where the cloth has passed through itself: the edges that pass through faces, and how they come apart again.

#include "patches.h"

namespace doublet::pbd {
inline namespace DOUBLET_PBD_ISA {

constexpr int kUntangleSteps = 10;      ///< at the start of a frame, at most
constexpr float kUntangleStep = 0.002f; ///< m, that an edge or a face moves in one
constexpr float kStrained = 1.25f;      ///< cloth longer than this by its length at rest has no contacts, where edges collide

template <class T> class Knots {
public:
  template <class Points> void find(const LaneModel &m, const Points &x) {
    in_knot_.resize(m.vertex_count);
    for (T &vertex : in_knot_)
      vertex = T(0);
    crossings_.clear();
    near_.clear();
    if (m.edge_collision)
      find_strained(m, x);
    const auto face_box = [&](int f) {
      const Vec3<T> a = x[m.faces[f].v[0]], b = x[m.faces[f].v[1]], c = x[m.faces[f].v[2]];
      return bounded(Box<T>{low(low(a, b), c), high(high(a, b), c)}, T(m.largest_extent));
    };
    const auto edge_box = [&](int i) {
      const Vec3<T> a = x[m.edges[i].a], b = x[m.edges[i].b];
      return Box<T>{low(a, b), high(a, b)};
    };
    if (m.edge_collision) {
      find_near(m, x, face_box, edge_box);
      return;
    }
    boxes_.refit(m.face_tree, face_box);
    for (int i = 0; i < m.edge_count; ++i)
      boxes_.for_each_overlap(m.face_tree, edge_box(i), [&](int f, auto lanes) {
        if (!has_corner_of(m, f, i))
          note_crossing(m, x, i, f, lanes);
      });
  }

  /// Moves the cloth apart where find() has seen it cross itself: each edge and each face the way that shortens the line of
  /// crossing fastest (Volino, Magnenat-Thalmann 2006, eq. 6), a little at a time, as long as they still cross. Speeds are left
  /// alone.
  template <class Points> void untangle(const LaneModel &m, Points &x) {
    if (crossings_.size() == 0)
      return;
    moved_.resize(m.vertex_count);
    for (int i = 0; i < m.vertex_count; ++i)
      moved_[i] = 0;
    for (int step = 0; step < kUntangleSteps && crossings_.size() > 0; ++step) {
      move_apart(m, x);
      crossings_.clear();
      for (const Pair &pair : near_) {
        const Edge &edge = m.edges[pair.edge];
        const int *v = m.faces[pair.face].v;
        if (moved_[edge.a] | moved_[edge.b] | moved_[v[0]] | moved_[v[1]] | moved_[v[2]])
          note_crossing(m, x, pair.edge, pair.face, pair.here > T(0));
      }
    }
  }

  /// The lanes in which a vertex belonged to an edge or a face of a crossing when they were last looked for.
  auto at(int vertex) const { return in_knot_[vertex] > T(0); }
  /// The lanes in which an edge of a vertex was strained then, and all where the rest shape is in a knot. What holds layers apart
  /// that something squeezes together can pull them out without end: cloth lets go before. Where edges collide alone.
  auto strained(int vertex) const { return strained_[vertex] > T(0); }

private:
  struct Pair {
    int edge, face;
    T here; ///< 1 in the lanes in which it is so, else 0
  };

  static bool has_corner_of(const LaneModel &m, int face, int edge) {
    const int *v = m.faces[face].v, a = m.edges[edge].a, b = m.edges[edge].b;
    return v[0] == a || v[1] == a || v[2] == a || v[0] == b || v[1] == b || v[2] == b;
  }

  template <class Points, class FaceBox, class EdgeBox>
  void find_near(const LaneModel &m, const Points &x, const FaceBox &face_box, const EdgeBox &edge_box) {
    const T reach(kUntangleStep);
    patches_.find(m, x, face_box, reach);
    face_boxes_.resize(m.face_count);
    for (int f = 0; f < m.face_count; ++f)
      face_boxes_[f] = grown(face_box(f), reach);
    patches_.for_each_pair([&](int i, int j, auto lanes) {
      find_near(m, x, m.patches[i], m.patches[j], patches_.box(j), lanes, edge_box);
      if (i != j)
        find_near(m, x, m.patches[j], m.patches[i], patches_.box(i), lanes, edge_box);
    });
  }
  template <class Points, class M, class EdgeBox>
  void find_near(const LaneModel &m, const Points &x, const Patch &edges, const Patch &faces, const Box<T> &around, M may,
                 const EdgeBox &edge_box) {
    for (int i = edges.first_edge; i < edges.first_edge + edges.edge_count; ++i) {
      const Box<T> box = edge_box(i);
      if (!any(may & overlap(box, around)))
        continue;
      for (int k = 0; k < faces.face_count; ++k) {
        const int f = m.patch_faces[faces.first_face + k];
        const auto lanes = may & overlap(box, face_boxes_[f]);
        if (!any(lanes) || has_corner_of(m, f, i))
          continue;
        near_.push_back({i, f, select(lanes, T(1), T(0))});
        note_crossing(m, x, i, f, lanes);
      }
    }
  }

  template <class Points> void find_strained(const LaneModel &m, const Points &x) {
    strained_.resize(m.vertex_count);
    for (T &vertex : strained_)
      vertex = T(0);
    for (int i = 0; i < m.resting_knot_count; ++i)
      strained_[m.resting_knots[i]] = T(1);
    for (int i = 0; i < m.stretch_count; ++i) {
      const StretchConstraint &c = m.stretches[i];
      const Vec3<T> d = x[c.b] - x[c.a];
      const float most = kStrained * c.length;
      const auto over = dot(d, d) > T(most * most);
      strained_[c.a] = select(over, T(1), strained_[c.a]);
      strained_[c.b] = select(over, T(1), strained_[c.b]);
    }
  }

  template <class Points, class M> void note_crossing(const LaneModel &m, const Points &x, int edge, int face, M lanes) {
    const int corners[] = {m.edges[edge].a, m.edges[edge].b, m.faces[face].v[0], m.faces[face].v[1], m.faces[face].v[2]};
    const Vec3<T> a = x[corners[0]], b = x[corners[1]], c = x[corners[2]], d = x[corners[3]], e = x[corners[4]];
    const Vec3<T> n = cross<T>(d - c, e - c);
    const T ha = dot(n, a - c), hb = dot(n, b - c);
    lanes = lanes & (((ha < T(0)) & (T(0) < hb)) | ((hb < T(0)) & (T(0) < ha)));
    if (!any(lanes))
      return;
    const T share = ha / select(lanes, ha - hb, T(1));
    const Vec3<T> foot = barycentric(mul_add(share, b - a, a), c, d, e);
    lanes = lanes & (foot.x >= T(0)) & (foot.y >= T(0)) & (foot.z >= T(0));
    if (!any(lanes))
      return;
    for (const int vertex : corners)
      in_knot_[vertex] = select(lanes, T(1), in_knot_[vertex]);
    crossings_.push_back({edge, face, select(lanes, T(1), T(0))});
  }

  static Vec3<T> unit(const Vec3<T> &d) { return (T(1) / lane_max(lane_sqrt(dot(d, d)), T(1e-12f))) * d; }

  /// The way of the edge, the face going the other; at most 1 long, and shorter where the faces beside the edge do not agree.
  template <class Points> Vec3<T> way_apart(const LaneModel &m, const Points &x, const Pair &crossing) const {
    const Edge &edge = m.edges[crossing.edge];
    const int *v = m.faces[crossing.face].v;
    const Vec3<T> a = x[edge.a], e = unit(x[edge.b] - a), n = unit(cross<T>(x[v[1]] - x[v[0]], x[v[2]] - x[v[0]]));
    const T en = dot(e, n), slope = with_sign(lane_max(lane_abs(en), T(0.05f)), en);
    Vec3<T> sum{T(0), T(0), T(0)};
    for (const int wing : edge.wings)
      if (wing >= 0) {
        const Vec3<T> in = x[wing] - a, across = in - dot(in, e) * e;
        const Vec3<T> line = unit(cross(n, cross(e, in))), along = select(dot(line, across) < T(0), T(-1) * line, line);
        sum += along - (T(2) * dot(e, along) / slope) * n;
      }
    return (crossing.here / lane_sqrt(dot(sum, sum) + T(0.01f))) * sum;
  }

  template <class Points> void move_apart(const LaneModel &m, Points &x) {
    ways_.resize(m.vertex_count);
    counts_.resize(m.vertex_count);
    for (int i = 0; i < m.vertex_count; ++i) {
      ways_[i] = Vec3<T>{T(0), T(0), T(0)};
      counts_[i] = T(0);
    }
    for (const Pair &crossing : crossings_) {
      const Vec3<T> way = way_apart(m, x, crossing);
      const Edge &edge = m.edges[crossing.edge];
      const int *v = m.faces[crossing.face].v;
      const auto add = [&](int vertex, const Vec3<T> &by) {
        ways_[vertex] = select(crossing.here > T(0), ways_[vertex] + by, ways_[vertex]);
        counts_[vertex] += crossing.here;
      };
      add(edge.a, way);
      add(edge.b, way);
      for (int k = 0; k < 3; ++k)
        add(v[k], T(-1) * way);
    }
    for (int i = 0; i < m.vertex_count; ++i) {
      const auto moves = (counts_[i] > T(0)) & !strained(i);
      if (m.weights[i] == 0 || !any(moves))
        continue;
      moved_[i] = 1;
      x[i] = select(moves, Vec3<T>(x[i]) + (T(kUntangleStep) / lane_max(counts_[i], T(1))) * ways_[i], x[i]);
    }
  }

  FaceBoxes<T> boxes_;
  Patches<T> patches_;
  Array<Box<T>> face_boxes_;     ///< where edges collide
  Array<T> in_knot_, strained_;  ///< of each vertex: 0, 1
  Array<Pair> near_, crossings_; ///< edges and faces less than a step apart along every axis; that pass through each other
  Array<Vec3<T>> ways_;          ///< of each vertex, from all of its crossings
  Array<T> counts_;              ///< of these
  Array<int> moved_;             ///< 1: in some lane
};

} // namespace DOUBLET_PBD_ISA
} // namespace doublet::pbd
