#include "doublet/core/stage_values.h"

#include "doublet/core/error.h"
#include "doublet/core/skinning.h"
#include "doublet/options/options.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace doublet {

namespace {

void expect(const std::string &what, Eigen::Index found, Eigen::Index expected) {
  if (found != expected)
    throw std::invalid_argument(what + ": expected " + std::to_string(expected) + " entries, found " + std::to_string(found));
}

/// All, or none.
void expect_all(const std::string &what, Eigen::Index found, Eigen::Index expected) {
  if (found != 0)
    expect(what, found, expected);
}

template <class Derived> void expect_finite(const std::string &what, const Eigen::DenseBase<Derived> &values) {
  if (!values.derived().allFinite())
    throw Error(what + ": expected finite numbers, found NaN or infinity");
}

} // namespace

void require_actor(const RiggedMesh &actor, const std::string &what) {
  require_usable(actor.mesh, what + ": actor.mesh");
  expect(what + ": actor.face_valid", static_cast<Eigen::Index>(actor.face_valid.size()), actor.mesh.faces.rows());
  expect(what + ": actor.weights", actor.weights.rows(), actor.mesh.vertices.rows());
  expect(what + ": a row of actor.weights", actor.weights.cols(), actor.skeleton.joint_count());
  expect_finite(what + ": actor.weights", actor.weights);
}

void require_frames(const std::vector<Vertices> &frames, Eigen::Index vertices, const std::string &what) {
  for (const Vertices &frame : frames) {
    expect(what, frame.rows(), vertices);
    expect_finite(what, frame);
  }
}

void require_performance(const ReferencePerformance &performance, const RiggedMesh &actor, const std::string &what) {
  const auto count = static_cast<Eigen::Index>(performance.surface.frames.size());
  if (count == 0)
    throw Error(what + ": performance: expected at least one frame, found none");
  require_frames(performance.surface.frames, actor.mesh.vertices.rows(), what + ": a frame of the performance");
  expect(what + ": performance.dofs", performance.dofs.rows(), count);
  expect(what + ": a row of performance.dofs", performance.dofs.cols(), actor.skeleton.dof_count());
  expect_finite(what + ": performance.dofs", performance.dofs);
  expect_all(what + ": performance.joints", static_cast<Eigen::Index>(performance.joints.size()), count);
  require_frames(performance.joints, actor.skeleton.joint_count(), what + ": a frame of performance.joints");
  expect_all(what + ": performance.frames", static_cast<Eigen::Index>(performance.frames.size()), count);
}

void require_segmentation(const Segmentation &segmentation, Eigen::Index vertices, const std::string &what) {
  expect(what + ": segmentation.clothness", segmentation.clothness.size(), vertices);
  expect(what + ": segmentation.region", segmentation.region.size(), vertices);
  expect_all(what + ": segmentation.sigma", segmentation.sigma.size(), vertices);
  expect_all(what + ": segmentation.probability", segmentation.probability.size(), vertices);
  expect_all(what + ": segmentation.slack", segmentation.slack.size(), vertices);
  expect_all(what + ": segmentation.rest", segmentation.rest.rows(), vertices);
  if (!(segmentation.clothness.array() >= 0).all() || !(segmentation.clothness.array() <= 1).all())
    throw Error(what + ": segmentation.clothness: expected values in [0, 1], found others");
  if (!(segmentation.probability.array() >= 0).all() || !(segmentation.probability.array() <= 1).all())
    throw Error(what + ": segmentation.probability: expected values in [0, 1], found others");
  if (vertices > 0 && (segmentation.region.minCoeff() < -1 || segmentation.region.maxCoeff() >= segmentation.region_count))
    throw Error(what + ": segmentation.region: expected numbers from -1 to below region_count " +
                std::to_string(segmentation.region_count) + ", found " + std::to_string(segmentation.region.minCoeff()) + " to " +
                std::to_string(segmentation.region.maxCoeff()));
  expect_finite(what + ": segmentation.slack", segmentation.slack);
  expect_finite(what + ": segmentation.rest", segmentation.rest);
}

void require_proxies(const std::vector<TaperedCapsule> &proxies, const Skeleton &skeleton, const std::string &what) {
  for (const TaperedCapsule &capsule : proxies) {
    if (capsule.joint < 0 || capsule.joint >= skeleton.joint_count())
      throw Error(what + ": a proxy hangs on joint " + std::to_string(capsule.joint) + " of " +
                  std::to_string(skeleton.joint_count()));
    if (!capsule.p0.allFinite() || !capsule.p1.allFinite() || !(capsule.r0 > 0) || !(capsule.r1 > 0) ||
        !std::isfinite(capsule.r0 + capsule.r1))
      throw Error(what + ": a proxy of joint " + std::to_string(capsule.joint) +
                  ": expected finite ends and positive radii, found radii " + options::to_text(capsule.r0) + " and " +
                  options::to_text(capsule.r1));
  }
}

void require_body(const BodyFit &fit, const std::string &what) {
  require_usable(fit.body, what + ": body");
  expect_all(what + ": body.deviation", fit.deviation.size(), fit.body.vertices.rows());
  expect_finite(what + ": body.deviation", fit.deviation);
  expect_finite(what + ": body.coefficients", fit.coefficients);
}

std::vector<Vertices> canonical_frames(const RiggedMesh &actor, const ReferencePerformance &performance, const Context &context) {
  expect("canonical_frames: actor.weights", actor.weights.rows(), actor.mesh.vertices.rows());
  require_performance(performance, actor, "canonical_frames");
  const int frames = static_cast<int>(performance.surface.frames.size()), vertices = static_cast<int>(actor.mesh.vertices.rows());
  std::vector<Vertices> unposed(frames, Vertices(vertices, 3));
  parallel_for(context, frames, [&](int t) {
    const Vertices &posed = performance.surface.frames[t];
    const Transforms blend =
        dual_quaternion_blend(actor.weights, actor.skeleton, forward_kinematics(actor.skeleton, performance.dofs.row(t)));
    for (int i = 0; i < vertices; ++i)
      unposed[t].row(i) = (blend[i].inverse() * Eigen::Vector3d(posed.row(i))).transpose();
  });
  return unposed;
}

namespace {
void require_transforms(const Skeleton &skeleton, const Transforms &world_from_rest) {
  if (static_cast<int>(world_from_rest.size()) != skeleton.joint_count())
    throw std::invalid_argument("pose_capsules: expected " + std::to_string(skeleton.joint_count()) + " transforms, found " +
                                std::to_string(world_from_rest.size()));
}
} // namespace

Capsule pose_capsule(const TaperedCapsule &c, const Skeleton &skeleton, const Transforms &world_from_rest) {
  require_transforms(skeleton, world_from_rest);
  if (c.joint < 0 || c.joint >= skeleton.joint_count())
    throw std::invalid_argument("pose_capsules: a capsule names joint " + std::to_string(c.joint) + ", there are " +
                                std::to_string(skeleton.joint_count()));
  const Eigen::Isometry3d &T = world_from_rest[c.joint];
  const Eigen::Vector3d &origin = skeleton.joints[c.joint].rest;
  return {T * (origin + c.p0), T * (origin + c.p1), c.r0, c.r1};
}

std::vector<Capsule> pose_capsules(const std::vector<TaperedCapsule> &capsules, const Skeleton &skeleton,
                                   const Transforms &world_from_rest) {
  std::vector<Capsule> posed;
  pose_capsules(capsules, skeleton, world_from_rest, posed);
  return posed;
}

void pose_capsules(const std::vector<TaperedCapsule> &capsules, const Skeleton &skeleton, const Transforms &world_from_rest,
                   std::vector<Capsule> &posed) {
  require_transforms(skeleton, world_from_rest);
  posed.clear();
  for (const TaperedCapsule &c : capsules)
    posed.push_back(pose_capsule(c, skeleton, world_from_rest));
}

Mesh capsule_mesh(const std::vector<Capsule> &capsules) {
  constexpr int kSegments = 16, kRings = 10; // from pole to pole; half on each sphere
  std::vector<Eigen::Vector3d> vertices;
  std::vector<Eigen::Vector3i> faces;
  for (const Capsule &capsule : capsules) {
    if (!capsule.p0.allFinite() || !capsule.p1.allFinite() || !(capsule.r0 > 0 && capsule.r1 > 0) ||
        !std::isfinite(capsule.r0 + capsule.r1))
      throw std::invalid_argument("capsule_mesh: expected finite ends and positive radii, found others");
    Capsule c = capsule;
    const Eigen::Vector3d between = c.p1 - c.p0;
    const double length = between.norm();
    const bool nested = length <= std::fabs(c.r0 - c.r1);
    if (nested) { // one sphere holds the other
      c.p0 = c.p1 = c.r0 > c.r1 ? c.p0 : c.p1;
      c.r0 = c.r1 = std::max(c.r0, c.r1);
    }
    const double slope = nested ? 0.0 : (c.r0 - c.r1) / length; // sine of the cone's half angle
    const Eigen::Vector3d axis = length > 0 ? Eigen::Vector3d(between / length) : Eigen::Vector3d::UnitY();
    const Eigen::Vector3d u = axis.unitOrthogonal(), w = axis.cross(u);
    const double tangent = std::asin(slope); // latitude at which sphere and cone touch
    const int first = static_cast<int>(vertices.size());
    const auto is_pole = [](int ring) { return ring == 0 || ring == kRings - 1; };
    const auto vertex = [&](int ring, int s) {
      return ring == 0 ? first : first + 1 + (ring - 1) * kSegments + (is_pole(ring) ? 0 : s % kSegments);
    };
    for (int ring = 0; ring < kRings; ++ring) {
      const bool lower = ring < kRings / 2;
      const double part = lower ? ring / (kRings / 2 - 1.0) : (ring - kRings / 2) / (kRings / 2 - 1.0);
      const double latitude = lower ? -M_PI_2 + part * (tangent + M_PI_2) : tangent + part * (M_PI_2 - tangent);
      const double radius = lower ? c.r0 : c.r1;
      for (int s = 0; s < (is_pole(ring) ? 1 : kSegments); ++s) {
        const double angle = 2 * M_PI * s / kSegments;
        const Eigen::Vector3d around = std::cos(angle) * u + std::sin(angle) * w;
        vertices.push_back((lower ? c.p0 : c.p1) + radius * (std::sin(latitude) * axis + std::cos(latitude) * around));
      }
    }
    for (int ring = 0; ring + 1 < kRings; ++ring)
      for (int s = 0; s < kSegments; ++s) {
        if (!is_pole(ring))
          faces.emplace_back(vertex(ring, s), vertex(ring, s + 1), vertex(ring + 1, s + 1));
        if (!is_pole(ring + 1))
          faces.emplace_back(vertex(ring, s), vertex(ring + 1, s + 1), vertex(ring + 1, s));
      }
  }
  Mesh mesh;
  mesh.vertices.resize(static_cast<Eigen::Index>(vertices.size()), 3);
  mesh.faces.resize(static_cast<Eigen::Index>(faces.size()), 3);
  for (std::size_t i = 0; i < vertices.size(); ++i)
    mesh.vertices.row(static_cast<Eigen::Index>(i)) = vertices[i].transpose();
  for (std::size_t i = 0; i < faces.size(); ++i)
    mesh.faces.row(static_cast<Eigen::Index>(i)) = faces[i].transpose();
  return mesh;
}

double signed_distance(const Capsule &capsule, const Eigen::Vector3d &point) {
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
