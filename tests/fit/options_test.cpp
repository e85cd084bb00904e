#include "doublet/fit/garment_trial.h"
#include "doublet/fit/material_estimator.h"
#include "support/option_ranges.h"

namespace doublet {
namespace {

TEST(Options, WhatLiesOutsideARangeIsRefusedByName) {
  expect_ranges<FitOptions>();
  expect_ranges<TrialOptions>();
  expect_ranges<MinimiseOptions>();
  expect_ranges<CmaEsOptions>();
  expect_ranges<AnnealingOptions>();
}

} // namespace
} // namespace doublet
