// Thompson sampling from a Gaussian process, see BayesianOptions.

#include "doublet/core/parts/normal_generator.h"
#include "doublet/fit/optimizer.h"
#include "doublet/fit/parts/even_points.h"
#include "doublet/fit/parts/gaussian_process.h"
#include "energy_scale.h"
#include "optimizer_checks.h"
#include "state_json.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <optional>
#include <set>

namespace doublet {
namespace {

using fit::EnergyScale;

constexpr const char *kBayesian = "bayesian";
constexpr int kGroup = 16;                   // samples that share a level: what fills the widest registers
constexpr int kDraws = 64;                   // functions
constexpr int kCandidates = 600;             // points at which a function is drawn; as many as a larger generation takes
constexpr int kBeside = 300;                 // more, at the levels beside those of the lowest samples
constexpr double kSameLevel = 1e-3;          // of the box: levels are further apart
constexpr int kAround = 8;                   // of the lowest samples, around which most candidates lie
constexpr int kFirstSteps = 60, kSteps = 15; // of the search for the process' parameters
constexpr std::size_t kSettled = 4;          // generations in which nothing was found ...
constexpr std::size_t kHopeless = 2;         // ... and after so many of them nothing is expected
constexpr std::size_t kQuiet = 2;            // generations without a find, and one without hope, before levels are looked at

/// Functions drawn from the process at points, of which the first is the answer.
struct FunctionDraws {
  MatrixRM points;        // (M, n)
  Eigen::MatrixXd values; // (M, kDraws)
  Eigen::Index lowest(Eigen::Index draw) const {
    Eigen::Index row = 0;
    values.col(draw).minCoeff(&row);
    return row;
  }
};

class Bayesian : public Optimizer {
public:
  Bayesian(int dimension, const BayesianOptions &options)
      : n_(dimension), options_(options), random_(options.seed), samples_(0, n_), answer_(Eigen::VectorXd::Constant(n_, 0.5)),
        deviations_(Eigen::VectorXd::Constant(n_, std::sqrt(1.0 / 12))) {
    if (options_.first.rows() == 0) {
      options_.first = even_points(2 * options.population, n_, static_cast<int>(options.seed % 1000) * 2 * options.population);
      for (auto sample : options_.first.rowwise())
        sample = on_level(sample);
    }
  }

  MatrixRM ask() override {
    if (generation_ == 0)
      return options_.first;
    if (!draws_)
      draws_ = draw_functions();
    const MatrixRM samples = picked(*draws_, levels_of_groups(*draws_));
    draws_.reset(); // asked again: another draw
    return samples;
  }

  void tell(const MatrixRM &samples, const Eigen::VectorXd &energies) override {
    check_told(samples, energies, n_, 1);
    const Eigen::Index before = samples_.rows(), count = samples.rows();
    samples_.conservativeResize(before + count, n_);
    samples_.bottomRows(count) = samples;
    energies_.conservativeResize(before + count);
    energies_.tail(count) = energies;
    ++generation_;
    consider(logs_.size() == 0 ? kFirstSteps : kSteps);
    answers_.push_back(answer_energy_);
    expected_gains_.push_back(expected_gain_);
  }

  bool stop() const override { return !reason().empty(); }

  OptimizerResult result() const override {
    OptimizerResult result;
    result.answer = answer_;
    result.deviations = deviations_;
    result.best = Eigen::VectorXd::Constant(n_, 0.5);
    if (energies_.size() > 0) {
      Eigen::Index best = 0;
      result.best_energy = energies_.minCoeff(&best);
      result.best = samples_.row(best).transpose();
    }
    result.evaluations = static_cast<int>(energies_.size());
    result.generations = generation_;
    result.stop_reason = reason();
    return result;
  }

  std::string save() const override {
    state::Json json = {{"kind", kBayesian}, {"n", n_}, {"generation", generation_}, {"random", random_before_}};
    json["samples"] = state::to_json(samples_);
    json["energies"] = state::to_json(energies_);
    json["logs"] = state::to_json(logs_);
    json["answers"] = answers_;
    json["expected_gains"] = expected_gains_;
    return json.dump();
  }

  void restore(const std::string &text) override {
    state::read(text, kBayesian, [&](const state::Json &json) {
      if (json.at("n") != n_)
        throw Error("optimiser state: expected dimension " + std::to_string(n_) + ", found " + json.at("n").dump());
      const auto count = static_cast<Eigen::Index>(json.at("energies").size());
      if (count < 2)
        throw Error("optimiser state: expected at least 2 energies, found " + std::to_string(count));
      samples_ = state::matrix(json.at("samples"), count, n_);
      energies_ = state::vector(json.at("energies"), count);
      logs_ = state::vector(json.at("logs"), n_ + 2);
      answers_ = json.at("answers").get<std::vector<double>>();
      expected_gains_ = json.at("expected_gains").get<std::vector<double>>();
      generation_ = state::count(json.at("generation"));
      random_.restore(json.at("random"));
      consider(0);
    });
  }

private:
  std::string reason() const {
    if (gained_nothing(kSettled) && hopeless(kHopeless) && open_levels().empty())
      return "the answer gained less than " + state::Json(options_.min_gain).dump() + " in " + std::to_string(kSettled) +
             " generations, and is expected to gain less than " + state::Json(options_.min_expected_gain).dump();
    if (energies_.size() >= options_.max_evaluations)
      return std::to_string(options_.max_evaluations) + " evaluations";
    return {};
  }

  /// Every generation goes where the minimum may be, a look at other levels too, so that several that find nothing tell that it
  /// is found. Not from the first on, which went anywhere.
  bool gained_nothing(std::size_t generations) const {
    const std::size_t count = answers_.size();
    if (options_.min_gain == 0 || count < generations + 2)
      return false;
    const double before = answers_[count - 1 - generations], now = answers_.back();
    return before - now < options_.min_gain * std::fabs(now);
  }

  /// Early on the process is too hopeful: its answer then rises, and has gained nothing, while the search is still on its way.
  bool hopeless(std::size_t generations) const {
    return expected_gains_.size() >= generations &&
           std::all_of(expected_gains_.end() - static_cast<std::ptrdiff_t>(generations), expected_gains_.end(),
                       [this](double gain) { return gain < options_.min_expected_gain; });
  }

  /// The levels beside the answer's at which the last group found more than is missing there: they may lie lower than the answer,
  /// which the process, that has seen little of them, does not expect.
  std::vector<double> open_levels() const {
    std::vector<double> open;
    if (options_.levels > 1)
      for (const double step : {-1, 1}) {
        const double level = answer_[n_ - 1] + step / (options_.levels - 1);
        if (level > -kSameLevel && level < 1 + kSameLevel && is_open(level))
          open.push_back(level);
      }
    return open;
  }

  /// Early enough for what they find to be followed: the open levels, when the answer moves no more.
  std::vector<double> levels_to_look_at() const {
    return gained_nothing(kQuiet) && hopeless(1) ? open_levels() : std::vector<double>{};
  }

  bool is_open(double level) const {
    std::vector<double> there;
    for (Eigen::Index i = 0; i < samples_.rows(); ++i)
      if (std::fabs(samples_(i, n_ - 1) - level) < kSameLevel)
        there.push_back(energies_[i]);
    const auto group = static_cast<std::size_t>(std::min(options_.population, kGroup));
    if (there.size() <= group)
      return true;
    const double before = *std::min_element(there.begin(), there.end() - static_cast<std::ptrdiff_t>(group));
    const double now = *std::min_element(there.begin(), there.end());
    return before - now > now - energies_.minCoeff();
  }

  Eigen::RowVectorXd on_level(Eigen::RowVectorXd point) const {
    if (options_.levels > 1)
      point[n_ - 1] = std::round(point[n_ - 1] * (options_.levels - 1)) / (options_.levels - 1);
    return point;
  }

  /// What follows from the samples so far: process, answer, where the minimum may be, and by how much it may lie lower. The scale
  /// zooms in with the samples.
  void consider(int steps) {
    random_before_ = random_.state();
    const EnergyScale scale = fit::scale_of(energies_);
    process_.emplace(samples_, scale.shown(energies_), logs_, steps);
    logs_ = process_->logs();
    draws_ = draw_functions();
    answer_ = draws_->points.row(0).transpose();
    answer_energy_ = scale.energy(process_->mean(MatrixRM(answer_.transpose()))[0]);
    MatrixRM minima(kDraws, n_);
    double at_answer = 0, lowest = 0; // sums
    for (Eigen::Index d = 0; d < kDraws; ++d) {
      const Eigen::Index row = draws_->lowest(d);
      minima.row(d) = draws_->points.row(row);
      at_answer += scale.energy(draws_->values(0, d));
      lowest += scale.energy(draws_->values(row, d));
    }
    expected_gain_ = (at_answer - lowest) / std::max(std::fabs(at_answer), 1e-300);
    const Eigen::RowVectorXd centre = minima.colwise().mean();
    deviations_ = (minima.rowwise() - centre).array().square().colwise().mean().sqrt().transpose();
  }

  FunctionDraws draw_functions() {
    const MatrixRM around = candidates();
    FunctionDraws drawn;
    drawn.points.resize(around.rows() + 1, n_);
    drawn.points << lowest_mean(around).transpose(), around;
    Eigen::VectorXd mean;
    Eigen::MatrixXd covariance;
    process_->posterior(drawn.points, mean, covariance);
    Eigen::MatrixXd normal(mean.size(), kDraws);
    for (Eigen::Index d = 0; d < kDraws; ++d)
      for (Eigen::Index i = 0; i < mean.size(); ++i)
        normal(i, d) = random_.normal();
    covariance.diagonal().array() += 1e-6 * covariance.diagonal().maxCoeff() + 1e-12; // of points that nearly coincide
    const Eigen::LLT<Eigen::MatrixXd> factor(covariance);
    drawn.values = (factor.matrixL() * normal).colwise() + mean;
    return drawn;
  }

  /// Most around the lowest samples, at all distances, along some of the axes: often on the faces of the box, where minima are.
  /// Others as near to them, but at the next level: a valley that is narrower than a level is wide goes on there.
  MatrixRM candidates() {
    const std::vector<int> lowest = lowest_samples();
    const auto low = [&] {
      return Eigen::RowVectorXd(
          samples_.row(lowest[static_cast<std::size_t>(random_.uniform() * static_cast<double>(lowest.size()))]));
    };
    const int wide = std::max(kCandidates, options_.population), beside = options_.levels > 1 ? kBeside : 0;
    MatrixRM points(wide + beside, n_);
    for (int i = 0; i < wide; ++i)
      points.row(i) = on_level(i % 3 == 0 ? everywhere() : near(low()));
    for (int i = wide; i < points.rows(); ++i) {
      const Eigen::RowVectorXd from = low();
      points.row(i) = near(from);
      points(i, n_ - 1) = inside(from[n_ - 1] + (random_.uniform() < 0.5 ? -1 : 1) / (options_.levels - 1.0));
      points.row(i) = on_level(points.row(i));
    }
    return points;
  }

  Eigen::RowVectorXd everywhere() {
    Eigen::RowVectorXd point(n_);
    for (int j = 0; j < n_; ++j)
      point[j] = std::clamp(1.2 * random_.uniform() - 0.1, 0.0, 1.0);
    return point;
  }

  Eigen::RowVectorXd near(Eigen::RowVectorXd point) {
    constexpr double kNear = 0.02, kFar = 0.4, kMoved = 0.6;
    const double reach = kNear * std::pow(kFar / kNear, random_.uniform());
    const int always = static_cast<int>(random_.uniform() * n_);
    for (int j = 0; j < n_; ++j) {
      const double step = reach * random_.normal();
      if (j == always || random_.uniform() < kMoved)
        point[j] = inside(point[j] + step);
    }
    return point;
  }

  /// Half of what leaves the box stays on its face, the other half comes back.
  double inside(double x) {
    if (x < 0)
      x = random_.uniform() < 0.5 ? 0 : -x;
    if (x > 1)
      x = random_.uniform() < 0.5 ? 1 : 2 - x;
    return std::clamp(x, 0.0, 1.0);
  }

  /// By the mean of the process, which does not believe in lucky samples, and as many that were lucky: it may be wrong.
  std::vector<int> lowest_samples() const {
    std::vector<int> lowest;
    for (const Eigen::VectorXd &values : {process_->mean(samples_), energies_}) {
      std::vector<int> order(static_cast<std::size_t>(values.size()));
      std::iota(order.begin(), order.end(), 0);
      const auto count = std::min<std::ptrdiff_t>(kAround, values.size());
      std::partial_sort(order.begin(), order.begin() + count, order.end(), [&](int a, int b) { return values[a] < values[b]; });
      lowest.insert(lowest.end(), order.begin(), order.begin() + count);
    }
    return lowest;
  }

  Eigen::VectorXd lowest_mean(const MatrixRM &candidates) const {
    MatrixRM all(candidates.rows() + samples_.rows(), n_);
    all << candidates, samples_;
    const Eigen::VectorXd mean = process_->mean(all);
    Eigen::Index best = 0;
    mean.minCoeff(&best);
    return process_->minimum(all.row(best).transpose(), options_.levels > 1 ? 1 : 0);
  }

  /// The next generation: the minima of functions drawn, no two alike, in groups at these levels (negative: at any).
  MatrixRM picked(const FunctionDraws &drawn, const std::vector<double> &levels) const {
    std::vector<Eigen::Index> rows;
    std::set<Eigen::Index> taken;
    for (std::size_t group = 0; group < levels.size(); ++group) {
      const std::size_t size = static_cast<std::size_t>(options_.population) * (group + 1) / levels.size();
      const double level = levels[group];
      for (Eigen::Index depth = 0; rows.size() < size && depth < drawn.points.rows(); ++depth)
        for (Eigen::Index d = 0; rows.size() < size && d < kDraws; ++d)
          if (const Eigen::Index row = lowest_free(drawn, d, level, taken); row >= 0) {
            taken.insert(row);
            rows.push_back(row);
          }
    }
    MatrixRM samples(static_cast<Eigen::Index>(rows.size()), n_);
    for (std::size_t i = 0; i < rows.size(); ++i)
      samples.row(static_cast<Eigen::Index>(i)) = drawn.points.row(rows[i]);
    return samples;
  }

  /// In proportion to how many of the draws are lowest there. When the answer moves no more, those beside it that are open.
  std::vector<double> levels_of_groups(const FunctionDraws &drawn) const {
    if (options_.levels < 2)
      return {-1};
    const std::size_t groups = static_cast<std::size_t>(std::max(1, options_.population / kGroup));
    std::vector<double> lowest;
    for (Eigen::Index d = 0; d < kDraws; ++d)
      lowest.push_back(drawn.points(drawn.lowest(d), n_ - 1));
    std::sort(lowest.begin(), lowest.end());
    if (const std::vector<double> open = levels_to_look_at(); !open.empty())
      lowest = open;
    std::vector<double> levels;
    for (std::size_t group = 0; group < groups; ++group)
      levels.push_back(lowest[(2 * group + 1) * lowest.size() / (2 * groups)]);
    return levels;
  }

  /// The lowest point of a draw that is not taken, of those at the level if it is not negative; -1 if there is none.
  Eigen::Index lowest_free(const FunctionDraws &drawn, Eigen::Index draw, double level,
                           const std::set<Eigen::Index> &taken) const {
    Eigen::Index best = -1;
    for (Eigen::Index i = 0; i < drawn.points.rows(); ++i)
      if ((level < 0 || std::fabs(drawn.points(i, n_ - 1) - level) < kSameLevel) && !taken.count(i) &&
          (best < 0 || drawn.values(i, draw) < drawn.values(best, draw)))
        best = i;
    return best;
  }

  int n_;
  BayesianOptions options_;
  NormalGenerator random_;
  std::string random_before_; // where the random numbers stood when the samples so far were considered
  MatrixRM samples_;
  Eigen::VectorXd energies_, logs_, answer_, deviations_;
  std::vector<double> answers_;        // what the process says that they cost, after every generation ...
  std::vector<double> expected_gains_; // ... and how much of that it expects to gain
  std::optional<GaussianProcess> process_;
  std::optional<FunctionDraws> draws_;
  double answer_energy_ = 0, expected_gain_ = 0;
  int generation_ = 0;
};

} // namespace

void BayesianOptions::validate() const {
  options::check(*this);
  require(first.size() == 0 || (first.rows() >= 4 && first.allFinite()),
          "BayesianOptions: first: expected no samples, or at least 4 finite ones, found " + std::to_string(first.rows()) +
              (first.allFinite() ? "" : " with NaN or infinity"));
}

std::unique_ptr<Optimizer> create_bayesian(int dimension, const BayesianOptions &options) {
  require_dimension(dimension, "create_bayesian");
  options.validate();
  require(options.first.size() == 0 || options.first.cols() == dimension, "create_bayesian: first: expected " +
                                                                              std::to_string(dimension) + " columns, found " +
                                                                              std::to_string(options.first.cols()));
  return std::make_unique<Bayesian>(dimension, options);
}

} // namespace doublet
