#include "doublet/core/parts/normal_generator.h"
#include "doublet/fit/optimizer.h"
#include "optimizer_checks.h"
#include "state_json.h"

#include <cmath>

namespace doublet {
namespace {

constexpr const char *kAnnealing = "annealing";

/// Folds a coordinate back into [0, 1].
double reflect(double x) {
  return std::fabs(std::remainder(x, 2.0));
} // the distance to the nearest even number

class Annealing : public Optimizer {
public:
  Annealing(int dimension, const AnnealingOptions &options)
      : n_(dimension), options_(options), random_(options.seed), current_(MatrixRM::Constant(options.chains, n_, 0.5)),
        energies_(Eigen::VectorXd::Zero(options.chains)), best_(Eigen::VectorXd::Constant(n_, 0.5)) {}

  MatrixRM ask() override {
    MatrixRM samples = current_;
    for (Eigen::Index i = 0; i < samples.size(); ++i)
      samples.data()[i] = reflect(samples.data()[i] + step() * random_.normal());
    return samples;
  }

  void tell(const MatrixRM &samples, const Eigen::VectorXd &energies) override {
    check_told(samples, energies, n_, options_.chains);
    require(energies.size() == options_.chains, "tell: energies: expected one per chain");
    const bool first = generation_ == 0;
    if (first)
      scale_ = std::max(std::fabs(energies.mean()), 1e-300);
    for (int c = 0; c < options_.chains; ++c) {
      const double chance = random_.uniform(); // drawn always: the sequence does not depend on the energies
      if (first || energies[c] <= energies_[c] || chance < std::exp((energies_[c] - energies[c]) / temperature())) {
        current_.row(c) = samples.row(c);
        energies_[c] = energies[c];
      }
      if ((first && c == 0) || energies[c] < best_energy_) {
        best_energy_ = energies[c];
        best_ = samples.row(c).transpose();
      }
    }
    evaluations_ += options_.chains;
    ++generation_;
  }

  bool stop() const override { return evaluations_ >= options_.max_evaluations; }

  OptimizerResult result() const override {
    OptimizerResult result;
    result.answer = result.best = best_;
    result.best_energy = best_energy_;
    result.deviations = Eigen::VectorXd::Constant(n_, step());
    result.evaluations = evaluations_;
    result.generations = generation_;
    if (stop())
      result.stop_reason = std::to_string(options_.max_evaluations) + " evaluations";
    return result;
  }

  std::string save() const override {
    state::Json json = {{"kind", kAnnealing},
                        {"n", n_},
                        {"chains", options_.chains},
                        {"random", random_.state()},
                        {"scale", scale_},
                        {"best_energy", best_energy_},
                        {"evaluations", evaluations_},
                        {"generation", generation_}};
    json["current"] = state::to_json(current_);
    json["energies"] = state::to_json(energies_);
    json["best"] = state::to_json(best_);
    return json.dump();
  }

  void restore(const std::string &text) override {
    state::read(text, kAnnealing, [&](const state::Json &json) {
      if (json.at("n") != n_ || json.at("chains") != options_.chains)
        throw Error("optimiser state: expected dimension " + std::to_string(n_) + " and " + std::to_string(options_.chains) +
                    " chains, found " + json.at("n").dump() + " and " + json.at("chains").dump());
      current_ = state::matrix(json.at("current"), options_.chains, n_);
      energies_ = state::vector(json.at("energies"), options_.chains);
      best_ = state::vector(json.at("best"), n_);
      scale_ = json.at("scale");
      best_energy_ = json.at("best_energy");
      evaluations_ = state::count(json.at("evaluations"));
      generation_ = state::count(json.at("generation"));
      random_.restore(json.at("random"));
    });
  }

private:
  double cooled(double from, double to) const {
    const double progress = std::min(1.0, evaluations_ / static_cast<double>(options_.max_evaluations));
    return from * std::pow(to / from, progress);
  }
  double step() const { return cooled(options_.initial_step, options_.final_step); }
  double temperature() const { return scale_ * cooled(options_.initial_temperature, options_.final_temperature); }

  int n_;
  AnnealingOptions options_;
  NormalGenerator random_;
  MatrixRM current_;         // (chains, n)
  Eigen::VectorXd energies_; // (chains)
  Eigen::VectorXd best_;
  double scale_ = 1, best_energy_ = 0;
  int evaluations_ = 0, generation_ = 0;
};

} // namespace

std::unique_ptr<Optimizer> create_simulated_annealing(int dimension, const AnnealingOptions &options) {
  require_dimension(dimension, "create_simulated_annealing");
  options.validate();
  return std::make_unique<Annealing>(dimension, options);
}

} // namespace doublet
