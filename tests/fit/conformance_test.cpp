#include "doublet/testing/optimizer_conformance.h"

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
  for (const OptimizerFactory &make : {OptimizerFactory(cma_es), OptimizerFactory(annealing)})
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

} // namespace
} // namespace doublet
