#include "doublet/fit/minimise.h"

#include "doublet/core/parts/quantile.h"
#include "doublet/options/options.h"
#include "optimizer_checks.h"
#include "state_json.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace doublet {
namespace {

constexpr const char *kMinimise = "minimise";

class Run {
public:
  Run(Objective &objective, const MinimiseOptions &options)
      : objective_(objective), options_(options), n_(objective.parameter_count()), parts_(objective.part_count()),
        penalties_(std::max(0, parts_), 0.0), samples_(std::max(0, parts_), MatrixRM(0, n_)), energies_(std::max(0, parts_)) {
    require(n_ >= 1 && parts_ >= 1, "minimise: objective: expected at least one parameter and one part");
    for (int r = 0; r < parts_; ++r) {
      const std::uint64_t seed = options.seed + static_cast<std::uint64_t>(r);
      CmaEsOptions standard;
      standard.seed = seed;
      optimizers_.push_back(options.make_optimizer ? options.make_optimizer(n_, seed) : create_cma_es(n_, standard));
      require(optimizers_.back() != nullptr, "minimise: make_optimizer: expected an optimiser, found none");
    }
  }

  MinimiseResult operator()(const Context &context) {
    resume(context);
    if (!log_.empty())
      tell_caller(); // who may have missed the last generation
    while (!finished()) {
      report(context);
      generation(context);
      save();
      tell_caller();
    }
    if (context.progress)
      context.progress("fit", 1.0);
    return result();
  }

private:
  void tell_caller() const {
    if (options_.on_generation)
      options_.on_generation(result());
  }

  MinimiseResult result() const {
    MinimiseResult result;
    for (int r = 0; r < parts_; ++r)
      result.parts.push_back(now(r));
    result.penalties = penalties_;
    result.samples = samples_;
    result.energies = energies_;
    result.log = log_;
    result.seconds = seconds();
    return result;
  }

  double seconds() const {
    return seconds_before_ + std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count();
  }

  bool finished() const {
    return std::all_of(optimizers_.begin(), optimizers_.end(), [](const auto &o) { return o->stop(); });
  }

  /// Where the optimiser of a part stands; it may be anybody's, so that sizes are checked.
  OptimizerResult now(int r) const {
    OptimizerResult result = optimizers_[r]->result();
    require(result.answer.size() == n_ && result.best.size() == n_ && result.deviations.size() == n_ && result.answer.allFinite(),
            "minimise: result: expected answer, best and deviations of " + std::to_string(n_) + " finite numbers, found " +
                std::to_string(result.answer.size()) + ", " + std::to_string(result.best.size()) + " and " +
                std::to_string(result.deviations.size()));
    return result;
  }

  void report(const Context &context) const {
    int evaluations = now(0).evaluations;
    for (int r = 0; r < parts_; ++r)
      if (!optimizers_[r]->stop())
        evaluations = now(r).evaluations;
    const double fraction = std::min(1.0, evaluations / static_cast<double>(options_.expected_evaluations));
    context.report_progress("fit", fraction);
    if (log_.empty())
      return;
    std::string line = "fit: " + std::to_string(evaluations) + " evaluations";
    for (int r = 0; r < parts_; ++r)
      line += (r ? ", " : ", best ") + options::to_text(now(r).best_energy, 4);
    if (fraction > 0)
      line += ", at most " + std::to_string(std::lround(seconds() * (1 - fraction) / fraction)) + " s left";
    context.log_line(line);
  }

  void generation(const Context &context) {
    std::vector<MatrixRM> asked(parts_);
    Eigen::Index count = 0;
    for (int r = 0; r < parts_; ++r)
      if (!optimizers_[r]->stop()) {
        asked[r] = optimizers_[r]->ask();
        require(asked[r].cols() == n_ && asked[r].allFinite(),
                "minimise: ask: expected finite samples (S, " + std::to_string(n_) + "), found (" +
                    std::to_string(asked[r].rows()) + ", " + std::to_string(asked[r].cols()) + ")" +
                    (asked[r].allFinite() ? "" : " with NaN or infinity"));
        count = std::max(count, asked[r].rows());
      }
    require(count >= 1, "minimise: ask: expected at least one sample");

    MatrixRM samples(count, static_cast<Eigen::Index>(parts_) * n_);
    for (int r = 0; r < parts_; ++r) {
      samples.middleCols(r * n_, n_).rowwise() = now(r).answer.transpose();
      if (asked[r].rows() > 0) // one that has stopped is asked nothing, (0, 0)
        samples.block(0, r * n_, asked[r].rows(), n_) = asked[r];
    }
    const MatrixRM inside = samples.cwiseMax(0.0).cwiseMin(1.0);
    const MatrixRM energies = objective_.evaluate(inside, context);
    if (energies.rows() != count || energies.cols() != parts_ || !energies.allFinite())
      throw Error("minimise: evaluate: expected (" + std::to_string(count) + ", " + std::to_string(parts_) +
                  ") finite energies, found (" + std::to_string(energies.rows()) + ", " + std::to_string(energies.cols()) + ")" +
                  (energies.allFinite() ? "" : " with NaN or infinity"));
    for (int r = 0; r < parts_; ++r)
      if (asked[r].rows() > 0)
        tell(r, asked[r], energies.col(r).head(asked[r].rows()));
  }

  /// What the energies of a part are like, from its first generation.
  double scale(const Eigen::VectorXd &energies) const {
    const double middle = options_.relative_penalty ? std::fabs(median({energies.begin(), energies.end()})) : 1.0;
    return middle > 0 ? middle : 1.0;
  }

  void tell(int r, const MatrixRM &asked, Eigen::VectorXd energies) {
    if (penalties_[r] == 0)
      penalties_[r] = options_.penalty * scale(energies);
    const MatrixRM inside = asked.cwiseMax(0.0).cwiseMin(1.0);
    keep(r, inside, energies);
    energies += penalties_[r] * (asked - inside).rowwise().squaredNorm();
    optimizers_[r]->tell(asked, energies);
    const OptimizerResult result = now(r);
    GenerationRow row;
    row.part = r;
    row.generation = result.generations;
    row.evaluations = result.evaluations;
    row.best = result.best_energy;
    row.generation_best = energies.minCoeff();
    row.mean = result.answer;
    row.deviation = result.deviations;
    row.seconds = seconds();
    log_.push_back(row);
  }

  void keep(int r, const MatrixRM &samples, const Eigen::VectorXd &energies) {
    const Eigen::Index before = energies_[r].size();
    samples_[r].conservativeResize(before + samples.rows(), n_);
    samples_[r].bottomRows(samples.rows()) = samples;
    energies_[r].conservativeResize(before + samples.rows());
    energies_[r].tail(samples.rows()) = energies;
  }

  void save() const {
    if (options_.checkpoint.empty())
      return;
    state::Json json = {{"kind", kMinimise}, {"problem", options_.problem}, {"seconds", seconds()}, {"penalties", penalties_}};
    for (const auto &optimizer : optimizers_) {
      json["optimizers"].push_back(optimizer->save());
      if (json["optimizers"].back() == "")
        return; // cannot be saved, see Optimizer::save
    }
    for (int r = 0; r < parts_; ++r) {
      json["samples"].push_back(state::to_json(samples_[r]));
      json["energies"].push_back(state::to_json(energies_[r]));
    }
    for (const GenerationRow &row : log_)
      json["log"].push_back({row.part, row.generation, row.evaluations, row.best, row.generation_best, state::to_json(row.mean),
                             state::to_json(row.deviation), row.seconds});
    write_text(options_.checkpoint, json.dump());
  }

  /// Has a part begun a generation that a search of this budget would not have?
  bool beyond_budget(const state::Json &log) const {
    std::vector<int> before(static_cast<std::size_t>(parts_), 0); // evaluations at the end of the part's last generation
    for (const state::Json &entry : log) {
      int &evaluations = before.at(static_cast<std::size_t>(state::count(entry.at(0))));
      if (options_.budget > 0 && evaluations >= options_.budget)
        return true;
      evaluations = state::count(entry.at(2));
    }
    return false;
  }

  /// The log of a part ends where its optimiser stands.
  void require_whole_log(int r) const {
    int logged = 0;
    for (const GenerationRow &row : log_)
      if (row.part == r)
        logged = row.evaluations;
    if (logged != now(r).evaluations)
      throw Error("the log ends at evaluation " + std::to_string(logged) + ", the optimiser stands at " +
                  std::to_string(now(r).evaluations));
  }

  void resume(const Context &context) try {
    if (options_.checkpoint.empty() || !std::filesystem::exists(options_.checkpoint))
      return;
    state::read(read_json_text(options_.checkpoint), kMinimise, [&](const state::Json &json) {
      if (json.at("problem") != options_.problem || json.at("optimizers").size() != optimizers_.size() ||
          json.value("penalties", state::Json()).size() != penalties_.size()) {
        context.log_line("fit: " + options_.checkpoint.string() + " belongs to other data or options; starting over");
        return;
      }
      if (beyond_budget(json.at("log"))) {
        context.log_line("fit: " + options_.checkpoint.string() + " belongs to a longer search; starting over");
        return;
      }
      for (int r = 0; r < parts_; ++r)
        optimizers_[r]->restore(json.at("optimizers").at(r).get<std::string>());
      for (const state::Json &entry : json.at("log"))
        log_.push_back({state::count(entry.at(0)), state::count(entry.at(1)), state::count(entry.at(2)), entry.at(3), entry.at(4),
                        state::vector(entry.at(5), n_), state::vector(entry.at(6), n_), entry.at(7)});
      for (int r = 0; r < parts_; ++r) {
        require_whole_log(r);
        const auto count = now(r).evaluations;
        keep(r, state::matrix(json.at("samples").at(r), count, n_), state::vector(json.at("energies").at(r), count));
      }
      penalties_ = json.at("penalties").get<std::vector<double>>();
      seconds_before_ = json.at("seconds");
      context.log_line("fit: resuming after " + std::to_string(now(0).evaluations) + " evaluations");
    });
  } catch (const Error &error) {
    fail_to_resume(error);
  } catch (const std::out_of_range &error) {
    fail_to_resume(error);
  }

  [[noreturn]] void fail_to_resume(const std::exception &error) const {
    throw Error(options_.checkpoint.string() +
                ": expected the state of a search, found a damaged file (delete it to start over): " + error.what());
  }

  Objective &objective_;
  const MinimiseOptions &options_;
  int n_, parts_;
  std::vector<std::unique_ptr<Optimizer>> optimizers_;
  std::vector<double> penalties_; // (R), 0 before the first generation
  std::vector<MatrixRM> samples_; // [R] all that were evaluated
  std::vector<Eigen::VectorXd> energies_;
  std::vector<GenerationRow> log_;
  double seconds_before_ = 0;
  std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
};

} // namespace

MinimiseResult minimise(Objective &objective, const MinimiseOptions &options, const Context &context) {
  options.validate();
  return Run(objective, options)(context);
}

} // namespace doublet
