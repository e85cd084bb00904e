#include "doublet/bodymodel/body_fitter.h"
#include "doublet/bodymodel/proxies.h"
#include "doublet/bodymodel/train_body_model.h"
#include "support/option_ranges.h"

namespace doublet {
namespace {

TEST(Options, WhatLiesOutsideARangeIsRefusedByName) {
  expect_ranges<BodyFitOptions>();
  expect_ranges<ProxyOptions>();
  expect_ranges<TrainOptions>();
}

} // namespace
} // namespace doublet
