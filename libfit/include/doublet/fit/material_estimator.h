#pragma once
// Reference performance + its images -> material of every cloth region (Sect. 6.2).

#include "doublet/fit/material_objective.h"
#include "doublet/fit/posterior.h"
#include "doublet/options/options.h"
#include "doublet/simulate/solver_settings.h"

#include <limits>
#include <optional>

namespace doublet {

struct FitResult;

/// How a material is searched for.
enum class SearchMethod { Bayesian, CmaEs, Annealing };
inline constexpr std::array kSearchMethodNames{"bayesian", "cma-es", "annealing"}; ///< in the order of SearchMethod

struct FitOptions {
  std::uint64_t seed = 1;
  /// The spread of the answers of several searches shows an uncertainty that one search underestimates.
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
        option(&O::seed, "seed", at_least(0), "", "Seed of the search; region r of R in search k uses seed + k R + r"),
        option(&O::seeds, "seeds", at_least(1), "",
               "Number of searches with seeds of their own; the lowest energy is the answer"),
        option(&O::max_evaluations, "max_evaluations", at_least(1), "",
               "No generation begins at or beyond this number of evaluations", "512 is the paper's"),
        option(&O::population, "population", at_least(0), "",
               "Number of samples in a generation; 0 = 32, of CMA-ES Hansen's 4 + floor(3 ln n)",
               "8 for five parameters, 9 for six"),
        option(&O::initial_design_size, "initial_design_size", Range{4, 4096}, "",
               "Number of materials, spread evenly over the box, with which the Bayesian search begins",
               "Three of four do not stretch, as hardly any cloth does; groups of 16 share a width"),
        option(&O::min_gain, "min_gain", at_least(0), "",
               "The Bayesian search stops when four generations have gained less than this share; 0 = never"),
        option(&O::min_expected_gain, "min_expected_gain", above(0), "",
               "And when it expects, twice in a row, to gain less than this share; a large number = then at once"),
        option(&O::initial_sigma, "initial_sigma", above(0), "",
               "Standard deviation with which CMA-ES and annealing start, in box units"),
        option(&O::min_deviation, "min_deviation", at_least(0), "",
               "CMA-ES stops when all standard deviations are below this, in box units", "0.025 is the paper's"),
        option(&O::stagnation, "stagnation", at_least(0), "",
               "CMA-ES stops when best and median energy change by less than this share; 0 = never",
               "Those of ten generations against the ten before"),
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
                       "File from which a run that was killed goes on, to the same bits; empty = none"),
        not_serialised(&O::log, "log", "fit_log.csv, rewritten after every generation; empty = none"),
        not_serialised(&O::on_generation, "on_generation",
                       "Gets what there is after every generation, as an interrupted result; may be empty"),
    };
  }
  /// CMA-ES in the box itself until all deviations are below 0.025, on the paper's energy.
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

/// How well the video determines a parameter, by the length of its 90 % interval: low ("a guess") above half of its box, high
/// below a quarter.
enum class Confidence { Low, Medium, High };
const char *confidence_name(Confidence confidence); ///< "low", "medium", "high"

/// What is doubtful about a parameter of an answer.
struct FitFinding {
  enum class Kind { LowerBound, UpperBound, Guess, Seeds };
  Kind kind = Kind::Guess;
  std::string parameter;
  double value = 0;         ///< the answer, in the parameter's unit
  double low = 0, high = 0; ///< bounds: the box; a guess: its 90 % interval; seeds: the answers' range; in the parameter's unit
  std::string text() const; ///< one sentence
};
const char *finding_name(FitFinding::Kind kind);        ///< "lower_bound", "upper_bound", "guess", "seeds"
FitFinding::Kind finding_kind(const std::string &name); ///< throws std::invalid_argument for another name

struct RegionFit {
  pbd::Material material; ///< the answer; of an interrupted fit the best sample
  double width = -1; ///< position of the width that is answered among those offered, see choose_widths(); -1 = none was offered
  double energy = 0; ///< E_fit of the answer, pixels^2: mean of eight simulations that differ by chaos alone
  double energy_noise = std::numeric_limits<double>::quiet_NaN(); ///< their standard deviation; NaN = not measured
  double energy_at_centre =
      std::numeric_limits<double>::quiet_NaN(); ///< E_fit of the box's centre: what knowing nothing costs; NaN = not measured
  pbd::Material best;                           ///< best sample seen
  double best_energy = 0;                       ///< its E_fit
  Eigen::VectorXd answer;                       ///< (n) material, and width if there is a choice, in box units, [0, 1]
  Eigen::VectorXd deviations;                   ///< (n) of the search where it ended, box units
  Eigen::VectorXd answer_half_range;            ///< (n) half the range of the answers of all searches, box units; empty if one
  Posterior posterior;                          ///< how likely every material is; empty of an interrupted fit
  int evaluations = 0, generations = 0;         ///< of all searches
  std::string stop_reason;                      ///< of the one whose answer this is
  /// (n), empty without a posterior.
  std::vector<Confidence> confidence() const;
  /// A parameter within 0.01 (box units) of a bound of its box, one that the video does not determine, one about which the
  /// searches disagree by more than a tenth of the box.
  std::vector<FitFinding> findings(const ParameterSpace &space) const;
};

struct FitResult {
  ParameterSpace space; ///< that was searched
  int widths = 1;       ///< that the garment offered
  /// (widths) where they are among those of garment.npz, see at_positions(); empty = they are those, in their order.
  std::vector<double> width_positions;
  std::vector<RegionFit> regions;
  std::vector<GenerationRow> log; ///< part = region; of several searches the one whose answer is taken
  std::uint64_t seed = 0;
  SolverSettings solver; ///< without which the materials mean nothing
  double seconds = 0;
  bool interrupted = false;                     ///< the search was not over: the materials are the best samples so far
  std::vector<std::string> parameters() const;  ///< (n) names of those searched; the last is "width" if there was a choice
  std::vector<pbd::Material> materials() const; ///< (R) the answers, as CharacterSimulator takes them
  std::vector<double> chosen_widths() const;    ///< (R), as choose_widths() takes them; empty if there was no choice
  /// The same for a garment whose positions the widths of a take were, see common_widths(). Throws std::invalid_argument unless
  /// there is a position for each.
  FitResult at_positions(const std::vector<double> &positions) const;
};

/// One film of a character. All must outlive the call.
struct Take {
  std::vector<const CharacterSimulator *> widths; ///< in every width that its garment offers, see MaterialObjective
  const ReferencePerformance *performance = nullptr;
  const Observations *observations = nullptr;
  double dt = 0; ///< s, one video frame
};

/// The material, and the width, under which the takes are explained together: their energies are added, each in its own images. A
/// character without cloth has no material: a result without regions. Without feature matches E_fit is without their
/// term. Throws std::invalid_argument without takes, if they differ in regions or widths, or if a dt is not positive.
FitResult estimate_material(const std::vector<Take> &takes, const FitOptions &options = {}, const Context &context = {});
/// Of one take, of a garment of one width. dt: s, one video frame.
FitResult estimate_material(const CharacterSimulator &simulator, const ReferencePerformance &performance,
                            const Observations &observations, double dt, const FitOptions &options = {},
                            const Context &context = {});

/// (R) E_fit, pixels^2, of one material per region. dt: s, one video frame. Throws as estimate_material().
std::vector<double> material_energy(const CharacterSimulator &simulator, const ReferencePerformance &performance,
                                    const Observations &observations, double dt, const std::vector<pbd::Material> &materials,
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
/// (R) the widths of the garment that material.json answers, as choose_widths() takes them; empty if it names none. Throws as
/// read_materials.
std::vector<double> read_widths(const Path &path);
void write_fit_log(const Path &path, const std::vector<GenerationRow> &log, const ParameterSpace &space); // fit_log.csv
/// simulated.npz: T x (V + G, 3), of which the first `actor_vertices` (V) are the actor's and the others the garment's. Throws
/// std::invalid_argument without frames, or for a wrong V.
void write_simulated(const Path &path, const std::vector<Vertices> &frames, Eigen::Index actor_vertices);
std::vector<Vertices> read_simulated(const Path &path); ///< T x (V + G, 3)

} // namespace doublet
