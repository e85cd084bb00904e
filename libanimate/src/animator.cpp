#include "doublet/animate/animator.h"

#include "doublet/animate/display_surface.h"
#include "doublet/core/error.h"
#include "doublet/core/skinning.h"
#include "doublet/options/options.h"
#include "doublet/rays/ray_scene.h"

#include <cmath>
#include <optional>

namespace doublet {
namespace {

void require_finite(const Vertices &surface, int frame) {
  if (!surface.allFinite())
    throw Error("animate: the surface of frame " + std::to_string(frame) + " is not finite; expected a stable simulation");
}

Motion at_character_rate(const Character &character, const Motion &motion) {
  const double fps = 1 / character.solver.dt;
  return std::abs(motion.fps - fps) < 1e-6 * fps ? motion : resample(character.actor.skeleton, motion, fps);
}

} // namespace

Vertices tuck_body(const Character &character, const Vertices &surface, Vertices body) {
  // m; deeper under cloth, because the body's triangles are flat where the cloth folds inward between their corners
  constexpr double kDeepUnderSkin = 0.003, kDeepUnderCloth = 0.010, kReachUnderSkin = 0.012, kReachUnderCloth = 0.06;
  const Faces &faces = character.actor.mesh.faces;
  const Eigen::VectorXd &delta = character.segmentation.clothness;
  const RayScene scene({surface, faces}, character.actor.face_valid);
  const Vertices normals = vertex_normals(surface, faces);
  std::vector<std::uint8_t> drawn(body.rows(), 0);
  for (Eigen::Index f = 0; f < character.body.faces.rows(); ++f)
    for (int k = 0; k < 3 && character.body_shown[f]; ++k)
      drawn[character.body.faces(f, k)] = 1;
  for (Eigen::Index v = 0; v < body.rows(); ++v) {
    if (!drawn[v])
      continue;
    const Eigen::Vector3d p = body.row(v);
    const ClosestPoint at = scene.closest(p);
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    double cloth = 0;
    for (int k = 0; k < 3; ++k) {
      normal += at.barycentric[k] * normals.row(faces(at.face, k)).transpose();
      cloth += at.barycentric[k] * delta[faces(at.face, k)];
    }
    const double out = (p - at.point).dot(normal);
    const double deep = kDeepUnderSkin + cloth * (kDeepUnderCloth - kDeepUnderSkin);
    if (normal.norm() > 0.1 && out > -deep && at.distance < (cloth > 0 ? kReachUnderCloth : kReachUnderSkin))
      body.row(v) = at.point - deep * normal.normalized();
  }
  return body;
}

int animate(const Character &character, const Motion &motion, const AnimateOptions &options,
            const std::function<void(const AnimationFrame &)> &frame, const Context &context,
            const pbd::ClothSolverFactory &make_solver) {
  options.validate();
  validate_character(character);
  if (motion.dofs.rows() == 0 || motion.dofs.cols() != character.actor.skeleton.dof_count() || !motion.dofs.allFinite() ||
      !(motion.fps > 0))
    throw std::invalid_argument("animate: motion must have finite poses of " +
                                std::to_string(character.actor.skeleton.dof_count()) + " degrees of freedom and a rate, found (" +
                                std::to_string(motion.dofs.rows()) + ", " + std::to_string(motion.dofs.cols()) + ") at " +
                                options::shown(motion.fps) + " 1/s");
  const Motion poses = at_character_rate(character, motion);
  const CharacterSimulator simulator(character.actor, character.segmentation, character.proxies, character.solver.cloth,
                                     make_solver);
  std::optional<DisplaySurface> display;
  if (options.high && character.high.faces.rows() > 0)
    display.emplace(character);
  const bool body = options.body && character.body.faces.rows() > 0;

  const double dt = character.solver.dt;
  const int frames = static_cast<int>(poses.dofs.rows());
  PosedFrame posed = simulator.pose(poses.dofs.row(0));
  CharacterState state = simulator.start(posed);
  simulator.settle(state, posed, character.materials, dt, static_cast<int>(std::lround(options.settle_seconds / dt)));
  for (int t = 0; t < frames; ++t) {
    context.report("animate", static_cast<double>(t) / frames);
    if (t > 0) {
      PosedFrame next = simulator.pose(poses.dofs.row(t));
      simulator.step(state, posed, next, character.materials, dt);
      posed = std::move(next);
    }
    AnimationFrame out;
    out.index = t;
    out.dofs = poses.dofs.row(t);
    out.surface = simulator.surface(state, posed);
    require_finite(out.surface, t);
    out.joints = joint_positions(character.actor.skeleton, posed.world_from_rest);
    if (display)
      out.high = display->apply(out.surface);
    if (body)
      out.body = dual_quaternion_skinning(character.body.vertices, character.body_weights, posed.world_from_rest);
    if (body && options.tuck_body)
      out.body = tuck_body(character, out.surface, std::move(out.body));
    out.world_from_rest = posed.world_from_rest;
    frame(out);
  }
  context.report("animate", 1.0);
  return frames;
}

AnimationResult animate(const Character &character, const Motion &motion, const AnimateOptions &options, const Context &context,
                        const pbd::ClothSolverFactory &make_solver) {
  AnimationResult result;
  result.fps = 1 / character.solver.dt;
  std::vector<Eigen::VectorXd> dofs;
  animate(
      character, motion, options,
      [&](const AnimationFrame &frame) {
        dofs.push_back(frame.dofs);
        result.surface.push_back(frame.surface);
        result.joints.push_back(frame.joints);
        if (frame.high.rows() > 0)
          result.high.push_back(frame.high);
        if (frame.body.rows() > 0)
          result.body.push_back(frame.body);
      },
      context, make_solver);
  result.dofs.resize(dofs.size(), dofs[0].size());
  for (std::size_t t = 0; t < dofs.size(); ++t)
    result.dofs.row(t) = dofs[t];
  return result;
}

} // namespace doublet
