#pragma once
// The loop between Optimizer and Objective: penalty, log, checkpoint, progress, cancellation.

#include "doublet/core/context.h"
#include "doublet/files/files.h"
#include "doublet/fit/optimizer.h"
#include "doublet/options/options.h"

#include <functional>
#include <vector>

namespace doublet {

/// The swap point: energies of a whole generation in one call. An objective may have several independent parts (cloth regions):
/// each has its own block of parameters and its own energy, and each is minimised by an optimiser of its own, in the same calls.
class Objective {
public:
  virtual ~Objective() = default;
  virtual int parameter_count() const = 0;     ///< n, of one part
  virtual int part_count() const { return 1; } ///< R
  /// samples (S, R * n), inside the box [0, 1] -> energies (S, R), finite. Part r owns columns [r n, (r + 1) n).
  virtual MatrixRM evaluate(const MatrixRM &samples, const Context &context) = 0;
};

/// One generation of one part, a row of fit_log.csv.
struct GenerationRow {
  int part = 0, generation = 0, evaluations = 0;
  double best = 0;            ///< lowest energy so far
  double generation_best = 0; ///< lowest of this generation
  Eigen::VectorXd mean;       ///< (n) the optimiser's answer so far, box units
  Eigen::VectorXd deviation;  ///< (n) box units
  double seconds = 0;         ///< since the start, earlier runs of a resumed one included
};

using OptimizerFactory = std::function<std::unique_ptr<Optimizer>(int dimension, std::uint64_t seed)>;

struct MinimiseResult {
  std::vector<OptimizerResult> parts; ///< (R)
  /// (R) what was added to a sample's energy, for each unit of its squared distance from the box; 0 before the first generation.
  std::vector<double> penalties;
  std::vector<MatrixRM> samples;         ///< [R] (N, n) all that were evaluated, inside the box
  std::vector<Eigen::VectorXd> energies; ///< [R] (N) theirs, without penalty
  std::vector<GenerationRow> log;
  double seconds = 0; ///< earlier runs of a resumed one included
};

struct MinimiseOptions {
  OptimizerFactory make_optimizer;
  std::uint64_t seed = 1;
  double penalty = 16.0;
  /// The scale of the penalty: the median of the energies (before any penalty) of the part's first generation, so that 0.25
  /// outside the box costs as much as an ordinary sample, whatever the unit of the energy. The absolute value of the median, 1
  /// if that is 0. false = 1 (the paper's): nothing beside energies of tens to hundreds of pixels^2, so that the mean leaves the
  /// box along what the energy does not tell.
  bool relative_penalty = true;
  int expected_evaluations = 512;
  /// The checkpoint of a search that has gone on beyond it is not used, and the log says so. That of a search with a smaller
  /// budget goes on, to the bits of one search with the larger.
  int budget = 0;
  Path checkpoint;
  std::string problem;
  std::function<void(const MinimiseResult &)> on_generation;
  static constexpr auto describe() {
    using namespace options;
    using O = MinimiseOptions;
    return Description{
        "MinimiseOptions",
        no_option(&O::make_optimizer, "make_optimizer", "empty = CMA-ES with its defaults"),
        option(&O::seed, "seed", at_least(0), "", "part r gets seed + r"),
        option(&O::penalty, "penalty", at_least(0), "", "omega: energy(clamped sample) + omega scale |sample - clamped|^2"),
        option(&O::relative_penalty, "relative_penalty", "scale = median energy of the first generation; off = 1 (the paper's)"),
        option(&O::expected_evaluations, "expected_evaluations", at_least(1), "", "for the progress bar and the time left only"),
        option(&O::budget, "budget", at_least(0), "", "evaluations at which the optimisers stop; 0 = not known"),
        no_option(&O::checkpoint, "checkpoint", "empty = none; written after every generation, read at the start if it is there"),
        no_option(&O::problem, "problem",
                  "what the checkpoint belongs to; a checkpoint of another problem is not used, and the log says so"),
        no_option(&O::on_generation, "on_generation", "gets what there is, after every generation; may be empty"),
    };
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
};

/// Runs until every optimiser stops. A part that has stopped is evaluated at its answer while the others go on.
/// Throws Cancelled after the user asked to stop (the checkpoint holds the last complete generation), Error if an energy is not
/// finite, or if the checkpoint is damaged (naming it).
MinimiseResult minimise(Objective &objective, const MinimiseOptions &options = {}, const Context &context = {});

} // namespace doublet
