#pragma once
// Reference performance + its images -> material of every cloth region (Sect. 6.2).

#include "doublet/fit/influence.h"
#include "doublet/fit/material_objective.h"

#include <limits>

namespace doublet {

struct FitResult;

struct FitOptions {
  std::uint64_t seed = 1;
  /// Searches from as many different seeds, side by side; the answer is that of the lowest energy. How far their answers lie
  /// apart tells more than any one search can: each ends somewhere and calls it narrow. Evaluations are those of all searches.
  int seeds = 1;
  int max_evaluations = 512;  ///< the paper's
  int population = 0;         ///< 0 = 4 + floor(3 ln n)
  double stop_margin = 0;     ///< beyond the paper: samples that fall behind are stopped, see MaterialObjective::race; 0 = none
  double initial_sigma = 0.3; ///< of the search, box units
  double smallest_deviation = 0.025; ///< stop when all are below (the paper's)
  double stagnation = 0.02;          ///< stop when the energies change by less, see CmaEsOptions; 0 = never
  double penalty = 16.0;             ///< omega, see MinimiseOptions
  bool relative_penalty = true;      ///< times the median energy of the first generation; false = as it is (the paper's)
  /// The answer is, of the means of so many last generations, the one of the lowest energy; 1 = the final mean (the paper's). In
  /// a chaotic energy the mean wanders among answers that are equally good, or less so.
  int answer_generations = 1;
  bool answer_best = false; ///< answer the best sample seen instead of a mean
  /// "cma-es", or "annealing" (the paper's comparison; chains = population, 4 if 0; steps from initial_sigma down to
  /// smallest_deviation).
  std::string optimizer = "cma-es";
  bool influence = true; ///< measure at the end what the motion tells about each parameter: 4 n + 12 more evaluations
  ParameterSpace space;
  EnergyOptions energy;
  OptimizerFactory make_optimizer; ///< empty = `optimizer`, with the options above
  Path checkpoint;                 ///< empty = none; a killed run resumes from it to the same bits
  Path log;                        ///< fit_log.csv, rewritten after every generation; empty = none
  /// What there is after every generation, as an interrupted result; may be empty.
  std::function<void(const FitResult &)> on_generation;
  void validate() const;
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
  double dt = 0;                    ///< s
  int iterations = 0, substeps = 0; ///< of the solver
  pbd::Stiffness stiffness = pbd::Stiffness::Sweeps;
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
/// (R) throws FileNotFound, or Error naming file, region and parameter if one is missing or outside its box.
std::vector<pbd::Material> read_materials(const Path &path);
void write_fit_log(const Path &path, const std::vector<GenerationRow> &log, const ParameterSpace &space); // fit_log.csv
/// simulated.npz: T x (V + G, 3), of which the first `actor_vertices` (V) are the actor's and the others the garment's. Throws
/// std::invalid_argument without frames, or for a wrong V.
void write_simulated(const Path &path, const std::vector<Vertices> &frames, Eigen::Index actor_vertices);
std::vector<Vertices> read_simulated(const Path &path); ///< T x (V + G, 3)

} // namespace doublet
