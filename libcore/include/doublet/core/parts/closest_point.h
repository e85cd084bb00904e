#pragma once
// The point of a segment, or of a triangle, that is closest to another.

#include <Eigen/Core>

#include <algorithm>

namespace doublet {

/// The point of the segment a b that is closest to p, m; a if they are the same.
inline Eigen::Vector3d closest_on_segment(const Eigen::Vector3d &p, const Eigen::Vector3d &a, const Eigen::Vector3d &b) {
  const Eigen::Vector3d axis = b - a;
  return a + std::clamp((p - a).dot(axis) / std::max(axis.squaredNorm(), 1e-12), 0.0, 1.0) * axis;
}

/// Barycentric coordinates (Ericson, Real-Time Collision Detection, 2004, Sect. 5.1.5) of the point of triangle a b c that is
/// closest to p, in any number of dimensions. Arguments: dot products of the edges ab and ac with the vectors from the corners to
/// p.
inline Eigen::Vector3d closest_on_triangle(double ab_ap, double ac_ap, double ab_bp, double ac_bp, double ab_cp, double ac_cp) {
  if (ab_ap <= 0 && ac_ap <= 0)
    return {1, 0, 0};
  if (ab_bp >= 0 && ac_bp <= ab_bp)
    return {0, 1, 0};
  const double c = ab_ap * ac_bp - ab_bp * ac_ap;
  if (c <= 0 && ab_ap >= 0 && ab_bp <= 0)
    return {1 - ab_ap / (ab_ap - ab_bp), ab_ap / (ab_ap - ab_bp), 0};
  if (ac_cp >= 0 && ab_cp <= ac_cp)
    return {0, 0, 1};
  const double b = ab_cp * ac_ap - ab_ap * ac_cp;
  if (b <= 0 && ac_ap >= 0 && ac_cp <= 0)
    return {1 - ac_ap / (ac_ap - ac_cp), 0, ac_ap / (ac_ap - ac_cp)};
  const double a = ab_bp * ac_cp - ab_cp * ac_bp;
  if (a <= 0 && ac_bp - ab_bp >= 0 && ab_cp - ac_cp >= 0) {
    const double w = (ac_bp - ab_bp) / ((ac_bp - ab_bp) + (ab_cp - ac_cp));
    return {0, 1 - w, w};
  }
  return Eigen::Vector3d(a, b, c) / (a + b + c);
}

} // namespace doublet
