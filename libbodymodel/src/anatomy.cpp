#include "anatomy.h"

#include "doublet/core/parts/closest_point.h"

#include <algorithm>
#include <limits>

namespace doublet {
namespace {

constexpr double kShortestBone = 0.03; ///< m, shorter ones (a clavicle's stub) have no surface of their own
constexpr double kSkinDepth = 0.002;   ///< m, where a vertex looks for its bone from

} // namespace

Anatomy find_bones(const Mesh &body, const Vertices &normals, const RayScene &scene, const Skeleton &skeleton) {
  Anatomy anatomy;
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const int parent = skeleton.joints[j].parent;
    if (parent >= 0 && (skeleton.joints[j].rest - skeleton.joints[parent].rest).norm() > kShortestBone)
      anatomy.bones.push_back({parent, j});
  }
  anatomy.nearest.assign(body.vertices.rows(), -1);
  for (int v = 0; v < body.vertices.rows(); ++v) {
    const Eigen::Vector3d point = body.vertices.row(v), inside = point - kSkinDepth * normals.row(v).transpose();
    double best_seen = std::numeric_limits<double>::infinity(), best = best_seen;
    int nearest = -1;
    for (std::size_t b = 0; b < anatomy.bones.size(); ++b) {
      const Eigen::Vector3d on_bone =
          closest_on_segment(point, skeleton.joints[anatomy.bones[b].joint].rest, skeleton.joints[anatomy.bones[b].end].rest);
      const double distance = (point - on_bone).norm();
      if (distance < best) {
        best = distance;
        nearest = static_cast<int>(b);
      }
      if (distance < best_seen && !scene.occluded(inside, on_bone)) {
        best_seen = distance;
        anatomy.nearest[v] = static_cast<int>(b);
      }
    }
    if (anatomy.nearest[v] < 0) // a finger's side, a fold
      anatomy.nearest[v] = nearest;
  }
  return anatomy;
}

} // namespace doublet
