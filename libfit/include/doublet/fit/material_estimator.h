#pragma once
// Reference performance and 2D observations -> material of every cloth region (Sect. 6.2).

#include "doublet/fit/material_objective.h"
#include "doublet/fit/posterior.h"
#include "doublet/options/options.h"
#include "doublet/simulate/solver_settings.h"

#include <limits>
#include <optional>

namespace doublet {

struct FitResult;

/// The method of the material search.
enum class SearchMethod { Bayesian, CmaEs, Annealing };
inline constexpr std::array kSearchMethodNames{"bayesian", "cma-es", "annealing"}; ///< in the order of SearchMethod

struct FitOptions {
  std::uint64_t seed = 1;
  /// The spread of the answers of several searches reveals uncertainty that one search underestimates.
  int seeds = 1;
  int max_evaluations = 512;
  int population = 0;
  int initial_design_size = 64;
  double min_gain = 0.02; ///< see BayesianOptions
  double min_expected_gain = 0.005;
  double initial_sigma = 0.3;
  double min_deviation = 0.025;
  double stagnation = 0.0; ///< see CmaEsOptions
  double penalty = 16.0;   ///< see MinimiseOptions
  bool relative_penalty = true;
  /// Annealing: chains = population, 4 if 0; steps from initial_sigma down to min_deviation.
  SearchMethod optimizer = SearchMethod::Bayesian;
  ParameterSpace space;
  EnergyOptions energy;
  OptimizerFactory make_optimizer;
  Path checkpoint;
  Path log;
  std::function<void(const FitResult &)> on_generation;
  static constexpr auto describe() {
    using namespace options;
    using O = FitOptions;
    return Description{
        "FitOptions",
        option(&O::seed, "seed", at_least(0), "", "Seed of the search; region r of R regions in search k uses seed + k R + r"),
        option(&O::seeds, "seeds", at_least(1), "",
               "Number of searches, each with its own seed; the answer with the lowest energy is taken"),
        option(&O::max_evaluations, "max_evaluations", at_least(1), "",
               "No generation begins at or beyond this number of evaluations", "512 is the paper's"),
        option(&O::population, "population", at_least(0), "",
               "Number of samples per generation; 0 = 32, for CMA-ES Hansen's 4 + floor(3 ln n)",
               "8 for five parameters, 9 for six"),
        option(&O::initial_design_size, "initial_design_size", Range{4, 4096}, "",
               "Number of materials, spread evenly over the box, with which the Bayesian search begins",
               "Three of four do not stretch, like nearly all cloth; groups of 16 share a width"),
        option(&O::min_gain, "min_gain", at_least(0), "",
               "The Bayesian search stops when four generations have gained less than this share; 0 = never"),
        option(&O::min_expected_gain, "min_expected_gain", above(0), "",
               "To stop, it must also expect, twice in a row, to gain less than this share; large = no condition"),
        option(&O::initial_sigma, "initial_sigma", above(0), "",
               "Standard deviation with which CMA-ES and annealing start, in box units"),
        option(&O::min_deviation, "min_deviation", at_least(0), "",
               "CMA-ES stops when all standard deviations are below this, in box units", "0.025 is the paper's"),
        option(&O::stagnation, "stagnation", at_least(0), "",
               "CMA-ES stops when best and median energy change by less than this share; 0 = never",
               "Ten generations are compared with the ten before"),
        option(&O::penalty, "penalty", at_least(0), "", "Weight omega of the penalty for samples outside the box",
               "16 is the paper's"),
        option(&O::relative_penalty, "relative_penalty", "The penalty is omega times the median energy of the first generation",
               "Off = omega alone, the paper's"),
        option(&O::optimizer, "optimizer", kSearchMethodNames,
               "Method: bayesian, cma-es (the paper's) or annealing (the paper's comparison)"),
        option(&O::space, "space", "Parameters that are searched"),
        option(&O::energy, "energy", "Options of E_fit"),
        not_serialised(&O::make_optimizer, "make_optimizer", "Makes the optimiser; empty = `optimizer`, with the options above"),
        not_serialised(&O::checkpoint, "checkpoint",
                       "File from which an interrupted run resumes, with the same bits; empty = none"),
        not_serialised(&O::log, "log", "fit_log.csv, rewritten after every generation; empty = none"),
        not_serialised(&O::on_generation, "on_generation",
                       "Called after every generation with the result so far, marked as interrupted; may be empty"),
    };
  }
  /// The paper's: CMA-ES in the unwarped box until all deviations are below 0.025, with the paper's energy.
  static FitOptions paper() {
    FitOptions options;
    options.optimizer = SearchMethod::CmaEs;
    options.relative_penalty = false;
    options.space = ParameterSpace::paper();
    options.energy = EnergyOptions::paper();
    return options;
  }
  void validate() const; ///< throws std::invalid_argument naming option, range and value
};

/// How well the video determines a parameter, by the length of its 90 % interval: low ("a guess") above half of the parameter's
/// box, high below a quarter.
enum class Confidence { Low, Medium, High };
const char *confidence_name(Confidence confidence); ///< "low", "medium", "high"

/// A doubt about a parameter of an answer.
struct FitFinding {
  enum class Kind { LowerBound, UpperBound, Guess, Seeds };
  Kind kind = Kind::Guess;
  std::string parameter;
  double value = 0; ///< the answer, in the parameter's unit
  double low = 0,
         high = 0; ///< bounds: the box; guess: its 90 % interval; seeds: the range of the answers; in the parameter's unit
  std::string text() const; ///< one sentence
};
const char *finding_name(FitFinding::Kind kind);        ///< "lower_bound", "upper_bound", "guess", "seeds"
FitFinding::Kind finding_kind(const std::string &name); ///< throws std::invalid_argument for another name

struct RegionFit {
  pbd::Material material; ///< the answer; of an interrupted fit the best sample
  double width = -1;      ///< position of the answer's width among the garment's, see choose_widths(); -1 = there was no choice
  double energy = 0;      ///< E_fit of the answer, pixels^2: mean of eight simulations that differ by chaos alone
  double energy_noise = std::numeric_limits<double>::quiet_NaN(); ///< their standard deviation; NaN = not measured
  double energy_at_centre =
      std::numeric_limits<double>::quiet_NaN(); ///< E_fit at the centre of the box, i.e. without any estimate; NaN = not measured
  pbd::Material best;                           ///< best sample seen
  double best_energy = 0;                       ///< its E_fit
  Eigen::VectorXd answer;                       ///< (n) material, and width if there is a choice, in box units, [0, 1]
  Eigen::VectorXd deviations;                   ///< (n) standard deviations of the search at its end, box units
  Eigen::VectorXd answer_half_range;    ///< (n) half the range of the answers of all searches, box units; empty for one search
  Posterior posterior;                  ///< over the material; empty for an interrupted fit
  int evaluations = 0, generations = 0; ///< of all searches
  std::string stop_reason;              ///< of the search whose answer this is
  /// (n), empty without a posterior.
  std::vector<Confidence> confidence() const;
  /// Parameters within 0.01 (box units) of a bound of their box, parameters that the video does not determine, and parameters on
  /// which the searches differ by more than a tenth of the box.
  std::vector<FitFinding> findings(const ParameterSpace &space) const;
};

struct FitResult {
  ParameterSpace space; ///< that was searched
  int widths = 1;       ///< number of widths of the garment
  /// (widths) positions of these widths among those of garment.npz, see at_positions(); empty = they are the same, in the same
  /// order.
  std::vector<double> width_positions;
  std::vector<RegionFit> regions;
  std::vector<GenerationRow> log; ///< part = region; for several searches, that of the answer
  std::uint64_t seed = 0;
  SolverSettings solver; ///< the materials are valid only with these
  double seconds = 0;
  bool interrupted = false;                     ///< the search was not finished: the materials are the best samples so far
  std::vector<std::string> parameters() const;  ///< (n) names of those searched; the last is "width" if there was a choice
  std::vector<pbd::Material> materials() const; ///< (R) the answers, as CharacterSimulator takes them
  std::vector<double> chosen_widths() const;    ///< (R), as choose_widths() takes them; empty if there was no choice
  /// The same result with width_positions = `positions`: for a take whose garment was simulated at these positions among its
  /// widths, see common_widths(). Throws std::invalid_argument unless there is one position per width.
  FitResult at_positions(const std::vector<double> &positions) const;
};

/// One captured performance of a character. All pointers must outlive the call.
struct Take {
  std::vector<const CharacterSimulator *> widths; ///< one simulator per width of the garment, see MaterialObjective
  const ReferencePerformance *performance = nullptr;
  const Observations *observations = nullptr;
  double dt = 0; ///< s, one video frame
};

/// The material, and the width, that best explain all takes together: the sum of their energies, each in its own images, is
/// minimised. A character without cloth gives a result without regions. Without feature matches E_fit has no feature term. Throws
/// std::invalid_argument if there are no takes, if they differ in regions or widths, or if a dt is not positive.
FitResult estimate_material(const std::vector<Take> &takes, const FitOptions &options = {}, const Context &context = {});
/// The same for one take and a garment of one width. dt: s, one video frame.
FitResult estimate_material(const CharacterSimulator &simulator, const ReferencePerformance &performance,
                            const Observations &observations, double dt, const FitOptions &options = {},
                            const Context &context = {});

/// (R) E_fit, pixels^2, of one material per region. dt: s, one video frame. Throws as estimate_material().
std::vector<double> material_energy(const CharacterSimulator &simulator, const ReferencePerformance &performance,
                                    const Observations &observations, double dt, const std::vector<pbd::Material> &materials,
                                    const EnergyOptions &options = {}, const Context &context = {});

/// [T] (V, 3) the reference motion simulated with these materials, after `settle_frames` frames in the first pose. The cloth
/// begins draped from its rest shape or, if it has none, at the captured first frame.
std::vector<Vertices> simulate_reference(const CharacterSimulator &simulator, const ReferencePerformance &performance,
                                         const std::vector<pbd::Material> &materials, double dt, int settle_frames = 20,
                                         const Context &context = {});

void write_materials(const Path &path, const FitResult &result); // material.json
/// (R) Throws FileNotFound, or Error naming file, region and parameter if one is missing or outside its box, or if the solver
/// settings in the file differ from `solver`: with other settings a material behaves differently. Without `solver` they are not
/// checked; files of doublet 0.1.0 have only dt, iterations, substeps and stiffness.
std::vector<pbd::Material> read_materials(const Path &path, const std::optional<SolverSettings> &solver = std::nullopt);
/// (R) the widths of the garment in material.json, as choose_widths() takes them; empty if it has none. Throws as read_materials.
std::vector<double> read_widths(const Path &path);
void write_fit_log(const Path &path, const std::vector<GenerationRow> &log, const ParameterSpace &space); // fit_log.csv
/// simulated.npz: T x (V + G, 3), of which the first `actor_vertices` (V) are the actor's and the others the garment's. Throws
/// std::invalid_argument without frames, or for a wrong V.
void write_simulated(const Path &path, const std::vector<Vertices> &frames, Eigen::Index actor_vertices);
std::vector<Vertices> read_simulated(const Path &path); ///< T x (V + G, 3)

} // namespace doublet
