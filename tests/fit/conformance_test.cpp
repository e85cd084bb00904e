#include "doublet/testing/objective_conformance.h"
#include "doublet/testing/optimizer_conformance.h"
#include "synthetic.h"

#include <gtest/gtest.h>

namespace doublet {
namespace {

TEST(Conformance, OurOptimizersConform) {
  const auto cma_es = [](int dimension, std::uint64_t seed) {
    CmaEsOptions options;
    options.seed = seed;
    return create_cma_es(dimension, options);
  };
  const auto annealing = [](int dimension, std::uint64_t seed) {
    AnnealingOptions options;
    options.seed = seed;
    return create_simulated_annealing(dimension, options);
  };
  const auto bayesian = [](int dimension, std::uint64_t seed) {
    BayesianOptions options;
    options.seed = seed;
    return create_bayesian(dimension, options);
  };
  for (const OptimizerFactory &make : {OptimizerFactory(cma_es), OptimizerFactory(annealing), OptimizerFactory(bayesian)})
    for (const std::string &broken : testing::optimizer_violations(make))
      ADD_FAILURE() << broken;
}

/// Samples the same point for ever, remembers nothing, takes anything.
class Stubborn : public Optimizer {
public:
  MatrixRM ask() override { return MatrixRM::Constant(4, 3, 0.1); }
  void tell(const MatrixRM &, const Eigen::VectorXd &) override {}
  bool stop() const override { return false; }
  OptimizerResult result() const override { return {Eigen::VectorXd::Constant(3, 0.1), {}, 0, {}, 0, 0, ""}; }
};

TEST(Conformance, TheKitCatchesAStubbornOptimizer) {
  // Does not end, forgets the best, misses the minimum, refuses nothing (two ways).
  EXPECT_EQ(testing::optimizer_violations([](int, std::uint64_t) { return std::make_unique<Stubborn>(); }).size(), 5u);
}

TEST(Conformance, OurObjectiveConforms) {
  const auto scene =
      testing::make_scene({testing::cotton()}, {.frames = 12, .cameras = 2, .pixels = 160, .rings = 6, .segments = 16});
  MaterialObjective objective(*scene->simulator, scene->performance, scene->observations, testing::kDt);
  for (const std::string &broken : testing::objective_violations(objective))
    ADD_FAILURE() << broken;
}

/// Its energy is the sample's place in the generation, and another one each time.
class Ranking : public Objective {
public:
  int parameter_count() const override { return 2; }
  MatrixRM evaluate(const MatrixRM &samples, const Context &) override {
    MatrixRM energies(samples.rows(), 1);
    for (int i = 0; i < samples.rows(); ++i)
      energies(i, 0) = i + 1000 * calls_ + samples.rows();
    ++calls_;
    return energies;
  }

private:
  int calls_ = 0;
};

TEST(Conformance, TheKitCatchesARankingObjective) {
  Ranking objective;
  EXPECT_EQ(testing::objective_violations(objective).size(), 5u); // again, order, alone, too wide, too narrow
}

/// Finds everything as good.
class Indifferent : public Objective {
public:
  int parameter_count() const override { return 2; }
  MatrixRM evaluate(const MatrixRM &samples, const Context &) override {
    if (samples.cols() != 2)
      throw std::invalid_argument("two parameters");
    return MatrixRM::Ones(samples.rows(), 1);
  }
};

TEST(Conformance, TheKitCatchesAnIndifferentObjective) {
  Indifferent objective;
  EXPECT_EQ(testing::objective_violations(objective), std::vector<std::string>{"part 0: every sample costs the same"});
}

} // namespace
} // namespace doublet
