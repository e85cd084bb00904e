#include "doublet/pbd/cloth_solver.h"
#include "support/option_ranges.h"

namespace doublet {
namespace options_test {

TEST(Options, WhatLiesOutsideARangeIsRefusedByName) {
  expect_ranges<pbd::ClothOptions>();
  expect_ranges<pbd::Material>();
}

} // namespace options_test
} // namespace doublet
