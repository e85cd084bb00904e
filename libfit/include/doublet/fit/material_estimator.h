#pragma once
// Reference performance + its images -> material of every cloth region (Sect. 6.2).

#include "doublet/fit/material_objective.h"

namespace doublet {

struct FitOptions {
  std::uint64_t seed = 1;
  int max_evaluations = 512;         ///< the paper's
  int population = 0;                ///< 0 = 4 + floor(3 ln n)
  double initial_sigma = 0.3;        ///< of the search, box units
  double smallest_deviation = 0.025; ///< stop when all are below (the paper's)
  double penalty = 16.0;             ///< omega, see MinimiseOptions
  bool answer_best = false;          ///< answer the best sample seen instead of the final mean (the paper's)
  ParameterSpace space;
  EnergyOptions energy;
  OptimizerFactory make_optimizer; ///< empty = CMA-ES with the options above
  Path checkpoint;                 ///< empty = none; a killed run resumes from it to the same bits
  Path log;                        ///< fit_log.csv, rewritten after every generation; empty = none
  void validate() const;
};

struct RegionFit {
  pbd::Material material;      ///< the answer
  double energy = 0;           ///< E_fit of the answer, pixels^2
  double energy_at_centre = 0; ///< E_fit of the box's centre: what knowing nothing costs
  pbd::Material best;          ///< best sample seen
  double best_energy = 0;      ///< its E_fit
  Eigen::VectorXd deviations;  ///< (n) of the final distribution, box units: small = the motion told this parameter
  int evaluations = 0, generations = 0;
  std::string stop_reason;
};

struct FitResult {
  std::vector<std::string> parameters; ///< (n) names of those searched
  std::vector<RegionFit> regions;
  std::vector<GenerationRow> log;
  std::uint64_t seed = 0;
  double dt = 0;                    ///< s
  int iterations = 0, substeps = 0; ///< of the solver
  double seconds = 0;
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
void write_simulated(const Path &path, const std::vector<Vertices> &frames);                              // simulated.npz
std::vector<Vertices> read_simulated(const Path &path);

} // namespace doublet
