#pragma once
// Where the cloth has passed through itself: the edges that pass through faces, and how they come apart again.

#include "patches.h"

namespace doublet::pbd {
inline namespace DOUBLET_PBD_ISA {

constexpr int kUntangleSteps = 10;      ///< at the start of a frame, at most
constexpr float kUntangleStep = 0.002f; ///< m, that an edge or a face moves in one
constexpr float kStrained = 1.5f;       ///< cloth longer than this by its length at rest has no contacts, where edges collide

/// The ends a and b of an edge and the plane of the face (c, d, e): do they lie on either side of it?
template <class T, class M> struct Parted {
  M lanes; ///< in which they do
  T a, b;  ///< heights over the plane, times twice the face's area, m^3
};
template <class T>
inline auto part_by_plane(const Vec3<T> &a, const Vec3<T> &b, const Vec3<T> &c, const Vec3<T> &d, const Vec3<T> &e) {
  const Vec3<T> n = cross<T>(d - c, e - c);
  const T ha = dot(n, a - c), hb = dot(n, b - c);
  const auto lanes = ((ha < T(0)) & (T(0) < hb)) | ((hb < T(0)) & (T(0) < ha));
  return Parted<T, decltype(lanes)>{lanes, ha, hb};
}

template <class T> class Knots {
public:
  template <class Points> void find(const LaneModel &m, const Points &x) {
    in_knot_.resize(m.vertex_count);
    for (int i = 0; i < m.vertex_count; ++i)
      in_knot_[i] = T(0);
    crossings_.clear();
    near_.clear();
    if (m.edge_collision)
      find_strained(m, x);
    if (m.edge_collision)
      find_near(m, x);
    else
      find_by_tree(m, x);
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
  static constexpr bool kSingle = sizeof(T) == sizeof(float);
  struct Pair {
    int edge, face;
    T here; ///< 1 in the lanes in which it is so, else 0
  };

  static bool has_corner_of(const LaneModel &m, int face, int edge) {
    const int *v = m.faces[face].v, a = m.edges[edge].a, b = m.edges[edge].b;
    return v[0] == a || v[1] == a || v[2] == a || v[0] == b || v[1] == b || v[2] == b;
  }

  template <class Points> void find_by_tree(const LaneModel &m, const Points &x) {
    boxes_.refit(m.face_tree, [&](int f) {
      const Vec3<T> a = x[m.faces[f].v[0]], b = x[m.faces[f].v[1]], c = x[m.faces[f].v[2]];
      return bounded(Box<T>{low(low(a, b), c), high(high(a, b), c)}, T(m.largest_extent));
    });
    for (int i = 0; i < m.edge_count; ++i) {
      const Vec3<T> a = x[m.edges[i].a], b = x[m.edges[i].b];
      boxes_.for_each_overlap(m.face_tree, Box<T>{low(a, b), high(a, b)}, [&](int f, auto lanes) {
        if (!has_corner_of(m, f, i))
          note_crossing(m, x, i, f, lanes);
      });
    }
  }

  template <class Points> void find_near(const LaneModel &m, const Points &x) {
    set_boxes(x, x, m.edge_count, m.edge_ends, Margin{0, m.largest_extent}, edge_boxes_);
    set_boxes(x, x, m.face_count, m.patch_corners, Margin{kUntangleStep, m.largest_extent}, face_boxes_);
    patches_.look_anew();
    patches_.find(m, x, face_boxes_, T(kUntangleStep));
    near_pairs_.clear();
    patches_.for_each_pair([&](int i, int j, auto may) {
      find_near(m, m.patches[i], m.patches[j], patches_.box(j), may);
      if (i != j)
        find_near(m, m.patches[j], m.patches[i], patches_.box(i), may);
    });
    if constexpr (kSingle)
      note_crossings_in_rows(m, x);
    else
      for (const Pair &pair : near_)
        note_crossing(m, x, pair.edge, pair.face, pair.here > T(0));
  }
  /// The edges of one patch and the faces of another, which lie within `around`.
  template <class M> void find_near(const LaneModel &m, const Patch &edges, const Patch &faces, const Box<T> &around, M may) {
    const int first = faces.first_face, last = first + faces.face_count;
    edge_boxes_.for_each_overlap(edges.first_edge, edges.first_edge + edges.edge_count, around, may, [&](int i, auto near) {
      if constexpr (kSingle)
        face_boxes_.for_each_row(first, last, edge_boxes_[i], [&](int n, int overlaps) {
          add_pairs(i, n, overlaps & ~equal_bits(m.patch_corners, n, {m.edges[i].a, m.edges[i].b}), near_pairs_);
        });
      else
        face_boxes_.for_each_overlap(first, last, edge_boxes_[i], near, [&](int n, auto lanes) {
          const int f = m.patch_faces[n];
          if (!has_corner_of(m, f, i))
            near_.push_back({i, f, select(lanes, T(1), T(0))});
        });
    });
  }
  /// Of one simulation the ends of a row of edges are held to their faces' planes side by side.
  void note_crossings_in_rows(const LaneModel &m, const Array<Point> &x) {
    for_each_row(near_pairs_, [&](const IndexPair *row, int count, Mask<kRow> there) {
      const auto end = [&](int k) { return gather_row(x, count, [&](int l) { return m.edge_ends[k][row[l].i]; }); };
      const auto corner = [&](int k) { return gather_row(x, count, [&](int l) { return m.patch_corners[k][row[l].j]; }); };
      for (int l = 0; l < count; ++l)
        near_.push_back({row[l].i, m.patch_faces[row[l].j], 1});
      const auto parted = part_by_plane(end(0), end(1), corner(0), corner(1), corner(2)).lanes & there;
      for_each_bit(lane_bits(parted), [&](int l) { note_crossing(m, x, row[l].i, m.patch_faces[row[l].j], true); });
    });
  }

  template <class Points> void find_strained(const LaneModel &m, const Points &x) {
    strained_.resize(m.vertex_count);
    for (T &vertex : strained_)
      vertex = T(0);
    for (int i = 0; i < m.resting_knot_count; ++i)
      strained_[m.resting_knots[i]] = T(1);
    for (int i = 0; i < m.stretch_block_count; ++i) {
      const StretchBlock &block = m.stretch_blocks[i];
      for (int k = 0; k < block.count; ++k) {
        const int a = block.v[0][k], b = block.v[1][k];
        const Vec3<T> d = x[b] - x[a];
        const float most = kStrained * block.length[k];
        const auto over = dot(d, d) > T(most * most);
        strained_[a] = select(over, T(1), strained_[a]);
        strained_[b] = select(over, T(1), strained_[b]);
      }
    }
  }

  template <class Points, class M> void note_crossing(const LaneModel &m, const Points &x, int edge, int face, M lanes) {
    const int corners[] = {m.edges[edge].a, m.edges[edge].b, m.faces[face].v[0], m.faces[face].v[1], m.faces[face].v[2]};
    const Vec3<T> a = x[corners[0]], b = x[corners[1]], c = x[corners[2]], d = x[corners[3]], e = x[corners[4]];
    const auto parted = part_by_plane(a, b, c, d, e);
    lanes = lanes & parted.lanes;
    if (!any(lanes))
      return;
    const T share = parted.a / select(lanes, parted.a - parted.b, T(1));
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
  BoxList<T> edge_boxes_, face_boxes_; ///< in the order of the patches
  Array<T> in_knot_, strained_;        ///< of each vertex: 0, 1
  Array<Pair> near_, crossings_;       ///< edges and faces less than a step apart along every axis; that pass through each other
  Array<IndexPair> near_pairs_;        ///< the same of one simulation, edge and patch_faces
  Array<Vec3<T>> ways_;                ///< of each vertex, from all of its crossings
  Array<T> counts_;                    ///< of these
  Array<int> moved_;                   ///< 1: in some lane
};

} // namespace DOUBLET_PBD_ISA
} // namespace doublet::pbd
