// Hansen, "The CMA Evolution Strategy: A Tutorial", arXiv:1604.00772; equation numbers are its.

#include "doublet/core/parts/normal_generator.h"
#include "doublet/core/parts/quantile.h"
#include "doublet/fit/optimizer.h"
#include "optimizer_checks.h"
#include "state_json.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <numeric>

namespace doublet {
namespace {

constexpr const char *kCmaEs = "cma-es";
constexpr std::size_t kHalf = 10;          // generations that are compared with as many before them, see stagnation
constexpr double kLargestCondition = 1e14; // beyond it the eigenvalues are rounding errors

/// (mu) of the best mu of lambda samples, positive, sum to one, eq. (49).
Eigen::VectorXd falling_weights(int mu, int lambda) {
  Eigen::VectorXd weights(mu);
  for (int i = 0; i < mu; ++i)
    weights[i] = std::log((lambda + 1) / 2.0) - std::log(i + 1.0);
  return weights / weights.sum();
}

/// Fixed numbers of a run, Table 1 of the tutorial.
struct Strategy {
  int lambda, mu;
  Eigen::VectorXd weights; // (mu), positive, sum to one
  double mu_eff, c_sigma, d_sigma, c_c, c_1, c_mu, expected_norm;

  Strategy(int n, int population) {
    lambda = population > 0 ? population : 4 + static_cast<int>(std::floor(3 * std::log(n)));
    mu = lambda / 2;
    weights = falling_weights(mu, lambda);
    mu_eff = 1 / weights.squaredNorm();
    c_sigma = (mu_eff + 2) / (n + mu_eff + 5);                                               // eq. (55)
    d_sigma = 1 + 2 * std::max(0.0, std::sqrt((mu_eff - 1) / (n + 1)) - 1) + c_sigma;        // eq. (55)
    c_c = (4 + mu_eff / n) / (n + 4 + 2 * mu_eff / n);                                       // eq. (56)
    c_1 = 2 / (std::pow(n + 1.3, 2) + mu_eff);                                               // eq. (57)
    c_mu = std::min(1 - c_1, 2 * (mu_eff - 2 + 1 / mu_eff) / (std::pow(n + 2, 2) + mu_eff)); // eq. (58)
    expected_norm = std::sqrt(n) * (1 - 1 / (4.0 * n) + 1 / (21.0 * n * n));                 // E |N(0, I)|
  }
};

class CmaEs : public Optimizer {
public:
  CmaEs(int dimension, const CmaEsOptions &options)
      : n_(dimension), options_(options), strategy_(dimension, options.population), random_(options.seed),
        mean_(Eigen::VectorXd::Constant(n_, options.initial_mean)), sigma_(options.initial_sigma),
        covariance_(Eigen::MatrixXd::Identity(n_, n_)), path_sigma_(Eigen::VectorXd::Zero(n_)),
        path_c_(Eigen::VectorXd::Zero(n_)), best_(mean_) {
    decompose();
  }

  MatrixRM ask() override {
    MatrixRM samples(strategy_.lambda, n_);
    Eigen::VectorXd z(n_);
    for (int k = 0; k < strategy_.lambda; ++k) {
      for (int i = 0; i < n_; ++i)
        z[i] = random_.normal();
      samples.row(k) = (mean_ + sigma_ * (axes_ * lengths_.cwiseProduct(z))).transpose(); // eq. (38)-(40)
    }
    return samples;
  }

  void tell(const MatrixRM &samples, const Eigen::VectorXd &energies) override {
    check_told(samples, energies, n_, strategy_.mu);
    std::vector<int> order(static_cast<std::size_t>(energies.size()));
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return energies[a] < energies[b]; });
    if (evaluations_ == 0 || energies[order[0]] < best_energy_) {
      best_energy_ = energies[order[0]];
      best_ = samples.row(order[0]).transpose();
    }
    evaluations_ += static_cast<int>(energies.size());
    ++generation_;
    remember(bests_, energies[order[0]]);
    remember(medians_, energies[order[order.size() / 2]]);
    update(samples, order);
    decompose();
  }

  bool stop() const override { return !reason().empty(); }

  OptimizerResult result() const override {
    OptimizerResult result;
    result.answer = mean_;
    result.best = best_;
    result.best_energy = best_energy_;
    result.deviations = deviations();
    result.evaluations = evaluations_;
    result.generations = generation_;
    result.stop_reason = reason();
    return result;
  }

  std::string save() const override {
    state::Json json = {{"kind", kCmaEs},
                        {"n", n_},
                        {"lambda", strategy_.lambda},
                        {"random", random_.state()},
                        {"sigma", sigma_},
                        {"best_energy", best_energy_},
                        {"evaluations", evaluations_},
                        {"generation", generation_}};
    json["mean"] = state::to_json(mean_);
    json["covariance"] = state::to_json(covariance_);
    json["path_sigma"] = state::to_json(path_sigma_);
    json["path_c"] = state::to_json(path_c_);
    json["best"] = state::to_json(best_);
    json["bests"] = bests_;
    json["medians"] = medians_;
    return json.dump();
  }

  void restore(const std::string &text) override {
    state::read(text, kCmaEs, [&](const state::Json &json) {
      if (json.at("n") != n_ || json.at("lambda") != strategy_.lambda)
        throw Error("optimiser state: expected dimension " + std::to_string(n_) + " and population " +
                    std::to_string(strategy_.lambda) + ", found " + json.at("n").dump() + " and " + json.at("lambda").dump());
      mean_ = state::vector(json.at("mean"), n_);
      covariance_ = state::matrix(json.at("covariance"), n_, n_);
      path_sigma_ = state::vector(json.at("path_sigma"), n_);
      path_c_ = state::vector(json.at("path_c"), n_);
      best_ = state::vector(json.at("best"), n_);
      bests_ = json.at("bests").get<std::vector<double>>();
      medians_ = json.at("medians").get<std::vector<double>>();
      sigma_ = json.at("sigma");
      best_energy_ = json.at("best_energy");
      evaluations_ = state::count(json.at("evaluations"));
      generation_ = state::count(json.at("generation"));
      random_.restore(json.at("random"));
      decompose();
    });
  }

private:
  Eigen::VectorXd deviations() const { return sigma_ * covariance_.diagonal().cwiseSqrt(); }

  std::string reason() const {
    if (deviations().maxCoeff() < options_.min_deviation)
      return "every standard deviation below " + state::Json(options_.min_deviation).dump();
    if (settled(bests_) && settled(medians_))
      return "energies of " + std::to_string(2 * kHalf) + " generations within " + state::Json(options_.stagnation).dump();
    if (evaluations_ >= options_.max_evaluations)
      return std::to_string(options_.max_evaluations) + " evaluations";
    if (lengths_.minCoeff() <= 0 || std::pow(lengths_.maxCoeff() / lengths_.minCoeff(), 2) > kLargestCondition)
      return "condition of the covariance above 1e14";
    if ((mean_ + 0.2 * deviations()).cwiseEqual(mean_).all())
      return "steps below the precision of the numbers";
    return {};
  }

  static void remember(std::vector<double> &history, double energy) {
    if (history.size() == 2 * kHalf)
      history.erase(history.begin());
    history.push_back(energy);
  }
  /// In either direction: while the search still widens, energies rise.
  bool settled(const std::vector<double> &history) const {
    if (history.size() < 2 * kHalf)
      return false;
    const auto half = history.begin() + kHalf;
    const double before = median({history.begin(), half}), now = median({half, history.end()});
    return std::fabs(before - now) < options_.stagnation * std::fabs(now);
  }

  void update(const MatrixRM &samples, const std::vector<int> &order) {
    const Strategy &s = strategy_;
    const Eigen::VectorXd old_mean = mean_;
    Eigen::MatrixXd steps(n_, s.mu); // y_i:lambda
    for (int i = 0; i < s.mu; ++i)
      steps.col(i) = (samples.row(order[i]).transpose() - old_mean) / sigma_;
    const Eigen::VectorXd step = steps * s.weights; // eq. (41)
    mean_ = old_mean + sigma_ * step;               // eq. (42)

    const Eigen::VectorXd whitened = axes_ * (axes_.transpose() * step).cwiseQuotient(lengths_);                // C^-1/2 <y>_w
    path_sigma_ = (1 - s.c_sigma) * path_sigma_ + std::sqrt(s.c_sigma * (2 - s.c_sigma) * s.mu_eff) * whitened; // eq. (43)
    const double norm = path_sigma_.norm();
    const double decay = 1 - std::pow(1 - s.c_sigma, 2 * generation_);
    const bool stalled = norm / std::sqrt(decay) >= (1.4 + 2.0 / (n_ + 1)) * s.expected_norm;             // h_sigma = 0
    path_c_ = (1 - s.c_c) * path_c_ + (stalled ? 0.0 : std::sqrt(s.c_c * (2 - s.c_c) * s.mu_eff)) * step; // eq. (45)

    const double correction = stalled ? s.c_1 * s.c_c * (2 - s.c_c) : 0.0;
    covariance_ = (1 - s.c_1 - s.c_mu + correction) * covariance_ + s.c_1 * path_c_ * path_c_.transpose() +
                  s.c_mu * steps * s.weights.asDiagonal() * steps.transpose(); // eq. (47)
    covariance_ = (0.5 * (covariance_ + covariance_.transpose())).eval();
    sigma_ *= std::exp(std::min(1.0, (s.c_sigma / s.d_sigma) * (norm / s.expected_norm - 1))); // eq. (44), growth bounded
  }

  // Every generation: n is small, and a state restored from the covariance alone has the same axes.
  void decompose() {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance_);
    axes_ = solver.eigenvectors();
    lengths_ = solver.eigenvalues().cwiseMax(0.0).cwiseSqrt();
  }

  int n_;
  CmaEsOptions options_;
  Strategy strategy_;
  NormalGenerator random_;
  Eigen::VectorXd mean_;
  double sigma_;
  Eigen::MatrixXd covariance_, axes_; // C = axes diag(lengths^2) axes^T
  Eigen::VectorXd lengths_, path_sigma_, path_c_, best_;
  std::vector<double> bests_, medians_; // of the last generations
  double best_energy_ = 0;
  int evaluations_ = 0, generation_ = 0;
};

} // namespace

void Optimizer::restore(const std::string &) {
  throw Error("optimiser state: this optimiser cannot be restored");
}

void CmaEsOptions::validate() const {
  options::check(*this);
  require(population == 0 || population >= 4,
          "CmaEsOptions: population: expected 0 or at least 4, found " + std::to_string(population));
}

std::unique_ptr<Optimizer> create_cma_es(int dimension, const CmaEsOptions &options) {
  require_dimension(dimension, "create_cma_es");
  options.validate();
  return std::make_unique<CmaEs>(dimension, options);
}

} // namespace doublet
