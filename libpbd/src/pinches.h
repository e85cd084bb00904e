#pragma once
// Where proxies leave the cloth between them no room.

#include "capsule_contacts.h"

namespace doublet::pbd {
inline namespace DOUBLET_PBD_ISA {

constexpr float kLayersBetween = 3; ///< of cloth, for which two proxies leave room between them
constexpr float kBeside = 0.5f; ///< cosine between the normals of two proxies from which on down they begin to face each other

/// Vertices that are pinched (Baraff, Witkin, Kass 2003): the nearest proxy and another that faces it, an arm and the trunk, two
/// thighs, both sides of a bent elbow, have less room between them than both thicknesses and some layers of cloth. Each would
/// push its cloth into the other and through what lies there. So both keep it only so far off that the layers have their room in
/// the middle, which is inside both where they overlap. Where their normals are 60 degrees apart and less the cloth comes out
/// between them and nothing changes; from 120 degrees on they keep it no farther off than that. (A sudden change would tear at
/// the cloth.)
template <class T> class Pinches {
public:
  /// At x, with the spare vertices; ways: boxes around them, which may be larger.
  template <class Points>
  void find(const LaneModel &model, const Array<CapsuleMotion<T>> &capsules, const Points &x, const VertexBoxes<T> &ways) {
    clear(model);
    find_near(model, capsules, x, ways);
    for (const Near &near : near_)
      give_way(model, near);
  }
  /// No vertex is pinched.
  void clear(const LaneModel &model) {
    const int count = model.vertex_count + kSpareVertices;
    near_.clear();
    nearest_.resize(count);
    normals_.resize(count);
    give_.resize(count);
    for (int i = 0; i < count; ++i) {
      nearest_[i] = T(kFar);
      give_[i] = T(0);
    }
  }
  /// m, of each vertex: how much nearer than the thickness proxies let it come.
  const Array<T> &give() const { return give_; }

private:
  static constexpr float kFar = 1e30f;
  /// Vertices and a proxy less than `reach` from them; kFar where it is farther.
  struct Near {
    int vertex[kSide<T>];
    Distance<Side<T>> proxy;
  };

  static float layers(const LaneModel &model) { return kLayersBetween * model.self_thickness; }

  template <class Points>
  void find_near(const LaneModel &model, const Array<CapsuleMotion<T>> &capsules, const Points &x, const VertexBoxes<T> &ways) {
    using S = Side<T>;
    const float reach = 2 * model.thickness + layers(model);
    for (int k = 0; k < capsules.size(); ++k) {
      const CapsuleMotion<S> &motion = in_all_lanes<S>(capsules[k]);
      const auto note = [&](const int *, const int *vertices, auto lanes) {
        Near near{{}, capsule_distance(motion.start, points_at<T>(x.data(), vertices))};
        lanes = lanes & (near.proxy.value < S(reach));
        if (!any(lanes))
          return;
        near.proxy.value = select(lanes, near.proxy.value, S(kFar));
        for (int l = 0; l < kSide<T>; ++l)
          near.vertex[l] = vertices[l];
        near_.push_back(near);
        note_nearest(near);
      };
      ways.for_each_near(
          model, reach_of(capsules[k].start, capsules[k].start, T(reach)), [](int, auto lanes) { return lanes; }, note);
    }
  }
  /// The vertices of a row differ, but for spare ones.
  void note_nearest(const Near &near) {
    using S = Side<T>;
    const S known = values_at<T>(nearest_.data(), near.vertex);
    const auto nearer = near.proxy.value < known;
    if (!any(nearer))
      return;
    set_values<T>(nearest_.data(), near.vertex, select(nearer, near.proxy.value, known));
    const Vec3<S> normal = points_at<T>(normals_.data(), near.vertex);
    move_points<T>(normals_.data(), near.vertex, select(nearer, near.proxy.normal, normal));
  }
  void give_way(const LaneModel &model, const Near &near) {
    using S = Side<T>;
    const S cosine = dot(near.proxy.normal, points_at<T>(normals_.data(), near.vertex));
    const S facing = lane_min(lane_max(S(kBeside) - cosine, S(0)), S(1));
    if (!any(facing > S(0)))
      return;
    const S room = values_at<T>(nearest_.data(), near.vertex) + near.proxy.value;
    const S give = facing * lane_max(S(model.thickness + 0.5f * layers(model)) - S(0.5f) * room, S(0));
    if (any(give > S(0)))
      set_values<T>(give_.data(), near.vertex, lane_max(give, values_at<T>(give_.data(), near.vertex)));
  }

  Array<Near> near_; ///< in the order of the proxies
  Array<T> nearest_, give_;
  Array<Place<T>> normals_; ///< of the nearest proxy
};

} // namespace DOUBLET_PBD_ISA
} // namespace doublet::pbd
