#pragma once
// Where the cloth has passed through itself: the vertices of edges that pass through faces, and of these faces.

#include "face_boxes.h"

namespace doublet::pbd {
inline namespace DOUBLET_PBD_ISA {

template <class T> class Knots {
public:
  template <class Points> void find(const LaneModel &m, const Points &x) {
    in_knot_.resize(m.vertex_count);
    for (T &vertex : in_knot_)
      vertex = T(0);
    boxes_.refit(m, [&](int f) {
      const Vec3<T> a = x[m.faces[f].v[0]], b = x[m.faces[f].v[1]], c = x[m.faces[f].v[2]];
      return bounded(Box<T>{low(low(a, b), c), high(high(a, b), c)}, T(m.largest_extent));
    });
    for (int i = 0; i < m.edge_count; ++i) {
      const int a = m.edges[i].a, b = m.edges[i].b;
      const Box<T> box{low<T>(x[a], x[b]), high<T>(x[a], x[b])};
      boxes_.for_each_overlap(m, box, [&](int f, auto lanes) {
        const int *v = m.faces[f].v;
        if (v[0] != a && v[1] != a && v[2] != a && v[0] != b && v[1] != b && v[2] != b)
          note_crossing(x, a, b, v, lanes);
      });
    }
  }
  /// The lanes in which a vertex belonged to an edge or a face of a crossing when they were last looked for.
  auto at(int vertex) const { return in_knot_[vertex] > T(0); }

private:
  template <class Points, class M> void note_crossing(const Points &x, int i, int j, const int *face, M lanes) {
    const Vec3<T> a = x[i], b = x[j], c = x[face[0]], d = x[face[1]], e = x[face[2]];
    const Vec3<T> n = cross<T>(d - c, e - c);
    const T ha = dot(n, a - c), hb = dot(n, b - c);
    lanes = lanes & (((ha < T(0)) & (T(0) < hb)) | ((hb < T(0)) & (T(0) < ha)));
    if (!any(lanes))
      return;
    const T share = ha / select(lanes, ha - hb, T(1));
    const Vec3<T> foot = barycentric(mul_add(share, b - a, a), c, d, e);
    lanes = lanes & (foot.x >= T(0)) & (foot.y >= T(0)) & (foot.z >= T(0));
    const int corners[] = {i, j, face[0], face[1], face[2]};
    for (const int vertex : corners)
      in_knot_[vertex] = select(lanes, T(1), in_knot_[vertex]);
  }

  FaceBoxes<T> boxes_;
  Array<T> in_knot_; ///< of each vertex: 0, 1
};

} // namespace DOUBLET_PBD_ISA
} // namespace doublet::pbd
