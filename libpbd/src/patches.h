#pragma once
// Which pieces of the cloth can meet: a patch and its neighbours cannot as long as they look about the same way.

#include "face_boxes.h"

namespace doublet::pbd {
inline namespace DOUBLET_PBD_ISA {

constexpr int kLooks = 7;         ///< the directions that faces may look along, see looks_along
constexpr float kSameSide = 0.3f; ///< least cosine of a face's normal with a direction that it looks along

/// Cosines of a unit normal with three axes and four diagonals.
template <class T> inline void looks_along(const Vec3<T> &n, T (&cosine)[kLooks]) {
  const T diagonal(0.57735027f), plus = n.y + n.z, minus = n.y - n.z;
  cosine[0] = n.x, cosine[1] = n.y, cosine[2] = n.z;
  cosine[3] = diagonal * (n.x + plus), cosine[4] = diagonal * (n.x - plus);
  cosine[5] = diagonal * (n.x + minus), cosine[6] = diagonal * (n.x - minus);
}

/// The faces in a few to a patch, as the tree has them side by side. Cloth that hangs together and looks one way all over lies
/// above a plane like a map: no part of it is before another. (Volino, Magnenat-Thalmann 1994, with a few
/// directions to choose from.) So most of what is near to a face, its own surroundings, need not be looked at.
template <class T> class Patches {
public:
  /// Finds what may meet. The cloth at `at`; box(face): where the face is, or has been on its way there. Patches meet as far
  /// apart as `reach`.
  template <class Points, class BoxOf> void find(const LaneModel &m, const Points &at, const BoxOf &box, T reach) {
    boxes_.resize(m.patch_count);
    grown_.resize(m.patch_count);
    looks_.resize(m.patch_count);
    around_.resize(m.patch_count);
    for (int i = 0; i < m.patch_count; ++i) {
      const Patch &patch = m.patches[i];
      const int *faces = m.patch_faces + patch.first_face;
      Looks all = looks_of(m, at, faces[0]);
      Box<T> around = box(faces[0]);
      for (int k = 1; k < patch.face_count; ++k) {
        all = united(all, looks_of(m, at, faces[k]));
        around = DOUBLET_PBD_ISA::united(around, box(faces[k]));
      }
      if (!patch.connected)
        for (int k = 0; k < kLooks; ++k)
          all.least[k] = T(-1), all.most[k] = T(1);
      looks_[i] = all;
      boxes_[i] = around;
      grown_[i] = grown(around, reach);
    }
    for (int i = 0; i < m.patch_count; ++i) {
      const Patch &patch = m.patches[i];
      around_[i] = looks_[i];
      for (int k = 0; k < patch.next_count; ++k)
        around_[i] = united(around_[i], looks_[m.patch_next[patch.first_next + k]]);
    }
    tree_.refit(m.patch_tree, [&](int i) { return grown_[i]; });
    pairs_.clear();
    for (int i = 0; i < m.patch_count; ++i) {
      const Patch &patch = m.patches[i];
      const int *near = m.patch_near + patch.first_near, *const last = near + patch.near_count;
      tree_.for_each_overlap(
          m.patch_tree, boxes_[i],
          [&](int j, auto lanes) {
            while (near < last && *near < j) // the tree finds them in this order, too
              ++near;
            if (j == i)
              lanes = may_meet(looks_[i], looks_[i], lanes);
            else if (near < last && *near == j)
              lanes = may_meet(around_[i], looks_[j], lanes);
            if (any(lanes))
              pairs_.push_back({i, j, select(lanes, T(1), T(0))});
          },
          patch.node);
    }
  }

  /// Calls use(i, j, lanes) for all patches i <= j that may meet, in the lanes in which they may; in the order of i, then j.
  template <class Use> void for_each_pair(const Use &use) const {
    for (const Pair &pair : pairs_)
      use(pair.i, pair.j, pair.may > T(0));
  }

  /// Of patch i, with the reach.
  const Box<T> &box(int i) const { return grown_[i]; }

private:
  struct Pair {
    int i, j;
    T may; ///< 1 in the lanes in which they may meet, else 0
  };
  struct Looks {
    T least[kLooks], most[kLooks];
  };
  static Looks united(const Looks &a, const Looks &b) {
    Looks out;
    for (int k = 0; k < kLooks; ++k)
      out.least[k] = lane_min(a.least[k], b.least[k]), out.most[k] = lane_max(a.most[k], b.most[k]);
    return out;
  }
  /// Those of the lanes in which the two do not look one way.
  template <class M> static M may_meet(const Looks &a, const Looks &b, M lanes) {
    for (int k = 0; k < kLooks && any(lanes); ++k)
      lanes = lanes & (lane_min(a.least[k], b.least[k]) <= T(kSameSide)) & (lane_max(a.most[k], b.most[k]) >= T(-kSameSide));
    return lanes;
  }
  template <class Points> static Looks looks_of(const LaneModel &m, const Points &at, int face) {
    const int *v = m.faces[face].v;
    const Vec3<T> n = cross<T>(at[v[1]] - at[v[0]], at[v[2]] - at[v[0]]);
    Looks out;
    looks_along((T(1) / lane_max(lane_sqrt(dot(n, n)), T(1e-12f))) * n, out.least);
    for (int k = 0; k < kLooks; ++k)
      out.most[k] = out.least[k];
    return out;
  }

  Array<Box<T>> boxes_, grown_;
  Array<Looks> looks_, around_; ///< of a patch; of it and those that touch it
  Array<Pair> pairs_;
  FaceBoxes<T> tree_;
};

} // namespace DOUBLET_PBD_ISA
} // namespace doublet::pbd
