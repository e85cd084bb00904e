#include "../../libsegment/src/surface_patches.h"
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

/// The deviation exactly as in eq. 1: one ray, every frame.
SegmentOptions plain() {
  SegmentOptions options;
  options.opposite.rays = 1;
  options.opposite.trim = 0;
  return options;
}

/// What moves `amplitude` (m) between two heights, the rest `noise`; in and out.
MeshSequence moving(double low, double high, double amplitude, double noise) {
  MeshSequence sequence{tube::faces(), {}};
  for (int t = 0; t < 40; ++t) {
    const double s = std::sin(2 * std::numbers::pi * 2 * t / 40);
    sequence.frames.push_back(
        tube::vertices([&](double y) { return tube::kRadius + s * (y > low && y < high ? amplitude : noise); }));
  }
  return sequence;
}

Mesh still_tube() {
  return {tube::vertices([](double) { return tube::kRadius; }), tube::faces()};
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
  const Segmentation result = segment_cloth({tube::pulsating(0.0)});
  EXPECT_EQ(result.region_count, 0);
  EXPECT_EQ(result.clothness.maxCoeff(), 0.0);
  EXPECT_EQ(result.region.maxCoeff(), -1);
  for (double sigma : result.sigma)
    EXPECT_TRUE(std::isnan(sigma) || sigma < 1e-9);
}

TEST(Segment, PulsatingPartIsClothWithTheKnownDeviation) {
  const double amplitude = 0.02;
  const Segmentation result = segment_cloth({tube::pulsating(amplitude)}, plain());
  EXPECT_EQ(result.region_count, 1);
  for (int i = 0; i < result.sigma.size(); ++i) {
    if (!on_side(i))
      continue;
    const double y = height(i);
    if (std::abs(y - 0.5) < 0.15) { // diameter 2 (r + a sin): deviation 2 a / sqrt(2)
      EXPECT_NEAR(result.sigma[i], std::sqrt(2.0) * amplitude, 0.02 * amplitude) << y;
      EXPECT_NEAR(result.clothness[i], 1.0, 0.02) << y;
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
  SegmentInputs explained{moving}; // the skeleton accounts for all of it, as for skin at a bent joint
  explained.canonical = still.frames;
  EXPECT_EQ(segment_cloth(explained).region_count, 0);
  SegmentInputs misplaced{still}; // shape is kept, only the skin weights are wrong
  misplaced.canonical = moving.frames;
  EXPECT_EQ(segment_cloth(misplaced).region_count, 0);
  SegmentInputs loose{moving};
  loose.canonical = tube::pulsating(0.02, 40, false).frames;
  const Segmentation result = segment_cloth(loose);
  EXPECT_EQ(result.region_count, 1);
  EXPECT_LT((result.clothness - segment_cloth({moving}).clothness).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(Segment, ACaptureIsMeasuredByWhatItsStillestTenthDoes) {
  // The same picture at ten times the scale of all motion: skin as noisy as cloth in the other is still skin.
  for (const double scale : {1.0, 10.0}) {
    const Segmentation result = segment_cloth({moving(0.3, 0.7, 0.006 * scale, 0.001 * scale)});
    EXPECT_EQ(result.region_count, 1) << scale;
    EXPECT_EQ(cloth_between(result, 0.32, 0.68), 1.0) << scale;
    EXPECT_EQ(cloth_between(result, 0.0, 0.25) + cloth_between(result, 0.75, 1.0), 0.0) << scale;
  }
  // Twice the noise is what skin does elsewhere: below even odds.
  EXPECT_EQ(segment_cloth({moving(0.3, 0.7, 0.002, 0.001)}).region_count, 0);
  EXPECT_EQ(segment_cloth({moving(0.0, 1.0, 0.05, 0.05)}).region_count, 0); // all alike: nothing tells cloth
}

TEST(Segment, ColoursTellWhatMotionDoesNot) {
  const Eigen::RowVector3d skin(130, 150, 200), red(40, 30, 170), white(230, 230, 230); // B G R
  // Loose from 0.3 to 0.5 m; from there to 0.7 m it moves 2.5 times the noise, a little less than even odds.
  const auto coloured = [&](const Eigen::RowVector3d &between, double shade = 1, bool seen = true) {
    SegmentInputs inputs{{tube::faces(), {}}};
    for (int t = 0; t < 40; ++t) {
      const double s = std::sin(2 * std::numbers::pi * 2 * t / 40);
      inputs.surface.frames.push_back(tube::vertices([&](double y) {
        return tube::kRadius + s * (y > 0.3 && y < 0.5 ? 0.02 : y >= 0.5 && y < 0.7 ? 0.0025 : 0.001);
      }));
    }
    const Faces &faces = inputs.surface.faces;
    inputs.colours.resize(4 * faces.rows(), 3);
    for (int row = 0; row < inputs.colours.rows(); ++row) {
      const int vertex = faces(row / 4, 0);
      const double y = on_side(vertex) ? height(vertex) : 0.0;
      const Eigen::RowVector3d cloth = row % 4 == 0 ? white : red; // a pattern
      const Eigen::RowVector3d middle = between == red ? cloth : between;
      inputs.colours.row(row) = y > 0.3 && y < 0.5 ? cloth : y >= 0.5 && y < 0.7 ? shade * middle : skin;
      if (!seen)
        inputs.colours.row(row).setConstant(std::numeric_limits<double>::quiet_NaN());
    }
    return inputs;
  };
  const auto between = [](const SegmentInputs &inputs) {
    const Segmentation result = segment_cloth(inputs);
    EXPECT_EQ(cloth_between(result, 0.33, 0.47), 1.0);
    EXPECT_EQ(cloth_between(result, 0.0, 0.25) + cloth_between(result, 0.76, 1.0), 0.0);
    return cloth_between(result, 0.56, 0.66);
  };
  EXPECT_EQ(between(coloured(red)), 1.0);
  EXPECT_EQ(between(coloured(skin)), 0.0);
  EXPECT_EQ(between(coloured(red, 0.8)), 1.0); // in the shade
  EXPECT_EQ(between(coloured(skin, 0.8)), 0.0);
  SegmentOptions off;
  off.colour = 0;
  const Segmentation without = segment_cloth(coloured(red), off);
  EXPECT_EQ(cloth_between(without, 0.56, 0.66), 0.0);
  for (const SegmentInputs &tells_nothing : {coloured(red, 1, false), coloured(skin, 1, false)})
    EXPECT_EQ(segment_cloth(tells_nothing).clothness, without.clothness);
  const Eigen::VectorXd sigma = segment_cloth(coloured(red)).sigma; // what was measured stays as it was
  for (int i = 0; i < sigma.size(); ++i)
    EXPECT_TRUE(sigma[i] == without.sigma[i] || (std::isnan(sigma[i]) && std::isnan(without.sigma[i]))) << i;
}

TEST(Segment, ThePriorKeepsAHeadThatMovesOutOfTheCloth) {
  const MeshSequence sequence = moving(0.75, 2.0, 0.01, 0.001);
  SegmentInputs inputs{sequence};
  EXPECT_EQ(segment_cloth(inputs).region_count, 1);
  inputs.prior = Eigen::VectorXd::Zero(sequence.frames[0].rows());
  for (Eigen::Index v = 0; v < inputs.prior.size(); ++v)
    inputs.prior[v] = sequence.frames[0](v, 1) > 0.7 ? -5 : 0;
  EXPECT_EQ(segment_cloth(inputs).region_count, 0);
  inputs.prior.setZero();
  EXPECT_EQ(segment_cloth(inputs).clothness, segment_cloth({sequence}).clothness);
}

TEST(Segment, WhatStandsOffTheBodyWithinIsClothThoughItMovesLittle) {
  const MeshSequence little = moving(0.3, 0.7, 0.002, 0.001); // twice the noise is no evidence of cloth
  const auto gap = [&](double between, double elsewhere) {
    Eigen::VectorXd result(little.frames[0].rows());
    for (Eigen::Index v = 0; v < result.size(); ++v)
      result[v] = little.frames[0](v, 1) > 0.3 && little.frames[0](v, 1) < 0.7 ? between : elsewhere;
    return result;
  };
  SegmentInputs inputs{little};
  inputs.gap = gap(0.02, 0.003);
  const Segmentation result = segment_cloth(inputs);
  EXPECT_EQ(cloth_between(result, 0.33, 0.67), 1.0);
  EXPECT_EQ(cloth_between(result, 0.0, 0.26) + cloth_between(result, 0.74, 1.0), 0.0);
  SegmentOptions unasked;
  unasked.gap_slope = 0;
  EXPECT_EQ(segment_cloth(inputs, unasked).region_count, 0);
  inputs.gap = gap(0.003, 0.003);
  EXPECT_EQ(segment_cloth(inputs).region_count, 0);
  inputs.surface = moving(0.3, 0.7, 0.02, 0.001); // what swings is cloth, though it lies on the body in the scan
  EXPECT_EQ(cloth_between(segment_cloth(inputs), 0.33, 0.67), 1.0);
}

TEST(Segment, ASideThatTellsLittleGoesWithItsMirroredOne) {
  SegmentInputs inputs{moving(0.3, 0.7, 0.001, 0.001)}; // nothing moves
  const Vertices &pose = inputs.surface.frames[0];
  SegmentOptions options;
  options.border = 0;
  const auto odds = [&](double left, double right) {
    inputs.prior = Eigen::VectorXd::Constant(pose.rows(), -3);
    for (Eigen::Index v = 0; v < pose.rows(); ++v)
      if (pose(v, 1) > 0.3 && pose(v, 1) < 0.7)
        inputs.prior[v] = 3 * std::log(3) + (pose(v, 0) > 0.02 ? left : right); // what the motion takes, and the odds
  };
  const auto cloth = [&](bool of_left) {
    const Segmentation found = segment_cloth(inputs, options);
    double sum = 0, count = 0;
    for (Eigen::Index v = 0; v < pose.rows(); ++v)
      if (pose(v, 1) > 0.35 && pose(v, 1) < 0.65 && (of_left ? pose(v, 0) > 0.05 : pose(v, 0) < -0.05)) {
        sum += found.clothness[v] > 0.5;
        count += 1;
      }
    return sum / count;
  };
  odds(2, -0.5);
  EXPECT_EQ(cloth(true), 1);
  EXPECT_EQ(cloth(false), 0);
  inputs.mirrored = Eigen::VectorXi::Constant(pose.rows(), -1);
  for (int i = 0; on_side(i); ++i)
    inputs.mirrored[i] = i / tube::kAround * tube::kAround + (tube::kAround - i % tube::kAround) % tube::kAround;
  EXPECT_EQ(cloth(true), 1);
  EXPECT_EQ(cloth(false), 1);
  odds(0.5, -2); // either way
  EXPECT_EQ(cloth(true), 0);
  odds(2, -2); // a garment of one side
  EXPECT_EQ(cloth(true), 1);
  EXPECT_EQ(cloth(false), 0);
  odds(2, -0.5);
  options.symmetry = 0;
  EXPECT_EQ(cloth(false), 0);
}

TEST(Segment, SmallPatchesAreNotWorthTheirBorder) {
  const Mesh pose = still_tube();
  Eigen::VectorXd sigma = Eigen::VectorXd::Constant(pose.vertices.rows(), 0.001);
  for (int i = 0; on_side(i); ++i) {
    const int around = i % tube::kAround;
    if (height(i) < 0.55)
      sigma[i] = 0.05;
    if (height(i) > 0.27 && height(i) < 0.33 && around > 11 && around < 16)
      sigma[i] = 0.001; // a hole of 5 cm
    if (height(i) > 0.8 && height(i) < 0.86 && around > 11 && around < 16)
      sigma[i] = 0.05; // an island of 5 cm
  }
  const Segmentation result = segmentation_from_deviation(pose, {}, sigma);
  ASSERT_EQ(result.region_count, 1);
  EXPECT_GT(result.clothness[12 * tube::kAround + 14], 0.95);
  EXPECT_EQ(result.clothness[33 * tube::kAround + 14], 0.0);
  SegmentOptions free_borders;
  free_borders.border = 0;
  const Segmentation raw = segmentation_from_deviation(pose, {}, sigma, free_borders);
  EXPECT_EQ(raw.region_count, 2);
  EXPECT_EQ(raw.region[33 * tube::kAround + 14], 1); // numbered by falling area
  EXPECT_LT(raw.clothness[12 * tube::kAround + 14], 0.5);
}

TEST(Segment, TheProbabilityIsSureInTheMiddleAndNotAtEvenOdds) {
  const Mesh pose = still_tube();
  Eigen::VectorXd sigma = Eigen::VectorXd::Constant(pose.vertices.rows(), 0.001);
  for (int i = 0; on_side(i); ++i)
    sigma[i] = height(i) < 0.4 ? 0.05 : height(i) < 0.7 ? 0.0031 : 0.001; // cloth, hardly cloth, skin
  const Segmentation result = segmentation_from_deviation(pose, {}, sigma);
  ASSERT_EQ(result.probability.size(), sigma.size());
  EXPECT_GT(result.probability[8 * tube::kAround], 0.95);
  EXPECT_LT(result.probability[36 * tube::kAround], 0.1);
  EXPECT_NEAR(result.probability[22 * tube::kAround], 0.5, 0.2);
  for (int i = 0; on_side(i); ++i) // the label is the side of a half on which the probability is; borders are smoothed
    if (result.clothness[i] > 0.95 || result.clothness[i] == 0) {
      EXPECT_EQ(result.clothness[i] > 0.5, result.probability[i] > 0.5) << height(i);
    }
  EXPECT_GT(summarise_segmentation(pose, {}, result).uncertain_area, 0.2);
}

TEST(Segment, RejectsInputsThatDoNotBelongToTheSequence) {
  SegmentInputs inputs{tube::pulsating(0.02)};
  const Eigen::Index vertices = inputs.surface.frames[0].rows();
  inputs.colours = Vertices::Zero(inputs.surface.faces.rows() + 1, 3);
  EXPECT_THROW(segment_cloth(inputs), std::invalid_argument);
  inputs.colours.resize(0, 3);
  inputs.canonical.assign(3, inputs.surface.frames.front());
  EXPECT_THROW(segment_cloth(inputs), std::invalid_argument);
  inputs.canonical.assign(inputs.surface.frames.size(), Vertices::Zero(4, 3));
  EXPECT_THROW(segment_cloth(inputs), std::invalid_argument);
  inputs.canonical.clear();
  inputs.prior = Eigen::VectorXd::Zero(vertices - 1);
  EXPECT_THROW(segment_cloth(inputs), std::invalid_argument);
  inputs.prior = Eigen::VectorXd::Constant(vertices, std::numeric_limits<double>::infinity());
  EXPECT_THROW(segment_cloth(inputs), std::invalid_argument);
  inputs.prior.resize(0);
  inputs.gap = Eigen::VectorXd::Constant(vertices, std::numeric_limits<double>::quiet_NaN());
  EXPECT_THROW(segment_cloth(inputs), std::invalid_argument);
  inputs.gap.resize(0);
  for (const Eigen::VectorXi &mirrored :
       {Eigen::VectorXi::Constant(vertices, static_cast<int>(vertices)).eval(), Eigen::VectorXi::Constant(vertices, -2).eval(),
        Eigen::VectorXi::Zero(vertices - 1).eval()}) {
    inputs.mirrored = mirrored;
    EXPECT_THROW(segment_cloth(inputs), std::invalid_argument);
  }
}

TEST(Segment, WhatASeamCutsOffIsNoGarmentOfItsOwn) {
  const Mesh pose = still_tube();
  const detail::Surface surface = detail::surface_of(pose, {});
  Segmentation cloth;
  cloth.clothness = Eigen::VectorXd::Ones(pose.vertices.rows());
  std::vector<char> seam(pose.vertices.rows(), 0); // around the tube, and around a patch of it
  for (int i = 0; on_side(i); ++i) {
    const int ring = i / tube::kAround, around = i % tube::kAround;
    const bool edge = ring == 25 || ring == 29 || around == 4 || around == 9;
    seam[i] = ring == 20 || (edge && ring >= 25 && ring <= 29 && around >= 4 && around <= 9);
  }
  detail::label_regions(surface, seam, cloth);
  EXPECT_EQ(cloth.region_count, 3);
  detail::label_regions(surface, seam, cloth, 0.02);
  EXPECT_EQ(cloth.region_count, 2);
  EXPECT_EQ(cloth.region[27 * tube::kAround + 6], cloth.region[27 * tube::kAround + 12]);
}

TEST(Segment, GarmentsOfTwoLooksThatTouchWhereTheyAreStillAreTwo) {
  const Eigen::RowVector3d skin(130, 150, 200), red(40, 30, 170), blue(160, 60, 30); // B G R
  const auto dressed = [&](double seam, const Eigen::RowVector3d &below) {           // a waist at 0.5 m, cloth from 0.15 to 0.85
    SegmentInputs inputs{{tube::faces(), {}}};
    for (int t = 0; t < 40; ++t) {
      const double s = std::sin(2 * std::numbers::pi * 2 * t / 40);
      inputs.surface.frames.push_back(tube::vertices([&](double y) {
        const double out = std::abs(y - 0.5);
        return tube::kRadius + s * (out > 0.35 ? 0.0005 : 0.008 + 0.04 * out);
      }));
    }
    inputs.colours.resize(inputs.surface.faces.rows(), 3);
    for (int f = 0; f < inputs.surface.faces.rows(); ++f) {
      const int vertex = inputs.surface.faces(f, 0);
      const double y = on_side(vertex) ? height(vertex) : 0.0;
      inputs.colours.row(f) = y < 0.15 || y > 0.85 ? skin : y > seam ? red : below;
    }
    return inputs;
  };
  const Segmentation two = segment_cloth(dressed(0.5, blue));
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
  EXPECT_EQ(segment_cloth(dressed(0.5, red)).region_count, 1);  // of one fabric
  EXPECT_EQ(segment_cloth(dressed(0.7, blue)).region_count, 1); // a hem that flies before the other
  // A person's corrections keep what parts them, but where cloth is painted over it.
  const Mesh pose{dressed(0.5, blue).surface.frames.front(), tube::faces()};
  Eigen::VectorXi painted = Eigen::VectorXi::Constant(pose.vertices.rows(), static_cast<int>(CorrectionLabel::None));
  EXPECT_EQ(apply_corrections(pose, {}, two, painted).region, two.region);
  for (int i = 0; on_side(i); ++i)
    if (std::abs(height(i) - 0.5) < 0.06)
      painted[i] = static_cast<int>(CorrectionLabel::Cloth);
  EXPECT_EQ(apply_corrections(pose, {}, two, painted).region_count, 1);
}

TEST(Segment, ThePaintedGoesBeforeTheFound) {
  const Mesh pose{tube::vertices([](double) { return tube::kRadius; }), tube::faces()};
  Eigen::VectorXd sigma = Eigen::VectorXd::Zero(pose.vertices.rows());
  for (int i = 0; on_side(i); ++i)
    if (height(i) > 0.2 && height(i) < 0.8)
      sigma[i] = 0.05;
  const Segmentation found = segmentation_from_deviation(pose, {}, sigma);
  Eigen::VectorXi painted = Eigen::VectorXi::Constant(pose.vertices.rows(), static_cast<int>(CorrectionLabel::None));
  const Segmentation same = apply_corrections(pose, {}, found, painted);
  EXPECT_EQ(same.clothness, found.clothness);
  EXPECT_EQ(same.region, found.region);
  const int seam = 14, skin = 25, cloth = 3; // rings
  for (int a = 0; a < tube::kAround; ++a) {
    painted[seam * tube::kAround + a] = static_cast<int>(CorrectionLabel::Border);
    painted[skin * tube::kAround + a] = static_cast<int>(CorrectionLabel::Skin);
    painted[cloth * tube::kAround + a] = static_cast<int>(CorrectionLabel::Cloth);
  }
  const Segmentation result = apply_corrections(pose, {}, found, painted);
  const auto region = [&](int ring) { return result.region[ring * tube::kAround + 7]; };
  EXPECT_EQ(result.region_count, 4); // between skin and seam, above the skin, below the seam, the painted ring
  EXPECT_EQ(result.clothness[seam * tube::kAround + 7], found.clothness[seam * tube::kAround + 7]);
  EXPECT_NE(region(seam - 1), region(seam + 1));
  EXPECT_TRUE(region(seam) == region(seam - 1) || region(seam) == region(seam + 1));
  EXPECT_EQ(result.clothness[skin * tube::kAround + 7], 0.0);
  EXPECT_EQ(result.probability[skin * tube::kAround + 7], 0.0);
  EXPECT_EQ(result.probability[seam * tube::kAround + 7], found.probability[seam * tube::kAround + 7]);
  EXPECT_EQ(region(skin), -1);
  EXPECT_EQ(result.clothness[cloth * tube::kAround + 7], 1.0);
  EXPECT_EQ(region(cloth), 3); // the smallest
  painted[5] = 3;
  EXPECT_THROW(apply_corrections(pose, {}, found, painted), std::invalid_argument);
  EXPECT_THROW(apply_corrections(pose, {}, found, painted.head(7)), std::invalid_argument);
}

TEST(Segment, TrimmingIgnoresFramesOfLostTracking) {
  MeshSequence sequence = tube::pulsating(0.0, 60);
  sequence.frames[7] *= 1.5; // one frame is half as big again
  EXPECT_EQ(segment_cloth({sequence}).region_count, 0);
  EXPECT_GT(segment_cloth({sequence}, plain()).sigma.head(tube::kAround * 30).tail(tube::kAround).maxCoeff(), 0.01);
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
  const Segmentation result = segment_cloth({sequence, valid});
  EXPECT_TRUE(std::isnan(result.sigma[front]));
  EXPECT_EQ(result.clothness[back], 0.0);
  EXPECT_EQ(result.region[back], -1);
}

TEST(Segment, UnknownRaysAreFilledFromTheirSurroundings) {
  const MeshSequence sequence = tube::pulsating(0.02, 40, false);
  Segmentation known = segment_cloth({sequence}, plain());
  Eigen::VectorXd sigma = known.sigma;
  for (int i = 0; i < sigma.size(); ++i)
    if (on_side(i) && std::abs(height(i) - 0.5) < 0.12 && i % tube::kAround < 12)
      sigma[i] = std::numeric_limits<double>::quiet_NaN();
  const Segmentation filled = segmentation_from_deviation({sequence.frames[0], sequence.faces}, {}, sigma, plain());
  EXPECT_LT((filled.clothness - known.clothness).cwiseAbs().maxCoeff(), 0.1);
}

TEST(Segment, DoesNotDependOnThreadsOrOnTheFrameOfReference) {
  const MeshSequence sequence = tube::pulsating(0.015);
  Context one, three;
  one.threads = 1;
  three.threads = 3;
  const Segmentation a = segment_cloth({sequence}, {}, one), b = segment_cloth({sequence}, {}, three);
  EXPECT_TRUE((a.clothness.array() == b.clothness.array()).all());
  MeshSequence moved = sequence;
  const Eigen::Matrix3d turn = Eigen::AngleAxisd(1.1, Eigen::Vector3d(3, -1, 2).normalized()).toRotationMatrix();
  for (Vertices &frame : moved.frames)
    frame = (frame * turn.transpose()).rowwise() + Eigen::RowVector3d(3, -2, 1);
  const Segmentation c = segment_cloth({moved});
  EXPECT_EQ(c.region_count, a.region_count);
  // A ray that leaves exactly through an edge of this symmetric tube may fall to either side: compare what that cannot change.
  EXPECT_LT((c.clothness - a.clothness).cwiseAbs().mean(), 1e-3);
}

TEST(Segment, ReportsWhatItFound) {
  const MeshSequence sequence = tube::pulsating(0.02);
  const SegmentSummary summary = summarise_segmentation({sequence.frames[0], sequence.faces}, {}, segment_cloth({sequence}));
  EXPECT_EQ(summary.regions, 1);
  EXPECT_NEAR(summary.cloth_area, 2 * std::numbers::pi * tube::kRadius * 0.38, 0.03);
  EXPECT_GT(summary.known_fraction, 0.95);
}

TEST(Segment, RejectsWrongInput) {
  const MeshSequence sequence = tube::pulsating(0.01, 4);
  MeshSequence single{sequence.faces, {sequence.frames[0]}};
  EXPECT_THROW(segment_cloth({single}), std::invalid_argument);
  EXPECT_THROW(segment_cloth({}), std::invalid_argument);
  EXPECT_THROW(segment_cloth({sequence, std::vector<std::uint8_t>(3, 1)}), std::invalid_argument);
  MeshSequence nan = sequence;
  nan.frames[2](5, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(segment_cloth({nan}), Error);
  MeshSequence shrunk = sequence;
  shrunk.frames[1] = sequence.frames[1].topRows(10);
  EXPECT_THROW(segment_cloth({shrunk}), std::invalid_argument);
  MeshSequence outside = sequence;
  outside.faces(0, 0) = 1 << 20;
  EXPECT_THROW(segment_cloth({outside}), Error);
  SegmentOptions options;
  options.diffusion = -1;
  EXPECT_THROW(segment_cloth({sequence}, options), std::invalid_argument);
}

TEST(Segment, SurvivesBadMeshes) {
  MeshSequence sequence = tube::pulsating(0.02, 6);
  Faces &faces = sequence.faces;
  faces.row(10) << 5, 5, 5;                // degenerate
  faces.row(11) = faces.row(12);           // doubled: non-manifold
  faces.row(20) = faces.row(20).reverse(); // flipped
  const Faces open = faces.topRows(faces.rows() / 2);
  EXPECT_NO_THROW(segment_cloth({sequence}));
  sequence.faces = open; // boundary, and half the vertices unused
  const Segmentation result = segment_cloth({sequence});
  EXPECT_TRUE(result.clothness.allFinite());
  EXPECT_EQ(result.region[tube::kAround * tube::kRings - 1], -1);
  const Segmentation nothing = segment_cloth({sequence, std::vector<std::uint8_t>(open.rows(), 0)});
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
  mutable SegmentInputs given;
  Segmentation segment(const SegmentInputs &inputs, const Context &) const override {
    given = inputs;
    const auto n = inputs.surface.frames[0].rows();
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

TEST(Segment, APerformanceIsComparedWithTheScan) {
  const RiggedMesh actor = doublet::testing::figure_actor(0.06);
  for (const double bent : {0.05, 0.3}) {
    const ReferencePerformance performance = first_pose::turning(actor, bent);
    const first_pose::Keeper keeper;
    segment_performance(actor, performance, keeper);
    EXPECT_EQ(keeper.given.surface.frames.front(), actor.mesh.vertices);
    EXPECT_EQ(keeper.given.surface.frames.size(), 3u);
    EXPECT_EQ(keeper.given.canonical.size(), keeper.given.surface.frames.size());
    EXPECT_LT((keeper.given.canonical.front() - actor.mesh.vertices).rowwise().norm().maxCoeff(), 1e-9);
  }
}
