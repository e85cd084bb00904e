#pragma once
// Which vertices meet which proxies.

#include "kernels.h"
#include "lane_array.h"
#include "pack.h"

namespace doublet::pbd {
inline namespace DOUBLET_PBD_ISA {

constexpr float kNear = 0.02f; ///< m from a proxy within which a vertex is watched during the iterations
constexpr float kMinAgreement =
    0.5f; ///< cosine between closest normal and entry normal up to which a vertex has not passed the axis

template <class T> struct Reach { Vec3<T> lo, hi; };
/// Box around both ends of a capsule's motion, grown by `margin`.
template <class T> inline Reach<T> reach_of(const CapsuleShape<T> &start, const CapsuleShape<T> &end, T margin) {
  const T far(1e30f);
  Reach<T> r{{far, far, far}, {-far, -far, -far}};
  const auto add = [&](const CapsuleShape<T> &c, T t) {
    const Vec3<T> p = c.a + t * c.axis;
    const T radius = c.radius - c.slope * t + margin;
    r.lo = {lane_min(r.lo.x, p.x - radius), lane_min(r.lo.y, p.y - radius), lane_min(r.lo.z, p.z - radius)};
    r.hi = {lane_max(r.hi.x, p.x + radius), lane_max(r.hi.y, p.y + radius), lane_max(r.hi.z, p.z + radius)};
  };
  add(start, T(0));
  add(start, start.length);
  add(end, T(0));
  add(end, end.length);
  return r;
}
template <class T> inline auto may_touch(const Reach<T> &r, const Vec3<T> &a, const Vec3<T> &b) {
  return (lane_min(a.x, b.x) <= r.hi.x) & (r.lo.x <= lane_max(a.x, b.x)) & (lane_min(a.y, b.y) <= r.hi.y) &
         (r.lo.y <= lane_max(a.y, b.y)) & (lane_min(a.z, b.z) <= r.hi.z) & (r.lo.z <= lane_max(a.z, b.z));
}
/// The same question, asked of many ways.
template <class T> struct Gate {
  explicit Gate(const Reach<T> &r) : reach(r) {}
  auto may_touch(const Vec3<T> &a, const Vec3<T> &b) const { return pbd::may_touch(reach, a, b); }
  Reach<T> reach;
};
/// Of one simulation the axes lie side by side; a point's fourth number is not looked at.
template <> struct Gate<float> {
  explicit Gate(const Reach<float> &r)
      : lo(Pack<4>::Lanes{r.lo.x, r.lo.y, r.lo.z, 0}), hi(Pack<4>::Lanes{r.hi.x, r.hi.y, r.hi.z, 0}) {}
  bool may_touch(const Point &a, const Point &b) const {
    const Pack<4> from = Pack<4>::load(&a.x), to = Pack<4>::load(&b.x);
    const Mask<4> touches = (lane_min(from, to) <= hi) & (lo <= lane_max(from, to)), axes{{-1, -1, -1, 0}};
    return !any(axes & !touches);
  }
  Pack<4> lo, hi;
};

/// Vertices that enter a proxy during the step from x to p, or are near one at either end. Everything is seen from the moving
/// proxy: a leg that jumps a quarter of a metre between frames sweeps the cloth that stood before it along. A vertex that starts
/// inside is moved out by at most `opening`.
template <class T, class Points>
inline void find_capsule_contacts(const LaneModel &model, const Array<CapsuleMotion<T>> &capsules, Points &x, Points &p,
                                  T opening, Array<CapsuleContact<T>> &contacts) {
  contacts.clear();
  const T thickness(model.thickness), margin(model.thickness + kNear);
  for (int k = 0; k < capsules.size(); ++k) {
    const CapsuleMotion<T> &m = capsules[k];
    const Gate<T> gate(reach_of(m.start, m.end, margin));
    for (int i = 0; i < model.vertex_count; ++i) {
      if (model.weights[i] == 0)
        continue;
      auto lanes = gate.may_touch(x[i], p[i]);
      if (!any(lanes))
        continue;
      Vec3<T> &xi = x[i], &pi = p[i];
      const Distance<T> start = capsule_distance(m.start, xi);
      const T depth = thickness - start.value;
      const auto inside = lanes & (depth > T(0)), outside = lanes & (depth <= T(0));
      CapsuleContact<T> contact{i, k, T(0), T(0), m.rotate(start.normal), T(0), T(kMinAgreement), T(0)};
      if (any(inside)) { // open it gently by moving start and end alike, which gives no speed
        const T moved = lane_min(depth, opening);
        xi = select(inside, xi + moved * start.normal, xi);
        pi = select(inside, pi + moved * start.normal, pi);
        contact.slack = select(inside, depth - moved, T(0));
        contact.plane = dot(contact.reference, m.carry(xi));
        lanes = inside;
      }
      if (any(outside)) {
        const Vec3<T> q0 = m.carry(xi), way = pi - q0;
        const auto moves = depth + lane_sqrt(dot(way, way)) > T(0);
        const T t = entry_time(m.end, q0, pi, thickness, outside & moves);
        const auto enters = t <= T(1);
        const Vec3<T> q = select(enters, q0 + t * way, pi);
        const Distance<T> d = capsule_distance(m.end, q);
        contact.reference = select(outside, d.normal, contact.reference);
        contact.plane = select(outside, dot(d.normal, q) - (d.value - thickness), contact.plane);
        // One that has not met the proxy may yet slide a quarter round it.
        contact.min_agreement = select(outside & !enters, T(0), contact.min_agreement);
        lanes = inside | (outside & (enters | (start.value <= margin) | (d.value <= margin)));
        if (!any(lanes))
          continue;
      }
      contact.active = select(lanes, T(1), T(0));
      contacts.push_back(contact);
    }
  }
}

/// Vertices that the iterations dragged into a proxy they were not near before.
template <class T, class Points>
inline void push_out_strays(const LaneModel &model, const Array<CapsuleMotion<T>> &capsules,
                            const Array<CapsuleContact<T>> &contacts, Points &p) {
  const T thickness(model.thickness);
  int next = 0;
  for (int k = 0; k < capsules.size(); ++k) {
    const CapsuleShape<T> &shape = capsules[k].end;
    const Gate<T> gate(reach_of(shape, shape, thickness));
    for (int i = 0; i < model.vertex_count; ++i) {
      const bool watched = next < contacts.size() && contacts[next].capsule == k && contacts[next].vertex == i;
      const T active = watched ? contacts[next++].active : T(0);
      if (model.weights[i] == 0)
        continue;
      const auto lanes = gate.may_touch(p[i], p[i]) & (active <= T(0));
      if (!any(lanes))
        continue;
      Vec3<T> &pi = p[i];
      const Distance<T> d = capsule_distance(shape, pi);
      pi = select(lanes & (d.value < thickness), pi + (thickness - d.value) * d.normal, pi);
    }
  }
}

} // namespace DOUBLET_PBD_ISA
} // namespace doublet::pbd
