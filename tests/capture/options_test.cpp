#include "doublet/capture/calibration_file.h"
#include "doublet/capture/heat_weights.h"
#include "doublet/capture/performance_capture.h"
#include "doublet/capture/rims.h"
#include "doublet/capture/template_builder.h"
#include "support/option_ranges.h"

namespace doublet {
namespace options_test {

TEST(Options, WhatLiesOutsideARangeIsRefusedByName) {
  expect_ranges<CalibrationOptions>();
  expect_ranges<CaptureOptions>();
  expect_ranges<SilhouetteOptions>();
  expect_ranges<TemplateOptions>();
  expect_ranges<HeatWeightOptions>();
  expect_ranges<RimMatchOptions>();
}

} // namespace options_test
} // namespace doublet
