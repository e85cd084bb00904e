#include "doublet/fit/material_estimator.h"

#include "doublet/core/error.h"
#include "optimizer_checks.h"

#include <cmath>

namespace doublet {
namespace {

constexpr int kFramesPerReport = 8;
constexpr double kSmallestStep = 1e-6; // of annealing, which needs one
constexpr double kWellSearched = 0.1;  // of the box: a deviation below it is a parameter that was found

CmaEsOptions cma_options(const FitOptions &options, std::uint64_t seed) {
  CmaEsOptions cma;
  cma.population = options.population;
  cma.initial_sigma = options.initial_sigma;
  cma.max_evaluations = options.max_evaluations;
  cma.smallest_deviation = options.smallest_deviation;
  cma.seed = seed;
  return cma;
}

AnnealingOptions annealing_options(const FitOptions &options, std::uint64_t seed) {
  AnnealingOptions annealing;
  if (options.population > 0)
    annealing.chains = options.population;
  annealing.max_evaluations = options.max_evaluations;
  annealing.initial_step = options.initial_sigma;
  annealing.final_step = std::max(options.smallest_deviation, kSmallestStep);
  annealing.seed = seed;
  return annealing;
}

OptimizerFactory optimizer_factory(const FitOptions &options) {
  if (options.make_optimizer)
    return options.make_optimizer;
  if (options.optimizer == "annealing")
    return [options](int n, std::uint64_t seed) { return create_simulated_annealing(n, annealing_options(options, seed)); };
  return [options](int n, std::uint64_t seed) { return create_cma_es(n, cma_options(options, seed)); };
}

RegionFit region_fit(const OptimizerResult &part, const ParameterSpace &space) {
  RegionFit region;
  region.best = space.material(part.best);
  region.best_energy = part.best_energy;
  region.deviations = part.deviations;
  region.evaluations = part.evaluations;
  region.generations = part.generations;
  region.stop_reason = part.stop_reason;
  return region;
}

/// The best so far, while the search goes on.
FitResult interrupted(FitResult result, const MinimiseResult &found, const FitOptions &options) {
  result.interrupted = true;
  result.log = found.log;
  result.seconds = found.seconds;
  for (std::size_t r = 0; r < found.parts.size(); ++r) {
    const OptimizerResult &part = found.parts[r];
    RegionFit region = region_fit(part, options.space);
    const Eigen::VectorXd inside = part.best.cwiseMax(0.0).cwiseMin(1.0);
    region.best_energy -= found.penalties[r] * (part.best - inside).squaredNorm(); // told with it, see minimise()
    region.material = region.best;
    region.energy = region.best_energy;
    result.regions.push_back(region);
  }
  return result;
}

MinimiseOptions minimise_options(const FitOptions &options, const MaterialObjective &objective, const FitResult &frame) {
  MinimiseOptions result;
  result.seed = options.seed;
  result.penalty = options.penalty;
  result.relative_penalty = options.relative_penalty;
  result.expected_evaluations = options.max_evaluations;
  result.checkpoint = options.checkpoint;
  result.make_optimizer = optimizer_factory(options);
  result.problem = objective.fingerprint() + " seed " + std::to_string(options.seed) + " evaluations " +
                   std::to_string(options.max_evaluations) + " population " + std::to_string(options.population) + " sigma " +
                   std::to_string(options.initial_sigma) + " " + std::to_string(options.smallest_deviation) + " penalty " +
                   std::to_string(options.penalty) + (options.relative_penalty ? " relative " : " absolute ") +
                   (options.make_optimizer ? "own optimiser" : options.optimizer);
  result.on_generation = [&options, &frame](const MinimiseResult &found) {
    if (!options.log.empty())
      write_fit_log(options.log, found.log, options.space);
    if (options.on_generation)
      options.on_generation(interrupted(frame, found, options));
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

const char *confidence_name(Confidence confidence) {
  return confidence == Confidence::kLow ? "low" : confidence == Confidence::kMedium ? "medium" : "high";
}

std::vector<Confidence> RegionFit::confidence() const {
  std::vector<Confidence> result;
  for (int i = 0; i < influence.change.size(); ++i)
    result.push_back(!influence.told(i)              ? Confidence::kLow
                     : deviations[i] < kWellSearched ? Confidence::kHigh
                                                     : Confidence::kMedium);
  return result;
}

void FitOptions::validate() const {
  require(optimizer == "cma-es" || optimizer == "annealing",
          "FitOptions: optimizer: expected 'cma-es' or 'annealing', found '" + optimizer + "'");
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
  const FitResult frame = result; // what every interrupted result has
  const MinimiseResult found = minimise(objective, minimise_options(options, objective, frame), context);
  const MatrixRM energies = final_energies(objective, found, context);
  result.log = found.log;
  result.seconds = found.seconds;
  MatrixRM answers(objective.part_count(), objective.parameter_count());
  for (int r = 0; r < objective.part_count(); ++r) {
    const OptimizerResult &part = found.parts[r];
    RegionFit region = region_fit(part, options.space);
    region.best_energy = energies(2, r);
    region.material = options.answer_best ? region.best : options.space.material(part.answer);
    region.energy = options.answer_best ? energies(2, r) : energies(1, r);
    region.energy_at_centre = energies(0, r);
    answers.row(r) = (options.answer_best ? part.best : part.answer).cwiseMax(0.0).cwiseMin(1.0);
    if (region.energy > region.best_energy)
      context.say("fit: region " + std::to_string(r) + ": the answer costs " + std::to_string(region.energy) +
                  " pixels^2, the best sample seen " + std::to_string(region.best_energy));
    result.regions.push_back(region);
  }
  if (options.influence) {
    const std::vector<Influence> influences = measure_influence(objective, answers, context);
    for (std::size_t r = 0; r < influences.size(); ++r)
      result.regions[r].influence = influences[r];
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
