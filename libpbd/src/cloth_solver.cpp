// What every solver shares: the checks before and after a step.

#include "doublet/pbd/cloth_solver.h"

#include "doublet/options/options.h"

#include <algorithm>
#include <stdexcept>

namespace doublet::pbd {
namespace {

[[noreturn]] void refuse_step(const std::string &what) {
  throw std::invalid_argument("cloth step: " + what);
}

void check_vertices(VerticesView m, int n, const char *name) {
  if (m.rows() != n)
    refuse_step(std::string(name) + " must have " + std::to_string(n) + " rows, found " + std::to_string(m.rows()));
  if (!((0 * m.map().array()).sum() == 0)) // one that is not finite makes it not a number
    refuse_step(std::string(name) + " holds a value that is not finite");
}

void check_state(const ClothModel &model, const ClothState &state) {
  check_vertices(state.positions, model.vertex_count(), "state.positions");
  check_vertices(state.velocities, model.vertex_count(), "state.velocities");
}

void check_inputs(const ClothModel &model, const StepInputs &in) {
  const int n = model.vertex_count();
  if (in.targets.empty() && (model.clothness().array() < 1).any())
    refuse_step("targets are missing, and the model has vertices that follow them");
  if (!in.targets.empty())
    check_vertices(in.targets, n, "targets");
  if (!in.previous_targets.empty())
    check_vertices(in.previous_targets, n, "previous_targets");
  if (!(in.dt > 0 && in.dt <= 1))
    refuse_step("dt must lie in (0, 1] s, found " + options::to_text(in.dt));
  if (!in.wind.allFinite())
    refuse_step("wind is not finite");
  if (in.gravity && !(in.gravity->allFinite() && in.gravity->cwiseAbs().maxCoeff() <= 1000))
    refuse_step("gravity must lie within 1000 m/s^2, found (" + options::to_text(in.gravity->x()) + ", " +
                options::to_text(in.gravity->y()) + ", " + options::to_text(in.gravity->z()) + ")");
  if (!in.previous_capsules.empty() && in.capsules.size() != in.previous_capsules.size())
    refuse_step("capsules and previous_capsules must be equally many, found " + std::to_string(in.capsules.size()) + " and " +
                std::to_string(in.previous_capsules.size()));
  for (const std::span<const Capsule> list : {in.capsules, in.previous_capsules})
    for (size_t i = 0; i < list.size(); ++i) {
      const Capsule &c = list[i];
      if (!c.p0.allFinite() || !c.p1.allFinite() || !(c.r0 >= 0 && c.r0 < 1e3) || !(c.r1 >= 0 && c.r1 < 1e3))
        refuse_step("capsule " + std::to_string(i) + " must have finite ends and radii in [0, 1000) m, found radii " +
                    options::to_text(c.r0) + " and " + options::to_text(c.r1));
    }
  if (in.substeps < 0 || in.substeps > 1000)
    refuse_step("substeps must lie in [0, 1000], found " + std::to_string(in.substeps));
}

/// What the lanes of one register do together.
void check_together(const StepInputs &in, const StepInputs &first) {
  if (in.capsules.size() != first.capsules.size())
    refuse_step("inputs of one call must have equally many capsules, found " + std::to_string(first.capsules.size()) + " and " +
                std::to_string(in.capsules.size()));
  if (in.substeps != first.substeps)
    refuse_step("inputs of one call must have equally many substeps, found " + std::to_string(first.substeps) + " and " +
                std::to_string(in.substeps));
}

void check_counts(size_t states, size_t inputs, size_t materials) {
  if (states != materials || (inputs != states && inputs != 1))
    refuse_step("states, inputs (or one for all) and materials must be equally many, found " + std::to_string(states) + ", " +
                std::to_string(inputs) + " and " + std::to_string(materials));
}

/// The word that advance() gave.
void check_outcome(int vertices, std::span<const ClothState> states, const std::vector<int> &failed) {
  for (size_t i = 0; i < states.size(); ++i)
    if (states[i].positions.rows() != vertices || states[i].velocities.rows() != vertices)
      throw std::logic_error("cloth step: the solver left simulation " + std::to_string(i) + " with " +
                             std::to_string(states[i].positions.rows()) + " positions and " +
                             std::to_string(states[i].velocities.rows()) + " velocities, expected " + std::to_string(vertices));
  for (size_t k = 0; k < failed.size(); ++k)
    if (failed[k] < 0 || failed[k] >= static_cast<int>(states.size()) || (k > 0 && failed[k] <= failed[k - 1]))
      throw std::logic_error("cloth step: the solver must return ascending indices of " + std::to_string(states.size()) +
                             " simulations, found " + std::to_string(failed[k]));
}

} // namespace

ClothSolver::ClothSolver(std::shared_ptr<const ClothModel> model) : model_(std::move(model)) {
  if (!model_)
    throw std::invalid_argument("ClothSolver: expected a model, found none");
}

std::vector<int> ClothSolver::step_batch(std::span<ClothState> states, std::span<const StepInputs> inputs,
                                         std::span<const Material> materials, int threads) const {
  check_counts(states.size(), inputs.size(), materials.size());
  for (const StepInputs &in : inputs) {
    check_inputs(*model_, in);
    check_together(in, inputs[0]);
  }
  for (size_t i = 0; i < states.size(); ++i) {
    validate(materials[i]);
    check_state(*model_, states[i]);
  }
  std::vector<int> failed = advance(states, inputs, materials, threads);
  check_outcome(model_->vertex_count(), states, failed);
  return failed;
}

void ClothSolver::step(ClothState &state, const StepInputs &inputs, const Material &material) const {
  if (!step_batch({&state, 1}, {&inputs, 1}, {&material, 1}).empty())
    throw std::runtime_error("cloth step: it came out with a position or velocity that is not finite");
}

ClothState initial_state(const Vertices &positions) {
  return {positions, Vertices::Zero(positions.rows(), 3)};
}

} // namespace doublet::pbd
