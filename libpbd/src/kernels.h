#pragma once
// One small function for each constraint of Stoll et al. 2010, Sect. 6: the value C with its gradients, and the projection
// dx_i = -k w_i grad_i C / (sum_j w_j |grad_j C|^2) of Mueller et al. 2007, eq. (8)-(9). T: see lane.h. Masses and rest values
// are shared by all lanes (float), positions and stiffness are not (T). Where a constraint acts in some lanes only (`active`, 0
// or 1) the others keep their bits: adding a zero would not do, it turns -0 into 0.

#include "lane.h"

namespace doublet::pbd {
inline namespace DOUBLET_PBD_ISA {

/// |a - b| - l, eq. (2). share_a = w_a / (w_a + w_b), share_b likewise.
template <class T> inline void project_stretch(Vec3<T> &a, Vec3<T> &b, T share_a, T share_b, T rest_length, T stiffness) {
  const Vec3<T> d = a - b;
  const T length =
      lane_max(lane_sqrt(dot(d, d)), T(1e-12f)); // two points in one place have no direction: d = 0 leaves them there
  const T s = stiffness * (length - rest_length) / length;
  a = neg_mul_add(s * share_a, d, a);
  b = mul_add(s * share_b, d, b);
}

/// The same with compliance (Macklin et al. 2016, eq. 18): `multiplier` (m) is the constraint's own through the sweeps of a step,
/// `compliance` is alpha / (h^2 (w_a + w_b)). relaxation > 1: successive over-relaxation (Young 1954), which has the same answer.
template <class T>
inline void project_soft_stretch(Vec3<T> &a, Vec3<T> &b, T share_a, T share_b, T rest_length, T compliance, T relaxation,
                                 T &multiplier) {
  const Vec3<T> d = a - b;
  const T length = lane_max(lane_sqrt(dot(d, d)), T(1e-12f));
  const T change = relaxation * (rest_length - length - compliance * multiplier) / (T(1) + compliance);
  multiplier += change;
  const T s = change / length;
  a = mul_add(s * share_a, d, a);
  b = neg_mul_add(s * share_b, d, b);
}

/// The same, of stretches alone that are longer than their force so far asks for, by more than `slack` times their length at
/// rest: that much stays. Which were?
template <class T>
inline auto project_violated_stretch(Vec3<T> &a, Vec3<T> &b, T share_a, T share_b, T rest_length, T compliance, T slack,
                                     T &multiplier) {
  const Vec3<T> d = a - b;
  const T square = dot(d, d), most = rest_length - compliance * multiplier + slack * rest_length;
  const auto over = (square > most * most) & (most > T(0)); // a force may for a while ask for less than no length
  if (any(over)) {
    const T length = lane_sqrt(square), change = (most - length) / (T(1) + compliance), s = change / length;
    multiplier = select(over, multiplier + change, multiplier);
    a = select(over, mul_add(s * share_a, d, a), a);
    b = select(over, neg_mul_add(s * share_b, d, b), b);
  }
  return over;
}

/// A bend's inverse masses, divided by the largest of the four, and its rest values.
template <class S> struct BendRest {
  S w0, w1, w2, w3;
  S cos, sin; ///< of the rest angle
  S floor;    ///< 1/m^2, see bend_terms
  S response; ///< sum_i w_i |g_i|^2 at rest, at least floor, 1/m^2
};
/// C = the signed angle between the normals of the faces (x0, x1, x2) and (x1, x0, x3) minus the rest angle, in (-pi, pi]. Eq.
/// (3) with atan2 for acos: the same value up to sign, and a gradient at 0. Gradients (Bridson et al. 2003), whose sum is zero:
///   g2 = -|e| n1 / |n1|^2,  g0 = (ae / ee - 1) g2 + (be / ee - 1) g3,
///   g3 = -|e| n2 / |n2|^2,  g1 = -ae / ee g2 - be / ee g3.
/// Nothing is divided: `scale` times the gradients' weighted sum of squares is a polynomial.
template <class T> struct BendTerms {
  Vec3<T> n1, n2; ///< e x a, b x e, m^2, with e = x1 - x0, a = x2 - x0, b = x3 - x0
  T ee, ae, be, nn1, nn2, length;
  T sine, cosine; ///< of C, both times |n1| |n2|
  T scale;        ///< ee nn1 nn2, m^10
  T sum;          ///< scale sum_i w_i |g_i|^2, m^8
};
/// The sum has two floors, neither of which ordinary cloth reaches. Beside an attachment a vertex may be asked to close an angle
/// it has (almost) no lever on: C / sum would throw it to infinity. And faces blown up to several times their size (a rubber
/// material) would be moved by as much again, and grow without end: rest.floor, a quarter of |g2|^2 + |g3|^2 at rest, lets them
/// be moved by their rest size at most.
template <class T>
inline BendTerms<T> bend_terms(const Vec3<T> &x0, const Vec3<T> &x1, const Vec3<T> &x2, const Vec3<T> &x3,
                               const BendRest<T> &rest) {
  BendTerms<T> r;
  const Vec3<T> e = x1 - x0, a = x2 - x0, b = x3 - x0;
  r.n1 = cross(e, a), r.n2 = cross(b, e);
  r.ee = dot(e, e), r.ae = dot(a, e), r.be = dot(b, e), r.nn1 = dot(r.n1, r.n1), r.nn2 = dot(r.n2, r.n2);
  r.length = lane_sqrt(r.ee);
  const T c = dot(r.n1, r.n2), s = -r.length * dot(r.n1, b); // cos and sin, both times |n1| |n2|
  r.sine = mul_sub(s, T(rest.cos), c * T(rest.sin));
  r.cosine = mul_add(c, T(rest.cos), s * T(rest.sin));
  r.scale = r.ee * (r.nn1 * r.nn2);
  const auto squared = [&](T k2, T k3) { return mul_add(k2, mul_add(k2, r.nn2, k3 * c), k3 * mul_add(k2, c, k3 * r.nn1)); };
  const T square = r.ee * r.ee;
  const T sum = mul_add(rest.w0, squared(r.ae - r.ee, r.be - r.ee),
                        mul_add(rest.w1, squared(r.ae, r.be), square * mul_add(rest.w2, r.nn2, rest.w3 * r.nn1)));
  // The last keeps faces folded to nothing, whose C is 0, from 0 / 0.
  r.sum = lane_max(sum, lane_max(T(0.25f) * square * (r.nn1 + r.nn2), mul_add(rest.floor, r.scale, T(1e-36f))));
  return r;
}
/// x_i -= multiplier w_i g_i scale / |e|.
template <class T>
inline void move_bend(const BendTerms<T> &c, const BendRest<T> &rest, T multiplier, Vec3<T> &x0, Vec3<T> &x1, Vec3<T> &x2,
                      Vec3<T> &x3) {
  const Vec3<T> m1 = (multiplier * c.nn2) * c.n1, m2 = (multiplier * c.nn1) * c.n2;
  x0 = mul_add(rest.w0 * (c.ae - c.ee), m1, mul_add(rest.w0 * (c.be - c.ee), m2, x0));
  x1 = neg_mul_add(rest.w1 * c.ae, m1, neg_mul_add(rest.w1 * c.be, m2, x1));
  x2 = mul_add(rest.w2 * c.ee, m1, x2);
  x3 = mul_add(rest.w3 * c.ee, m2, x3);
}
/// C, known last.
template <class T> inline T bend_value(const BendTerms<T> &c) {
  return lane_atan2(c.sine, c.cosine);
}
/// What move_bend wants of a projection.
template <class T> inline T bend_multiplier(const BendTerms<T> &c, T stiffness) {
  return (stiffness * c.length / c.sum) * bend_value(c);
}
/// The same with compliance alpha / (h^2 response), as project_soft_stretch; multiplier, the constraint's own, in m^2. relaxation
/// < 1: a step of that share, which has the same answer.
template <class T> inline T soft_bend_multiplier(const BendTerms<T> &c, T response, T compliance, T relaxation, T &multiplier) {
  const T softness = compliance * response;
  const T change = relaxation * mul_add(softness, multiplier, bend_value(c)) / mul_add(softness, c.scale, c.sum);
  multiplier -= change * c.scale;
  return change * c.length;
}
template <class T>
inline void project_bend(Vec3<T> &x0, Vec3<T> &x1, Vec3<T> &x2, Vec3<T> &x3, const BendRest<T> &rest, T stiffness) {
  const BendTerms<T> c = bend_terms(x0, x1, x2, x3, rest);
  move_bend(c, rest, bend_multiplier(c, stiffness), x0, x1, x2, x3);
}

/// C = p - target, eq. (4).
template <class T> inline void project_blend(Vec3<T> &p, const Vec3<T> &target, T stiffness) {
  p = mul_add(stiffness, target - p, p);
}

/// Tapered capsule made ready for distances: the hull of the spheres (a, radius) and (a + length axis, radius - slope length).
/// |slope| < 1; a capsule whose one sphere contains the other is that sphere, with length 0.
template <class S> struct CapsuleShape {
  Vec3<S> a, axis, side; ///< side: unit vector across the axis, the normal where none is defined
  S length, radius, slope, slope_over_cos;
};
/// Exact signed distance to a tapered capsule, negative inside, with its gradient (the outward unit normal).
template <class T> struct Distance {
  T value;
  Vec3<T> normal;
};
/// One capsule for all lanes (S = float) or one a lane (S = T).
template <class S, class T> inline Distance<T> capsule_distance(const CapsuleShape<S> &c, const Vec3<T> &p) {
  const Vec3<T> axis{T(c.axis.x), T(c.axis.y), T(c.axis.z)}, a{T(c.a.x), T(c.a.y), T(c.a.z)},
      side{T(c.side.x), T(c.side.y), T(c.side.z)};
  const Vec3<T> d = p - a;
  const T z = dot(d, axis);
  const Vec3<T> radial = neg_mul_add(z, axis, d);
  const T rho = lane_sqrt(dot(radial, radial));
  // The closest surface point lies on the sphere about the axis point f: walk from p down the cone's normal, stop at the end
  // spheres.
  const T f = lane_min(lane_max(neg_mul_add(rho, T(c.slope_over_cos), z), T(0)), T(c.length));
  const Vec3<T> r = neg_mul_add(f, axis, d);
  const T length = lane_sqrt(dot(r, r));
  const auto defined = length > T(1e-9f);
  return {length - (T(c.radius) - T(c.slope) * f), select(defined, (T(1) / select(defined, length, T(1))) * r, side)};
}

/// Start and end of one step of a capsule that moves rigidly. The motion between turns the axis by the shortest way; spin about
/// the axis leaves the surface where it is and is left out. Holds nothing but T: lanes are filled value by value.
template <class T> struct CapsuleMotion {
  CapsuleShape<T> start, end;
  T rotation[9]; ///< row-major, end_from_start

  /// Direction, start -> end.
  Vec3<T> rotate(Vec3<T> d) const {
    const T *r = rotation;
    return {r[0] * d.x + r[1] * d.y + r[2] * d.z, r[3] * d.x + r[4] * d.y + r[5] * d.z, r[6] * d.x + r[7] * d.y + r[8] * d.z};
  }
  /// Direction, end -> start.
  Vec3<T> rotate_back(Vec3<T> d) const {
    const T *r = rotation;
    return {r[0] * d.x + r[3] * d.y + r[6] * d.z, r[1] * d.x + r[4] * d.y + r[7] * d.z, r[2] * d.x + r[5] * d.y + r[8] * d.z};
  }
  Vec3<T> carry(Vec3<T> p) const { return end.a + rotate(p - start.a); }           ///< point fixed to the capsule, start -> end
  Vec3<T> carry_back(Vec3<T> p) const { return start.a + rotate_back(p - end.a); } ///< the same, end -> start
};

/// First point of the segment q0 -> q1 closer than `thickness` to the capsule, as a fraction in [0, 1]; 2 if there is none, and
/// in lanes outside `where`. The distance to a convex body is convex along a line, so Newton's method from an outside q0 walks up
/// to the first root and never past it.
template <class T, class M>
inline T entry_time(const CapsuleShape<T> &shape, const Vec3<T> &q0, const Vec3<T> &q1, T thickness, M where) {
  const Vec3<T> way = q1 - q0;
  T t(0), entry(2);
  for (int i = 0; i < 32 && any(where); ++i) {
    const Distance<T> d = capsule_distance(shape, q0 + t * way);
    const T gap = d.value - thickness, approach = -dot(d.normal, way);
    const M met = where & (gap <= T(1e-6f));
    entry = select(met, t, entry);
    where = where & !met & (approach > T(0));
    t = select(where, t + gap / approach, t);
    where = where & (t <= T(1));
  }
  return select(where, t, entry); // still creeping towards a grazing contact: take it as one
}

/// A vertex against a proxy during one step, or n vertices against one. `reference`: normal where the vertex entered during the
/// step; while the closest normal still agrees with it the vertex is pushed to the closest surface, else (it is past the axis)
/// back to the plane through its entry.
template <class T, int n = 1> struct CapsuleContact {
  int capsule, vertex[n];
  T active;
  T slack;           ///< m below the thickness that may stay: where it is pinched, and of a penetration at the start of the step
  Vec3<T> reference; ///< unit normal
  T plane;           ///< reference . that place, m
  T min_agreement;   ///< least cosine between closest normal and reference
  T touched;         ///< 1 once the contact has pushed
};
/// shape: one for all lanes (S = float) or one a lane (S = T). where: in these lanes.
template <class S, class T, int n, class M>
inline void project_capsule(Vec3<T> &p, CapsuleContact<T, n> &contact, const CapsuleShape<S> &shape, T thickness, M where) {
  const Distance<T> d = capsule_distance(shape, p);
  const auto past = dot(d.normal, contact.reference) < contact.min_agreement;
  const T gap = select(past, dot(p, contact.reference) - contact.plane, d.value - (thickness - contact.slack));
  const auto pushes = (gap < T(0)) & (contact.active > T(0)) & where;
  p = select(pushes, neg_mul_add(gap, select(past, contact.reference, d.normal), p), p);
  contact.touched = select(pushes, T(1), contact.touched);
}

/// Vertex q against the point (b0, b1, b2) of face (a, b, c), kept at `thickness` on the side (+1, -1) it started on.
template <class T> struct SelfContact {
  int q, a, b, c;
  float wq, wa, wb, wc; ///< inverse masses
  T active, b0, b1, b2, side, thickness, touched;
  T inverse_sum; ///< 1 / (wq + wa b0^2 + wb b1^2 + wc b2^2), see contact_response
};
/// The multiplier's denominator. Where all but one corner are pinned and the contact is far from that corner the sum is next to
/// nothing and would throw it: a quarter of the largest inverse mass is its floor.
template <class T> inline T contact_response(const SelfContact<T> &s) {
  const T sum = T(s.wq) + T(s.wa) * s.b0 * s.b0 + T(s.wb) * s.b1 * s.b1 + T(s.wc) * s.b2 * s.b2;
  const float largest = lane_max(lane_max(s.wq, s.wa), lane_max(s.wb, s.wc));
  return T(1) / lane_max(sum, T(0.25f * largest));
}
/// Distance along the face normal and that normal, pointing to q's side.
template <class T>
inline Distance<T> self_distance(const Vec3<T> &q, const Vec3<T> &a, const Vec3<T> &b, const Vec3<T> &c, T b0, T b1, T b2,
                                 T side) {
  const Vec3<T> n = cross(b - a, c - a);
  const T scale = side / lane_max(lane_sqrt(dot(n, n)), T(1e-12f));
  const Vec3<T> normal = scale * n;
  return {dot(q - (b0 * a + b1 * b + b2 * c), normal), normal};
}
template <class T> inline void project_self(Vec3<T> &q, Vec3<T> &a, Vec3<T> &b, Vec3<T> &c, SelfContact<T> &s) {
  const Distance<T> d = self_distance(q, a, b, c, s.b0, s.b1, s.b2, s.side);
  const auto pushes = (d.value < s.thickness) & (s.active > T(0));
  const T lambda = (s.thickness - d.value) * s.inverse_sum;
  q = select(pushes, mul_add(lambda * T(s.wq), d.normal, q), q);
  a = select(pushes, neg_mul_add(lambda * T(s.wa) * s.b0, d.normal, a), a);
  b = select(pushes, neg_mul_add(lambda * T(s.wb) * s.b1, d.normal, b), b);
  c = select(pushes, neg_mul_add(lambda * T(s.wc) * s.b2, d.normal, c), c);
  s.touched = select(pushes, T(1), s.touched);
}

/// Edge (a, b) against edge (c, d), which come nearest at the fractions s and t of the way along them: kept at `thickness` on the
/// side on which they started, +1 where (c, d) lies to the side of (b - a) x (d - c).
template <class T> struct EdgeContact {
  int a, b, c, d;
  float wa, wb, wc, wd; ///< inverse masses
  T active, s, t, side, thickness, touched;
  T inverse_sum; ///< see contact_response
};
template <class T> inline T contact_response(const EdgeContact<T> &e) {
  const T r = T(1) - e.s, u = T(1) - e.t;
  const T sum = T(e.wa) * r * r + T(e.wb) * e.s * e.s + T(e.wc) * u * u + T(e.wd) * e.t * e.t;
  const float largest = lane_max(lane_max(e.wa, e.wb), lane_max(e.wc, e.wd));
  return T(1) / lane_max(sum, T(0.25f * largest));
}
/// Distance between the two points along the normal of both edges, and that normal, pointing to the side of (c, d).
template <class T>
inline Distance<T> edge_distance(const Vec3<T> &a, const Vec3<T> &b, const Vec3<T> &c, const Vec3<T> &d, T s, T t, T side) {
  const Vec3<T> u = b - a, v = d - c, n = cross(u, v);
  const T scale = side / lane_max(lane_sqrt(dot(n, n)), T(1e-12f));
  const Vec3<T> normal = scale * n;
  return {dot(mul_add(t, v, c) - mul_add(s, u, a), normal), normal};
}
template <class T> inline void project_edges(Vec3<T> &a, Vec3<T> &b, Vec3<T> &c, Vec3<T> &d, EdgeContact<T> &e) {
  const Distance<T> now = edge_distance(a, b, c, d, e.s, e.t, e.side);
  const auto pushes = (now.value < e.thickness) & (e.active > T(0));
  const T lambda = (e.thickness - now.value) * e.inverse_sum;
  a = select(pushes, neg_mul_add(lambda * T(e.wa) * (T(1) - e.s), now.normal, a), a);
  b = select(pushes, neg_mul_add(lambda * T(e.wb) * e.s, now.normal, b), b);
  c = select(pushes, mul_add(lambda * T(e.wc) * (T(1) - e.t), now.normal, c), c);
  d = select(pushes, mul_add(lambda * T(e.wd) * e.t, now.normal, d), d);
  e.touched = select(pushes, T(1), e.touched);
}

/// Air drag, eq. (5) with A(v) = m, over a time h: exact for u' = -d_n/2 |u_n| u_n and u' = -d_t/2 u_t taken apart, hence it
/// slows and never reverses, whatever the parameter. u: velocity relative to the air; tangential_factor = exp(-d_t h / 2);
/// half_dn_h = d_n h / 2.
template <class T> inline Vec3<T> apply_drag(const Vec3<T> &u, const Vec3<T> &normal, T half_dn_h, T tangential_factor) {
  const T un = dot(u, normal);
  const T normal_factor = T(1) / (T(1) + half_dn_h * lane_abs(un));
  return tangential_factor * u + (un * (normal_factor - tangential_factor)) * normal;
}

} // namespace DOUBLET_PBD_ISA
} // namespace doublet::pbd
