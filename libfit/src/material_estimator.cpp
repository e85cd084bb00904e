#include "doublet/fit/material_estimator.h"

#include "doublet/core/error.h"
#include "optimizer_checks.h"

#include <cmath>

namespace doublet {
namespace {

constexpr int kFramesPerReport = 8;

CmaEsOptions cma_options(const FitOptions &options, std::uint64_t seed) {
  CmaEsOptions cma;
  cma.population = options.population;
  cma.initial_sigma = options.initial_sigma;
  cma.max_evaluations = options.max_evaluations;
  cma.smallest_deviation = options.smallest_deviation;
  cma.seed = seed;
  return cma;
}

MinimiseOptions minimise_options(const FitOptions &options, const MaterialObjective &objective) {
  MinimiseOptions result;
  result.seed = options.seed;
  result.penalty = options.penalty;
  result.expected_evaluations = options.max_evaluations;
  result.checkpoint = options.checkpoint;
  result.make_optimizer = options.make_optimizer;
  if (!result.make_optimizer)
    result.make_optimizer = [options](int n, std::uint64_t seed) { return create_cma_es(n, cma_options(options, seed)); };
  result.problem = objective.fingerprint() + " seed " + std::to_string(options.seed) + " evaluations " +
                   std::to_string(options.max_evaluations) + " population " + std::to_string(options.population) + " sigma " +
                   std::to_string(options.initial_sigma) + " " + std::to_string(options.smallest_deviation) + " penalty " +
                   std::to_string(options.penalty);
  if (!options.log.empty())
    result.on_generation = [log = options.log, space = options.space](const std::vector<GenerationRow> &rows) {
      write_fit_log(log, rows, space);
    };
  return result;
}

bool has_matches(const Observations &observations) {
  for (const auto &views : observations.views)
    for (const ViewObservation &view : views)
      if (!view.matches.empty())
        return true;
  return false;
}

/// E_fit of the centre, the optimiser's answer and its best sample, for all regions at once: (3, R).
MatrixRM final_energies(const MaterialObjective &objective, const MinimiseResult &found, const Context &context) {
  std::vector<std::vector<pbd::Material>> materials(3);
  const ParameterSpace &space = objective.space();
  for (const OptimizerResult &part : found.parts) {
    materials[0].push_back(space.material(Eigen::VectorXd::Constant(space.size(), 0.5)));
    materials[1].push_back(space.material(part.answer));
    materials[2].push_back(space.material(part.best));
  }
  return objective.energies(materials, context);
}

} // namespace

void FitOptions::validate() const {
  cma_options(*this, seed).validate();
  require(penalty >= 0 && std::isfinite(penalty), "FitOptions: penalty: expected at least 0, found " + std::to_string(penalty));
  space.validate();
  energy.validate();
}

std::vector<pbd::Material> FitResult::materials() const {
  std::vector<pbd::Material> result;
  for (const RegionFit &region : regions)
    result.push_back(region.material);
  return result;
}

FitResult estimate_material(const CharacterSimulator &simulator, const ReferencePerformance &performance,
                            const Observations &observations, const FitOptions &options, const Context &context) {
  options.validate();
  FitResult result;
  result.parameters = options.space.names;
  result.seed = options.seed;
  result.dt = options.energy.dt;
  result.iterations = simulator.options().iterations;
  result.substeps = simulator.options().substeps;
  if (simulator.regions().empty()) {
    context.say("fit: no cloth, so there is no material to estimate");
    if (!options.log.empty())
      write_fit_log(options.log, {}, options.space);
    return result;
  }
  if (!has_matches(observations))
    context.say("fit: no feature matches: E_fit is the silhouettes' term alone");
  MaterialObjective objective(simulator, performance, observations, options.energy, options.space, context);
  const MinimiseResult found = minimise(objective, minimise_options(options, objective), context);
  const MatrixRM energies = final_energies(objective, found, context);
  result.log = found.log;
  result.seconds = found.seconds;
  for (std::size_t r = 0; r < found.parts.size(); ++r) {
    const OptimizerResult &part = found.parts[r];
    const auto column = static_cast<Eigen::Index>(r);
    RegionFit region;
    region.best = options.space.material(part.best);
    region.best_energy = energies(2, column);
    region.material = options.answer_best ? region.best : options.space.material(part.answer);
    region.energy = options.answer_best ? energies(2, column) : energies(1, column);
    region.energy_at_centre = energies(0, column);
    region.deviations = part.deviations;
    region.evaluations = part.evaluations;
    region.generations = part.generations;
    region.stop_reason = part.stop_reason;
    if (region.energy > region.best_energy)
      context.say("fit: region " + std::to_string(r) + ": the answer costs " + std::to_string(region.energy) +
                  " pixels^2, the best sample seen " + std::to_string(region.best_energy));
    result.regions.push_back(region);
  }
  return result;
}

std::vector<double> material_energy(const CharacterSimulator &simulator, const ReferencePerformance &performance,
                                    const Observations &observations, const std::vector<pbd::Material> &materials,
                                    const EnergyOptions &options, const Context &context) {
  const MaterialObjective objective(simulator, performance, observations, options, {}, context);
  const MatrixRM energies = objective.energies({materials}, context);
  return {energies.data(), energies.data() + energies.size()};
}

std::vector<Vertices> simulate_reference(const CharacterSimulator &simulator, const ReferencePerformance &performance,
                                         const std::vector<pbd::Material> &materials, double dt, int settle_frames,
                                         const Context &context) {
  require(dt > 0 && std::isfinite(dt), "simulate_reference: dt: expected a positive number, found " + std::to_string(dt));
  require(settle_frames >= 0, "simulate_reference: settle_frames: expected at least 0, found " + std::to_string(settle_frames));
  for (const pbd::Material &material : materials)
    pbd::validate(material);
  const int count = static_cast<int>(performance.dofs.rows());
  if (count == 0 || performance.surface.frames.empty())
    throw Error("simulate_reference: performance: expected at least one frame, found none");
  std::vector<Vertices> result;
  PosedFrame previous = simulator.pose(performance.dofs.row(0).transpose());
  CharacterState state = simulator.start(previous, &performance.surface.frames[0]);
  simulator.settle(state, previous, materials, dt, settle_frames);
  result.push_back(simulator.surface(state, previous));
  for (int t = 1; t < count; ++t) {
    if (t % kFramesPerReport == 0)
      context.report("simulate", t / static_cast<double>(count));
    PosedFrame current = simulator.pose(performance.dofs.row(t).transpose());
    simulator.step(state, previous, current, materials, dt);
    result.push_back(simulator.surface(state, current));
    previous = std::move(current);
  }
  return result;
}

} // namespace doublet
