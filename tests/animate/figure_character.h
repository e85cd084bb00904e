#pragma once
// The test figure in a skirt, as a character: one surface of body and skirt, the skirt hung on a ring at the waist.

#include "doublet/animate/character.h"
#include "support/figure.h"

namespace doublet::testing {

inline bool under_skirt(const Eigen::Vector3d &p) {
  return p.y() > 0.5 && p.y() < 0.97 && std::abs(p.x()) < 0.25;
}

/// Body and skirt in one mesh (two components); the thighs under the skirt are left out of the surface, as in a scan.
inline RiggedMesh dressed_actor(int rings = 16, int segments = 36) {
  RiggedMesh actor = figure_actor(0.035);
  const int body_faces = static_cast<int>(actor.mesh.faces.rows());
  const Mesh cloth = skirt(rings, segments);
  actor.mesh = join({actor.mesh, cloth});
  actor.weights = figure_weights(actor.mesh.vertices, actor.skeleton);
  actor.face_valid.assign(actor.mesh.faces.rows(), 1);
  for (int f = 0; f < body_faces; ++f)
    for (int k = 0; k < 3; ++k)
      if (under_skirt(actor.mesh.vertices.row(actor.mesh.faces(f, k))))
        actor.face_valid[f] = 0;
  return actor;
}

inline Segmentation skirt_clothness(const RiggedMesh &actor, int cloth_vertices) {
  const auto n = actor.mesh.vertices.rows();
  Segmentation segmentation;
  segmentation.sigma = Eigen::VectorXd::Zero(n);
  segmentation.sigma[0] = std::numeric_limits<double>::quiet_NaN();
  segmentation.clothness = Eigen::VectorXd::Zero(n);
  segmentation.region = Eigen::VectorXi::Constant(n, -1);
  segmentation.region_count = 1;
  for (Eigen::Index v = n - cloth_vertices; v < n; ++v) {
    const double y = actor.mesh.vertices(v, 1);
    segmentation.clothness[v] = y > 0.98 ? 0 : y > 0.93 ? 0.5 : 1.0;
    if (segmentation.clothness[v] > 0)
      segmentation.region[v] = 0;
  }
  return segmentation;
}

inline Character figure_character() {
  const RiggedMesh actor = dressed_actor();
  const Segmentation segmentation = skirt_clothness(actor, static_cast<int>(skirt(16, 36).vertices.rows()));
  BodyFit body;
  body.body = figure_surface(0.035);
  body.model = "figure";
  std::vector<TaperedCapsule> proxies;
  for (const TaperedCapsule &capsule : figure_capsules(actor.skeleton)) {
    const std::string &joint = actor.skeleton.joints[capsule.joint].name;
    if (joint == "pelvis" || joint == "l_hip" || joint == "r_hip" || joint == "l_knee" || joint == "r_knee")
      proxies.push_back(capsule);
  }
  pbd::Material material;
  material.d_n = 4;
  material.d_t = 1;
  material.k_bend = 0.1;
  material.k_stretch = 1;
  SolverSettings solver;
  solver.cloth.iterations = 24;
  const Mesh skin = figure_surface(0.025), cloth = skirt(24, 60);
  const Mesh high = join({skin, cloth});
  std::vector<std::uint8_t> high_valid(high.faces.rows(), 1);
  for (int f = 0; f < skin.faces.rows(); ++f)
    for (int k = 0; k < 3; ++k)
      if (under_skirt(skin.vertices.row(skin.faces(f, k))))
        high_valid[f] = 0;
  return make_character(actor, segmentation, body, proxies, {material}, solver, high, high_valid);
}

/// Walking on the spot: legs and arms swing, the hips turn.
inline MatrixRM marching(const Skeleton &skeleton, int frames, double fps) {
  MatrixRM dofs = MatrixRM::Zero(frames, skeleton.dof_count());
  const auto set = [&](int t, const std::string &joint, int component, double value) {
    dofs(t, skeleton.joints[skeleton.find(joint)].first_dof + component) = value;
  };
  for (int t = 0; t < frames; ++t) {
    const double phase = 2 * pi * t / fps, swing = std::sin(phase) * std::min(1.0, t / (0.25 * fps));
    set(t, "pelvis", 4 - 1, 0.5 * swing);
    set(t, "l_hip", 0, -0.6 * swing);
    set(t, "r_hip", 0, 0.6 * swing);
    set(t, "l_shoulder", 0, 0.5 * swing);
    set(t, "r_shoulder", 0, -0.5 * swing);
    set(t, "l_knee", 0, 0.5 * std::max(0.0, swing));
    set(t, "spine", 1, 0.3 * swing);
  }
  return dofs;
}

} // namespace doublet::testing
