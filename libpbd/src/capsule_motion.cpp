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

CapsuleShape<float> capsule_shape(const Capsule &c, const Eigen::Vector3d &origin) {
  const Eigen::Vector3d along = c.p1 - c.p0;
  const double length = along.norm();
  CapsuleShape<float> s{};
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

CapsuleMotion<float> capsule_motion(const Capsule &start, const Capsule &end, const Eigen::Vector3d &origin) {
  CapsuleMotion<float> m{capsule_shape(start, origin), capsule_shape(end, origin), {1, 0, 0, 0, 1, 0, 0, 0, 1}};
  if (m.start.length > 0 && m.end.length > 0) {
    const Eigen::Matrix3d r =
        Eigen::Quaterniond::FromTwoVectors(to_double(m.start.axis), to_double(m.end.axis)).toRotationMatrix();
    for (int i = 0; i < 9; ++i)
      m.rotation[i] = static_cast<float>(r(i / 3, i % 3));
  }
  return m;
}

} // namespace doublet::pbd
