#include "doublet/core/parts/colour_histogram.h"

#include <gtest/gtest.h>

using namespace doublet;
using Eigen::Vector3d;

namespace {

/// Likelihoods where this colour alone was seen.
Eigen::VectorXd seen_alone(const Vector3d &bgr) {
  return colour_likelihoods(Eigen::VectorXd::Unit(colour_bin_count(), colour_bin(bgr)));
}

} // namespace

TEST(ColourHistogram, EveryColourHasABin) {
  for (double b : {0.0, 1.0, 90.0, 255.0})
    for (double g : {0.0, 1.0, 90.0, 255.0})
      for (double r : {0.0, 1.0, 90.0, 255.0}) {
        const int bin = colour_bin({b, g, r});
        EXPECT_TRUE(bin >= 0 && bin < colour_bin_count()) << b << " " << g << " " << r;
      }
}

TEST(ColourHistogram, AColourIsLikeItselfInTheShadeAndUnlikeAnother) {
  const Vector3d skin(110, 140, 200), cloth(40, 30, 150);
  const Eigen::VectorXd of_skin = seen_alone(skin), of_cloth = seen_alone(cloth);
  for (double shade : {1.0, 0.8}) {
    EXPECT_GT(of_skin[colour_bin(shade * skin)], 100 * of_cloth[colour_bin(shade * skin)]);
    EXPECT_GT(of_cloth[colour_bin(shade * cloth)], 100 * of_skin[colour_bin(shade * cloth)]);
  }
}

TEST(ColourHistogram, WhatNeitherHasTellsNothing) {
  const Eigen::VectorXd of_skin = seen_alone({110, 140, 200});
  const int green = colour_bin({40, 200, 40});
  EXPECT_GT(of_skin[green], 0);
  EXPECT_EQ(of_skin[green], seen_alone({40, 30, 150})[green]);
  EXPECT_NEAR(of_skin.sum(), 1.1, 1e-9);
}
