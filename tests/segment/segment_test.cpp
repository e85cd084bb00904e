#include "skirt_person.h"
#include "tube.h"

#include "doublet/core/error.h"
#include "doublet/core/skinning.h"
#include "doublet/segment/cloth_segmenter.h"
#include "doublet/segment/corrections.h"
#include "doublet/segment/parts/diffusion.h"
#include "support/figure.h"

#include <gtest/gtest.h>

#include <random>

using namespace doublet;

namespace {

double height(int i) {
  return tube::kLength * (i / tube::kAround) / (tube::kRings - 1);
}
bool on_side(int i) {
  return i < tube::kAround * tube::kRings;
}

/// Exactly eq. 1: one ray, every frame.
SegmentOptions plain() {
  SegmentOptions options;
  options.opposite.rays = 1;
  options.opposite.trim = 0;
  return options;
}

/// Loose from 0.3 to 0.5 m; from there to 0.7 m what moves `times` as much as the skin beyond, in and out as well as along, and
/// too little for the thresholds.
MeshSequence half_loose(double times) {
  constexpr double kLoose = 0.02, kSkin = 0.0013;
  MeshSequence sequence{tube::faces(), {}};
  for (int t = 0; t < 40; ++t) {
    const double s = std::sin(2 * std::numbers::pi * 2 * t / 40), c = std::cos(2 * std::numbers::pi * 3 * t / 40);
    const auto moved = [&](double y) { return y > 0.3 && y < 0.5 ? kLoose : y >= 0.5 && y < 0.7 ? times * kSkin : kSkin; };
    Vertices v = tube::vertices([&](double y) { return tube::kRadius + s * moved(y); });
    for (int i = 0; i < v.rows(); ++i)
      v(i, 1) += 2 * c * moved(v(i, 1));
    sequence.frames.push_back(v);
  }
  sequence.unposed = sequence.frames;
  return sequence;
}

/// Share of the rings between two heights that is cloth.
double cloth_between(const Segmentation &result, double low, double high) {
  int cloth = 0, all = 0;
  for (int i = 0; on_side(i); ++i)
    if (height(i) > low && height(i) < high) {
      ++all;
      cloth += result.clothness[i] > 0.5;
    }
  return static_cast<double>(cloth) / all;
}

} // namespace

TEST(Segment, RigidTubeHasNoCloth) {
  const Segmentation result = segment_cloth(tube::pulsating(0.0), {});
  EXPECT_EQ(result.region_count, 0);
  EXPECT_EQ(result.clothness.maxCoeff(), 0.0);
  EXPECT_EQ(result.region.maxCoeff(), -1);
  for (double sigma : result.sigma)
    EXPECT_TRUE(std::isnan(sigma) || sigma < 1e-9);
}

TEST(Segment, PulsatingPartIsClothWithTheKnownDeviation) {
  const double amplitude = 0.02;
  const Segmentation result = segment_cloth(tube::pulsating(amplitude), {}, plain());
  EXPECT_EQ(result.region_count, 1);
  for (int i = 0; i < result.sigma.size(); ++i) {
    if (!on_side(i))
      continue;
    const double y = height(i);
    if (std::abs(y - 0.5) < 0.15) { // diameter 2 (r + a sin): deviation 2 a / sqrt(2)
      EXPECT_NEAR(result.sigma[i], std::sqrt(2.0) * amplitude, 0.02 * amplitude) << y;
      EXPECT_EQ(result.clothness[i], 1.0) << y;
      EXPECT_EQ(result.region[i], 0);
    }
    if (y > 0.1 && y < 0.9 && std::abs(y - 0.5) > 0.29) {
      EXPECT_EQ(result.clothness[i], 0.0) << y;
      EXPECT_EQ(result.region[i], -1);
    }
  }
}

TEST(Segment, OnlyWhatMovesInTheScanPoseAsWellIsCloth) {
  const MeshSequence moving = tube::pulsating(0.02), still = tube::pulsating(0.0, 40, false);
  MeshSequence explained = moving; // the skeleton accounts for all of it, as for skin at a bent joint
  explained.unposed = still.frames;
  EXPECT_EQ(segment_cloth(explained, {}).region_count, 0);
  MeshSequence misplaced = still; // shape is kept, only the skin weights are wrong
  misplaced.unposed = moving.frames;
  EXPECT_EQ(segment_cloth(misplaced, {}).region_count, 0);
  MeshSequence loose = moving;
  loose.unposed = tube::pulsating(0.02, 40, false).frames;
  SegmentOptions alone;
  alone.contrast = 1000;
  const Segmentation result = segment_cloth(loose, {}, alone);
  EXPECT_EQ(result.region_count, 1);
  EXPECT_LT((result.clothness - segment_cloth(moving, {}).clothness).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(Segment, ClothThatLiesOnTheBodyMovesMoreThanTheSkinAroundIt) {
  SegmentOptions alone;
  alone.contrast = 1000;
  const MeshSequence snug = half_loose(2.0);
  EXPECT_EQ(cloth_between(segment_cloth(snug, {}, alone), 0.56, 0.69), 0.0);
  const Segmentation result = segment_cloth(snug, {});
  EXPECT_EQ(cloth_between(result, 0.31, 0.66), 1.0);
  EXPECT_EQ(cloth_between(result, 0.75, 1.0), 0.0);
  EXPECT_EQ(cloth_between(result, 0.0, 0.25), 0.0);
  EXPECT_EQ(result.region_count, 1);
  EXPECT_EQ(cloth_between(segment_cloth(half_loose(1.0), {}), 0.56, 1.0), 0.0);
}

TEST(Segment, ClothThatLiesOnTheBodyTakesBothItsMeasures) {
  MeshSequence sliding = half_loose(2.0); // keeps its thickness there: skin over a bone
  const MeshSequence still = half_loose(1.0);
  for (std::size_t t = 0; t < sliding.frames.size(); ++t)
    for (Vertices *frame : {&sliding.frames[t], &sliding.unposed[t]})
      for (int axis : {0, 2})
        frame->col(axis) = still.frames[t].col(axis);
  EXPECT_EQ(cloth_between(segment_cloth(sliding, {}), 0.56, 0.69), 0.0);
}

TEST(Segment, WhatLooksLikeSkinMovesMoreBeforeItIsCloth) {
  const Eigen::RowVector3d skin(130, 150, 200), red(40, 30, 170), white(230, 230, 230); // B G R
  const auto coloured = [&](const Eigen::RowVector3d &between, double shade = 1, bool seen = true) {
    MeshSequence sequence = half_loose(2.3); // of the skin's deviation from 0.5 to 0.7 m: 4 mm, neither rigid nor cloth
    sequence.unposed.clear();
    sequence.colours.resize(4 * sequence.faces.rows(), 3);
    for (int row = 0; row < sequence.colours.rows(); ++row) {
      const int vertex = sequence.faces(row / 4, 0);
      const double y = on_side(vertex) ? height(vertex) : 0.0;
      const Eigen::RowVector3d cloth = row % 4 == 0 ? white : red; // a pattern
      const Eigen::RowVector3d middle = between == red ? cloth : between;
      sequence.colours.row(row) = y > 0.3 && y < 0.5 ? cloth : y >= 0.5 && y < 0.7 ? shade * middle : skin;
      if (!seen)
        sequence.colours.row(row).setConstant(std::numeric_limits<double>::quiet_NaN());
    }
    return sequence;
  };
  const auto between = [](const MeshSequence &sequence) {
    const Segmentation result = segment_cloth(sequence, {});
    EXPECT_EQ(cloth_between(result, 0.33, 0.47), 1.0);
    EXPECT_EQ(cloth_between(result, 0.0, 0.25) + cloth_between(result, 0.76, 1.0), 0.0);
    return cloth_between(result, 0.56, 0.66);
  };
  EXPECT_EQ(between(coloured(red)), 1.0);
  EXPECT_EQ(between(coloured(skin)), 0.0);
  EXPECT_EQ(between(coloured(red, 0.8)), 1.0); // in the shade
  EXPECT_EQ(between(coloured(skin, 0.8)), 0.0);
  SegmentOptions off;
  off.skin_colour = off.cloth_colour = 0;
  const Segmentation without = segment_cloth(coloured(red), {}, off);
  for (const MeshSequence &tells_nothing : {coloured(red, 1, false), coloured(skin, 1, false)})
    EXPECT_EQ(segment_cloth(tells_nothing, {}).clothness, without.clothness);
  const Eigen::VectorXd sigma = segment_cloth(coloured(red), {}).sigma; // what was measured stays as it was
  for (int i = 0; i < sigma.size(); ++i)
    EXPECT_TRUE(sigma[i] == without.sigma[i] || (std::isnan(sigma[i]) && std::isnan(without.sigma[i]))) << i;
}

TEST(Segment, GarmentsOfTwoLooksThatTouchWhereTheyAreStillAreTwo) {
  const Eigen::RowVector3d skin(130, 150, 200), red(40, 30, 170), blue(160, 60, 30); // B G R
  const auto dressed = [&](double seam, const Eigen::RowVector3d &below) {           // a waist at 0.5 m, cloth from 0.15 to 0.85
    MeshSequence sequence{tube::faces(), {}};
    for (int t = 0; t < 40; ++t) {
      const double s = std::sin(2 * std::numbers::pi * 2 * t / 40);
      sequence.frames.push_back(tube::vertices([&](double y) {
        const double out = std::abs(y - 0.5);
        return tube::kRadius + s * (out > 0.35 ? 0.0005 : 0.008 + 0.04 * out);
      }));
    }
    for (int f = 0; f < sequence.faces.rows(); ++f) {
      const int vertex = sequence.faces(f, 0);
      const double y = on_side(vertex) ? height(vertex) : 0.0;
      sequence.colours.conservativeResize(f + 1, 3);
      sequence.colours.row(f) = y < 0.15 || y > 0.85 ? skin : y > seam ? red : below;
    }
    return sequence;
  };
  const Segmentation two = segment_cloth(dressed(0.5, blue), {});
  ASSERT_EQ(two.region_count, 2);
  const int above = two.region[tube::kAround * 26], below = two.region[tube::kAround * 14];
  EXPECT_NE(above, below);
  for (int i = 0; on_side(i); ++i) {
    if (height(i) > 0.55 && height(i) < 0.8) {
      EXPECT_EQ(two.region[i], above) << height(i);
    } else if (height(i) > 0.2 && height(i) < 0.45) {
      EXPECT_EQ(two.region[i], below) << height(i);
    }
  }
  EXPECT_EQ(segment_cloth(dressed(0.5, red), {}).region_count, 1);  // of one fabric
  EXPECT_EQ(segment_cloth(dressed(0.7, blue), {}).region_count, 1); // a hem that flies before the other
  // A person's corrections keep what parts them, but where cloth is painted over it.
  const Mesh pose{dressed(0.5, blue).frames.front(), tube::faces()};
  Eigen::VectorXi painted = Eigen::VectorXi::Constant(pose.vertices.rows(), static_cast<int>(Paint::None));
  EXPECT_EQ(corrected_segmentation(pose, {}, two, painted).region, two.region);
  for (int i = 0; on_side(i); ++i)
    if (std::abs(height(i) - 0.5) < 0.06)
      painted[i] = static_cast<int>(Paint::Cloth);
  EXPECT_EQ(corrected_segmentation(pose, {}, two, painted).region_count, 1);
}

TEST(Segment, RejectsColoursThatDoNotBelongToTheFaces) {
  MeshSequence sequence = tube::pulsating(0.02);
  sequence.colours = Vertices::Zero(sequence.faces.rows() + 1, 3);
  EXPECT_THROW(segment_cloth(sequence, {}), std::invalid_argument);
}

TEST(Segment, ThePaintedGoesBeforeTheFound) {
  const Mesh pose{tube::vertices([](double) { return tube::kRadius; }), tube::faces()};
  Eigen::VectorXd sigma = Eigen::VectorXd::Zero(pose.vertices.rows());
  for (int i = 0; on_side(i); ++i)
    if (height(i) > 0.2 && height(i) < 0.8)
      sigma[i] = 0.05;
  const Segmentation found = segmentation_from_deviation(pose, {}, sigma);
  Eigen::VectorXi painted = Eigen::VectorXi::Constant(pose.vertices.rows(), static_cast<int>(Paint::None));
  const Segmentation same = corrected_segmentation(pose, {}, found, painted);
  EXPECT_EQ(same.clothness, found.clothness);
  EXPECT_EQ(same.region, found.region);
  const int seam = 14, skin = 25, cloth = 3; // rings
  for (int a = 0; a < tube::kAround; ++a) {
    painted[seam * tube::kAround + a] = static_cast<int>(Paint::Seam);
    painted[skin * tube::kAround + a] = static_cast<int>(Paint::Skin);
    painted[cloth * tube::kAround + a] = static_cast<int>(Paint::Cloth);
  }
  const Segmentation result = corrected_segmentation(pose, {}, found, painted);
  const auto region = [&](int ring) { return result.region[ring * tube::kAround + 7]; };
  EXPECT_EQ(result.region_count, 4); // between skin and seam, above the skin, below the seam, the painted ring
  EXPECT_EQ(result.clothness[seam * tube::kAround + 7], found.clothness[seam * tube::kAround + 7]);
  EXPECT_NE(region(seam - 1), region(seam + 1));
  EXPECT_TRUE(region(seam) == region(seam - 1) || region(seam) == region(seam + 1));
  EXPECT_EQ(result.clothness[skin * tube::kAround + 7], 0.0);
  EXPECT_EQ(region(skin), -1);
  EXPECT_EQ(result.clothness[cloth * tube::kAround + 7], 1.0);
  EXPECT_EQ(region(cloth), 3); // the smallest
  painted[5] = 3;
  EXPECT_THROW(corrected_segmentation(pose, {}, found, painted), std::invalid_argument);
  EXPECT_THROW(corrected_segmentation(pose, {}, found, painted.head(7)), std::invalid_argument);
}

TEST(Segment, TrimmingIgnoresFramesOfLostTracking) {
  MeshSequence sequence = tube::pulsating(0.0, 60);
  sequence.frames[7] *= 1.5; // one frame is half as big again
  EXPECT_EQ(segment_cloth(sequence, {}).region_count, 0);
  EXPECT_GT(segment_cloth(sequence, {}, plain()).sigma.head(tube::kAround * 30).tail(tube::kAround).maxCoeff(), 0.01);
}

TEST(Segment, InvalidFacesCloseTheSurfaceButDoNotCount) {
  const MeshSequence sequence = tube::pulsating(0.02);
  std::vector<std::uint8_t> valid(sequence.faces.rows(), 1);
  for (int f = 0; f < sequence.faces.rows(); ++f) // the side z < 0 is invalid, so rays from z > 0 that hit it are unusable
    for (int k = 0; k < 3; ++k)
      if (sequence.frames[0](sequence.faces(f, k), 2) < -1e-9)
        valid[f] = 0;
  const Mesh pose{sequence.frames[0], sequence.faces};
  const OppositePoints all = find_opposite_points(pose, {}, plain().opposite);
  const OppositePoints masked = find_opposite_points(pose, valid, plain().opposite);
  const int front = 20 * tube::kAround, back = front + tube::kAround / 2; // z = +r and z = -r at half height
  EXPECT_GE(all.face[front], 0);
  EXPECT_EQ(masked.face[front], -1);
  EXPECT_EQ(masked.face[back], -1);
  const Segmentation result = segment_cloth(sequence, valid);
  EXPECT_TRUE(std::isnan(result.sigma[front]));
  EXPECT_EQ(result.clothness[back], 0.0);
  EXPECT_EQ(result.region[back], -1);
}

TEST(Segment, UnknownRaysAreFilledFromTheirSurroundings) {
  const MeshSequence sequence = tube::pulsating(0.02, 40, false);
  Segmentation known = segment_cloth(sequence, {}, plain());
  Eigen::VectorXd sigma = known.sigma;
  for (int i = 0; i < sigma.size(); ++i)
    if (on_side(i) && std::abs(height(i) - 0.5) < 0.12 && i % tube::kAround < 12)
      sigma[i] = std::numeric_limits<double>::quiet_NaN();
  const Segmentation filled = segmentation_from_deviation({sequence.frames[0], sequence.faces}, {}, sigma);
  EXPECT_LT((filled.clothness - known.clothness).cwiseAbs().maxCoeff(), 0.1);
}

TEST(Segment, SmallIslandsAreDroppedAndSmallHolesFilled) {
  const Mesh pose{tube::vertices([](double) { return tube::kRadius; }), tube::faces()};
  Eigen::VectorXd sigma = Eigen::VectorXd::Zero(pose.vertices.rows());
  for (int i = 0; on_side(i); ++i) {
    const int around = i % tube::kAround;
    if (height(i) < 0.55)
      sigma[i] = 0.05;
    if (height(i) > 0.25 && height(i) < 0.35 && around > 10 && around < 18)
      sigma[i] = 0; // hole of about 0.01 m^2
    if (height(i) > 0.8 && height(i) < 0.9 && around > 10 && around < 18)
      sigma[i] = 0.05; // island of about 0.01 m^2
  }
  const Segmentation result = segmentation_from_deviation(pose, {}, sigma);
  ASSERT_EQ(result.region_count, 1);
  EXPECT_GT(result.clothness[12 * tube::kAround + 14], 0.95);
  EXPECT_EQ(result.clothness[34 * tube::kAround + 14], 0.0);
  SegmentOptions keep_all;
  keep_all.smallest_region = 0;
  const Segmentation raw = segmentation_from_deviation(pose, {}, sigma, keep_all);
  EXPECT_EQ(raw.region_count, 2);
  EXPECT_EQ(raw.region[34 * tube::kAround + 14], 1); // numbered by falling area
  EXPECT_LT(raw.clothness[12 * tube::kAround + 14], 0.5);
}

TEST(Segment, TheEndOfALimbIsNoHole) {
  const Mesh pose{tube::vertices([](double) { return tube::kRadius; }), tube::faces()};
  Eigen::VectorXd sigma = Eigen::VectorXd::Zero(pose.vertices.rows());
  for (int i = 0; on_side(i); ++i)
    if (height(i) > 0.07 && height(i) < 0.6)
      sigma[i] = 0.05; // below it a foot of 0.075 m^2, less than the smallest region
  const Segmentation result = segmentation_from_deviation(pose, {}, sigma);
  EXPECT_GT(result.clothness[12 * tube::kAround], 0.95);
  EXPECT_EQ(result.clothness[0], 0.0);
  EXPECT_EQ(result.clothness[tube::kAround * tube::kRings], 0.0); // the sole
}

TEST(Segment, WhatDoesNotHangIsNoCloth) {
  const Mesh pose{tube::vertices([](double) { return tube::kRadius; }), tube::faces()};
  Eigen::VectorXd sigma = Eigen::VectorXd::Zero(pose.vertices.rows());
  std::vector<std::uint8_t> valid(pose.faces.rows(), 1);
  for (int i = 0; i < sigma.size(); ++i)
    if (const double y = on_side(i) ? height(i) : pose.vertices(i, 1); y < 0.6 || y > 0.85)
      sigma[i] = 0.05; // a garment, the leg below its hem, and the head
  for (int f = 0; f < pose.faces.rows(); ++f)
    if (const double y = pose.vertices(pose.faces(f, 0), 1); on_side(pose.faces(f, 0)) && y > 0.24 && y < 0.26)
      valid[f] = 0; // the hem: nobody saw how the leg goes on under it
  const Segmentation result = segmentation_from_deviation(pose, valid, sigma);
  EXPECT_EQ(result.region_count, 1);
  EXPECT_GT(result.clothness[16 * tube::kAround], 0.95);
  EXPECT_EQ(result.clothness[2 * tube::kAround], 0.0);
  EXPECT_EQ(result.clothness[tube::kAround * tube::kRings], 0.0);
  EXPECT_EQ(result.clothness[38 * tube::kAround], 0.0);
}

TEST(Segment, AHeadThatHairReachesIsNoCloth) {
  // The border slants: high at the front, low at the back, where hair falls on the collar. Its top is above the core's middle,
  // but the core rises above it all around.
  const Mesh pose{tube::vertices([](double) { return tube::kRadius; }), tube::faces()};
  Eigen::VectorXd sigma = Eigen::VectorXd::Zero(pose.vertices.rows());
  for (int i = 0; i < sigma.size(); ++i) {
    const double border = 0.68 + 0.2 * std::cos(std::atan2(pose.vertices(i, 0), pose.vertices(i, 2)));
    const double y = pose.vertices(i, 1);
    if (y > border || y < 0.4)
      sigma[i] = 0.05; // the head, and a garment
  }
  const Segmentation result = segmentation_from_deviation(pose, {}, sigma);
  EXPECT_EQ(result.region_count, 1);
  EXPECT_GT(result.clothness[8 * tube::kAround], 0.95);
  EXPECT_EQ(result.clothness[38 * tube::kAround], 0.0);
}

TEST(Segment, AHeadWithHolesInItsScanIsNoCloth) {
  const Mesh pose{tube::vertices([](double) { return tube::kRadius; }), tube::faces()};
  Eigen::VectorXd sigma = Eigen::VectorXd::Zero(pose.vertices.rows());
  std::vector<std::uint8_t> valid(pose.faces.rows(), 1);
  for (int i = 0; i < sigma.size(); ++i)
    if (const double y = pose.vertices(i, 1); y < 0.5 || y > 0.7)
      sigma[i] = 0.05; // a garment, and the head
  for (int f = 0; f < pose.faces.rows();
       ++f) // under the chin and at the crown: higher than most of the head, but nothing holds it
    if (const Eigen::Vector3d x = pose.vertices.row(pose.faces(f, 0)); x.z() > 0.08)
      valid[f] = (x.y() < 0.74 || x.y() > 0.84) && (x.y() < 0.93 || x.y() > 0.97 || x.z() < 0.09);
  const Segmentation result = segmentation_from_deviation(pose, valid, sigma);
  EXPECT_EQ(result.region_count, 1);
  EXPECT_GT(result.clothness[8 * tube::kAround], 0.95);
  EXPECT_EQ(result.clothness[36 * tube::kAround], 0.0);
}

TEST(Segment, AHeadOfWhichOnlySomeMovesEnoughIsNoCloth) {
  const Mesh pose{tube::vertices([](double) { return tube::kRadius; }), tube::faces()};
  const SegmentOptions options;
  Eigen::VectorXd sigma = Eigen::VectorXd::Zero(pose.vertices.rows());
  for (int i = 0; i < sigma.size(); ++i)
    if (const double y = pose.vertices(i, 1); y < 0.5) // a garment
      sigma[i] = 0.05;
    else if (y > 0.8) // the head; its core borders on a face that moves less, as high as itself
      sigma[i] = pose.vertices(i, 2) < 0.075 ? 0.05 : 0.7 * options.rigid_threshold + 0.3 * options.cloth_threshold;
  const Segmentation result = segmentation_from_deviation(pose, {}, sigma);
  EXPECT_EQ(result.region_count, 1);
  EXPECT_GT(result.clothness[8 * tube::kAround], 0.95);
  EXPECT_EQ(result.clothness[36 * tube::kAround + tube::kAround / 2], 0.0);
}

TEST(Segment, ThresholdsRiseAboveTheNoiseOfAPoorCapture) {
  const Mesh pose{tube::vertices([](double) { return tube::kRadius; }), tube::faces()};
  Eigen::VectorXd sigma = Eigen::VectorXd::Constant(pose.vertices.rows(), 0.012); // skin, seen by few cameras
  for (int i = 0; on_side(i); ++i)
    if (height(i) < 0.5)
      sigma[i] = 0.06;
  const SegmentOptions plain, raised = fitting_thresholds(pose, {}, sigma);
  EXPECT_GT(raised.rigid_threshold, 1.5 * plain.rigid_threshold);
  EXPECT_NEAR(raised.cloth_threshold / raised.rigid_threshold, plain.cloth_threshold / plain.rigid_threshold, 1e-9);
  const Segmentation result = segmentation_from_deviation(pose, {}, sigma, raised);
  EXPECT_EQ(result.region_count, 1);
  EXPECT_GT(result.clothness[10 * tube::kAround], 0.95);
  EXPECT_EQ(result.clothness[38 * tube::kAround], 0.0);
  // A good capture keeps its thresholds, and so does one in which all levels are alike.
  for (int i = 0; on_side(i); ++i)
    if (height(i) >= 0.5)
      sigma[i] = 0.0015;
  EXPECT_EQ(fitting_thresholds(pose, {}, sigma).rigid_threshold, plain.rigid_threshold);
  // A middling one is not far above what it makes of skin.
  for (int i = 0; on_side(i); ++i)
    if (height(i) >= 0.5)
      sigma[i] = 0.0025;
  EXPECT_NEAR(fitting_thresholds(pose, {}, sigma).rigid_threshold, 1.4 * 0.0025, 1e-12);
  EXPECT_EQ(fitting_thresholds(pose, {}, Eigen::VectorXd::Constant(sigma.size(), 1.0)).rigid_threshold, plain.rigid_threshold);
}

TEST(Segment, FaintDeviationFarFromClothIsRigid) {
  const Mesh pose{tube::vertices([](double) { return tube::kRadius; }), tube::faces()};
  const SegmentOptions options;
  Eigen::VectorXd sigma =
      Eigen::VectorXd::Constant(pose.vertices.rows(), 0.6 * options.rigid_threshold + 0.4 * options.cloth_threshold);
  for (int i = 0; on_side(i); ++i)
    if (height(i) < 0.4)
      sigma[i] = 0.05;
  const Segmentation result = segmentation_from_deviation(pose, {}, sigma);
  EXPECT_EQ(result.region_count, 1);
  EXPECT_GT(result.clothness[5 * tube::kAround], 0.99);
  EXPECT_GT(result.clothness[18 * tube::kAround], 0.2); // 5 cm from the core: its transition
  EXPECT_EQ(result.clothness[30 * tube::kAround], 0.0); // 35 cm from it
}

TEST(Segment, AnInvalidSeamKeepsCoresApart) {
  // A small core and a large one that touch along a ring where the surface was invented: the small one does not survive through
  // the large.
  const Mesh pose{tube::vertices([](double) { return tube::kRadius; }), tube::faces()};
  Eigen::VectorXd sigma = Eigen::VectorXd::Zero(pose.vertices.rows());
  std::vector<std::uint8_t> valid(pose.faces.rows(), 1);
  for (int i = 0; on_side(i); ++i)
    if (height(i) > 0.425 && height(i) < 0.9)
      sigma[i] = 0.05;
  for (int f = 0; f < pose.faces.rows(); ++f) {
    const double y = pose.vertices(pose.faces(f, 0), 1);
    if (on_side(pose.faces(f, 0)) && y > 0.465 && y < 0.485 && f % 6 != 0)
      valid[f] = 0; // ring 19 in part: what is left still connects
  }
  const Segmentation result = segmentation_from_deviation(pose, valid, sigma);
  EXPECT_EQ(result.region_count, 1);
  EXPECT_GT(result.clothness[30 * tube::kAround], 0.99);
  EXPECT_LT(result.clothness[17 * tube::kAround + 1], 0.5);
}

TEST(Segment, DoesNotDependOnThreadsOrOnTheFrameOfReference) {
  const MeshSequence sequence = tube::pulsating(0.015);
  Context one, three;
  one.threads = 1;
  three.threads = 3;
  const Segmentation a = segment_cloth(sequence, {}, {}, one), b = segment_cloth(sequence, {}, {}, three);
  EXPECT_TRUE((a.clothness.array() == b.clothness.array()).all());
  MeshSequence moved = sequence;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Eigen::Vector3d(3, -1, 2).normalized()).toRotationMatrix();
  for (Vertices &frame : moved.frames)
    frame = (frame * turn.transpose()).rowwise() + Eigen::RowVector3d(3, -2, 1);
  const Segmentation c = segment_cloth(moved, {});
  EXPECT_EQ(c.region_count, a.region_count);
  // A ray that leaves exactly through an edge of this symmetric tube may fall to either side: compare what that cannot change.
  EXPECT_LT((c.clothness - a.clothness).cwiseAbs().mean(), 1e-3);
}

TEST(Segment, ReportsWhatItFound) {
  const MeshSequence sequence = tube::pulsating(0.02);
  const SegmentSummary summary = summarise_segmentation({sequence.frames[0], sequence.faces}, {}, segment_cloth(sequence, {}));
  EXPECT_EQ(summary.regions, 1);
  EXPECT_NEAR(summary.cloth_area, 2 * std::numbers::pi * tube::kRadius * 0.38, 0.03);
  EXPECT_GT(summary.known_fraction, 0.95);
}

TEST(Segment, RejectsWrongInput) {
  const MeshSequence sequence = tube::pulsating(0.01, 4);
  MeshSequence single{sequence.faces, {sequence.frames[0]}};
  EXPECT_THROW(segment_cloth(single, {}), std::invalid_argument);
  EXPECT_THROW(segment_cloth({}, {}), std::invalid_argument);
  EXPECT_THROW(segment_cloth(sequence, std::vector<std::uint8_t>(3, 1)), std::invalid_argument);
  MeshSequence nan = sequence;
  nan.frames[2](5, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(segment_cloth(nan, {}), Error);
  MeshSequence shrunk = sequence;
  shrunk.frames[1] = sequence.frames[1].topRows(10);
  EXPECT_THROW(segment_cloth(shrunk, {}), std::invalid_argument);
  MeshSequence outside = sequence;
  outside.faces(0, 0) = 1 << 20;
  EXPECT_THROW(segment_cloth(outside, {}), Error);
  SegmentOptions options;
  options.cloth_threshold = options.rigid_threshold;
  EXPECT_THROW(segment_cloth(sequence, {}, options), std::invalid_argument);
}

TEST(Segment, RejectsUnposedFramesThatDoNotBelongToTheSequence) {
  MeshSequence sequence = tube::pulsating(0.02);
  sequence.unposed.assign(3, sequence.frames.front());
  EXPECT_THROW(segment_cloth(sequence, {}), std::invalid_argument);
  sequence.unposed.assign(sequence.frames.size(), Vertices::Zero(4, 3));
  EXPECT_THROW(segment_cloth(sequence, {}), std::invalid_argument);
}

TEST(Segment, SurvivesBadMeshes) {
  MeshSequence sequence = tube::pulsating(0.02, 6);
  Faces &faces = sequence.faces;
  faces.row(10) << 5, 5, 5;                // degenerate
  faces.row(11) = faces.row(12);           // doubled: non-manifold
  faces.row(20) = faces.row(20).reverse(); // flipped
  const Faces open = faces.topRows(faces.rows() / 2);
  EXPECT_NO_THROW(segment_cloth(sequence, {}));
  sequence.faces = open; // boundary, and half the vertices unused
  const Segmentation result = segment_cloth(sequence, {});
  EXPECT_TRUE(result.clothness.allFinite());
  EXPECT_EQ(result.region[tube::kAround * tube::kRings - 1], -1);
  const Segmentation nothing = segment_cloth(sequence, std::vector<std::uint8_t>(open.rows(), 0));
  EXPECT_EQ(nothing.region_count, 0);
}

TEST(Diffusion, KeepsConstantsAndObeysTheMaximumPrinciple) {
  const Vertices v = tube::vertices([](double y) { return 0.1 + 0.03 * std::sin(9 * y); });
  const Faces f = tube::faces();
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(v.rows());
  EXPECT_LT((diffuse_on_surface(v, f, ones, 0.1) - ones).cwiseAbs().maxCoeff(), 1e-9);
  std::mt19937 random(1);
  Eigen::VectorXd values(v.rows());
  for (double &value : values)
    value = (random() % 1000) / 999.0;
  const Eigen::VectorXd smooth = diffuse_on_surface(v, f, values, 0.05);
  EXPECT_GE(smooth.minCoeff(), -1e-9);
  EXPECT_LE(smooth.maxCoeff(), 1 + 1e-9);
  EXPECT_LT((smooth.array() - smooth.mean()).abs().mean(), 0.3 * (values.array() - values.mean()).abs().mean());
}

TEST(Diffusion, DecaysWithTheStatedLength) {
  // Along a long tube (1 - t d2/dy2) x = x_0 with x_0 = a step at y = 0.5 has the solution 0.5 exp(-(y - 0.5) / length) above it.
  const Vertices v = tube::vertices([](double) { return tube::kRadius; });
  Eigen::VectorXd step(v.rows());
  for (int i = 0; i < v.rows(); ++i)
    step[i] = v(i, 1) < 0.5 - 1e-9 ? 1.0 : std::abs(v(i, 1) - 0.5) < 1e-9 ? 0.5 : 0.0;
  const Eigen::VectorXd x = diffuse_on_surface(v, tube::faces(), step, 0.1);
  for (int ring : {22, 24, 28})
    EXPECT_NEAR(x[ring * tube::kAround], 0.5 * std::exp(-(0.025 * (ring - 20)) / 0.1), 0.01) << ring;
}

TEST(Diffusion, UnknownValuesTakeTheHarmonicInterpolation) {
  const Vertices v = tube::vertices([](double) { return tube::kRadius; });
  Eigen::VectorXd values = Eigen::VectorXd::Constant(v.rows(), std::numeric_limits<double>::quiet_NaN());
  for (int a = 0; a < tube::kAround; ++a)
    values[a] = 0, values[(tube::kRings - 1) * tube::kAround + a] = 1;
  const Eigen::VectorXd x = diffuse_on_surface(v, tube::faces(), values, 0.0);
  EXPECT_NEAR(x[20 * tube::kAround], 0.5, 0.01);
  EXPECT_NEAR(x[10 * tube::kAround] - x[5 * tube::kAround], x[30 * tube::kAround] - x[25 * tube::kAround], 0.01);
}

TEST(Diffusion, ComponentsWithoutKnownValuesStayUnknown) {
  Vertices v(6, 3);
  v << 0, 0, 0, 1, 0, 0, 0, 1, 0, 5, 0, 0, 6, 0, 0, 5, 1, 0;
  Faces f(2, 3);
  f << 0, 1, 2, 3, 4, 5;
  Eigen::VectorXd values = Eigen::VectorXd::Constant(6, std::numeric_limits<double>::quiet_NaN());
  values[0] = 2;
  const Eigen::VectorXd x = diffuse_on_surface(v, f, values, 0.1);
  EXPECT_NEAR(x[1], 2, 1e-6);
  EXPECT_TRUE(std::isnan(x[4]));
  EXPECT_THROW(diffuse_on_surface(v, f, Eigen::VectorXd::Zero(2), 0.1), std::invalid_argument);
  EXPECT_THROW(diffuse_on_surface(v, f, values, -1), std::invalid_argument);
}

namespace first_pose {

/// Keeps what it was given.
struct Keeper : ClothSegmenter {
  mutable MeshSequence given;
  Segmentation segment(const MeshSequence &sequence, const std::vector<std::uint8_t> &, const Context &) const override {
    given = sequence;
    const auto n = sequence.frames[0].rows();
    Segmentation none;
    none.sigma = none.clothness = Eigen::VectorXd::Zero(n);
    none.region = Eigen::VectorXi::Constant(n, -1);
    return none;
  }
};

ReferencePerformance turning(const RiggedMesh &actor, double bent) {
  ReferencePerformance performance;
  performance.dofs = MatrixRM::Zero(2, actor.skeleton.dof_count());
  performance.dofs.leftCols(6).setConstant(0.5); // where and which way is no pose
  performance.dofs.rightCols(performance.dofs.cols() - 6).setConstant(bent);
  performance.surface.faces = actor.mesh.faces;
  for (int t = 0; t < 2; ++t)
    performance.surface.frames.push_back(dual_quaternion_skinning(actor.mesh.vertices, actor.weights,
                                                                  forward_kinematics(actor.skeleton, performance.dofs.row(t))));
  return performance;
}

} // namespace first_pose

namespace bare_limbs {

/// Finds what it is told.
struct Told : ClothSegmenter {
  Segmentation told;
  Segmentation segment(const MeshSequence &, const std::vector<std::uint8_t> &, const Context &) const override { return told; }
};

/// A person in a skirt whose leg, down to a foot of four rings, was taken for cloth, as was the sheet between leg and hem.
struct Case {
  skirt_person::Person person;
  ReferencePerformance performance;
  Told segmenter;
  std::string said;

  Case() {
    person.actor.face_valid.assign(person.actor.mesh.faces.rows(), 1);
    const int ankle = person.actor.skeleton.find("l_ankle");
    person.actor.weights.setZero();
    person.actor.weights.col(0).setOnes();
    for (int v = 0; v < skirt_person::vertex(4, 0); ++v) {
      person.actor.weights(v, 0) = 0;
      person.actor.weights(v, ankle) = 1;
    }
    for (int ring = 0; ring < 28; ++ring)
      person.set_cloth(ring, 0);
    segmenter.told = person.segmentation;
    performance.dofs = MatrixRM::Zero(2, person.actor.skeleton.dof_count());
    performance.surface = {person.actor.mesh.faces, {person.actor.mesh.vertices, person.actor.mesh.vertices}, {}};
  }
  Segmentation found() {
    Context context;
    context.log = [&](const std::string &line) { said += line; };
    return segment_performance(person.actor, performance, segmenter, {}, context);
  }
  static double cloth_of_ring(const Segmentation &segmentation, int ring) {
    return segmentation.clothness.segment(skirt_person::vertex(ring, 0), skirt_person::kAround).mean();
  }
};

} // namespace bare_limbs

TEST(BareLimbs, ALegBelowAHemWhoseFootCountsAsClothIsSkin) {
  bare_limbs::Case leg;
  const Segmentation found = leg.found();
  for (int ring = 0; ring < 19; ++ring)
    EXPECT_EQ(leg.cloth_of_ring(found, ring), 0) << ring;
  for (int ring = 28; ring < 54; ++ring)
    EXPECT_EQ(leg.cloth_of_ring(found, ring), 1) << ring;
  EXPECT_EQ(found.region_count, 1);
  EXPECT_NE(leg.said.find("l_toe moved like cloth"), std::string::npos) << leg.said;
}

TEST(BareLimbs, WithAFootThatIsSkinNothingChanges) {
  bare_limbs::Case leg;
  for (int ring = 0; ring < 4; ++ring)
    for (int k = 0; k < skirt_person::kAround; ++k) {
      leg.segmenter.told.clothness[skirt_person::vertex(ring, k)] = 0;
      leg.segmenter.told.region[skirt_person::vertex(ring, k)] = -1;
    }
  EXPECT_EQ(leg.found().clothness, leg.segmenter.told.clothness);
  EXPECT_EQ(leg.said.find("moved like cloth"), std::string::npos);
}

TEST(BareLimbs, ALimbThatNothingWidensStaysAsItWas) {
  bare_limbs::Case leg;
  leg.person.actor.mesh.vertices = skirt_person::surface(skirt_person::plain);
  for (Eigen::Index v = 0; v < leg.person.actor.mesh.vertices.rows(); ++v) { // as wide as the leg all over
    auto row = leg.person.actor.mesh.vertices.row(v);
    const double radius = std::hypot(row.x(), row.z());
    if (radius > 0) {
      row.x() *= 0.08 / radius;
      row.z() *= 0.08 / radius;
    }
  }
  leg.performance.surface.frames = {leg.person.actor.mesh.vertices, leg.person.actor.mesh.vertices};
  EXPECT_EQ(leg.found().clothness, leg.segmenter.told.clothness);
  EXPECT_NE(leg.said.find("no hem was found above it"), std::string::npos) << leg.said;
}

TEST(SegmentedPose, IsTheFirstFrameOrElseTheScans) {
  const RiggedMesh actor = doublet::testing::figure_actor(0.06);
  for (const double bent : {0.05, 0.3}) {
    const ReferencePerformance performance = first_pose::turning(actor, bent);
    const first_pose::Keeper keeper;
    segment_performance(actor, performance, keeper);
    const Vertices &first = bent < 0.15 ? performance.surface.frames[0] : actor.mesh.vertices;
    EXPECT_EQ(segmented_pose(actor, performance).vertices, first);
    EXPECT_EQ(keeper.given.frames.front(), first);
    EXPECT_EQ(keeper.given.frames.size(), bent < 0.15 ? 2u : 3u);
    EXPECT_EQ(keeper.given.unposed.size(), keeper.given.frames.size());
    EXPECT_LT((keeper.given.unposed.front() - actor.mesh.vertices).rowwise().norm().maxCoeff(), 1e-9);
  }
}
