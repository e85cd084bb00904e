#include "doublet/fit/material_estimator.h"

#include "doublet/core/error.h"
#include "doublet/fit/parts/even_points.h"
#include "doublet/options/options.h"
#include "optimizer_checks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

namespace doublet {
namespace {

constexpr int kFramesPerReport = 8;
constexpr double kSmallestStep = 1e-6; // of annealing, which needs one
constexpr double kFound = 0.25;        // of the box: a 90 % interval below it is a parameter that was found
constexpr double kGuess = 0.5;         // of the box: above it a guess
constexpr double kDisputed = 0.1;      // of the box: searches whose answers are spread by more disagree
constexpr double kAtBound = 0.01;      // of the box: closer to its bound is at it
constexpr int kPerWidth = 16;          // samples of one width, see BayesianOptions
constexpr int kAnswers = 4;            // for an answer: what the optimiser says, and the lowest samples
constexpr int kRepeats = 8;            // of each, whose mean is its energy; all together fill 32 lanes
constexpr int kBeyond = 32;            // samples beyond the ends of the intervals
constexpr double kNowhere = 0.001;     // of the box: far below what any film tells
constexpr double kElsewhere = 0.02;    // of the box, along some axis: another candidate
constexpr const char *kWidth = "width";

/// What is searched: materials, and a width if there is a choice.
struct Searched {
  const ParameterSpace &space;
  int widths;
  int size() const { return space.size() + (widths > 1 ? 1 : 0); }
  pbd::Material material(const Eigen::VectorXd &unit) const { return space.material(unit.head(space.size())); }
  int width(const Eigen::VectorXd &unit) const { return widths > 1 ? width_index(unit[space.size()], widths) : -1; }
};

/// (count, n) spread evenly over the box; three of four do not stretch, as hardly any cloth does, and groups share a width, from
/// the widest to the narrowest.
/// `share`: which `count` of the sequence, so that searches side by side begin with different ones.
MatrixRM initial_design_size(const Searched &searched, int count, int share) {
  MatrixRM samples = even_points(count, searched.size(), share * count);
  const auto &names = searched.space.names;
  const auto stretch = std::find(names.begin(), names.end(), "k_stretch") - names.begin();
  const double last_group = std::max<double>(1, (count - 1) / kPerWidth);
  for (Eigen::Index s = 0; s < count; ++s) {
    if (stretch < searched.space.size() && s % 4 != 3)
      samples(s, stretch) = 1;
    if (searched.widths > 1)
      samples(s, searched.space.size()) =
          static_cast<double>(width_index(static_cast<double>(s / kPerWidth) / last_group, searched.widths)) /
          (searched.widths - 1);
  }
  return samples;
}

CmaEsOptions cma_options(const FitOptions &options, std::uint64_t seed) {
  CmaEsOptions cma;
  cma.population = options.population;
  cma.initial_sigma = options.initial_sigma;
  cma.max_evaluations = options.max_evaluations;
  cma.min_deviation = options.min_deviation;
  cma.stagnation = options.stagnation;
  cma.seed = seed;
  return cma;
}

AnnealingOptions annealing_options(const FitOptions &options, std::uint64_t seed) {
  AnnealingOptions annealing;
  if (options.population > 0)
    annealing.chains = options.population;
  annealing.max_evaluations = options.max_evaluations;
  annealing.initial_step = options.initial_sigma;
  annealing.final_step = std::max(options.min_deviation, kSmallestStep);
  annealing.seed = seed;
  return annealing;
}

BayesianOptions bayesian_options(const FitOptions &options, const Searched &searched, std::uint64_t seed) {
  BayesianOptions bayesian;
  if (options.population > 0)
    bayesian.population = options.population;
  bayesian.max_evaluations = options.max_evaluations;
  bayesian.min_gain = options.min_gain;
  bayesian.min_expected_gain = options.min_expected_gain;
  bayesian.levels = searched.widths > 1 ? searched.widths : 0;
  bayesian.seed = seed;
  constexpr std::uint64_t kShares = 1000; // the sequence is long, not endless
  bayesian.first = initial_design_size(searched, options.initial_design_size, static_cast<int>(seed % kShares));
  return bayesian;
}

OptimizerFactory optimizer_factory(const FitOptions &options, const Searched &searched) {
  if (options.make_optimizer)
    return options.make_optimizer;
  if (options.optimizer == SearchMethod::Annealing)
    return [options](int n, std::uint64_t seed) { return create_simulated_annealing(n, annealing_options(options, seed)); };
  if (options.optimizer == SearchMethod::CmaEs)
    return [options](int n, std::uint64_t seed) { return create_cma_es(n, cma_options(options, seed)); };
  return [options, searched](int n, std::uint64_t seed) { return create_bayesian(n, bayesian_options(options, searched, seed)); };
}

/// The energies of several takes, added.
class AllTakes : public Objective {
public:
  AllTakes(const std::vector<Take> &takes, const FitOptions &options, const Context &context) {
    for (const Take &take : takes) {
      require(take.performance && take.observations,
              "estimate_material: takes: expected performance and observations, found none");
      takes_.push_back(std::make_unique<MaterialObjective>(take.widths, *take.performance, *take.observations, take.dt,
                                                           options.energy, options.space, context));
      require(takes_.back()->part_count() == takes_[0]->part_count() && takes_.back()->width_count() == takes_[0]->width_count(),
              "estimate_material: takes: expected as many cloth regions and widths in all, found " +
                  std::to_string(takes_.back()->part_count()) + " and " + std::to_string(takes_.back()->width_count()) +
                  " beside " + std::to_string(takes_[0]->part_count()) + " and " + std::to_string(takes_[0]->width_count()));
    }
  }
  int parameter_count() const override { return takes_[0]->parameter_count(); }
  int part_count() const override { return takes_[0]->part_count(); }
  MatrixRM evaluate(const MatrixRM &samples, const Context &context) override {
    MatrixRM sum = takes_[0]->evaluate(samples, context);
    for (std::size_t i = 1; i < takes_.size(); ++i)
      sum += takes_[i]->evaluate(samples, context);
    return sum;
  }
  std::string fingerprint() const {
    std::string all;
    for (const auto &take : takes_)
      all += take->fingerprint() + " ";
    return all;
  }

private:
  std::vector<std::unique_ptr<MaterialObjective>> takes_;
};

/// Searches from several seeds at once, so that their samples fill the lanes: part k R + r is search k of region r.
class Searches : public Objective {
public:
  Searches(AllTakes &objective, int count) : objective_(objective), count_(count) {}
  int parameter_count() const override { return objective_.parameter_count(); }
  int part_count() const override { return count_ * regions(); }
  int regions() const { return objective_.part_count(); }
  int count() const { return count_; }
  int part(int search, int region) const { return search * regions() + region; }

  MatrixRM evaluate(const MatrixRM &samples, const Context &context) override {
    const Eigen::Index rows = samples.rows(), width = static_cast<Eigen::Index>(regions()) * parameter_count();
    MatrixRM all(count_ * rows, width), energies(rows, part_count());
    for (int k = 0; k < count_; ++k)
      all.middleRows(k * rows, rows) = samples.middleCols(k * width, width);
    const MatrixRM found = objective_.evaluate(all, context);
    for (int k = 0; k < count_; ++k)
      energies.middleCols(part(k, 0), regions()) = found.middleRows(k * rows, rows);
    return energies;
  }

private:
  AllTakes &objective_;
  int count_;
};

Eigen::VectorXd in_box(const Eigen::VectorXd &unit) {
  return unit.cwiseMax(0.0).cwiseMin(1.0);
}

/// What search `k` has found of region `r`, its best sample for the answer; evaluations are those of all searches.
RegionFit region_fit(const MinimiseResult &found, const Searches &searches, int k, int r, const Searched &searched) {
  const int index = searches.part(k, r);
  const OptimizerResult &part = found.parts[index];
  RegionFit region;
  region.deviations = part.deviations;
  region.stop_reason = part.stop_reason;
  for (int other = 0; other < searches.count(); ++other) {
    region.evaluations += found.parts[searches.part(other, r)].evaluations;
    region.generations += found.parts[searches.part(other, r)].generations;
  }
  Eigen::Index best = 0;
  region.best_energy = found.energies[index].minCoeff(&best);
  region.answer = found.samples[index].row(best).transpose();
  region.best = searched.material(region.answer);
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
FitResult interrupted(FitResult result, const MinimiseResult &found, const Searches &searches, const Searched &searched) {
  result.interrupted = true;
  result.seconds = found.seconds;
  std::vector<int> chosen;
  for (int r = 0; r < searches.regions(); ++r) {
    std::vector<double> energies;
    for (int k = 0; k < searches.count(); ++k)
      energies.push_back(found.energies[searches.part(k, r)].minCoeff());
    chosen.push_back(lowest(energies));
    RegionFit region = region_fit(found, searches, chosen[r], r, searched);
    region.energy = region.best_energy;
    region.material = region.best;
    region.width = searched.width(region.answer);
    result.regions.push_back(region);
  }
  result.log = log_of(found, searches, chosen);
  return result;
}

/// What a search depends on: every option but those that matter after it. The budget is no part of it, for a search goes on with
/// a larger one; only annealing's schedule depends on it.
std::string problem_of(const FitOptions &options, const AllTakes &objective) {
  const auto counts = [&](const std::string &name) {
    for (const char *other : {"space.", "energy."}) // in the fingerprint
      if (name.rfind(other, 0) == 0)
        return false;
    return name != "max_evaluations" || options.optimizer == SearchMethod::Annealing;
  };
  std::string problem = objective.fingerprint();
  for (const auto &[name, value] : options::to_pairs(options))
    if (counts(name))
      problem += " " + name + " " + value;
  return problem + (options.make_optimizer ? " own optimiser" : "");
}

MinimiseOptions minimise_options(const FitOptions &options, const AllTakes &objective, const Searches &searches,
                                 const Searched &searched, const FitResult &frame) {
  MinimiseOptions result;
  result.seed = options.seed;
  result.penalty = options.penalty;
  result.relative_penalty = options.relative_penalty;
  result.expected_evaluations = options.max_evaluations;
  result.budget = options.max_evaluations;
  result.checkpoint = options.checkpoint;
  result.make_optimizer = optimizer_factory(options, searched);
  result.problem = problem_of(options, objective);
  result.on_generation = [&options, &searches, searched, &frame](const MinimiseResult &found) {
    const FitResult so_far = interrupted(frame, found, searches, searched);
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

/// What the optimiser answers, and the lowest samples that are not the same, best first; the last of them again where there are
/// too few.
std::vector<Eigen::VectorXd> candidates(const MinimiseResult &found, int part) {
  const MatrixRM &samples = found.samples[part];
  const Eigen::VectorXd &energies = found.energies[part];
  std::vector<Eigen::VectorXd> chosen{in_box(found.parts[part].answer)};
  std::vector<Eigen::Index> order(static_cast<std::size_t>(energies.size()));
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) { return energies[a] < energies[b]; });
  for (Eigen::Index sample : order) {
    const Eigen::VectorXd unit = samples.row(sample).transpose();
    if (chosen.size() < kAnswers && std::all_of(chosen.begin(), chosen.end(), [&](const Eigen::VectorXd &other) {
          return (other - unit).cwiseAbs().maxCoeff() > kElsewhere;
        }))
      chosen.push_back(unit);
  }
  chosen.resize(kAnswers, chosen.back());
  return chosen;
}

/// (kRepeats, n) samples that are the same for all practical purposes.
MatrixRM repeats_of(const Eigen::VectorXd &unit, int axes) {
  MatrixRM samples = unit.transpose().replicate(kRepeats, 1);
  for (int k = 1; k < kRepeats; ++k) {
    double &x = samples(k, k % axes);
    const double step = kNowhere * (1 + k / axes) * (k % 2 ? 1 : -1); // no two alike
    x += x + step < 0 || x + step > 1 ? -step : step;
  }
  return samples;
}

/// What an answer costs.
struct AnswerCost {
  Eigen::VectorXd answer;                   ///< (n) box units, the candidate of the lowest mean energy
  double energy = 0, noise = 0, centre = 0; ///< its mean and standard deviation; that of the box's centre
};

/// Of the energies of all candidates' repeats. One sample of the last candidate stands for the centre.
AnswerCost cost_of(const std::vector<Eigen::VectorXd> &candidates, const Eigen::VectorXd &energies) {
  AnswerCost cost;
  cost.energy = std::numeric_limits<double>::infinity();
  cost.centre = energies[energies.size() - 1];
  for (int c = 0; c < kAnswers; ++c) {
    const Eigen::VectorXd own = energies.segment(c * kRepeats, kRepeats - (c + 1 == kAnswers ? 1 : 0));
    if (own.mean() >= cost.energy)
      continue;
    cost.answer = candidates[c];
    cost.energy = own.mean();
    cost.noise = std::sqrt((own.array() - own.mean()).square().sum() / static_cast<double>(own.size() - 1));
  }
  return cost;
}

/// [searches][regions], all in one go.
std::vector<std::vector<AnswerCost>> answer_costs(AllTakes &objective, const Searches &searches, const MinimiseResult &found,
                                                  const Searched &searched, const Context &context) {
  const int n = searched.size(), rows = kAnswers * kRepeats, regions = searches.regions();
  MatrixRM samples(static_cast<Eigen::Index>(searches.count()) * rows, static_cast<Eigen::Index>(n) * regions);
  std::vector<std::vector<std::vector<Eigen::VectorXd>>> tried(searches.count());
  for (int k = 0; k < searches.count(); ++k)
    for (int r = 0; r < regions; ++r) {
      tried[k].push_back(candidates(found, searches.part(k, r)));
      for (int c = 0; c < kAnswers; ++c)
        samples.block(k * rows + c * kRepeats, r * n, kRepeats, n) = repeats_of(tried[k][r][c], searched.space.size());
      samples.row((k + 1) * rows - 1).segment(r * n, searched.space.size()).setConstant(0.5);
    }
  const MatrixRM energies = objective.evaluate(samples, context);
  std::vector<std::vector<AnswerCost>> costs(searches.count());
  for (int k = 0; k < searches.count(); ++k)
    for (int r = 0; r < regions; ++r)
      costs[k].push_back(cost_of(tried[k][r], energies.col(r).segment(k * rows, rows)));
  return costs;
}

/// Of what one search of one region has found. noise: of its answer's energy, 0 if that is not known yet.
Posterior posterior_of(const MinimiseResult &found, int part, double noise, const FitOptions &options, const Searched &searched) {
  PosteriorOptions posterior;
  posterior.noise = noise;
  posterior.levels = searched.widths;
  posterior.seed = options.seed + static_cast<std::uint64_t>(part); // as the search
  return posterior_of(found.samples[part], found.energies[part], posterior);
}

/// Adds samples beyond the ends of the intervals to what every search has found: the search looked where energies are low, not
/// where its error bars end.
void look_beyond_intervals(Searches &searches, MinimiseResult &found, const FitOptions &options, const Searched &searched,
                           const Context &context) {
  const int n = searched.size();
  MatrixRM samples(kBeyond, static_cast<Eigen::Index>(n) * searches.part_count());
  for (int part = 0; part < searches.part_count(); ++part) {
    const Posterior posterior = posterior_of(found, part, 0, options, searched);
    samples.middleCols(part * n, n) =
        beyond_intervals(posterior, in_box(found.parts[part].answer), searched.space.size(), kBeyond);
  }
  const MatrixRM energies = searches.evaluate(samples, context);
  for (int part = 0; part < searches.part_count(); ++part) {
    MatrixRM &all = found.samples[part];
    Eigen::VectorXd &costs = found.energies[part];
    all.conservativeResize(all.rows() + kBeyond, Eigen::NoChange);
    all.bottomRows(kBeyond) = samples.middleCols(part * n, n);
    costs.conservativeResize(all.rows());
    costs.tail(kBeyond) = energies.col(part);
  }
}

/// The answer of the search of lowest energy. chosen: which.
RegionFit final_region(const MinimiseResult &found, const Searches &searches, int r,
                       const std::vector<std::vector<AnswerCost>> &costs, const FitOptions &options, const Searched &searched,
                       int &chosen) {
  std::vector<double> energies;
  MatrixRM answers(searches.count(), searched.size());
  for (int k = 0; k < searches.count(); ++k) {
    energies.push_back(costs[k][r].energy);
    answers.row(k) = costs[k][r].answer.transpose();
  }
  chosen = lowest(energies);
  const AnswerCost &cost = costs[chosen][r];
  const int part = searches.part(chosen, r);
  RegionFit region = region_fit(found, searches, chosen, r, searched);
  region.answer = cost.answer;
  region.material = searched.material(region.answer);
  region.width = searched.width(region.answer);
  region.energy = cost.energy;
  region.energy_noise = cost.noise;
  region.energy_at_centre = cost.centre;
  if (searches.count() > 1)
    region.answer_half_range = (answers.colwise().maxCoeff() - answers.colwise().minCoeff()).transpose() / 2;
  if (found.energies[part].size() > 1) {
    region.posterior = posterior_of(found, part, cost.noise, options, searched);
    MatrixRM &interval = region.posterior.interval; // the answer is likely, whatever the process says
    interval.col(0) = interval.col(0).cwiseMin(region.answer);
    interval.col(1) = interval.col(1).cwiseMax(region.answer);
  }
  return region;
}

const pbd::MaterialParameter &parameter_named(const std::string &name) {
  for (const pbd::MaterialParameter &parameter : pbd::material_parameters())
    if (name == parameter.name)
      return parameter;
  throw std::invalid_argument("expected a parameter of a material, found '" + name + "'");
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
  for (const Eigen::VectorXd &pose : lead_in_poses(simulator.actor().skeleton, dofs, dt))
    way.push_back(simulator.pose(pose));
  first = way.back();
  StepEnvironment world;
  world.dt = dt;
  return simulator.drape_along(way, materials, world);
}

struct NamedKind {
  FitFinding::Kind kind;
  const char *name;
};
constexpr NamedKind kKinds[] = {{FitFinding::Kind::LowerBound, "lower_bound"},
                                {FitFinding::Kind::UpperBound, "upper_bound"},
                                {FitFinding::Kind::Guess, "guess"},
                                {FitFinding::Kind::Seeds, "seeds"}};

} // namespace

const char *confidence_name(Confidence confidence) {
  return confidence == Confidence::Low ? "low" : confidence == Confidence::Medium ? "medium" : "high";
}

const char *finding_name(FitFinding::Kind kind) {
  for (const NamedKind &named : kKinds)
    if (named.kind == kind)
      return named.name;
  return "";
}

FitFinding::Kind finding_kind(const std::string &name) {
  for (const NamedKind &named : kKinds)
    if (name == named.name)
      return named.kind;
  throw std::invalid_argument("finding_kind: expected lower_bound, upper_bound, guess or seeds, found '" + name + "'");
}

std::string FitFinding::text() const {
  const std::string is = parameter + " = " + options::to_text(value, 3), from = options::to_text(low, 3),
                    to = options::to_text(high, 3);
  switch (kind) {
  case Kind::LowerBound:
    return is + " lies at the lower bound of its box, " + from + ": the search would go further if it could.";
  case Kind::UpperBound:
    return is + " lies at the upper bound of its box, " + to + ": the search would go further if it could.";
  case Kind::Guess:
    return is + " is a guess: its 90 % interval is " + from + " to " + to + ".";
  case Kind::Seeds:
    return is + " depends on the seed: the answers of the searches lie between " + from + " and " + to + ".";
  }
  return is;
}

std::vector<Confidence> RegionFit::confidence() const {
  std::vector<Confidence> result;
  for (const auto &interval : posterior.interval.rowwise()) {
    const double length = interval[1] - interval[0];
    result.push_back(length > kGuess ? Confidence::Low : length > kFound ? Confidence::Medium : Confidence::High);
  }
  return result;
}

std::vector<FitFinding> RegionFit::findings(const ParameterSpace &space) const {
  std::vector<FitFinding> result;
  const auto value_at = [&](int i, double unit) {
    Eigen::VectorXd point = answer.head(space.size());
    point[i] = unit;
    return space.material(point).*parameter_named(space.names[i]).value;
  };
  const std::vector<Confidence> known = confidence();
  for (int i = 0; i < space.size() && i < answer.size(); ++i) {
    const pbd::MaterialParameter &parameter = parameter_named(space.names[i]);
    const auto add = [&](FitFinding::Kind kind, double low, double high) {
      result.push_back({kind, space.names[i], material.*parameter.value, low, high});
    };
    if (answer[i] <= kAtBound)
      add(FitFinding::Kind::LowerBound, parameter.lower, parameter.upper);
    if (answer[i] >= 1 - kAtBound)
      add(FitFinding::Kind::UpperBound, parameter.lower, parameter.upper);
    if (i < static_cast<int>(known.size()) && known[i] == Confidence::Low)
      add(FitFinding::Kind::Guess, value_at(i, posterior.interval(i, 0)), value_at(i, posterior.interval(i, 1)));
    if (i < answer_half_range.size() && answer_half_range[i] > kDisputed)
      add(FitFinding::Kind::Seeds, value_at(i, std::max(0.0, answer[i] - 2 * answer_half_range[i])),
          value_at(i, std::min(1.0, answer[i] + 2 * answer_half_range[i])));
  }
  return result;
}

void FitOptions::validate() const {
  options::check(*this);
  if (make_optimizer)
    return;
  if (optimizer == SearchMethod::CmaEs)
    cma_options(*this, seed).validate();
  else if (optimizer == SearchMethod::Annealing)
    annealing_options(*this, seed).validate();
  else
    bayesian_options(*this, {space, 1}, seed).validate();
}

std::vector<std::string> FitResult::parameters() const {
  std::vector<std::string> names = space.names;
  if (widths > 1)
    names.push_back(kWidth);
  return names;
}

std::vector<pbd::Material> FitResult::materials() const {
  std::vector<pbd::Material> result;
  for (const RegionFit &region : regions)
    result.push_back(region.material);
  return result;
}

FitResult FitResult::at_positions(const std::vector<double> &positions) const {
  require(static_cast<int>(positions.size()) == widths, "FitResult::at_positions: expected " + std::to_string(widths) +
                                                            " positions, found " + std::to_string(positions.size()));
  FitResult result = *this;
  if (widths > 1)
    result.width_positions = positions;
  for (RegionFit &region : result.regions)
    if (widths > 1)
      region.width = positions[static_cast<std::size_t>(region.width)];
  return result;
}

std::vector<double> FitResult::chosen_widths() const {
  std::vector<double> result;
  for (const RegionFit &region : regions)
    if (widths > 1)
      result.push_back(region.width);
  return result;
}

FitResult estimate_material(const CharacterSimulator &simulator, const ReferencePerformance &performance,
                            const Observations &observations, double dt, const FitOptions &options, const Context &context) {
  return estimate_material({{{&simulator}, &performance, &observations, dt}}, options, context);
}

FitResult estimate_material(const std::vector<Take> &takes, const FitOptions &options, const Context &context) {
  options.validate();
  require(!takes.empty() && !takes[0].widths.empty() && takes[0].widths[0],
          "estimate_material: takes: expected at least one with a simulator, found none");
  const CharacterSimulator &simulator = *takes[0].widths[0];
  for (const Take &take : takes) {
    require(take.dt > 0, "estimate_material: takes: expected a dt above 0, found " + options::to_text(take.dt));
    require(!take.widths.empty() && take.widths[0] && take.widths[0]->regions().size() == simulator.regions().size(),
            "estimate_material: takes: expected a simulator of as many cloth regions in all, found others");
  }
  FitResult result;
  result.space = options.space;
  result.widths = static_cast<int>(takes[0].widths.size());
  result.seed = options.seed;
  result.solver = {takes[0].dt, simulator.options()};
  if (simulator.regions().empty()) {
    context.log_line("fit: no cloth, so there is no material to estimate");
    if (!options.log.empty())
      write_fit_log(options.log, {}, options.space);
    return result;
  }
  const Searched searched{options.space, result.widths};
  AllTakes objective(takes, options, context);
  for (const Take &take : takes)
    if (!has_matches(*take.observations))
      context.log_line("fit: no feature matches, so E_fit has no feature term");
  Searches searches(objective, options.seeds);
  const FitResult frame = result; // what every interrupted result has
  MinimiseResult found = minimise(searches, minimise_options(options, objective, searches, searched, frame), context);
  if (found.energies[0].size() > 1)
    look_beyond_intervals(searches, found, options, searched, context);
  const auto costs = answer_costs(objective, searches, found, searched, context);
  result.seconds = found.seconds;
  std::vector<int> chosen(objective.part_count());
  for (int r = 0; r < objective.part_count(); ++r) {
    result.regions.push_back(final_region(found, searches, r, costs, options, searched, chosen[r]));
    for (const FitFinding &finding : result.regions.back().findings(options.space))
      context.log_line("fit: region " + std::to_string(r) + ": " + finding.text());
  }
  result.log = log_of(found, searches, chosen);
  return result;
}

std::vector<double> material_energy(const CharacterSimulator &simulator, const ReferencePerformance &performance,
                                    const Observations &observations, double dt, const std::vector<pbd::Material> &materials,
                                    const EnergyOptions &options, const Context &context) {
  const MaterialObjective objective(simulator, performance, observations, dt, options, {}, context);
  const MatrixRM energies = objective.energies({materials}, context);
  return {energies.data(), energies.data() + energies.size()};
}

std::vector<Vertices> simulate_reference(const CharacterSimulator &simulator, const ReferencePerformance &performance,
                                         const std::vector<pbd::Material> &materials, double dt, int settle_frames,
                                         const Context &context) {
  require(dt > 0 && std::isfinite(dt), "simulate_reference: dt: expected a positive number, found " + options::to_text(dt));
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
      context.report_progress("simulate", t / static_cast<double>(count));
    PosedFrame current = simulator.pose(performance.dofs.row(t).transpose());
    simulator.step(state, previous, current, materials, dt);
    result.push_back(simulator.surface(state, current));
    previous = std::move(current);
  }
  return result;
}

} // namespace doublet
