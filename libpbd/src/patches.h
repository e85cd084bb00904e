#pragma once
// Which pieces of the cloth can meet: a patch and its neighbours cannot as long as they look about the same way.

#include "box_list.h"

namespace doublet::pbd {
inline namespace DOUBLET_PBD_ISA {

constexpr int kDirections = 7;    ///< the directions that faces may look along, see cosines_along
constexpr float kSameSide = 0.3f; ///< least cosine of a face's normal with a direction that it looks along

/// Cosines of the normal n of a face with three axes and four diagonals.
template <class T> inline void cosines_along(const Vec3<T> &n, T *cosine) {
  const Vec3<T> u = (T(1) / lane_max(lane_sqrt(dot(n, n)), T(1e-12f))) * n;
  const T diagonal(0.57735027f), plus = u.y + u.z, minus = u.y - u.z;
  cosine[0] = u.x, cosine[1] = u.y, cosine[2] = u.z;
  cosine[3] = diagonal * (u.x + plus), cosine[4] = diagonal * (u.x - plus);
  cosine[5] = diagonal * (u.x + minus), cosine[6] = diagonal * (u.x - minus);
}

/// The least and the most of each cosine over some faces.
template <class T> struct Looks {
  T least[kDirections], most[kDirections];

  /// Of a patch's faces. points: positions of vertices
  template <class Points> static Looks of_patch(const LaneModel &m, const Points &points, const Patch &patch) {
    Looks all;
    for (int k = 0; k < patch.face_count; ++k) {
      const int *v = m.faces[m.patch_faces[patch.first_face + k]].v;
      Looks one;
      cosines_along(cross<T>(points[v[1]] - points[v[0]], points[v[2]] - points[v[0]]), one.least);
      for (int i = 0; i < kDirections; ++i)
        one.most[i] = one.least[i];
      all = k == 0 ? one : united(all, one);
    }
    return all;
  }
  static Looks every_way() {
    Looks all;
    for (int i = 0; i < kDirections; ++i)
      all.least[i] = T(-1), all.most[i] = T(1);
    return all;
  }
  friend Looks united(const Looks &a, const Looks &b) {
    Looks out;
    for (int i = 0; i < kDirections; ++i)
      out.least[i] = lane_min(a.least[i], b.least[i]), out.most[i] = lane_max(a.most[i], b.most[i]);
    return out;
  }
  /// Those of the lanes in which the two do not look one way.
  template <class M> friend M may_meet(const Looks &a, const Looks &b, M lanes) {
    for (int i = 0; i < kDirections && any(lanes); ++i)
      lanes = lanes & (lane_min(a.least[i], b.least[i]) <= T(kSameSide)) & (lane_max(a.most[i], b.most[i]) >= T(-kSameSide));
    return lanes;
  }
};

/// For one simulation four faces of a patch are looked at side by side, and then the cosines, the first of them twice.
template <> struct Looks<float> {
  Pack<4> least[2], most[2];

  static Looks of_patch(const LaneModel &m, const Array<Point> &points, const Patch &patch) {
    Looks all;
    for (int first = 0; first < patch.face_count; first += 4) {
      int v[3][4];
      for (int l = 0; l < 4; ++l) {
        const int face = m.patch_faces[patch.first_face + (first + l < patch.face_count ? first + l : 0)];
        for (int k = 0; k < 3; ++k)
          v[k][l] = m.faces[face].v[k];
      }
      const Vec3<Pack<4>> corner = gather<4>(points.data(), v[0]);
      Pack<4> cosine[kDirections + 1];
      cosines_along(cross(gather<4>(points.data(), v[1]) - corner, gather<4>(points.data(), v[2]) - corner), cosine);
      cosine[kDirections] = cosine[0];
      Looks four;
      for (int half = 0; half < 2; ++half) {
        Pack<4> of_face[4];
        transpose(cosine + 4 * half, of_face);
        four.least[half] = lane_min(lane_min(of_face[0], of_face[1]), lane_min(of_face[2], of_face[3]));
        four.most[half] = lane_max(lane_max(of_face[0], of_face[1]), lane_max(of_face[2], of_face[3]));
      }
      all = first == 0 ? four : united(all, four);
    }
    return all;
  }
  static Looks every_way() { return {{Pack<4>(-1), Pack<4>(-1)}, {Pack<4>(1), Pack<4>(1)}}; }
  friend Looks united(const Looks &a, const Looks &b) {
    return {{lane_min(a.least[0], b.least[0]), lane_min(a.least[1], b.least[1])},
            {lane_max(a.most[0], b.most[0]), lane_max(a.most[1], b.most[1])}};
  }
  friend bool may_meet(const Looks &a, const Looks &b, bool may) {
    const auto crossed = [&](int half) {
      return (lane_min(a.least[half], b.least[half]) <= Pack<4>(kSameSide)) &
             (lane_max(a.most[half], b.most[half]) >= Pack<4>(-kSameSide));
    };
    return may && lane_bits(crossed(0) & crossed(1)) == 15;
  }
};

/// The boxes of patches.
template <class T> class PatchBoxes {
public:
  void resize(int count) { boxes_.resize(count); }
  void set(int i, const Box<T> &box) { boxes_[i] = box; }
  const Box<T> &operator[](int i) const { return boxes_[i]; }
  /// After the last box was set.
  void refit(const LaneModel &m) {
    nodes_.resize(m.patch_node_count);
    DOUBLET_PBD_ISA::refit<T>(m.patch_nodes, m.patch_node_count, nodes_.data(), [&](int i) { return boxes_[i]; });
  }
  /// Calls found(j, lanes) for the patches j >= i whose box overlaps `query` in some of the lanes, in their order.
  template <class Found> void for_each_overlap(const LaneModel &m, int i, const Box<T> &query, Found &&found) const {
    DOUBLET_PBD_ISA::for_each_overlap<T>(m.patch_nodes, m.patch_node_count, nodes_.data(), query, found, m.patches[i].node);
  }

private:
  Array<Box<T>> boxes_, nodes_; ///< of the patches, of their tree
};

template <> class PatchBoxes<float> {
public:
  void resize(int count) { boxes_.resize(count); }
  void set(int i, const Box<float> &box) { boxes_.set(i, box); }
  Box<float> operator[](int i) const { return boxes_[i]; }
  void refit(const LaneModel &) { boxes_.refit(); }
  template <class Found> void for_each_overlap(const LaneModel &m, int i, const Box<float> &query, Found &&found) const {
    boxes_.for_each_overlap(i, m.patch_count, query, true, found);
  }

private:
  RowsOfBoxes boxes_;
};

/// The faces in a few to a patch, as the tree has them side by side. Cloth that hangs together and looks one way all over lies
/// above a plane like a map: no part of it is before another. (Volino, Magnenat-Thalmann 1994, with a few
/// directions to choose from.) So most of what is near to a face, its own surroundings, need not be looked at: of two patches
/// that lie side by side these two are to look one way, of two with a third between them all three.
template <class T> class Patches {
public:
  /// The next find() looks where the patches look; those after it keep to that. (Within a frame cloth does not turn by so much
  /// against the cloth beside it as lies between kSameSide and a right angle.)
  void look_anew() { looked_ = false; }
  /// Finds what may meet. The cloth at `points`; faces: where each of the model's patch_faces is, or has been on its way there,
  /// `reach` wider. Patches meet as far apart as that.
  template <class Points> void find(const LaneModel &m, const Points &points, const BoxList<T> &faces, T reach) {
    find_boxes(m, faces);
    if (!looked_)
      find_looks(m, points);
    find_pairs(m, reach);
  }

  /// Calls use(i, j, lanes) for all patches i <= j that may meet, in the lanes in which they may; in the order of i, then j.
  template <class Use> void for_each_pair(const Use &use) const {
    for (const Pair &pair : pairs_)
      use(pair.i, pair.j, pair.may > T(0));
  }

  /// Of patch i, with the reach.
  Box<T> box(int i) const { return boxes_[i]; }

private:
  struct Pair {
    int i, j;
    T may; ///< 1 in the lanes in which they may meet, else 0
  };

  void find_boxes(const LaneModel &m, const BoxList<T> &faces) {
    boxes_.resize(m.patch_count);
    for (int i = 0; i < m.patch_count; ++i) {
      const Patch &patch = m.patches[i];
      Box<T> box = faces[patch.first_face];
      for (int k = 1; k < patch.face_count; ++k)
        box = united(box, faces[patch.first_face + k]);
      boxes_.set(i, box);
    }
    boxes_.refit(m);
  }

  template <class Points> void find_looks(const LaneModel &m, const Points &points) {
    looks_.resize(m.patch_count);
    for (int i = 0; i < m.patch_count; ++i)
      looks_[i] = m.patches[i].connected ? Looks<T>::of_patch(m, points, m.patches[i]) : Looks<T>::every_way();
    near_may_.resize(m.patch_near_count);
    for (T &may : near_may_)
      may = T(-1);
    looked_ = true;
  }

  void find_pairs(const LaneModel &m, T reach) {
    pairs_.clear();
    for (int i = 0; i < m.patch_count; ++i) {
      const Patch &patch = m.patches[i];
      const NearPatch *near = m.patch_near + patch.first_near, *const last = near + patch.near_count;
      boxes_.for_each_overlap(m, i, grown(boxes_[i], -reach), [&](int j, auto lanes) {
        while (near < last && near->patch < j)
          ++near;
        if (j == i)
          lanes = may_meet(looks_[i], looks_[i], lanes);
        else if (near < last && near->patch == j)
          lanes = lanes & (may_meet_near(m, i, near) > T(0));
        if (any(lanes))
          pairs_.push_back({i, j, select(lanes, T(1), T(0))});
      });
    }
  }

  /// 1 in the lanes in which patch i and a near one may meet, else 0.
  T may_meet_near(const LaneModel &m, int i, const NearPatch *near) {
    T &known = near_may_[static_cast<int>(near - m.patch_near)];
    if (any(known < T(0))) {
      auto lanes = T(0) <= T(0);
      for (int k = near->first_bridge; k < near->first_bridge + near->bridge_count && any(lanes); ++k)
        lanes = may_meet(united(looks_[i], looks_[m.patch_bridges[k]]), looks_[near->patch], lanes);
      known = select(lanes, T(1), T(0));
    }
    return known;
  }

  PatchBoxes<T> boxes_;
  Array<Looks<T>> looks_; ///< of a patch
  Array<T> near_may_;     ///< see may_meet_near(); -1: not looked at yet
  bool looked_ = false;
  Array<Pair> pairs_;
};

} // namespace DOUBLET_PBD_ISA
} // namespace doublet::pbd
