#pragma once
// The loop between Optimizer and Objective: penalty, log, checkpoint, progress, cancellation.

#include "doublet/core/context.h"
#include "doublet/files/files.h"
#include "doublet/fit/optimizer.h"
#include "doublet/options/options.h"

#include <functional>
#include <vector>

namespace doublet {

/// The swap point: energies of a whole generation in one call. An objective may have several independent parts (cloth regions),
/// each with its own parameters and energy; each part is minimised by its own optimiser, all in the same calls. Threads:
/// minimise() makes one call at a time, from its own; context.threads is what evaluate() may use.
class Objective {
public:
  virtual ~Objective() = default;
  virtual int parameter_count() const = 0;     ///< n, per part
  virtual int part_count() const { return 1; } ///< R
  /// samples (S, R * n), inside the box [0, 1] -> energies (S, R), finite. Part r owns columns [r n, (r + 1) n).
  virtual MatrixRM evaluate(const MatrixRM &samples, const Context &context) = 0;
};

/// One generation of one part, a row of fit_log.csv.
struct GenerationRow {
  int part = 0, generation = 0, evaluations = 0;
  double best = 0;            ///< lowest energy so far
  double generation_best = 0; ///< lowest of this generation
  Eigen::VectorXd mean;       ///< (n) the optimiser's current answer, box units
  Eigen::VectorXd deviation;  ///< (n) box units
  double seconds = 0;         ///< since the start, including the time before a resume
};

using OptimizerFactory = std::function<std::unique_ptr<Optimizer>(int dimension, std::uint64_t seed)>;

struct MinimiseResult {
  std::vector<OptimizerResult> parts; ///< (R)
  /// (R) penalty that is added to a sample's energy, per unit of its squared distance from the box; 0 before the first
  /// generation.
  std::vector<double> penalties;
  std::vector<MatrixRM> samples;         ///< [R] (N, n) all evaluated samples, inside the box
  std::vector<Eigen::VectorXd> energies; ///< [R] (N) their energies, without penalty
  std::vector<GenerationRow> log;
  double seconds = 0; ///< including the time before a resume
};

struct MinimiseOptions {
  OptimizerFactory make_optimizer;
  std::uint64_t seed = 1;
  double penalty = 16.0;
  /// The scale of the penalty is the absolute value of the median energy (without penalty) of the part's first generation, or 1
  /// if that is 0, so that a distance of 0.25 from the box costs as much as a typical sample, whatever the unit of the energy.
  /// false = 1 (the paper's): negligible against energies of tens to hundreds of pixels^2, so that the mean leaves the box along
  /// directions in which the energy is flat.
  bool relative_penalty = true;
  int expected_evaluations = 512;
  /// A checkpoint with more evaluations than this is ignored, which is logged. One of a search with a smaller budget is
  /// continued, with the same bits as a single search with the larger budget.
  int budget = 0;
  Path checkpoint;
  std::string problem;
  std::function<void(const MinimiseResult &)> on_generation;
  static constexpr auto describe() {
    using namespace options;
    using O = MinimiseOptions;
    return Description{
        "MinimiseOptions",
        not_serialised(&O::make_optimizer, "make_optimizer", "Makes the optimiser of a part; empty = CMA-ES with its defaults"),
        option(&O::seed, "seed", at_least(0), "", "Seed of the search; part r gets seed + r"),
        option(&O::penalty, "penalty", at_least(0), "",
               "Weight omega: energy(clamped sample) + omega scale |sample - clamped|^2"),
        option(&O::relative_penalty, "relative_penalty", "Scale of the penalty is the median energy of the first generation",
               "Off = 1, the paper's"),
        option(&O::expected_evaluations, "expected_evaluations", at_least(1), "",
               "Expected number of evaluations; only for progress and remaining time"),
        option(&O::budget, "budget", at_least(0), "", "Number of evaluations at which the optimisers stop; 0 = not known"),
        not_serialised(&O::checkpoint, "checkpoint",
                       "File that is read at the start and written after every generation; empty = none"),
        not_serialised(&O::problem, "problem", "Name of the problem that the checkpoint belongs to",
                       "A checkpoint of another problem is ignored, which is logged"),
        not_serialised(&O::on_generation, "on_generation", "Called after every generation with the result so far; may be empty"),
    };
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
};

/// Runs until every optimiser stops. A part whose optimiser has stopped is evaluated at its answer while the others continue.
/// Throws Cancelled after the user asked to stop (the checkpoint holds the last complete generation), Error if an energy is not
/// finite, or if the checkpoint is damaged (naming it).
MinimiseResult minimise(Objective &objective, const MinimiseOptions &options = {}, const Context &context = {});

} // namespace doublet
