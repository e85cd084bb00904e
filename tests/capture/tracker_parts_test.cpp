// Outlines, rims, Jacobians, smoothing, features: each against a known answer.

#include "doublet/capture/parts/smoothing.h"
#include "tracker_scene.h"

#include <algorithm>
#include <gtest/gtest.h>
#include <random>

using namespace doublet;
using namespace tracker_scene;

namespace tracker_parts_test {

Image disc(int size, double x, double y, double radius) {
  Image mask(size, size, 1);
  for (int v = 0; v < size; ++v)
    for (int u = 0; u < size; ++u)
      if (std::hypot(u - x, v - y) < radius)
        mask.at(u, v) = 255;
  return mask;
}

TEST(Outline, LiesOnACircleWithOutwardNormals) {
  const Outline outline = trace_outline(disc(200, 97.3, 104.6, 60));
  ASSERT_GT(outline.points.size(), 300u);
  double bias = 0, worst = 0, cosine = 1;
  for (size_t i = 0; i < outline.points.size(); ++i) {
    const Eigen::Vector2f from_centre = outline.points[i] - Eigen::Vector2f(97.3f, 104.6f);
    bias += (from_centre.norm() - 60) / outline.points.size();
    worst = std::max(worst, std::abs(from_centre.norm() - 60.0));
    cosine = std::min(cosine, double(from_centre.normalized().dot(outline.normals[i])));
  }
  EXPECT_LT(std::abs(bias), 0.1);
  EXPECT_LT(worst, 0.7);
  EXPECT_GT(cosine, 0.9);
}

TEST(Outline, NormalsOfAHolePointIntoTheHole) {
  Image mask = disc(200, 100, 100, 80);
  const Image hole = disc(200, 100, 100, 30);
  for (size_t i = 0; i < mask.data.size(); ++i)
    if (hole.data[i])
      mask.data[i] = 0;
  const Outline outline = trace_outline(mask);
  int inner = 0;
  for (size_t i = 0; i < outline.points.size(); ++i) {
    const Eigen::Vector2f from_centre = outline.points[i] - Eigen::Vector2f(100, 100);
    if (from_centre.norm() < 50) {
      EXPECT_LT(from_centre.dot(outline.normals[i]), 0);
      ++inner;
    }
  }
  EXPECT_GT(inner, 100);
}

TEST(Outline, LeavesOutTheImageBorderAndEmptyMasks) {
  const Outline cut = trace_outline(disc(200, 0, 100, 60));
  for (const Eigen::Vector2f &p : cut.points)
    EXPECT_GT(p.x(), 1.4f);
  EXPECT_FALSE(cut.empty());
  EXPECT_TRUE(trace_outline(Image(100, 100, 1)).empty());
  EXPECT_TRUE(trace_outline(Image()).empty());
  EXPECT_TRUE(trace_outline(Image(100, 100, 1, 255)).empty()); // all actor: only border
}

TEST(Outline, OfAPartOfAMaskIsThatOfTheMask) {
  for (const double x : {97.3, 20.0}) { // the second is cut by the border
    const Image mask = disc(200, x, 104.6, 60);
    const int left = static_cast<int>(std::max(0.0, x - 64)), top = 40;
    Image part(200 - left, 130, 1);
    for (int v = 0; v < part.height; ++v)
      for (int u = 0; u < part.width; ++u)
        part.at(u, v) = mask.at(u + left, v + top);
    const Outline whole = trace_outline(mask), same = trace_outline(part, left, top, 200, 200);
    EXPECT_EQ(same.points, whole.points);
    EXPECT_EQ(same.normals, whole.normals);
    EXPECT_EQ(same.pixels, whole.pixels);
    EXPECT_THROW(trace_outline(part, left + 1, top, 200, 200), std::invalid_argument);
  }
}

TEST(Outline, FilledAgainIsTheMask) {
  Image mask = disc(200, 90, 90, 50);
  const Image other = disc(200, 160, 160, 20);
  for (size_t i = 0; i < mask.data.size(); ++i)
    mask.data[i] |= other.data[i];
  EXPECT_GT(mask_iou(fill_outline(trace_outline(mask).points, 200, 200), mask), 0.97);
}

TEST(OutlineIndex, AgreesWithASearchOverAllPoints) {
  const Outline outline = trace_outline(disc(200, 97, 104, 60));
  const OutlineIndex index(outline, 200, 200);
  for (int k = 0; k < 400; ++k) {
    const Eigen::Vector2f p(std::fmod(37.7f * k, 220.f) - 10, std::fmod(91.3f * k, 220.f) - 10);
    const Eigen::Vector2f normal(std::cos(0.7f * k), std::sin(0.7f * k));
    int best = -1;
    float least = 25 * 25;
    for (size_t i = 0; i < outline.points.size(); ++i)
      if ((outline.points[i] - p).squaredNorm() < least && outline.normals[i].dot(normal) >= 0.5f) {
        least = (outline.points[i] - p).squaredNorm();
        best = static_cast<int>(i);
      }
    const int found = index.nearest(p, normal, 25, 0.5f);
    ASSERT_EQ(found < 0, best < 0) << p.transpose();
    if (best >= 0) {
      EXPECT_FLOAT_EQ((outline.points[found] - p).squaredNorm(), least);
    }
  }
  EXPECT_EQ(index.nearest({std::nanf(""), 0}, {1, 0}, 25, 0.5f), -1);
}

TEST(Rims, OfTheTruePoseLieOnTheMeasuredOutline) {
  const RiggedMesh actor = figure();
  const Camera camera = ring(8, 400)[3];
  const Vertices &v = actor.mesh.vertices;
  const Outline measured = trace_outline(silhouette(rasterize(v, actor.mesh.faces, camera)));
  const Rims rims = find_rims(v, actor.mesh.faces, {}, camera, 200); // half size: rims keep their accuracy
  const RimMatches matches = match_rims(rims, measured, OutlineIndex(measured, 400, 400), 0, camera, {});
  ASSERT_GT(matches.constraints.size(), 300u);
  EXPECT_LT(matches.unmatched, 10);
  double mean = 0, mean_absolute = 0;
  for (const RimConstraint &c : matches.constraints) {
    const double r = rim_residual(c, v, actor.mesh.faces, camera);
    mean += r / matches.constraints.size();
    mean_absolute += std::abs(r) / matches.constraints.size();
  }
  EXPECT_LT(std::abs(mean), 0.15); // no bias from the half-size rendering
  EXPECT_LT(mean_absolute, 0.6);
}

TEST(Pose, JacobianOfRigidPointsEqualsFiniteDifferences) {
  const RiggedMesh actor = figure();
  const Eigen::VectorXd dofs = motion(actor, 8).row(7);
  const MatrixRM influence = dof_influence(actor);
  const Vertices v = pose_surface(actor, dofs, {}).vertices;
  const std::vector<DofTwist> twists = dof_twists(actor.skeleton, dofs);
  const double h = 1e-6;
  int rigid = 0;
  for (int f = 0; f < actor.mesh.faces.rows(); f += 37) {
    const SurfacePoint point{f, {0.2, 0.3, 0.5}};
    const Eigen::Matrix3Xd jacobian = surface_jacobian(point, v, actor.mesh.faces, influence, twists);
    double blended = 0;
    for (int c = 0; c < 3; ++c)
      blended = std::max(blended, 1 - actor.weights.row(actor.mesh.faces(f, c)).maxCoeff());
    rigid += blended == 0;
    for (int d = 0; d < dofs.size(); ++d) {
      Eigen::VectorXd plus = dofs, minus = dofs;
      plus[d] += h;
      minus[d] -= h;
      const Eigen::Vector3d numeric = (point.position(pose_surface(actor, plus, {}).vertices, actor.mesh.faces) -
                                       point.position(pose_surface(actor, minus, {}).vertices, actor.mesh.faces)) /
                                      (2 * h);
      // Dual quaternions blend rotations on a sphere: the twist mean is first-order there, exact where one joint rules.
      EXPECT_LT((numeric - jacobian.col(d)).norm(), blended == 0 ? 1e-7 : 0.05) << "face " << f << " dof " << d;
    }
  }
  EXPECT_GT(rigid, 20);
}

TEST(Smoothing, KeepsParabolasAndRemovesNoise) {
  MatrixRM parabola(20, 2), noisy(20, 1);
  for (int t = 0; t < 20; ++t) {
    parabola.row(t) << 3 + 2 * t - 0.1 * t * t, -t;
    noisy(t, 0) = t % 2 ? 1 : -1;
  }
  EXPECT_LT((savitzky_golay(parabola, 7, 2) - parabola).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_LT(savitzky_golay(noisy, 5, 2).middleRows(2, 16).cwiseAbs().maxCoeff(), 0.5);
  EXPECT_NEAR(mean_second_difference(noisy, 0, 1), 4, 1e-12);
  EXPECT_NEAR(mean_second_difference(parabola, 0, 1), 0.2, 1e-12);
  // The published weights for window 5, order 2: (-3 12 17 12 -3) / 35.
  const MatrixRM w = savitzky_golay_weights(5, 2);
  EXPECT_NEAR(w(2, 0), -3. / 35, 1e-12);
  EXPECT_NEAR(w(2, 1), 12. / 35, 1e-12);
  EXPECT_NEAR(w(2, 2), 17. / 35, 1e-12);
  EXPECT_THROW(savitzky_golay(noisy, 4, 2), std::invalid_argument);
  EXPECT_EQ(savitzky_golay(noisy.topRows(3), 5, 2), noisy.topRows(3));
}

TEST(Features, FollowAKnownShift) {
  Image image(160, 160, 3), moved(160, 160, 3);
  const auto paint = [](Image &target, int dx, int dy) {
    for (int y = 0; y < 160; ++y)
      for (int x = 0; x < 160; ++x)
        for (int c = 0; c < 3; ++c)
          target.at(x, y, c) = static_cast<std::uint8_t>(texture({(x - dx) * 0.004, (y - dy) * 0.004, 0.3}));
  };
  paint(image, 0, 0);
  paint(moved, 6, -4);
  const Image mask = disc(160, 80, 80, 60);
  const auto tracker = FeatureTracker::create();
  const auto a = tracker->detect(image, mask), b = tracker->detect(moved, mask);
  const auto matches = tracker->match(a, b, 20);
  ASSERT_GT(matches.size(), 20u);
  int right = 0;
  for (const auto &[i, j] : matches)
    right += (b.points[j] - a.points[i] - Eigen::Vector2f(6, -4)).norm() < 0.5f;
  EXPECT_GT(right, 0.9 * matches.size());
  for (const Eigen::Vector2f &p : a.points)
    EXPECT_LT((p - Eigen::Vector2f(80, 80)).norm(), 60);
  for (const auto &[i, j] : tracker->match(a, b, 5))
    EXPECT_LE((b.points[j] - a.points[i]).norm(), 5); // the true partners are out of reach
  EXPECT_TRUE(tracker->detect(image, Image(160, 160, 1)).points.empty());
  EXPECT_THROW(tracker->detect(image, Image(10, 10, 1)), std::invalid_argument);
}

TEST(Features, BytesMatchAsOtherNumbersDo) {
  std::mt19937 random(1);
  std::uniform_int_distribution<int> byte(0, 255), error(-40, 40);
  std::uniform_real_distribution<float> pixel(0, 100);
  Features a, b;
  a.descriptors.resize(200, 128);
  b.descriptors.resize(200, 128);
  for (int i = 0; i < 200; ++i) {
    a.points.emplace_back(pixel(random), pixel(random));
    b.points.push_back(a.points.back() + Eigen::Vector2f(3, 4));
    for (int c = 0; c < 128; ++c) {
      a.descriptors(i, c) = byte(random);
      b.descriptors(i, c) = std::clamp(a.descriptors(i, c) + error(random), 0.0, 255.0);
    }
  }
  const auto tracker = FeatureTracker::create();
  const auto bytes = tracker->match(a, b, 30);
  ASSERT_GT(bytes.size(), 100u);
  for (Features *features : {&a, &b})
    features->descriptors *= 0.5; // exactly: all distances keep their order and their ratios
  EXPECT_EQ(tracker->match(a, b, 30), bytes);
}

} // namespace tracker_parts_test
