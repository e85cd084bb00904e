#include "doublet/animate/animator.h"

#include "doublet/animate/parts/arm_penetration.h"
#include "doublet/animate/parts/body_penetration.h"
#include "doublet/core/error.h"
#include "doublet/options/options.h"
#include "motion/require_motion.h"

#include <cmath>

namespace doublet {
namespace {

void advance(Player &player, int t, const Eigen::VectorXd &dofs) {
  try {
    if (t == 0)
      player.reset(dofs);
    else
      player.step(dofs);
  } catch (const Error &error) {
    throw Error("animate: frame " + std::to_string(t) + ": " + error.what());
  }
}

Motion at_character_rate(const Character &character, const Motion &motion) {
  const double fps = 1 / character.solver.dt;
  return std::abs(motion.fps - fps) < 1e-6 * fps ? motion : resample(character.actor.skeleton, motion, fps);
}

} // namespace

Vertices resolve_body_penetration(const Character &character, const Vertices &surface, Vertices body) {
  BodyPenetrationFix(character).apply(surface, body);
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
                                options::to_text(motion.fps) + " 1/s");
  Motion poses = at_character_rate(character, motion);
  if (options.resolve_arm_penetration && has_steps(poses))
    poses = resolve_arm_penetration(character, poses, context);
  else if (options.resolve_arm_penetration)
    context.log_line("animate: arms are not cleared of the body: expected 0.1 to 10000 frames per second, found " +
                     options::to_text(poses.fps));
  const int frames = static_cast<int>(poses.dofs.rows());
  Player player(character, options, make_solver);
  for (int t = 0; t < frames; ++t) {
    context.report_progress("animate", static_cast<double>(t) / frames);
    const Eigen::VectorXd dofs = poses.dofs.row(t);
    advance(player, t, dofs);
    frame(player.frame());
  }
  context.report_progress("animate", 1.0);
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
