#pragma once
// A plain person for tests: joints with the standard names, capsules around the bones, a closed surface, a skirt, cameras.

#include "doublet/core/stage_values.h"
#include "support/meshes.h"

#include <algorithm>
#include <string>
#include <vector>

namespace doublet::testing {

/// 24 joints of a person of about 1.7 m at the origin, facing +Z, left is +X, arms lowered by 45 degrees. 36 dof by default
/// names.
inline std::vector<JointAnnotation> stick_figure() {
  std::vector<JointAnnotation> marks = {
      {"pelvis", "", {0, 0.90, 0}, {}},         {"spine", "pelvis", {0, 1.02, -0.02}, {}},
      {"chest", "spine", {0, 1.25, -0.02}, {}}, {"neck", "chest", {0, 1.42, -0.02}, {}},
      {"head", "neck", {0, 1.53, 0.01}, {}},    {"head_top", "head", {0, 1.68, 0.01}, {}},
  };
  for (const double side : {1.0, -1.0}) {
    const std::string s = side > 0 ? "l_" : "r_";
    const auto add = [&](const char *name, const std::string &parent, double x, double y, double z) {
      marks.push_back({s + name, parent, {side * x, y, z}, {}});
    };
    add("clavicle", "chest", 0.03, 1.36, -0.01);
    add("shoulder", s + "clavicle", 0.17, 1.34, -0.02);
    add("elbow", s + "shoulder", 0.35, 1.16, -0.02);
    add("wrist", s + "elbow", 0.50, 1.01, 0.06);
    add("hand", s + "wrist", 0.56, 0.95, 0.10);
    add("hip", "pelvis", 0.09, 0.87, 0);
    add("knee", s + "hip", 0.11, 0.47, 0.02);
    add("ankle", s + "knee", 0.12, 0.08, 0);
    add("toe", s + "ankle", 0.13, 0.02, 0.13);
  }
  return marks;
}

inline Skeleton figure_skeleton() {
  return make_skeleton(stick_figure());
}

/// Capsules around the figure's bones in the joints' frames, the trunk twice side by side: the body as an implicit surface.
inline std::vector<TaperedCapsule> figure_capsules(const Skeleton &skeleton) {
  const auto bone = [&](const std::string &from, const std::string &to, double r0, double r1, double shift = 0) {
    const int j = skeleton.find(from);
    const Eigen::Vector3d side(shift, 0, 0), way = skeleton.joints[skeleton.find(to)].rest - skeleton.joints[j].rest;
    return TaperedCapsule{j, side, way + side, r0, r1};
  };
  std::vector<TaperedCapsule> out;
  for (const double side : {1.0, -1.0}) {
    const std::string s = side > 0 ? "l_" : "r_";
    out.push_back(bone("pelvis", "spine", 0.11, 0.10, 0.06 * side));
    out.push_back(bone("spine", "chest", 0.10, 0.10, 0.06 * side));
    out.push_back(bone(s + "clavicle", s + "shoulder", 0.07, 0.06));
    out.push_back(bone(s + "shoulder", s + "elbow", 0.055, 0.045));
    out.push_back(bone(s + "elbow", s + "wrist", 0.045, 0.032));
    out.push_back(bone(s + "wrist", s + "hand", 0.032, 0.035));
    out.push_back(bone(s + "hip", s + "knee", 0.085, 0.06));
    out.push_back(bone(s + "knee", s + "ankle", 0.06, 0.042));
    out.push_back(bone(s + "ankle", s + "toe", 0.042, 0.035));
  }
  out.push_back(bone("chest", "neck", 0.08, 0.06));
  out.push_back(bone("neck", "head", 0.06, 0.08));
  out.push_back(bone("head", "head_top", 0.09, 0.09));
  return out;
}

/// The figure's closed surface in a pose. At 0.025 m about 12000 vertices in well under a second.
inline Mesh figure_surface(const Skeleton &skeleton, const Eigen::VectorXd &dofs, double cell = 0.025) {
  const std::vector<Capsule> capsules = pose_capsules(figure_capsules(skeleton), skeleton, forward_kinematics(skeleton, dofs));
  Eigen::Vector3d low = capsules[0].p0, high = low;
  for (const Capsule &c : capsules) {
    const Eigen::Vector3d margin = Eigen::Vector3d::Constant(std::max(c.r0, c.r1) + 2 * cell);
    low = low.cwiseMin(c.p0 - margin).cwiseMin(c.p1 - margin);
    high = high.cwiseMax(c.p0 + margin).cwiseMax(c.p1 + margin);
  }
  return level_set(
      [&](const Eigen::Vector3d &p) {
        double d = 1e9;
        for (const Capsule &c : capsules)
          d = std::min(d, signed_distance(c, p));
        return d;
      },
      low, high, cell);
}

inline Mesh figure_surface(double cell = 0.025) {
  const Skeleton skeleton = figure_skeleton();
  return figure_surface(skeleton, Eigen::VectorXd::Zero(skeleton.dof_count()), cell);
}

/// Skin weights that fall with the distance to each bone's capsule: smooth and plausible, no more.
inline MatrixRM figure_weights(const Vertices &vertices, const Skeleton &skeleton) {
  const std::vector<TaperedCapsule> own = figure_capsules(skeleton);
  const std::vector<Capsule> capsules =
      pose_capsules(own, skeleton, Transforms(skeleton.joint_count(), Eigen::Isometry3d::Identity()));
  MatrixRM weights = MatrixRM::Zero(vertices.rows(), skeleton.joint_count());
  for (int v = 0; v < vertices.rows(); ++v) {
    for (std::size_t c = 0; c < capsules.size(); ++c) {
      const double d = std::max(signed_distance(capsules[c], vertices.row(v)), 0.0);
      weights(v, own[c].joint) = std::max(weights(v, own[c].joint), std::exp(-d / 0.02));
    }
    weights.row(v) /= weights.row(v).sum();
  }
  return weights;
}

/// A flared skirt from the waist (y = 1.0) to the knees (y = 0.5), outside the figure's hips. Open at both ends.
inline Mesh skirt(int rings = 20, int segments = 48) {
  return tube(
      {0, 0.5, 0}, {0, 1.0, 0}, [](double s) { return 0.38 - 0.2 * s; }, rings, segments);
}

inline RiggedMesh figure_actor(double cell = 0.025) {
  RiggedMesh actor;
  actor.skeleton = figure_skeleton();
  actor.mesh = figure_surface(cell);
  actor.face_valid.assign(actor.mesh.faces.rows(), 1);
  actor.weights = figure_weights(actor.mesh.vertices, actor.skeleton);
  return actor;
}

/// A camera at `from` that looks at `at`, image x to the right, +Y up in the world.
inline Camera look_at(const Eigen::Vector3d &from, const Eigen::Vector3d &at, double focal, int width, int height,
                      const std::string &name = "cam") {
  const Eigen::Vector3d z = (at - from).normalized(), x = z.cross(Eigen::Vector3d::UnitY()).normalized();
  Camera camera;
  camera.name = name;
  camera.R << x.transpose(), z.cross(x).transpose(), z.transpose();
  camera.t = -camera.R * from;
  camera.K << focal, 0, (width - 1) / 2.0, 0, focal, (height - 1) / 2.0, 0, 0, 1;
  camera.width = width;
  camera.height = height;
  return camera;
}

/// Cameras on a circle of 3.5 m around (0, 0.9, 0), which they look at; a person of 1.9 m fills the image. "cam0", "cam1", ...
inline CameraRig camera_ring(int count = 8, int size = 320) {
  CameraRig rig;
  for (int c = 0; c < count; ++c) {
    const double a = 2 * pi * c / count;
    rig.push_back(look_at({3.5 * std::sin(a), 1.2 + 0.3 * (c % 2), 3.5 * std::cos(a)}, {0, 0.9, 0}, 1.5 * size, size, size,
                          "cam" + std::to_string(c)));
  }
  return rig;
}

} // namespace doublet::testing
