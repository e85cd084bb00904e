#include "person_tangents.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <limits>

namespace doublet::detail {
namespace {

constexpr double kWidest = 2.0;        // rad, between the two planes that touch a person; wider: a camera sees the other
constexpr double kNearestToLine = 0.3; // m, of the person to the line of the centres

Eigen::Vector3d ray(const Camera &camera, const Eigen::Vector2d &pixel) {
  return camera.R.transpose() * camera.K.inverse() * pixel.homogeneous();
}

/// By which `to` is turned from `from` about `axis`, rad.
double turn_about(const Eigen::Vector3d &axis, const Eigen::Vector3d &from, const Eigen::Vector3d &to) {
  const Eigen::Vector3d a = from - from.dot(axis) * axis, b = to - to.dot(axis) * axis;
  return std::atan2(axis.dot(a.cross(b)), a.dot(b));
}

/// The first and the last corner of a hull about an axis.
struct Extremes {
  double least = std::numeric_limits<double>::infinity(), most = -least;
  Eigen::Vector2d first, last;
};
Extremes extremes(const Camera &camera, const std::vector<Eigen::Vector2d> &hull, const Eigen::Vector3d &axis,
                  const Eigen::Vector3d &towards) {
  Extremes found;
  for (const Eigen::Vector2d &corner : hull) {
    const double angle = turn_about(axis, towards, ray(camera, corner));
    if (angle < found.least) {
      found.least = angle;
      found.first = corner;
    }
    if (angle > found.most) {
      found.most = angle;
      found.last = corner;
    }
  }
  return found;
}

} // namespace

std::vector<TangentPair> match_tangents(const CameraRig &rig, const std::vector<const std::vector<Eigen::Vector2d> *> &hulls,
                                        const Eigen::Vector3d &person) {
  std::vector<TangentPair> pairs;
  for (int a = 0; a < static_cast<int>(rig.size()); ++a)
    for (int b = a + 1; b < static_cast<int>(rig.size()); ++b) {
      if (!hulls[a] || !hulls[b] || hulls[a]->empty() || hulls[b]->empty())
        continue;
      const Eigen::Vector3d line = rig[b].centre() - rig[a].centre(), towards = person - rig[a].centre();
      if (line.norm() == 0)
        continue;
      const Eigen::Vector3d axis = line.normalized();
      const double lever = (towards - towards.dot(axis) * axis).norm();
      if (lever < kNearestToLine)
        continue;
      const Extremes one = extremes(rig[a], *hulls[a], axis, towards), other = extremes(rig[b], *hulls[b], axis, towards);
      if (one.most - one.least > kWidest || other.most - other.least > kWidest)
        continue;
      pairs.push_back({a, b, one.first, other.first, lever});
      pairs.push_back({a, b, one.last, other.last, lever});
    }
  return pairs;
}

double tangent_residual(const Camera &first, const Camera &second, const TangentPair &pair) {
  const Eigen::Vector3d axis = (second.centre() - first.centre()).normalized();
  return pair.lever * turn_about(axis, ray(first, pair.in_first), ray(second, pair.in_second));
}

} // namespace doublet::detail
