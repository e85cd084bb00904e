#include "doublet/core/stage_values.h"

#include "doublet/core/skinning.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace doublet {

std::vector<std::uint8_t> RiggedMesh::skip_invalid() const {
  std::vector<std::uint8_t> skip(face_valid.size());
  std::transform(face_valid.begin(), face_valid.end(), skip.begin(), [](std::uint8_t valid) { return valid == 0; });
  return skip;
}

std::vector<Vertices> unposed_frames(const RiggedMesh &actor, const ReferencePerformance &performance, const Context &context) {
  const int frames = static_cast<int>(performance.surface.frames.size()), vertices = static_cast<int>(actor.mesh.vertices.rows());
  if (performance.dofs.rows() != frames || performance.dofs.cols() != actor.skeleton.dof_count())
    throw std::invalid_argument("unposed_frames: expected dofs (" + std::to_string(frames) + ", " +
                                std::to_string(actor.skeleton.dof_count()) + "), found (" +
                                std::to_string(performance.dofs.rows()) + ", " + std::to_string(performance.dofs.cols()) + ")");
  std::vector<Vertices> unposed(frames, Vertices(vertices, 3));
  parallel_for(context, frames, [&](int t) {
    const Vertices &posed = performance.surface.frames[t];
    if (posed.rows() != vertices)
      throw std::invalid_argument("unposed_frames: expected " + std::to_string(vertices) + " vertices in every frame, found " +
                                  std::to_string(posed.rows()));
    const Transforms blend = dual_quaternion_blend(actor.weights, forward_kinematics(actor.skeleton, performance.dofs.row(t)));
    for (int i = 0; i < vertices; ++i)
      unposed[t].row(i) = (blend[i].inverse() * Eigen::Vector3d(posed.row(i))).transpose();
  });
  return unposed;
}

std::vector<PosedCapsule> pose_capsules(const std::vector<TaperedCapsule> &capsules, const Skeleton &skeleton,
                                        const Transforms &world_from_rest) {
  if (static_cast<int>(world_from_rest.size()) != skeleton.joint_count())
    throw std::invalid_argument("pose_capsules: expected " + std::to_string(skeleton.joint_count()) + " transforms, found " +
                                std::to_string(world_from_rest.size()));
  std::vector<PosedCapsule> out;
  for (const TaperedCapsule &c : capsules) {
    if (c.joint < 0 || c.joint >= skeleton.joint_count())
      throw std::invalid_argument("pose_capsules: a capsule names joint " + std::to_string(c.joint) + ", there are " +
                                  std::to_string(skeleton.joint_count()));
    const Eigen::Isometry3d &T = world_from_rest[c.joint];
    const Eigen::Vector3d &origin = skeleton.joints[c.joint].rest;
    out.push_back({T * (origin + c.p0), T * (origin + c.p1), c.r0, c.r1});
  }
  return out;
}

double signed_distance(const PosedCapsule &capsule, const Eigen::Vector3d &point) {
  // The smallest distance to the spheres along the axis: |x - c(t)| - r(t) is convex in t, with its minimum where the radius
  // falls as fast as the distance grows.
  const Eigen::Vector3d axis = capsule.p1 - capsule.p0;
  const double length = axis.norm();
  const Eigen::Vector3d from_p0 = point - capsule.p0;
  if (length < 1e-12)
    return from_p0.norm() - std::max(capsule.r0, capsule.r1);
  const double along = from_p0.dot(axis) / length;
  const double across = (from_p0 - along / length * axis).norm();
  const double slope = (capsule.r0 - capsule.r1) / length;
  double t = slope > 0 ? 0 : length; // one sphere swallows the other
  if (std::abs(slope) < 1)
    t = std::clamp(along - slope * across / std::sqrt(1 - slope * slope), 0.0, length);
  return std::hypot(along - t, across) - (capsule.r0 - slope * t);
}

} // namespace doublet
