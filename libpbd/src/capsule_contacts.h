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
/// m, of a proxy: a quarter of its smaller radius, up to which pinched cloth may be inside it. Nearer to the axis it would come
/// out on the other side.
template <class T> inline T deepest_in(const CapsuleShape<T> &shape) {
  return T(0.25f) * lane_min(shape.radius, shape.radius - shape.slope * shape.length);
}
/// One vertex against a proxy, or of one simulation a row of them.
template <class T> using ContactOf = CapsuleContact<Side<T>, kSide<T>>;

template <class T> inline Box<T> box_around(const Vec3<T> &a, const Vec3<T> &b) {
  return {low(a, b), high(a, b)};
}
/// The boxes of the vertices, in the order of LaneModel::vertex_order.
template <class T> class VertexBoxes {
public:
  /// Around from[i] and to[i].
  template <class Points> void set(const LaneModel &m, const Points &from, const Points &to) {
    boxes_.resize(m.vertex_count);
    for (int n = 0; n < m.vertex_count; ++n)
      boxes_.set(n, box_around<T>(from[m.vertex_order[n]], to[m.vertex_order[n]]));
  }
  void replace(int n, const Box<T> &box) { boxes_.set(n, box); }
  /// Calls use(places, vertices, lanes) for the vertices that move, whose boxes overlap `query` and which keep(i, lanes) leaves:
  /// places in the order, kSide of them, and the lanes in which it is so. Of one simulation the last are filled up with spare
  /// vertices that have no lane.
  template <class Keep, class Use>
  void for_each_near(const LaneModel &m, const Box<T> &query, const Keep &keep, const Use &use) const {
    boxes_.for_each_overlap(0, m.vertex_count, query, T(0) <= T(0), [&](int n, auto lanes) {
      const int i = m.vertex_order[n];
      if (m.weights[i] != 0 && any(lanes = keep(i, lanes)))
        use(&n, &i, lanes);
    });
  }

private:
  BoxList<T> boxes_;
};
template <> class VertexBoxes<float> {
public:
  void set(const LaneModel &m, const Array<Point> &from, const Array<Point> &to) {
    boxes_.resize(m.vertex_count);
    for (int first = 0; first < m.vertex_count; first += kRow) {
      const auto vertex = [&](int l) { return m.vertex_order[first + l]; };
      const int left = m.vertex_count - first;
      boxes_.set_row(first, box_around(gather_row(from, left, vertex), gather_row(to, left, vertex)));
    }
    boxes_.refit();
  }
  void replace(int n, const Box<float> &box) { boxes_.replace(n, box); }
  template <class Keep, class Use>
  void for_each_near(const LaneModel &m, const Box<float> &query, const Keep &keep, const Use &use) const {
    int places[kRow], vertices[kRow], count = 0;
    const auto use_row = [&] {
      float taken[kRow];
      for (int l = 0; l < kRow; ++l) {
        taken[l] = l < count ? 1 : 0;
        if (l >= count)
          places[l] = 0, vertices[l] = m.vertex_count + l % kSpareVertices;
      }
      use(places, vertices, Row::load(taken) > Row(0));
      count = 0;
    };
    boxes_.for_each_overlap(0, m.vertex_count, query, true, [&](int n, bool) {
      const int i = m.vertex_order[n];
      if (m.weights[i] == 0 || !keep(i, true))
        return;
      places[count] = n;
      vertices[count++] = i;
      if (count == kRow)
        use_row();
    });
    if (count > 0)
      use_row();
  }

private:
  RowsOfBoxes boxes_;
};

/// A capsule's motion, the same in all lanes.
template <class To> inline CapsuleMotion<To> in_all_lanes(const CapsuleMotion<float> &one) {
  constexpr int count = sizeof one / sizeof(float);
  float values[count];
  __builtin_memcpy(values, &one, sizeof one);
  To spread[count];
  for (int j = 0; j < count; ++j)
    spread[j] = To(values[j]);
  CapsuleMotion<To> all;
  __builtin_memcpy(static_cast<void *>(&all), spread, sizeof all);
  return all;
}
template <class To> inline const CapsuleMotion<To> &in_all_lanes(const CapsuleMotion<To> &each) {
  return each;
}

/// Calls use(l) for those of the kSide that are in `lanes`; for many simulations there is one.
template <class T, class M, class Use> inline void for_each_side(M lanes, const Use &use) {
  if constexpr (kSide<T> == 1)
    use(0);
  else
    for_each_bit(lane_bits(lanes), use);
}

/// Adds what was found in `lanes`, for one simulation to the rows of one proxy without gaps; the rest of the last is idle.
/// taken: places of the last row, kRow before the first.
template <class T, class M>
inline void add_contact(const LaneModel &m, const ContactOf<T> &found, M lanes, int &taken, Array<ContactOf<T>> &contacts) {
  if constexpr (kSide<T> == 1) {
    contacts.push_back(found);
  } else {
    for_each_bit(lane_bits(lanes), [&](int l) {
      if (taken == kRow) {
        ContactOf<T> idle{found.capsule, {}, Row(0), Row(0), {Row(0), Row(0), Row(0)}, Row(0), Row(0), Row(0)};
        for (int k = 0; k < kRow; ++k)
          idle.vertex[k] = m.vertex_count + k % kSpareVertices;
        contacts.push_back(idle);
        taken = 0;
      }
      ContactOf<T> &last = contacts[contacts.size() - 1];
      const auto put = [&](const Row &from, Row &to) { to.lanes[taken] = from.lanes[l]; };
      last.vertex[taken] = found.vertex[l];
      put(found.active, last.active), put(found.slack, last.slack);
      put(found.reference.x, last.reference.x), put(found.reference.y, last.reference.y);
      put(found.reference.z, last.reference.z), put(found.plane, last.plane);
      put(found.min_agreement, last.min_agreement);
      ++taken;
    });
  }
}

/// Points outside a proxy, `gap` from it, that go from `from` to `to`: sets what a contact keeps of where they enter it, or come
/// to be. Which do enter it, or come within `margin`?
template <class S, class Contact, class M>
inline M enter(const CapsuleMotion<S> &m, const Vec3<S> &from, const Vec3<S> &to, S thickness, S gap, S margin, M outside,
               Contact &contact) {
  const Vec3<S> q0 = m.carry(from), way = to - q0;
  const auto moves = thickness - gap + lane_sqrt(dot(way, way)) > S(0);
  const S t = entry_time(m.end, q0, to, thickness, outside & moves);
  const auto enters = t <= S(1);
  const Vec3<S> q = select(enters, q0 + t * way, to);
  const Distance<S> d = capsule_distance(m.end, q);
  contact.reference = select(outside, d.normal, contact.reference);
  contact.plane = select(outside, dot(d.normal, q) - (d.value - thickness), contact.plane);
  // One that has not met the proxy may yet slide a quarter round it.
  contact.min_agreement = select(outside & !enters, S(0), contact.min_agreement);
  return outside & (enters | (d.value <= margin));
}

/// Vertices that enter a proxy during the step from x to p, or are near one at either end. Everything is seen from the moving
/// proxy: a leg that jumps a quarter of a metre between frames sweeps the cloth that stood before it along. A vertex that starts
/// inside is moved out by at most `opening`. give: m, how much nearer than the thickness each may come. ways: the boxes of the
/// vertices' ways. x, p, give: with the spare vertices.
template <class T, class Points>
inline void find_capsule_contacts(const LaneModel &model, const Array<CapsuleMotion<T>> &capsules, Points &x, Points &p,
                                  T opening, const Array<T> &give, VertexBoxes<T> &ways, Array<ContactOf<T>> &contacts) {
  using S = Side<T>;
  contacts.clear();
  const S margin(model.thickness + kNear), most(opening);
  for (int k = 0; k < capsules.size(); ++k) {
    const CapsuleMotion<S> &m = in_all_lanes<S>(capsules[k]);
    const S most_give = S(model.thickness) + deepest_in(m.end);
    int taken = kRow;
    const auto bring = [&](const int *places, const int *vertices, auto lanes) {
      Vec3<S> xi = points_at<T>(x.data(), vertices), pi = points_at<T>(p.data(), vertices);
      const Distance<S> start = capsule_distance(m.start, xi);
      const S less = lane_min(values_at<T>(give.data(), vertices), most_give), thickness = S(model.thickness) - less;
      const S depth = thickness - start.value;
      const auto inside = lanes & (depth > S(0)), outside = lanes & (depth <= S(0));
      ContactOf<T> contact{k, {}, S(0), less, m.rotate(start.normal), S(0), S(kMinAgreement), S(0)};
      lanes = inside;
      if (any(inside)) { // open it gently by moving start and end alike, which gives no speed
        const S moved = lane_min(depth, most);
        xi = select(inside, xi + moved * start.normal, xi);
        pi = select(inside, pi + moved * start.normal, pi);
        contact.slack = select(inside, less + (depth - moved), less);
        contact.plane = dot(contact.reference, m.carry(xi));
        move_points<T>(x.data(), vertices, xi);
        move_points<T>(p.data(), vertices, pi);
        for_each_side<T>(inside, [&](int l) { ways.replace(places[l], box_around<T>(x[vertices[l]], p[vertices[l]])); });
      }
      if (any(outside)) {
        const auto near = outside & (start.value <= margin);
        lanes = inside | near | enter(m, xi, pi, thickness, start.value, margin, outside, contact);
      }
      if (!any(lanes))
        return;
      for (int l = 0; l < kSide<T>; ++l)
        contact.vertex[l] = vertices[l];
      contact.active = select(lanes, S(1), S(0));
      add_contact<T>(model, contact, lanes, taken, contacts);
    };
    const Box<T> reach = reach_of(capsules[k].start, capsules[k].end, T(model.thickness + kNear));
    ways.for_each_near(
        model, reach, [](int, auto lanes) { return lanes; }, bring);
  }
}

/// Vertices that the iterations dragged into a proxy they were not near before. boxes, watched: room for the boxes of the
/// vertices, and for 1 in the lanes in which the proxy at hand has a contact with a vertex. p: with the spare vertices.
template <class T, class Points>
inline void push_out_strays(const LaneModel &model, const Array<CapsuleMotion<T>> &capsules, const Array<ContactOf<T>> &contacts,
                            Points &p, VertexBoxes<T> &boxes, Array<T> &watched) {
  using S = Side<T>;
  const S thickness(model.thickness);
  boxes.set(model, p, p);
  watched.resize(model.vertex_count + kSpareVertices);
  for (T &vertex : watched)
    vertex = T(0);
  int next = 0; // of the contacts, which are in the order of the capsules
  for (int k = 0; k < capsules.size(); ++k) {
    const int first = next;
    for (; next < contacts.size() && contacts[next].capsule == k; ++next)
      for (int l = 0; l < kSide<T>; ++l)
        watched[contacts[next].vertex[l]] = lane_of<T>(contacts[next].active, l);
    const CapsuleShape<T> &shape = capsules[k].end;
    const auto is_stray = [&](int i, auto near) { return near & (watched[i] <= T(0)); };
    const auto push_out = [&](const int *places, const int *vertices, auto lanes) {
      const Vec3<S> from = points_at<T>(p.data(), vertices);
      const Distance<S> d = capsule_distance(shape, from);
      lanes = lanes & (d.value < thickness);
      if (!any(lanes))
        return;
      move_points<T>(p.data(), vertices, select(lanes, from + (thickness - d.value) * d.normal, from));
      for_each_side<T>(lanes, [&](int l) { boxes.replace(places[l], {p[vertices[l]], p[vertices[l]]}); });
    };
    boxes.for_each_near(model, reach_of(shape, shape, T(model.thickness)), is_stray, push_out);
    for (int c = first; c < next; ++c)
      for (const int vertex : contacts[c].vertex)
        watched[vertex] = T(0);
  }
}

} // namespace DOUBLET_PBD_ISA
} // namespace doublet::pbd
