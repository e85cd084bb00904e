#include "doublet/core/error.h"
#include "doublet/fit/minimise.h"
#include "fit/functions.h"
#include "support/temp_folder.h"

#include <gtest/gtest.h>

namespace doublet {
namespace {

using namespace testing;

/// Two independent parts with different minima; counts what it was asked.
class TwoSpheres : public Objective {
public:
  int parameter_count() const override { return 3; }
  int part_count() const override { return 2; }
  MatrixRM evaluate(const MatrixRM &samples, const Context &) override {
    EXPECT_GE(samples.minCoeff(), 0);
    EXPECT_LE(samples.maxCoeff(), 1);
    if (++generations == fail_at)
      throw Error("killed");
    MatrixRM energies(samples.rows(), 2);
    energies.col(0) = (samples.leftCols(3).array() - 0.2).square().rowwise().sum();
    energies.col(1) = 50 * (samples.rightCols(3).array() - 1.0).square().rowwise().sum();
    return energies;
  }
  int generations = 0, fail_at = -1;
};

void expect_same(const MinimiseResult &a, const MinimiseResult &b) {
  EXPECT_EQ(a.penalties, b.penalties);
  ASSERT_EQ(a.parts.size(), b.parts.size());
  for (std::size_t r = 0; r < a.parts.size(); ++r) {
    EXPECT_EQ(a.parts[r].answer, b.parts[r].answer);
    EXPECT_EQ(a.parts[r].best, b.parts[r].best);
    EXPECT_EQ(a.parts[r].evaluations, b.parts[r].evaluations);
  }
  ASSERT_EQ(a.log.size(), b.log.size());
  for (std::size_t i = 0; i < a.log.size(); ++i) {
    EXPECT_EQ(a.log[i].mean, b.log[i].mean);
    EXPECT_EQ(a.log[i].best, b.log[i].best);
  }
}

TEST(Minimise, FindsEveryPartsOwnMinimumEvenAtTheBoxsCorner) {
  TwoSpheres objective;
  const MinimiseResult result = minimise(objective);
  EXPECT_LT((result.parts[0].answer.array() - 0.2).abs().maxCoeff(), 0.05);
  EXPECT_LT((result.parts[1].answer.array() - 1.0).abs().maxCoeff(), 0.06);
  EXPECT_FALSE(result.parts[0].stop_reason.empty());
  EXPECT_EQ(result.log.back().evaluations % 7, 0); // 4 + floor(3 ln 3)
}

TEST(Minimise, ResumesToTheSameBits) {
  TwoSpheres whole;
  MinimiseOptions options;
  const MinimiseResult expected = minimise(whole, options);

  const TempFolder folder;
  options.checkpoint = folder / "checkpoint.json";
  TwoSpheres killed;
  killed.fail_at = 6;
  EXPECT_THROW(minimise(killed, options), Error);
  TwoSpheres resumed;
  expect_same(minimise(resumed, options), expected);
  EXPECT_EQ(resumed.generations, whole.generations - 5);
  std::size_t rows = 0;
  options.on_generation = [&](const MinimiseResult &result) { rows = result.log.size(); };
  TwoSpheres again; // a finished run is not repeated, but its caller learns of it
  expect_same(minimise(again, options), expected);
  EXPECT_EQ(again.generations, 0);
  EXPECT_EQ(rows, expected.log.size());
}

/// Asks for the same samples twice, of which the last is outside the box, and keeps what it is told.
class Recorder : public Optimizer {
public:
  explicit Recorder(std::vector<Eigen::VectorXd> &told) : told_(&told) {}
  MatrixRM ask() override {
    MatrixRM samples = MatrixRM::Constant(3, 3, 0.4);
    samples.row(1).setConstant(0.7);
    samples.row(2) << 0.7, 1.5, -0.25;
    return samples;
  }
  void tell(const MatrixRM &, const Eigen::VectorXd &energies) override { told_->push_back(energies); }
  bool stop() const override { return told_->size() >= 2; }
  OptimizerResult result() const override {
    const Eigen::VectorXd zero = Eigen::VectorXd::Zero(3);
    return {zero, zero, 0, zero, 0, 0, ""};
  }

private:
  std::vector<Eigen::VectorXd> *told_;
};

/// Energies of 40, 300 and 80, and all twice as high in the second generation.
class Steps : public Objective {
public:
  int parameter_count() const override { return 3; }
  MatrixRM evaluate(const MatrixRM &samples, const Context &) override {
    EXPECT_EQ(samples.row(2), Eigen::RowVector3d(0.7, 1, 0));
    return ++generations * (MatrixRM(3, 1) << 40, 300, 80).finished();
  }
  int generations = 0;
};

TEST(Minimise, ThePenaltyIsRelativeToTheFirstGeneration) {
  for (bool relative : {false, true}) {
    std::vector<Eigen::VectorXd> told;
    MinimiseOptions options;
    options.relative_penalty = relative;
    options.make_optimizer = [&](int, std::uint64_t) { return std::make_unique<Recorder>(told); };
    Steps objective;
    const MinimiseResult result = minimise(objective, options);
    const double outside = (0.25 + 0.0625) * 16 * (relative ? 80 : 1); // median of 40, 80, 300
    EXPECT_EQ(told[0], Eigen::Vector3d(40, 300, 80 + outside));
    EXPECT_EQ(told[1], Eigen::Vector3d(80, 600, 160 + outside));
    EXPECT_EQ(result.penalties, std::vector<double>{relative ? 16 * 80.0 : 16.0});
  }
}

TEST(Minimise, AFlatDirectionStaysInsideTheBox) {
  /// Energies of hundreds that one parameter does not change.
  class Valley : public Objective {
  public:
    int parameter_count() const override { return 2; }
    MatrixRM evaluate(const MatrixRM &samples, const Context &) override {
      return (100 + 2000 * (samples.col(0).array() - 0.9).square() - 30 * samples.col(1).array()).matrix();
    }
  };
  const auto outside = [](bool relative) {
    double sum = 0;
    for (std::uint64_t seed = 1; seed <= 11; ++seed) {
      MinimiseOptions options;
      options.relative_penalty = relative;
      options.seed = seed;
      Valley valley;
      const Eigen::VectorXd answer = minimise(valley, options).parts[0].answer;
      sum += (answer - answer.cwiseMax(0.0).cwiseMin(1.0)).norm() / 11;
    }
    return sum;
  };
  const double relative = outside(true), absolute = outside(false);
  std::printf("outside the box by: relative %.3f, absolute %.3f\n", relative, absolute);
  EXPECT_LT(relative, 0.02);
  EXPECT_GT(absolute, 5 * relative);
}

TEST(Minimise, CancelsBetweenGenerationsAndResumes) {
  TwoSpheres whole;
  const MinimiseResult expected = minimise(whole);
  const TempFolder folder;
  MinimiseOptions options;
  options.checkpoint = folder / "checkpoint.json";
  TwoSpheres objective;
  Context context;
  context.cancelled = [&] { return objective.generations >= 4; };
  EXPECT_THROW(minimise(objective, options, context), Cancelled);
  EXPECT_EQ(objective.generations, 4);
  context.cancelled = nullptr;
  expect_same(minimise(objective, options, context), expected);
}

TEST(Minimise, ACheckpointOfAnotherProblemIsNotUsed) {
  const TempFolder folder;
  MinimiseOptions options;
  options.checkpoint = folder / "checkpoint.json";
  options.problem = "one";
  TwoSpheres first;
  minimise(first, options);
  options.problem = "two";
  TwoSpheres second;
  std::string said;
  Context context;
  context.log = [&](const std::string &line) { said += line + "\n"; };
  minimise(second, options, context);
  EXPECT_EQ(second.generations, first.generations);
  EXPECT_NE(said.find("belongs to other data or options"), std::string::npos);
  write_text(options.checkpoint, "{\"kind\":");
  EXPECT_THROW(minimise(second, options), Error);
}

MinimiseOptions with_budget(int budget, const Path &checkpoint) {
  MinimiseOptions options;
  options.budget = budget;
  options.checkpoint = checkpoint;
  options.make_optimizer = [budget](int n, std::uint64_t seed) {
    CmaEsOptions cma;
    cma.max_evaluations = budget;
    cma.seed = seed;
    return create_cma_es(n, cma);
  };
  return options;
}

TEST(Minimise, ALargerBudgetGoesOnToTheBitsOfOneSearch) {
  const TempFolder folder;
  TwoSpheres whole, first, second;
  const MinimiseResult expected = minimise(whole, with_budget(120, {}));
  minimise(first, with_budget(40, folder / "checkpoint"));
  expect_same(minimise(second, with_budget(120, folder / "checkpoint")), expected);
  EXPECT_EQ(first.generations + second.generations, whole.generations);

  TwoSpheres small, again; // and a smaller one does not take over what it would never have reached
  const MinimiseResult little = minimise(small, with_budget(40, {}));
  std::string said;
  Context context;
  context.log = [&](const std::string &line) { said += line; };
  expect_same(minimise(again, with_budget(40, folder / "checkpoint"), context), little);
  EXPECT_NE(said.find("longer search"), std::string::npos) << said;
}

TEST(Minimise, ADamagedCheckpointIsNamedAndNotQuoted) {
  const TempFolder folder;
  TwoSpheres objective;
  MinimiseOptions options = with_budget(40, folder / "checkpoint");
  minimise(objective, options);
  const std::string whole = read_text(options.checkpoint);
  const auto replaced = [&](const std::string &from, const std::string &to) {
    std::string text = whole;
    text.replace(text.find(from), from.size(), to);
    return text;
  };
  const std::size_t rows = whole.find("\"log\":["), end = whole.find("]]", rows);
  const std::string without_log = whole.substr(0, rows) + "\"log\":[" + whole.substr(end + 1);
  for (const std::string &text :
       {without_log, whole.substr(0, whole.size() / 2), std::string("{}"), std::string(), "[" + whole + "]",
        replaced("\"log\":[[", "\"log\":[[99,"), replaced("\"log\":[[0,1,", "\"log\":[[]],\"x\":[[0,1,"),
        replaced("\"optimizers\":[\"", "\"optimizers\":[\"x"), replaced("evaluations", "valuations"),
        replaced("\\\"evaluations\\\":", "\\\"evaluations\\\":-")}) {
    write_text(options.checkpoint, text);
    try {
      minimise(objective, options);
      ADD_FAILURE() << "was read: " << text.substr(0, 200);
    } catch (const Error &error) {
      const std::string said = error.what();
      EXPECT_NE(said.find(options.checkpoint.string()), std::string::npos) << said;
      EXPECT_LT(said.size(), 500u) << said;
    }
  }
}

TEST(Minimise, RowsComeAfterEveryGeneration) {
  TwoSpheres objective;
  MinimiseOptions options;
  std::size_t rows = 0;
  options.on_generation = [&](const MinimiseResult &sofar) {
    EXPECT_GT(sofar.log.size(), rows);
    EXPECT_EQ(sofar.parts[sofar.log.back().part].evaluations, sofar.log.back().evaluations);
    rows = sofar.log.size();
  };
  double fraction = 0;
  Context context;
  context.progress = [&](const std::string &, double now) {
    EXPECT_GE(now, fraction);
    fraction = now;
  };
  const MinimiseResult result = minimise(objective, options, context);
  EXPECT_EQ(rows, result.log.size());
  EXPECT_EQ(fraction, 1.0);
}

TEST(Minimise, AnOptimizerCanBeSwapped) {
  TwoSpheres objective;
  MinimiseOptions options;
  options.make_optimizer = [](int n, std::uint64_t seed) {
    AnnealingOptions annealing;
    annealing.seed = seed;
    return create_simulated_annealing(n, annealing);
  };
  const MinimiseResult result = minimise(objective, options);
  EXPECT_LT((result.parts[0].answer.array() - 0.2).abs().maxCoeff(), 0.08);
}

TEST(Minimise, NotFiniteIsAnError) {
  class Bad : public Objective {
    int parameter_count() const override { return 2; }
    MatrixRM evaluate(const MatrixRM &samples, const Context &) override {
      return MatrixRM::Constant(samples.rows(), 1, std::nan(""));
    }
  } objective;
  EXPECT_THROW(minimise(objective), Error);
}

} // namespace
} // namespace doublet
