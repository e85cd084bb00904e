#include "doublet/fit/material_estimator.h"

#include "doublet/core/error.h"
#include "doublet/fit/garment_trial.h"
#include "doublet/options/options.h"
#include "optimizer_checks.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

namespace doublet {
namespace {

constexpr int kFramesPerReport = 8;
constexpr double kSmallestStep = 1e-6; // of annealing, which needs one
constexpr double kWellSearched = 0.1;  // of the box: a deviation below it is a parameter that was found
constexpr double kDisputed = 0.1;      // of the box: searches whose answers are spread by more disagree
constexpr double kAtBound = 0.01;      // of the box: closer to its bound is at it

CmaEsOptions cma_options(const FitOptions &options, std::uint64_t seed) {
  CmaEsOptions cma;
  cma.population = options.population;
  cma.initial_sigma = options.initial_sigma;
  cma.max_evaluations = options.max_evaluations;
  cma.smallest_deviation = options.smallest_deviation;
  cma.stagnation = options.stagnation;
  cma.seed = seed;
  if (options.first_samples > 0)
    cma.first = trial_samples(options.space, options.first_samples, static_cast<int>(seed - options.seed));
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

/// The objective whose samples are raced against those of the same call.
class Raced : public Objective {
public:
  Raced(const MaterialObjective &objective, double margin) : objective_(objective), margin_(margin) {}
  int parameter_count() const override { return objective_.parameter_count(); }
  int part_count() const override { return objective_.part_count(); }
  MatrixRM evaluate(const MatrixRM &samples, const Context &context) override {
    return objective_.race(samples, margin_, context);
  }

private:
  const MaterialObjective &objective_;
  double margin_;
};

/// Searches from several seeds at once, so that their samples fill the lanes: part k R + r is search k of region r.
class Searches : public Objective {
public:
  Searches(Raced &objective, const FitOptions &options)
      : objective_(objective), count_(options.seeds), apart_(options.stop_margin > 0) {}
  int parameter_count() const override { return objective_.parameter_count(); }
  int part_count() const override { return count_ * regions(); }
  int regions() const { return objective_.part_count(); }
  int count() const { return count_; }
  int part(int search, int region) const { return search * regions() + region; }

  MatrixRM evaluate(const MatrixRM &samples, const Context &context) override {
    const Eigen::Index rows = samples.rows(), width = static_cast<Eigen::Index>(regions()) * parameter_count();
    MatrixRM energies(rows, part_count());
    if (apart_) { // samples are compared with those of their own search alone
      for (int k = 0; k < count_; ++k)
        energies.middleCols(part(k, 0), regions()) = objective_.evaluate(samples.middleCols(k * width, width), context);
      return energies;
    }
    MatrixRM all(count_ * rows, width);
    for (int k = 0; k < count_; ++k)
      all.middleRows(k * rows, rows) = samples.middleCols(k * width, width);
    const MatrixRM found = objective_.evaluate(all, context);
    for (int k = 0; k < count_; ++k)
      energies.middleCols(part(k, 0), regions()) = found.middleRows(k * rows, rows);
    return energies;
  }

private:
  Raced &objective_;
  int count_;
  bool apart_;
};

Eigen::VectorXd in_box(const Eigen::VectorXd &unit) {
  return unit.cwiseMax(0.0).cwiseMin(1.0);
}

/// What search `k` has found of region `r`, without any energy; evaluations are those of all searches.
RegionFit region_fit(const MinimiseResult &found, const Searches &searches, int k, int r, const ParameterSpace &space) {
  const OptimizerResult &part = found.parts[searches.part(k, r)];
  RegionFit region;
  region.deviations = part.deviations;
  region.stop_reason = part.stop_reason;
  for (int other = 0; other < searches.count(); ++other) {
    region.evaluations += found.parts[searches.part(other, r)].evaluations;
    region.generations += found.parts[searches.part(other, r)].generations;
  }
  region.best = space.material(part.best);
  return region;
}

/// The rows of one search of every region.
std::vector<GenerationRow> log_of(const MinimiseResult &found, const Searches &searches, const std::vector<int> &chosen) {
  std::vector<GenerationRow> result;
  for (GenerationRow row : found.log) {
    const int r = row.part % searches.regions();
    if (row.part != searches.part(chosen[r], r))
      continue;
    row.part = r;
    result.push_back(row);
  }
  std::stable_sort(result.begin(), result.end(), [](const GenerationRow &a, const GenerationRow &b) {
    return std::pair(a.generation, a.part) < std::pair(b.generation, b.part);
  });
  return result;
}

int lowest(const std::vector<double> &energies) {
  return static_cast<int>(std::min_element(energies.begin(), energies.end()) - energies.begin());
}

/// The best so far, while the search goes on.
FitResult interrupted(FitResult result, const MinimiseResult &found, const Searches &searches, const FitOptions &options) {
  result.interrupted = true;
  result.seconds = found.seconds;
  std::vector<int> chosen;
  for (int r = 0; r < searches.regions(); ++r) {
    std::vector<double> energies; // of the best samples, which were told with the penalty, see minimise()
    for (int k = 0; k < searches.count(); ++k) {
      const int p = searches.part(k, r);
      const Eigen::VectorXd &best = found.parts[p].best;
      energies.push_back(found.parts[p].best_energy - found.penalties[p] * (best - in_box(best)).squaredNorm());
    }
    chosen.push_back(lowest(energies));
    RegionFit region = region_fit(found, searches, chosen[r], r, options.space);
    region.energy = region.best_energy = energies[chosen[r]];
    region.material = region.best;
    region.answer = in_box(found.parts[searches.part(chosen[r], r)].best);
    result.regions.push_back(region);
  }
  result.log = log_of(found, searches, chosen);
  return result;
}

/// What a search depends on: every option but those that matter after it. The budget is no part of it, for a search goes on with
/// a larger one; only annealing's schedule depends on it.
std::string problem_of(const FitOptions &options, const MaterialObjective &objective) {
  const auto counts = [&](const std::string &name) {
    for (const char *other :
         {"answer_generations", "answer_best", "influence", "space.", "energy."}) // two are in the fingerprint
      if (name.rfind(other, 0) == 0)
        return false;
    return name != "max_evaluations" || options.optimizer == "annealing";
  };
  std::string problem = objective.fingerprint();
  for (const auto &[name, value] : options::listed(options))
    if (counts(name))
      problem += " " + name + " " + value;
  return problem + (options.make_optimizer ? " own optimiser" : "");
}

MinimiseOptions minimise_options(const FitOptions &options, const MaterialObjective &objective, const Searches &searches,
                                 const FitResult &frame) {
  MinimiseOptions result;
  result.seed = options.seed;
  result.penalty = options.penalty;
  result.relative_penalty = options.relative_penalty;
  result.expected_evaluations = options.max_evaluations;
  result.budget = options.max_evaluations;
  result.checkpoint = options.checkpoint;
  result.make_optimizer = optimizer_factory(options);
  result.problem = problem_of(options, objective);
  result.on_generation = [&options, &searches, &frame](const MinimiseResult &found) {
    const FitResult so_far = interrupted(frame, found, searches, options);
    if (!options.log.empty())
      write_fit_log(options.log, so_far.log, options.space);
    if (options.on_generation)
      options.on_generation(so_far);
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

/// [count] (n) means of the last generations of a part, the last one first; the oldest again where the search was shorter.
std::vector<Eigen::VectorXd> last_means(const MinimiseResult &found, int part, int count) {
  std::vector<Eigen::VectorXd> means;
  for (auto row = found.log.rbegin(); row != found.log.rend() && static_cast<int>(means.size()) < count; ++row)
    if (row->part == part)
      means.push_back(row->mean);
  if (!means.empty())
    means.resize(static_cast<std::size_t>(count), means.back());
  return means;
}

/// What one of the searches may answer about a region: candidates (K, n), box units, and their E_fit.
struct Answers {
  MatrixRM candidates;
  Eigen::VectorXd energies;
  int chosen() const { return lowest({energies.begin(), energies.end()}); }
  Eigen::VectorXd answer() const { return candidates.row(chosen()).transpose(); }
  double energy() const { return energies[chosen()]; }
};

/// What is known about a region once the searches are over.
struct Finals {
  double centre = 0;                 ///< E_fit of the box's centre
  std::vector<Answers> means, bests; ///< [searches]
};

/// [regions], all energies in one go.
std::vector<Finals> final_energies(const MaterialObjective &objective, const Searches &searches, const MinimiseResult &found,
                                   int generations, const Context &context) {
  const ParameterSpace &space = objective.space();
  const int count = searches.count(), regions = searches.regions();
  std::vector<Finals> result(regions);
  std::vector<std::vector<pbd::Material>> materials(1 + count * (generations + 1));
  for (int r = 0; r < regions; ++r) {
    int next = 0;
    materials[next++].push_back(space.material(Eigen::VectorXd::Constant(space.size(), 0.5)));
    for (int k = 0; k < count; ++k) {
      const int part = searches.part(k, r);
      Answers means{MatrixRM(generations, space.size()), {}}, best{MatrixRM(1, space.size()), {}};
      const std::vector<Eigen::VectorXd> last = last_means(found, part, generations);
      for (int g = 0; g < generations; ++g)
        means.candidates.row(g) = in_box(last[g]);
      best.candidates.row(0) = in_box(found.parts[part].best);
      for (const Answers *answers : {&means, &best})
        for (const auto &candidate : answers->candidates.rowwise())
          materials[next++].push_back(space.material(candidate.transpose()));
      result[r].means.push_back(std::move(means));
      result[r].bests.push_back(std::move(best));
    }
  }
  const MatrixRM energies = objective.energies(materials, context);
  for (int r = 0; r < regions; ++r) {
    Eigen::Index next = 0;
    result[r].centre = energies(next++, r);
    for (int k = 0; k < count; ++k)
      for (Answers *answers : {&result[r].means[k], &result[r].bests[k]}) {
        answers->energies = energies.col(r).segment(next, answers->candidates.rows());
        next += answers->candidates.rows();
      }
  }
  return result;
}

/// Index of the search of the lowest energy.
int lowest_of(const std::vector<Answers> &searches) {
  std::vector<double> energies;
  for (const Answers &answers : searches)
    energies.push_back(answers.energy());
  return lowest(energies);
}

/// The answer of the search of lowest energy. chosen: which.
RegionFit final_region(const MinimiseResult &found, const Searches &searches, int r, const Finals &finals,
                       const FitOptions &options, int &chosen) {
  const std::vector<Answers> &answers = options.answer_best ? finals.bests : finals.means;
  chosen = lowest_of(answers);
  RegionFit region = region_fit(found, searches, chosen, r, options.space);
  region.answer = answers[chosen].answer();
  region.material = options.space.material(region.answer);
  region.energy = answers[chosen].energy();
  region.energy_at_centre = finals.centre;
  const Answers &best = finals.bests[lowest_of(finals.bests)];
  region.best = options.space.material(best.answer());
  region.best_energy = best.energy();
  if (answers.size() > 1) {
    MatrixRM all(answers.size(), options.space.size());
    for (std::size_t k = 0; k < answers.size(); ++k)
      all.row(static_cast<Eigen::Index>(k)) = answers[k].answer().transpose();
    region.spread = (all.colwise().maxCoeff() - all.colwise().minCoeff()).transpose() / 2;
  }
  return region;
}

void say_remarks(const FitResult &result, const Context &context) {
  for (std::size_t r = 0; r < result.regions.size(); ++r)
    for (const std::string &remark : result.regions[r].remarks(result.parameters))
      context.say("fit: region " + std::to_string(r) + ": " + remark);
}

const pbd::MaterialParameter &parameter_named(const std::string &name) {
  for (const pbd::MaterialParameter &parameter : pbd::material_parameters())
    if (name == parameter.name)
      return parameter;
  throw std::invalid_argument("remarks: names: expected parameters of a material, found '" + name + "'");
}

/// Put on in the rest pose, where cloth has a rest shape, else as captured. first: the first pose
CharacterState cloth_at_first_pose(const CharacterSimulator &simulator, const ReferencePerformance &performance,
                                   const std::vector<pbd::Material> &materials, double dt, PosedFrame &first) {
  const Eigen::VectorXd dofs = performance.dofs.row(0).transpose();
  if (!simulator.has_rest_shape()) {
    first = simulator.pose(dofs);
    return simulator.start(first, &performance.surface.frames[0]);
  }
  std::vector<PosedFrame> way;
  for (const Eigen::VectorXd &pose : way_in(simulator.actor().skeleton, dofs, dt))
    way.push_back(simulator.pose(pose));
  first = way.back();
  World world;
  world.dt = dt;
  return simulator.put_on(way, materials, world);
}

} // namespace

const char *confidence_name(Confidence confidence) {
  return confidence == Confidence::kLow ? "low" : confidence == Confidence::kMedium ? "medium" : "high";
}

std::vector<Confidence> RegionFit::confidence() const {
  std::vector<Confidence> result;
  for (int i = 0; i < influence.change.size(); ++i) {
    const bool found = deviations[i] < kWellSearched;
    const bool disputed = spread.size() > 0 && spread[i] > kDisputed;
    result.push_back(!influence.exceeds_noise(i) || (!found && disputed) ? Confidence::kLow
                     : found && !disputed                                ? Confidence::kHigh
                                                                         : Confidence::kMedium);
  }
  return result;
}

std::vector<std::string> RegionFit::remarks(const std::vector<std::string> &names) const {
  std::vector<std::string> result;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    const pbd::MaterialParameter &parameter = parameter_named(names[k]);
    const std::string value = names[k] + " = " + options::shown(material.*parameter.value, 3);
    const bool low = i < answer.size() && answer[i] <= kAtBound, high = i < answer.size() && answer[i] >= 1 - kAtBound;
    if (low || high)
      result.push_back(value + " lies at the " + (low ? "lower" : "upper") + " bound of its box, " +
                       options::shown(low ? parameter.lower : parameter.upper, 3) + ": the search would go further if it could.");
    if (i < influence.change.size() && !influence.exceeds_noise(static_cast<int>(i)))
      result.push_back(value + " is a guess: the motion does not tell it (moved alone it changes the energy by " +
                       options::shown(influence.change[i], 3) + " pixels^2; " +
                       options::shown(Influence::kBeyondNoise * influence.noise, 3) + " would be beyond noise).");
    if (i < spread.size() && spread[i] > kDisputed)
      result.push_back(value + " depends on the seed: the answers of the searches span " + options::shown(2 * spread[i], 3) +
                       " of its box.");
  }
  return result;
}

void FitOptions::validate() const {
  options::check(*this);
  require(first_samples == 0 || first_samples >= 4,
          "FitOptions: first_samples: expected 0 or at least 4, found " + std::to_string(first_samples));
  cma_options(*this, seed).validate();
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
  result.solver = {options.energy.dt, simulator.options()};
  if (simulator.regions().empty()) {
    context.say("fit: no cloth, so there is no material to estimate");
    if (!options.log.empty())
      write_fit_log(options.log, {}, options.space);
    return result;
  }
  if (!has_matches(observations))
    context.say("fit: no feature matches: E_fit is the silhouettes' term alone");
  const MaterialObjective objective(simulator, performance, observations, options.energy, options.space, context);
  Raced raced(objective, options.stop_margin);
  Searches searches(raced, options);
  const FitResult frame = result; // what every interrupted result has
  const MinimiseResult found = minimise(searches, minimise_options(options, objective, searches, frame), context);
  const std::vector<Finals> finals = final_energies(objective, searches, found, options.answer_generations, context);
  result.seconds = found.seconds;
  std::vector<int> chosen(objective.part_count());
  MatrixRM answers(objective.part_count(), objective.parameter_count());
  for (int r = 0; r < objective.part_count(); ++r) {
    result.regions.push_back(final_region(found, searches, r, finals[r], options, chosen[r]));
    const RegionFit &region = result.regions.back();
    answers.row(r) = region.answer;
    if (region.energy > region.best_energy)
      context.say("fit: region " + std::to_string(r) + ": the answer costs " + std::to_string(region.energy) +
                  " pixels^2, the best sample seen " + std::to_string(region.best_energy));
  }
  result.log = log_of(found, searches, chosen);
  if (options.influence) {
    const std::vector<Influence> influences = measure_influence(raced, answers, context);
    for (std::size_t r = 0; r < influences.size(); ++r)
      result.regions[r].influence = influences[r];
  }
  say_remarks(result, context);
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
  require(dt > 0 && std::isfinite(dt), "simulate_reference: dt: expected a positive number, found " + options::shown(dt));
  require(settle_frames >= 0, "simulate_reference: settle_frames: expected at least 0, found " + std::to_string(settle_frames));
  for (const pbd::Material &material : materials)
    pbd::validate(material);
  const int count = static_cast<int>(performance.dofs.rows());
  if (count == 0 || performance.surface.frames.empty()) // the first surface is enough: the cloth begins there
    throw Error("simulate_reference: performance: expected at least one frame, found none");
  require_frames(performance.surface.frames, simulator.actor().mesh.vertices.rows(), "simulate_reference: a frame");
  std::vector<Vertices> result;
  PosedFrame previous;
  CharacterState state = cloth_at_first_pose(simulator, performance, materials, dt, previous);
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
