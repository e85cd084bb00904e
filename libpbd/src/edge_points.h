#pragma once
// Where edges meet which proxies.

#include "capsule_contacts.h"

namespace doublet::pbd {
inline namespace DOUBLET_PBD_ISA {

constexpr float kLongerYet = 1.2f;      ///< times as long as at the start of a step that an edge may be at its end
constexpr float kPointNear = 0.01f;     ///< m from a proxy within which a point is watched during the iterations
constexpr float kLeastResponse = 0.25f; ///< of the larger inverse mass, as contact_response

/// A point of an edge, (1 - t) a + t b, against a proxy.
template <class T> struct PointContact {
  int a, b;
  T t, response_a, response_b; ///< m that the ends move for a metre of the point
  CapsuleContact<T> at;        ///< its vertex is none
};

/// Edges that are so long that a proxy could slip through between their ends, which alone are kept at the thickness from it: the
/// arm of a sleeve that is drawn out. The point of each that is nearest to the proxy's axis is kept out of the proxy itself, so
/// that where ordinary cloth lies on one nothing changes.
template <class T> class EdgePoints {
public:
  /// Those that enter a proxy during the step from x to p, or are near one at either end. give: see Pinches.
  template <class Points>
  void find(const LaneModel &model, const Array<CapsuleMotion<T>> &capsules, const Points &x, const Points &p,
            const Array<T> &give) {
    contacts_.clear();
    find_long(model, capsules, x, p);
    for (int k = 0; k < capsules.size(); ++k) {
      const CapsuleMotion<T> &motion = capsules[k];
      const T harmless = harmless_length(model, motion.end);
      boxes_.for_each_overlap(0, long_.size(), reach_of(motion.start, motion.end, T(kPointNear)), T(0) <= T(0),
                              [&](int n, auto lanes) {
                                lanes = lanes & (long_[n].length > harmless);
                                if (any(lanes))
                                  add(model, k, motion, long_[n], lanes, x, p, give);
                              });
    }
  }
  template <class Points, class M> void project(const Array<CapsuleMotion<T>> &capsules, Points &p, M where) {
    for (PointContact<T> &c : contacts_) {
      const Vec3<T> from = point(p, c.a, c.b, c.t);
      Vec3<T> to = from;
      project_capsule(to, c.at, capsules[c.at.capsule].end, T(0), where);
      p[c.a] = mul_add(c.response_a, to - from, Vec3<T>(p[c.a]));
      p[c.b] = mul_add(c.response_b, to - from, Vec3<T>(p[c.b]));
    }
  }

private:
  struct LongEdge {
    int a, b;
    T length; ///< m, that it may have
  };

  /// m, up to which an edge stays out of the proxy if the ends keep their distance.
  static T harmless_length(const LaneModel &model, const CapsuleShape<T> &shape) {
    const T thickness(model.thickness), radius = lane_min(shape.radius, shape.radius - shape.slope * shape.length);
    return T(2) * lane_sqrt(thickness * (thickness + T(2) * radius));
  }
  template <class Points> static Vec3<T> point(const Points &points, int a, int b, T t) {
    return mul_add(t, Vec3<T>(points[b]) - Vec3<T>(points[a]), Vec3<T>(points[a]));
  }
  template <class Points>
  void find_long(const LaneModel &model, const Array<CapsuleMotion<T>> &capsules, const Points &x, const Points &p) {
    using S = Side<T>;
    long_.clear();
    T harmless(1e9f);
    for (const CapsuleMotion<T> &motion : capsules)
      harmless = lane_min(harmless, harmless_length(model, motion.end));
    for (int first = 0; first < model.edge_count; first += kSide<T>) {
      int a[kSide<T>], b[kSide<T>];
      for (int l = 0; l < kSide<T>; ++l) { // behind the last edge its lists hold no vertices
        const int edge = first + l < model.edge_count ? first + l : first;
        a[l] = model.edge_ends[0][edge], b[l] = model.edge_ends[1][edge];
      }
      const Vec3<S> along = points_at<T>(x.data(), a) - points_at<T>(x.data(), b);
      const S length = S(kLongerYet) * lane_sqrt(dot(along, along));
      const auto matters = length > S(harmless);
      if (any(matters))
        for_each_side<T>(matters, [&](int l) {
          if (first + l < model.edge_count && model.weights[a[l]] + model.weights[b[l]] > 0)
            long_.push_back({a[l], b[l], lane_of<T>(length, l)});
        });
    }
    boxes_.resize(long_.size());
    for (int n = 0; n < long_.size(); ++n) {
      const auto way = [&](int i) { return box_around<T>(Vec3<T>(x[i]), Vec3<T>(p[i])); };
      boxes_.set(n, united(way(long_[n].a), way(long_[n].b)));
    }
  }
  template <class M, class Points>
  void add(const LaneModel &model, int k, const CapsuleMotion<T> &motion, const LongEdge &edge, M lanes, const Points &x,
           const Points &p, const Array<T> &give) {
    const T t = nearest_to_axis(motion.end, Vec3<T>(p[edge.a]), Vec3<T>(p[edge.b]));
    const Vec3<T> from = point(x, edge.a, edge.b, t), to = point(p, edge.a, edge.b, t);
    const Distance<T> start = capsule_distance(motion.start, from);
    const T pinched = T(model.thickness) - lane_max(give[edge.a], give[edge.b]);
    const T thickness = lane_max(lane_min(T(0), pinched), T(0) - deepest_in(motion.end));
    const auto inside = lanes & (start.value < thickness), outside = lanes & !inside;
    CapsuleContact<T> contact{k, {-1}, T(0), T(0) - thickness, motion.rotate(start.normal), T(0), T(kMinAgreement), T(0)};
    contact.plane = dot(contact.reference, motion.carry(from));
    contact.slack = select(inside, T(0) - start.value, contact.slack);
    const auto near = outside & (start.value <= T(kPointNear));
    lanes = inside | near | enter(motion, from, to, thickness, start.value, T(kPointNear), outside, contact);
    if (!any(lanes))
      return;
    contact.active = select(lanes, T(1), T(0));
    const T wa(model.weights[edge.a]), wb(model.weights[edge.b]), r = T(1) - t;
    const T least = T(kLeastResponse) * lane_max(wa, wb), inverse = T(1) / lane_max(wa * r * r + wb * t * t, least);
    contacts_.push_back({edge.a, edge.b, t, wa * r * inverse, wb * t * inverse, contact});
  }
  /// The fraction of the edge (a, b) at which it comes nearest to the line of the axis.
  static T nearest_to_axis(const CapsuleShape<T> &shape, const Vec3<T> &a, const Vec3<T> &b) {
    const auto across = [&](const Vec3<T> &v) { return v - dot(v, shape.axis) * shape.axis; };
    const Vec3<T> from = across(a - shape.a), along = across(b - a);
    return lane_min(lane_max(T(0) - dot(from, along) / lane_max(dot(along, along), T(1e-12f)), T(0)), T(1));
  }

  Array<LongEdge> long_;
  BoxList<T> boxes_; ///< around their ways
  Array<PointContact<T>> contacts_;
};

} // namespace DOUBLET_PBD_ISA
} // namespace doublet::pbd
