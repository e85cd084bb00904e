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
