#include "capsule_motion.h"

#include <Eigen/Geometry>

namespace doublet::pbd {
namespace {

Vec3f to_float(const Eigen::Vector3d &v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}
Eigen::Vector3d to_double(Vec3f v) {
  return {v.x, v.y, v.z};
}

} // namespace

CapsuleShape capsule_shape(const Capsule &c, const Eigen::Vector3d &origin) {
  const Eigen::Vector3d along = c.p1 - c.p0;
  const double length = along.norm();
  CapsuleShape s{};
  if (length <= std::abs(c.r0 - c.r1) + 1e-6) { // one sphere holds the other (or all but)
    const bool first = c.r0 >= c.r1;
    s.a = to_float((first ? c.p0 : c.p1) - origin);
    s.axis = {0, 1, 0};
    s.side = {1, 0, 0};
    s.radius = static_cast<float>(first ? c.r0 : c.r1);
    return s;
  }
  const double slope = (c.r0 - c.r1) / length;
  s.a = to_float(c.p0 - origin);
  s.axis = to_float(along / length);
  s.side = to_float((along / length).unitOrthogonal());
  s.length = static_cast<float>(length);
  s.radius = static_cast<float>(c.r0);
  s.slope = static_cast<float>(slope);
  s.slope_over_cos = static_cast<float>(slope / std::sqrt(1 - slope * slope));
  return s;
}

CapsuleMotion capsule_motion(const Capsule &start, const Capsule &end, const Eigen::Vector3d &origin) {
  CapsuleMotion m{capsule_shape(start, origin), capsule_shape(end, origin), {1, 0, 0, 0, 1, 0, 0, 0, 1}};
  if (m.start.length > 0 && m.end.length > 0) {
    const Eigen::Matrix3d r =
        Eigen::Quaterniond::FromTwoVectors(to_double(m.start.axis), to_double(m.end.axis)).toRotationMatrix();
    for (int i = 0; i < 9; ++i)
      m.rotation[i] = static_cast<float>(r(i / 3, i % 3));
  }
  return m;
}

Vec3f CapsuleMotion::rotate(Vec3f d) const {
  const float *r = rotation;
  return {r[0] * d.x + r[1] * d.y + r[2] * d.z, r[3] * d.x + r[4] * d.y + r[5] * d.z, r[6] * d.x + r[7] * d.y + r[8] * d.z};
}
Vec3f CapsuleMotion::rotate_back(Vec3f d) const {
  const float *r = rotation;
  return {r[0] * d.x + r[3] * d.y + r[6] * d.z, r[1] * d.x + r[4] * d.y + r[7] * d.z, r[2] * d.x + r[5] * d.y + r[8] * d.z};
}
Vec3f CapsuleMotion::carry(Vec3f p) const {
  return end.a + rotate(p - start.a);
}
Vec3f CapsuleMotion::carry_back(Vec3f p) const {
  return start.a + rotate_back(p - end.a);
}

float entry_time(const CapsuleShape &shape, Vec3f q0, Vec3f q1, float thickness) {
  const Vec3f way = q1 - q0;
  const float tolerance = 1e-6f;
  float t = 0;
  for (int i = 0; i < 32; ++i) {
    const Distance<float> d = capsule_distance(shape, q0 + t * way);
    const float gap = d.value - thickness;
    if (gap <= tolerance)
      return t;
    const float approach = -dot(d.normal, way);
    if (approach <= 0)
      return 2;
    t += gap / approach;
    if (t > 1)
      return 2;
  }
  return t; // Newton is still creeping towards a grazing contact: take it as one
}

} // namespace doublet::pbd
