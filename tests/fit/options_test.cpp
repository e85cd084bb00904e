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

} // namespace
} // namespace doublet
