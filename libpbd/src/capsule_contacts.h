#pragma once
// Which vertices meet which proxies.

#include "box_list.h"

namespace doublet::pbd {
inline namespace DOUBLET_PBD_ISA {

constexpr float kNear = 0.02f; ///< m from a proxy within which a vertex is watched during the iterations
constexpr float kMinAgreement =
    0.5f; ///< cosine between closest normal and entry normal up to which a vertex has not passed the axis

/// Box around both ends of a capsule's motion, grown by `margin`.
template <class T> inline Box<T> reach_of(const CapsuleShape<T> &start, const CapsuleShape<T> &end, T margin) {
  const T far(1e30f);
  Box<T> r{{far, far, far}, {-far, -far, -far}};
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
template <class T, class Points> inline Box<T> way_of(const Points &x, const Points &p, int i) {
  return {low<T>(x[i], p[i]), high<T>(x[i], p[i])};
}

/// Vertices that enter a proxy during the step from x to p, or are near one at either end. Everything is seen from the moving
/// proxy: a leg that jumps a quarter of a metre between frames sweeps the cloth that stood before it along. A vertex that starts
/// inside is moved out by at most `opening`. ways: room for the boxes of the vertices' ways.
template <class T, class Points>
inline void find_capsule_contacts(const LaneModel &model, const Array<CapsuleMotion<T>> &capsules, Points &x, Points &p,
                                  T opening, BoxList<T> &ways, Array<CapsuleContact<T>> &contacts) {
  contacts.clear();
  ways.resize(model.vertex_count);
  for (int i = 0; i < model.vertex_count; ++i)
    ways.set(i, way_of<T>(x, p, i));
  const T thickness(model.thickness), margin(model.thickness + kNear);
  for (int k = 0; k < capsules.size(); ++k) {
    const CapsuleMotion<T> &m = capsules[k];
    const auto bring = [&](int i, auto lanes) {
      if (model.weights[i] == 0)
        return;
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
        ways.set(i, way_of<T>(x, p, i));
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
          return;
      }
      contact.active = select(lanes, T(1), T(0));
      contacts.push_back(contact);
    };
    const auto every_lane = T(0) <= T(0);
    ways.for_each_overlap(0, model.vertex_count, reach_of(m.start, m.end, margin), every_lane, bring);
  }
}

/// Vertices that the iterations dragged into a proxy they were not near before. places: room for the boxes of the vertices.
template <class T, class Points>
inline void push_out_strays(const LaneModel &model, const Array<CapsuleMotion<T>> &capsules,
                            const Array<CapsuleContact<T>> &contacts, Points &p, BoxList<T> &places) {
  const T thickness(model.thickness);
  places.resize(model.vertex_count);
  for (int i = 0; i < model.vertex_count; ++i)
    places.set(i, {p[i], p[i]});
  int next = 0; // of the contacts, which are in the same order
  for (int k = 0; k < capsules.size(); ++k) {
    const CapsuleShape<T> &shape = capsules[k].end;
    const auto push_out = [&](int i, auto near) {
      while (next < contacts.size() && (contacts[next].capsule < k || (contacts[next].capsule == k && contacts[next].vertex < i)))
        ++next;
      const bool watched = next < contacts.size() && contacts[next].capsule == k && contacts[next].vertex == i;
      const auto lanes = near & ((watched ? contacts[next].active : T(0)) <= T(0));
      if (model.weights[i] == 0 || !any(lanes))
        return;
      Vec3<T> &pi = p[i];
      const Distance<T> d = capsule_distance(shape, pi);
      pi = select(lanes & (d.value < thickness), pi + (thickness - d.value) * d.normal, pi);
      places.set(i, {pi, pi});
    };
    const auto every_lane = T(0) <= T(0);
    places.for_each_overlap(0, model.vertex_count, reach_of(shape, shape, thickness), every_lane, push_out);
  }
}

} // namespace DOUBLET_PBD_ISA
} // namespace doublet::pbd
