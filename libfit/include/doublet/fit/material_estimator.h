#pragma once
// Reference performance + its images -> material of every cloth region (Sect. 6.2).

#include "doublet/fit/material_objective.h"
#include "doublet/fit/parts/influence.h"
#include "doublet/options/options.h"
#include "doublet/simulate/solver_settings.h"

#include <limits>
#include <optional>

namespace doublet {

struct FitResult;

struct FitOptions {
  std::uint64_t seed = 1;
  /// How far the answers of several searches lie apart tells more than any one search can: each ends somewhere and calls it
  /// narrow.
  int seeds = 1;
  int max_evaluations = 512;
  int population = 0;
  int first_samples = 16;
  double stop_margin = 0.1; ///< see MaterialObjective::race
  double initial_sigma = 0.2;
  double smallest_deviation = 0.1; ///< what is gained below is less than what chaos adds
  double stagnation = 0.02;        ///< see CmaEsOptions
  double penalty = 16.0;           ///< see MinimiseOptions
  bool relative_penalty = true;
  /// In a chaotic energy the mean wanders among answers that are equally good, or less so.
  int answer_generations = 14;
  bool answer_best = false;
  /// Annealing: chains = population, 4 if 0; steps from initial_sigma down to smallest_deviation.
  std::string optimizer = "cma-es";
  bool influence = true;
  ParameterSpace space;
  EnergyOptions energy;
  OptimizerFactory make_optimizer;
  Path checkpoint;
  Path log;
  std::function<void(const FitResult &)> on_generation;
  static constexpr std::array kOptimizers{"cma-es", "annealing"};
  static constexpr auto describe() {
    using namespace options;
    using O = FitOptions;
    return Description{
        "FitOptions",
        option(&O::seed, "seed", at_least(0), "", "region r of R uses seed + r, and of search k (from 0) seed + k R + r"),
        option(&O::seeds, "seeds", at_least(1), "",
               "searches from as many seeds, side by side (two of 8 samples fill 16 lanes); the answer is that of the lowest "
               "energy"),
        option(&O::max_evaluations, "max_evaluations", at_least(1), "",
               "no generation begins at or beyond it; 512 is the paper's"),
        option(&O::population, "population", at_least(0), "",
               "samples a generation; 0 = 4 + floor(3 ln n), Hansen's: 8 for five parameters, 9 for six"),
        option(
            &O::first_samples, "first_samples", Range{0, 4096}, "",
            "CMA-ES begins with so many ordinary materials, spread evenly over the box and inelastic, and goes on from the best "
            "quarter; at least 4, or 0 = around the centre of the box (the paper's)"),
        option(&O::stop_margin, "stop_margin", at_least(0), "",
               "stop samples whose energy so far is more than 1 + this times that of the middle of the ranking; 0 = never"),
        option(&O::initial_sigma, "initial_sigma", above(0), "",
               "of the search where it starts, box units; 0.3 around the centre, where the box is +-1.7 sigma, is the paper's"),
        option(&O::smallest_deviation, "smallest_deviation", at_least(0), "",
               "stop when all standard deviations are below, box units; 0.025 is the paper's"),
        option(&O::stagnation, "stagnation", at_least(0), "",
               "stop when best and median energy of ten generations changed by less than this share since the ten before; 0 = "
               "never"),
        option(&O::penalty, "penalty", at_least(0), "", "omega, of samples outside the box; 16 is the paper's"),
        option(&O::relative_penalty, "relative_penalty",
               "omega times the median energy of the first generation; off = omega alone (the paper's)"),
        option(
            &O::answer_generations, "answer_generations", at_least(1), "",
            "answer, of the means of so many last generations, the one of the lowest energy; 1 = the final mean (the paper's)"),
        option(&O::answer_best, "answer_best", "answer the best sample seen instead of a mean, which averages the noise"),
        option(&O::optimizer, "optimizer", kOptimizers, "cma-es, or annealing (the paper's comparison)"),
        option(&O::influence, "influence",
               "measure at the end what the motion tells about each parameter: 4 n + 12 more evaluations"),
        option(&O::space, "space", "which parameters are searched"),
        option(&O::energy, "energy", "of E_fit"),
        no_option(&O::make_optimizer, "make_optimizer", "empty = `optimizer`, with the options above"),
        no_option(&O::checkpoint, "checkpoint", "empty = none; a killed run resumes from it to the same bits"),
        no_option(&O::log, "log", "fit_log.csv, rewritten after every generation; empty = none"),
        no_option(&O::on_generation, "on_generation",
                  "gets what there is after every generation, as an interrupted result; may be empty"),
    };
  }
  /// CMA-ES in the box itself until all deviations are below 0.025, whose final mean is the answer, on the paper's energy.
  static FitOptions paper() {
    FitOptions options;
    options.stop_margin = options.stagnation = 0;
    options.smallest_deviation = 0.025;
    options.first_samples = 0;
    options.initial_sigma = 0.3;
    options.relative_penalty = false;
    options.answer_generations = 1;
    options.space = ParameterSpace::paper();
    options.energy = EnergyOptions::paper();
    return options;
  }
  void validate() const; ///< throws std::invalid_argument naming option, range and value
};

/// How well the motion tells a parameter: low if moving it changes E_fit no more than noise does; high if it does and the
/// search's standard deviation came below a tenth of the box; medium otherwise. One lower if the answers of searches from other
/// seeds are spread by more than a tenth of the box.
enum class Confidence { kLow, kMedium, kHigh };
const char *confidence_name(Confidence confidence); ///< "low", "medium", "high"

struct RegionFit {
  pbd::Material material; ///< the answer; of an interrupted fit the best sample
  double energy = 0;      ///< E_fit of the answer, pixels^2
  double energy_at_centre =
      std::numeric_limits<double>::quiet_NaN(); ///< E_fit of the box's centre: what knowing nothing costs; NaN = not measured
  pbd::Material best;                           ///< best sample seen
  double best_energy = 0;                       ///< its E_fit
  Eigen::VectorXd answer;                       ///< (n) `material` in box units, [0, 1]
  Eigen::VectorXd deviations;                   ///< (n) of the final distribution, box units
  Eigen::VectorXd spread;                       ///< (n) half the range of the answers of all searches, box units; empty if one
  Influence influence;                          ///< of each parameter on E_fit, pixels^2; empty if not measured
  int evaluations = 0, generations = 0;         ///< of all searches
  std::string stop_reason;                      ///< of the one whose answer this is
  /// (n), empty if the influence was not measured.
  std::vector<Confidence> confidence() const;
  /// What is doubtful, a sentence each: a parameter within 0.01 (box units) of a bound of its box, one that the motion does not
  /// tell, one about which the searches disagree. names (n): of the parameters searched.
  std::vector<std::string> remarks(const std::vector<std::string> &names) const;
};

struct FitResult {
  std::vector<std::string> parameters; ///< (n) names of those searched
  std::vector<RegionFit> regions;
  std::vector<GenerationRow> log; ///< part = region; of several searches the one whose answer is taken
  std::uint64_t seed = 0;
  SolverSettings solver; ///< without which the materials mean nothing
  double seconds = 0;
  bool interrupted = false;                     ///< the search was not over: the materials are the best samples so far
  std::vector<pbd::Material> materials() const; ///< (R) the answers, as CharacterSimulator takes them
};

/// A character without cloth has no material: a result without regions. Without feature matches E_fit is its silhouette term.
FitResult estimate_material(const CharacterSimulator &simulator, const ReferencePerformance &performance,
                            const Observations &observations, const FitOptions &options = {}, const Context &context = {});

/// (R) E_fit of one material a region.
std::vector<double> material_energy(const CharacterSimulator &simulator, const ReferencePerformance &performance,
                                    const Observations &observations, const std::vector<pbd::Material> &materials,
                                    const EnergyOptions &options = {}, const Context &context = {});

/// [T] (V, 3) the reference motion re-animated by the finished character, from its captured first frame after `settle_frames` of
/// rest.
std::vector<Vertices> simulate_reference(const CharacterSimulator &simulator, const ReferencePerformance &performance,
                                         const std::vector<pbd::Material> &materials, double dt, int settle_frames = 20,
                                         const Context &context = {});

void write_materials(const Path &path, const FitResult &result); // material.json
/// (R) throws FileNotFound, or Error naming file, region and parameter if one is missing or outside its box. Also if the file
/// names solver settings other than `solver`: a material of one solver is another cloth in the next. Without `solver` they are
/// not looked at; files of doublet 0.1.0 name dt, iterations, substeps and stiffness alone.
std::vector<pbd::Material> read_materials(const Path &path, const std::optional<SolverSettings> &solver = std::nullopt);
void write_fit_log(const Path &path, const std::vector<GenerationRow> &log, const ParameterSpace &space); // fit_log.csv
/// simulated.npz: T x (V + G, 3), of which the first `actor_vertices` (V) are the actor's and the others the garment's. Throws
/// std::invalid_argument without frames, or for a wrong V.
void write_simulated(const Path &path, const std::vector<Vertices> &frames, Eigen::Index actor_vertices);
std::vector<Vertices> read_simulated(const Path &path); ///< T x (V + G, 3)

} // namespace doublet
