#pragma once
// A small character in a swinging skirt, filmed by perfect cameras: its own simulation under a known material is the truth.

#include "doublet/core/rasterizer.h"
#include "doublet/fit/material_estimator.h"
#include "doublet/simulate/character_simulator.h"
#include "support/figure.h"
#include "support/meshes.h"

namespace doublet::testing {

constexpr double kDt = 1.0 / 40; // s, a frame

struct Scene {
  RiggedMesh actor;
  Segmentation segmentation;
  std::vector<TaperedCapsule> proxies;
  ReferencePerformance performance;
  Observations observations;
  std::vector<Vertices> frames; ///< the true surface
  std::unique_ptr<CharacterSimulator> simulator;
};

/// Trunk (a cylinder) and `skirts` cones side by side, all on one joint; every skirt hangs from its top ring.
inline void make_character(Scene &scene, int skirts, int rings, int segments) {
  scene.actor.skeleton = make_skeleton({{"pelvis", "", {0, 1, 0}, {}}});
  std::vector<Mesh> parts;
  for (int i = 0; i < skirts; ++i) {
    const double x = 1.2 * i;
    parts.push_back(cylinder({x, 0.1, 0}, {x, 1.6, 0}, 0.12, 16, 16));
    parts.push_back(tube(
        {x, 0.5, 0}, {x, 1.0, 0}, [](double s) { return 0.34 - 0.2 * s; }, rings, segments));
    scene.proxies.push_back({0, Eigen::Vector3d(x, -0.9, 0), Eigen::Vector3d(x, 0.6, 0), 0.12, 0.12});
  }
  scene.actor.mesh = join(parts);
  const auto count = scene.actor.mesh.vertices.rows();
  scene.actor.face_valid.assign(scene.actor.mesh.faces.rows(), 1);
  scene.actor.weights = MatrixRM::Ones(count, 1);
  scene.segmentation.sigma = Eigen::VectorXd::Zero(count);
  scene.segmentation.clothness = Eigen::VectorXd::Zero(count);
  scene.segmentation.region = Eigen::VectorXi::Constant(count, -1);
  scene.segmentation.region_count = skirts;
  Eigen::Index first = 0;
  for (int i = 0; i < skirts; ++i) {
    first += parts[2 * i].vertices.rows();
    scene.segmentation.clothness.segment(first, rings * segments).setOnes();
    scene.segmentation.region.segment(first, rings * segments).setConstant(i);
    first += parts[2 * i + 1].vertices.rows();
  }
}

inline void make_motion(Scene &scene, int frames) {
  const int dofs = scene.actor.skeleton.dof_count();
  scene.performance.dofs = MatrixRM::Zero(frames, dofs);
  for (int t = 0; t < frames; ++t) {
    const double s = t * kDt;
    scene.performance.dofs(t, 0) = 0.15 * std::sin(6 * s);      // sideways, m
    scene.performance.dofs(t, 3) = 1.2 * (1 - std::cos(4 * s)); // turning, rad
    scene.performance.frames.push_back(t);
    scene.performance.joints.push_back(Vertices::Zero(1, 3));
  }
}

/// Pixels of the mask with a neighbour outside it.
inline std::vector<Eigen::Vector2f> mask_contour(const FaceBuffer &buffer) {
  std::vector<Eigen::Vector2f> contour;
  for (int y = 1; y + 1 < buffer.height; ++y)
    for (int x = 1; x + 1 < buffer.width; ++x)
      if (buffer.face_at(x, y) >= 0 && (buffer.face_at(x - 1, y) < 0 || buffer.face_at(x + 1, y) < 0 ||
                                        buffer.face_at(x, y - 1) < 0 || buffer.face_at(x, y + 1) < 0))
        contour.emplace_back(static_cast<float>(x), static_cast<float>(y));
  return contour;
}

/// Centres of every so many faces, seen in both frames, wherever they are on the character.
inline std::vector<FeatureMatch> exact_matches(const Faces &faces, int every, const Camera &camera, const Vertices &before,
                                               const Vertices &now, const FaceBuffer &buffer_before,
                                               const FaceBuffer &buffer_now) {
  const auto visible = [&](const Vertices &v, const FaceBuffer &b, int f, Eigen::Vector2d &pixel) {
    const Eigen::Vector3d centre = (v.row(faces(f, 0)) + v.row(faces(f, 1)) + v.row(faces(f, 2))).transpose() / 3;
    pixel = camera.project(centre);
    const int x = static_cast<int>(std::lround(pixel.x())), y = static_cast<int>(std::lround(pixel.y()));
    return x >= 0 && y >= 0 && x < b.width && y < b.height && b.face_at(x, y) == f;
  };
  std::vector<FeatureMatch> matches;
  for (int f = 0; f < faces.rows(); f += every) {
    Eigen::Vector2d p, q;
    if (visible(before, buffer_before, f, p) && visible(now, buffer_now, f, q))
      matches.push_back({p.cast<float>(), q.cast<float>()});
  }
  return matches;
}

inline void film(Scene &scene, const CameraRig &cameras, int faces_a_feature) {
  scene.observations.cameras = cameras;
  scene.observations.frames = scene.performance.frames;
  const auto &frames = scene.frames;
  const Faces &faces = scene.actor.mesh.faces;
  scene.observations.views.assign(frames.size(), std::vector<ViewObservation>(cameras.size()));
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    FaceBuffer before;
    for (std::size_t t = 0; t < frames.size(); ++t) {
      FaceBuffer now = rasterize(frames[t], faces, cameras[c]);
      ViewObservation &view = scene.observations.views[t][c];
      view.contour = mask_contour(now);
      if (t > 0)
        view.matches = exact_matches(faces, faces_a_feature, cameras[c], frames[t - 1], frames[t], before, now);
      before = std::move(now);
    }
  }
}

struct SceneSize {
  int frames = 32, cameras = 4, pixels = 320;
  int rings = 10, segments = 24; ///< of a skirt
  bool self_collision = false;   ///< slower
  int faces_a_feature = 3;
};

/// The scene under `truth`, one material a skirt.
inline std::unique_ptr<Scene> make_scene(const std::vector<pbd::Material> &truth, const SceneSize &size = {}) {
  auto scene = std::make_unique<Scene>();
  make_character(*scene, static_cast<int>(truth.size()), size.rings, size.segments);
  make_motion(*scene, size.frames);
  pbd::ClothOptions options = pbd::ClothOptions::paper();
  options.self_collision = size.self_collision;
  scene->simulator = std::make_unique<CharacterSimulator>(scene->actor, scene->segmentation, scene->proxies, options);
  scene->performance.surface.faces = scene->actor.mesh.faces;
  // Captured without error, but for the first frame: there the truth and the estimator both start from rest.
  scene->performance.surface.frames.assign(1, scene->actor.mesh.vertices);
  scene->frames = simulate_reference(*scene->simulator, scene->performance, truth, kDt);
  scene->performance.surface.frames = scene->frames;
  scene->performance.surface.frames[0] = scene->actor.mesh.vertices;
  film(*scene, camera_ring(size.cameras, size.pixels), size.faces_a_feature);
  return scene;
}

inline pbd::Material cotton() {
  pbd::Material material;
  material.d_n = 4.0, material.d_t = 4.9, material.k_bend = 0.3, material.k_stretch = 0.999, material.k_friction = 0.5;
  return material;
}

} // namespace doublet::testing
