#include "doublet/fit/material_estimator.h"
#include "support/option_ranges.h"

namespace doublet {
namespace {

TEST(Options, WhatLiesOutsideARangeIsRefusedByName) {
  expect_ranges<FitOptions>();
  expect_ranges<MinimiseOptions>();
  expect_ranges<CmaEsOptions>();
  expect_ranges<AnnealingOptions>();
  expect_ranges<BayesianOptions>();
}

TEST(Options, APopulationIsOneOfTheSearchThatIsAskedFor) {
  const auto valid = [](SearchMethod method, int population) {
    FitOptions options;
    options.optimizer = method;
    options.population = population;
    try {
      options.validate();
    } catch (const std::invalid_argument &) {
      return false;
    }
    return true;
  };
  for (const SearchMethod method : {SearchMethod::Bayesian, SearchMethod::CmaEs, SearchMethod::Annealing})
    EXPECT_TRUE(valid(method, 0));
  EXPECT_TRUE(valid(SearchMethod::Annealing, 2)); // chains
  EXPECT_FALSE(valid(SearchMethod::CmaEs, 2));
  EXPECT_FALSE(valid(SearchMethod::Bayesian, 2));
  EXPECT_FALSE(valid(SearchMethod::Bayesian, 5000));
}

} // namespace
} // namespace doublet
