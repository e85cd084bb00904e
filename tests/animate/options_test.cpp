#include "doublet/animate/animator.h"
#include "doublet/animate/baked_file.h"
#include "doublet/animate/renderer.h"
#include "doublet/animate/retarget.h"
#include "doublet/animate/texture_baker.h"
#include "support/option_ranges.h"

namespace doublet {
namespace {

TEST(Options, WhatLiesOutsideARangeIsRefusedByName) {
  expect_ranges<AnimateOptions>();
  expect_ranges<BakedGlbOptions>();
  expect_ranges<RenderOptions>();
  expect_ranges<RetargetOptions>();
  expect_ranges<TextureOptions>();
}

} // namespace
} // namespace doublet
