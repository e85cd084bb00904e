#include "doublet/segment/cloth_segmenter.h"
#include "doublet/segment/garment_mesher.h"
#include "support/option_ranges.h"

namespace doublet {
namespace {

TEST(Options, WhatLiesOutsideARangeIsRefusedByName) {
  expect_ranges<SegmentOptions>();
  expect_ranges<GarmentOptions>();
}

} // namespace
} // namespace doublet
