#pragma once
// One small function for each constraint of Stoll et al. 2010, Sect. 6: the value C with its gradients, and the projection
// dx_i = -k w_i grad_i C / (sum_j w_j |grad_j C|^2) of Mueller et al. 2007, eq. (8)-(9). T: see lane.h. Masses and rest values
// are shared by all lanes (float), positions and stiffness are not (T).

#include "lane.h"

namespace doublet::pbd {

/// |a - b| - l, eq. (2). share_a = w_a / (w_a + w_b), share_b likewise.
template <class T> inline void project_stretch(Vec3<T> &a, Vec3<T> &b, T share_a, T share_b, T rest_length, T stiffness) {
  const Vec3<T> d = a - b;
  const T length =
      lane_max(lane_sqrt(dot(d, d)), T(1e-12f)); // two points in one place have no direction: d = 0 leaves them there
  const T s = stiffness * (length - rest_length) / length;
  a -= (s * share_a) * d;
  b += (s * share_b) * d;
}

/// Signed angle between the normals of the faces (x0, x1, x2) and (x1, x0, x3) minus the rest angle, in (-pi, pi]. Eq. (3) with
/// atan2 for acos: the same value up to sign, and a gradient at 0. Gradients: Bridson et al. 2003; their sum is zero.
template <class T> struct Bend {
  T value;
  Vec3<T> g0, g1, g2, g3; ///< d value / d x_i, 1/m
};
template <class T>
inline Bend<T> bend_constraint(const Vec3<T> &x0, const Vec3<T> &x1, const Vec3<T> &x2, const Vec3<T> &x3, T rest_cos,
                               T rest_sin) {
  const Vec3<T> e = x1 - x0, a = x2 - x0, b = x3 - x0;
  const Vec3<T> n1 = cross(e, a), n2 = cross(b, e);
  const T ee = dot(e, e), length = lane_sqrt(ee), nn1 = dot(n1, n1), nn2 = dot(n2, n2);
  const T c = dot(n1, n2), s = -length * dot(n1, b); // cos and sin, both times |n1| |n2|
  // One division serves 1/|n1|^2, 1/|n2|^2 and 1/|e|^2. A folded-up face (below some 1e-6 m^2 in all) drops out instead of
  // exploding.
  const T product = nn1 * nn2 * ee;
  const T inverse = select(product > T(1e-33f), T(1), T(0)) / lane_max(product, T(1e-33f));
  Bend<T> r;
  r.value = lane_atan2(s * rest_cos - c * rest_sin, c * rest_cos + s * rest_sin);
  r.g2 = (-length * (inverse * nn2 * ee)) * n1;
  r.g3 = (-length * (inverse * nn1 * ee)) * n2;
  const T inverse_ee = inverse * nn1 * nn2, t2 = dot(a, e) * inverse_ee, t3 = dot(b, e) * inverse_ee;
  r.g0 = (t2 - T(1)) * r.g2 + (t3 - T(1)) * r.g3;
  r.g1 = (-t2) * r.g2 - t3 * r.g3;
  return r;
}
/// w_i: inverse masses divided by the largest of the four. The sum under the multiplier has two floors, neither of which ordinary
/// cloth reaches. Beside an attachment a vertex may be asked to close an angle it has (almost) no lever on: C / sum would throw
/// it to infinity. And faces blown up to several times their size (a rubber material) would be moved by as much again, and grow
/// without end: rest_floor, a quarter of |g2|^2 + |g3|^2 at rest, lets them be moved by their rest size at most.
template <class T>
inline void project_bend(Vec3<T> &x0, Vec3<T> &x1, Vec3<T> &x2, Vec3<T> &x3, T w0, T w1, T w2, T w3, T rest_cos, T rest_sin,
                         T rest_floor, T stiffness) {
  const Bend<T> c = bend_constraint(x0, x1, x2, x3, rest_cos, rest_sin);
  const T g22 = dot(c.g2, c.g2), g33 = dot(c.g3, c.g3);
  const T sum = w0 * dot(c.g0, c.g0) + w1 * dot(c.g1, c.g1) + w2 * g22 + w3 * g33;
  const T lambda = -stiffness * c.value / lane_max(sum, lane_max(T(0.25f) * (g22 + g33), rest_floor));
  x0 += (w0 * lambda) * c.g0;
  x1 += (w1 * lambda) * c.g1;
  x2 += (w2 * lambda) * c.g2;
  x3 += (w3 * lambda) * c.g3;
}

/// C = p - target, eq. (4).
template <class T> inline void project_blend(Vec3<T> &p, const Vec3<T> &target, T stiffness) {
  p += stiffness * (target - p);
}

/// Tapered capsule made ready for distances: the hull of the spheres (a, radius) and (a + length axis, radius - slope length).
/// |slope| < 1; a capsule whose one sphere contains the other is that sphere, with length 0.
struct CapsuleShape {
  Vec3f a, axis, side; ///< side: unit vector across the axis, the normal where none is defined
  float length, radius, slope, slope_over_cos;
};
/// Exact signed distance to a tapered capsule, negative inside, with its gradient (the outward unit normal).
template <class T> struct Distance {
  T value;
  Vec3<T> normal;
};
template <class T> inline Distance<T> capsule_distance(const CapsuleShape &c, const Vec3<T> &p) {
  const Vec3<T> axis{T(c.axis.x), T(c.axis.y), T(c.axis.z)}, a{T(c.a.x), T(c.a.y), T(c.a.z)},
      side{T(c.side.x), T(c.side.y), T(c.side.z)};
  const Vec3<T> d = p - a;
  const T z = dot(d, axis);
  const Vec3<T> radial = d - z * axis;
  const T rho = lane_sqrt(dot(radial, radial));
  // The closest surface point lies on the sphere about the axis point f: walk from p down the cone's normal, stop at the end
  // spheres.
  const T f = lane_min(lane_max(z - rho * T(c.slope_over_cos), T(0)), T(c.length));
  const Vec3<T> r = d - f * axis;
  const T length = lane_sqrt(dot(r, r));
  const auto defined = length > T(1e-9f);
  return {length - (T(c.radius) - T(c.slope) * f), select(defined, (T(1) / select(defined, length, T(1))) * r, side)};
}

/// Vertex against proxy during one step. `reference`: normal where the vertex entered during the step; while the closest normal
/// still agrees with it the vertex is pushed to the closest surface, else (it is past the axis) back to the plane through its
/// entry.
template <class T> struct CapsuleContact {
  int vertex, capsule;
  T slack;           ///< m, how much of a penetration at the start of the step may stay (below the thickness)
  Vec3<T> reference; ///< unit normal
  T plane;           ///< reference . that place, m
  T min_agreement;   ///< least cosine between closest normal and reference
  T touched;         ///< 1 once the contact has pushed
};
template <class T> inline void project_capsule(Vec3<T> &p, CapsuleContact<T> &contact, const CapsuleShape &shape, T thickness) {
  const Distance<T> d = capsule_distance(shape, p);
  const auto past = dot(d.normal, contact.reference) < contact.min_agreement;
  const T gap = select(past, dot(p, contact.reference) - contact.plane, d.value - (thickness - contact.slack));
  const T push = lane_max(-gap, T(0));
  p += push * select(past, contact.reference, d.normal);
  contact.touched = select(gap < T(0), T(1), contact.touched);
}

/// Vertex q against the point (b0, b1, b2) of face (a, b, c), kept at `thickness` on the side (+1, -1) it started on.
template <class T> struct SelfContact {
  int q, a, b, c;
  T b0, b1, b2, side, thickness, touched;
  float wq, wa, wb, wc; ///< inverse masses
  T inverse_sum;        ///< 1 / (wq + wa b0^2 + wb b1^2 + wc b2^2), see contact_response
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
  const T lambda = lane_max(s.thickness - d.value, T(0)) * s.inverse_sum;
  q += (lambda * T(s.wq)) * d.normal;
  a -= (lambda * T(s.wa) * s.b0) * d.normal;
  b -= (lambda * T(s.wb) * s.b1) * d.normal;
  c -= (lambda * T(s.wc) * s.b2) * d.normal;
  s.touched = select(d.value < s.thickness, T(1), s.touched);
}

/// Air drag, eq. (5) with A(v) = m, over a time h: exact for u' = -d_n/2 |u_n| u_n and u' = -d_t/2 u_t taken apart, hence it
/// slows and never reverses, whatever the parameter. u: velocity relative to the air; tangential_factor = exp(-d_t h / 2);
/// half_dn_h = d_n h / 2.
template <class T> inline Vec3<T> apply_drag(const Vec3<T> &u, const Vec3<T> &normal, T half_dn_h, T tangential_factor) {
  const T un = dot(u, normal);
  const T normal_factor = T(1) / (T(1) + half_dn_h * lane_abs(un));
  return tangential_factor * u + (un * (normal_factor - tangential_factor)) * normal;
}

} // namespace doublet::pbd
