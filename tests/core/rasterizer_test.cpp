#include "doublet/core/rasterizer.h"

#include "../../libcore/src/draw_face.h"
#include "support/figure.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

namespace doublet {

namespace {

/// World = camera: pixel = 100 x / z + 50.
Camera plain_camera() {
  Camera camera;
  camera.K << 100, 0, 50, 0, 100, 50, 0, 0, 1;
  camera.width = camera.height = 101;
  return camera;
}

} // namespace

TEST(Rasterizer, SamplesPixelCentres) {
  // A square from pixel (10.5, 20.5) to (30.5, 40.5) at 2 m: pixels 11..30 x 21..40.
  const auto at = [](double px, double py) { return Eigen::Vector3d((px - 50) / 50, (py - 50) / 50, 2); };
  const Mesh m = testing::make_mesh({at(10.5, 20.5), at(30.5, 20.5), at(30.5, 40.5), at(10.5, 40.5)}, {{0, 1, 2}, {0, 2, 3}});
  const FaceBuffer b = rasterize(m.vertices, m.faces, plain_camera());
  for (int y = 0; y < b.height; ++y)
    for (int x = 0; x < b.width; ++x)
      EXPECT_EQ(b.face_at(x, y) >= 0, x >= 11 && x <= 30 && y >= 21 && y <= 40) << x << " " << y;
  EXPECT_FLOAT_EQ(b.depth_at(20, 30), 2);
  EXPECT_EQ(b.depth_at(0, 0), std::numeric_limits<float>::infinity());
}

TEST(Rasterizer, EveryPixelOfASharedEdgeBelongsToExactlyOneFace) {
  // Random fans around a pixel centre: the count of faces over all single-face images equals the union.
  for (int turn = 0; turn < 20; ++turn) {
    std::vector<Eigen::Vector3d> v = {{0, 0, 1}};
    std::vector<Eigen::Vector3i> f;
    const int n = 5 + turn % 4;
    for (int k = 0; k < n; ++k) {
      const double a = 2 * testing::pi * k / n + 0.37 * turn;
      v.emplace_back(0.3 * std::cos(a), 0.3 * std::sin(a), 1);
      f.emplace_back(0, 1 + k, 1 + (k + 1) % n);
    }
    const Mesh fan = testing::make_mesh(v, f);
    const FaceBuffer all = rasterize(fan.vertices, fan.faces, plain_camera());
    std::vector<int> count(all.face.size(), 0);
    for (int k = 0; k < n; ++k) {
      std::vector<std::uint8_t> valid(n, 0);
      valid[k] = 1;
      const FaceBuffer one = rasterize(fan.vertices, fan.faces, plain_camera(), valid);
      for (std::size_t i = 0; i < count.size(); ++i)
        count[i] += one.face[i] >= 0;
    }
    for (std::size_t i = 0; i < count.size(); ++i)
      EXPECT_EQ(count[i], all.face[i] >= 0 ? 1 : 0);
    EXPECT_GE(all.face_at(50, 50), 0);
  }
}

TEST(Rasterizer, ClosedMeshHasNoCracks) {
  const Mesh body = testing::figure_surface(0.03);
  for (const Camera &camera : testing::camera_ring(3, 400)) {
    const FaceBuffer b = rasterize(body.vertices, body.faces, camera);
    for (int y = 1; y + 1 < b.height; ++y)
      for (int x = 1; x + 1 < b.width; ++x) {
        const bool around =
            b.face_at(x - 1, y) >= 0 && b.face_at(x + 1, y) >= 0 && b.face_at(x, y - 1) >= 0 && b.face_at(x, y + 1) >= 0;
        EXPECT_FALSE(around && b.face_at(x, y) < 0) << x << " " << y;
      }
  }
}

TEST(Rasterizer, AWindowIsThePartOfTheWholeThatHoldsTheActor) {
  const Mesh body = testing::figure_surface(0.04);
  Camera apart = testing::camera_ring(1, 400)[0], cut = apart;
  cut.K(0, 2) -= 190; // half of the body is beyond the border
  apart.distortion << -0.2, 0.05, 1e-3, 1e-3, 0;
  for (const Camera &camera : {apart, cut}) {
    const FaceBuffer whole = rasterize(body.vertices, body.faces, camera);
    const FaceWindow window = rasterize_window(body.vertices, body.faces, camera, {}, 3);
    EXPECT_LT(window.buffer.width, camera.width * 3 / 4);
    int seen = 0;
    for (int y = 0; y < whole.height; ++y)
      for (int x = 0; x < whole.width; ++x) {
        const int u = x - window.x, v = y - window.y;
        if (u >= 0 && v >= 0 && u < window.buffer.width && v < window.buffer.height) {
          ASSERT_EQ(window.buffer.face_at(u, v), whole.face_at(x, y)) << x << " " << y;
          ASSERT_EQ(window.buffer.depth_at(u, v), whole.depth_at(x, y)) << x << " " << y;
          seen += whole.face_at(x, y) >= 0;
        } else {
          ASSERT_EQ(whole.face_at(x, y), -1) << x << " " << y;
        }
      }
    EXPECT_GT(seen, 1000);
  }
  Camera away = apart;
  away.t.x() += 100;
  EXPECT_EQ(rasterize_window(body.vertices, body.faces, away).buffer.width, 0);
}

TEST(Rasterizer, FourPixelsAtATimeAreTheSameBits) {
  std::mt19937 random(1);
  for (const auto &[width, height] : {std::pair{61, 47}, {3, 5}, {4, 1}})
    for (const double size : {2.0, 12.0, 200.0, 20000.0}) { // pixels; the largest are drawn plainly by both
      const auto empty = [&, w = width, h = height] {
        FaceBuffer buffer;
        buffer.width = w, buffer.height = h;
        buffer.face.assign(static_cast<std::size_t>(w) * h, -1);
        buffer.depth.assign(buffer.face.size(), std::numeric_limits<float>::infinity());
        return buffer;
      };
      FaceBuffer fast = empty(), plain = empty();
      std::uniform_real_distribution<double> across(-size, size), share(0, 1);
      for (int f = 0; f < 300; ++f) {
        const double x = share(random) * width, y = share(random) * height;
        std::array<detail::ScreenVertex, 3> corner;
        const auto placed = [&](double pixel) { return f % 3 ? std::llround(pixel * 1024) : std::llround(pixel) * 1024; };
        for (detail::ScreenVertex &c : corner) // every third face has its corners on pixels' centres
          c = {placed(x + across(random)), placed(y + across(random)), 0.2 + share(random), true};
        detail::draw_face(fast, f, corner[0], corner[1], corner[2]);
        detail::draw_face_plainly(plain, f, corner[0], corner[1], corner[2]);
      }
      EXPECT_EQ(fast.face, plain.face) << width << " " << size;
      EXPECT_EQ(fast.depth, plain.depth) << width << " " << size;
      EXPECT_GT(*std::max_element(plain.face.begin(), plain.face.end()), 0) << width << " " << size;
    }
}

TEST(Rasterizer, DepthIsPerspectiveCorrectAndNearestWins) {
  // A slanted plane z = 2 + x seen as two big triangles, and a small one behind it.
  const Mesh m =
      testing::make_mesh({{-1, -1, 1}, {1, -1, 3}, {1, 1, 3}, {-1, 1, 1}, {-0.1, -0.1, 5}, {0.1, -0.1, 5}, {0, 0.1, 5}},
                         {{4, 5, 6}, {0, 1, 2}, {0, 2, 3}});
  const Camera camera = plain_camera();
  const FaceBuffer b = rasterize(m.vertices, m.faces, camera);
  for (const int x : {30, 50, 61}) {
    const double s = (x - 50) / 100.0, z = 2 / (1 - s); // z = 2 + s z
    EXPECT_NEAR(b.depth_at(x, 50), z, 1e-3);
    const int f = b.face_at(x, 50);
    EXPECT_GE(f, 1);
    const Eigen::Vector3d bary = barycentric_at(m.vertices, m.faces, f, camera, {double(x), 50});
    EXPECT_NEAR(bary.sum(), 1, 1e-12);
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k)
      p += bary[k] * m.vertices.row(m.faces(f, k)).transpose();
    EXPECT_NEAR((p - Eigen::Vector3d(s * z, 0, z)).norm(), 0, 1e-9);
  }
}

TEST(Rasterizer, BarycentricThroughALens) {
  Camera camera = testing::camera_ring(1, 400)[0];
  camera.distortion << -0.2, 0.05, 1e-3, 1e-3, 0;
  const Mesh body = testing::figure_surface(0.04);
  const FaceBuffer b = rasterize(body.vertices, body.faces, camera);
  int checked = 0;
  for (int y = 0; y < b.height; y += 3)
    for (int x = 0; x < b.width; x += 3) {
      const int f = b.face_at(x, y);
      if (f < 0)
        continue;
      const Eigen::Vector3d bary = barycentric_at(body.vertices, body.faces, f, camera, {double(x), double(y)});
      Eigen::Vector3d p = Eigen::Vector3d::Zero();
      for (int k = 0; k < 3; ++k)
        p += bary[k] * body.vertices.row(body.faces(f, k)).transpose();
      EXPECT_LT((camera.project(p) - Eigen::Vector2d(x, y)).norm(), 1e-6);
      EXPECT_GT(bary.minCoeff(), -0.2); // straight edges and rounded corners: a little outside at grazing faces
      ++checked;
    }
  EXPECT_GT(checked, 500);
}

TEST(Rasterizer, LeavesOutWhatCannotBeDrawn) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Mesh m = testing::make_mesh({{0, 0, 1}, {0.1, 0, 1}, {0, 0.1, -1}, {nan, 0, 1}, {0, 0.1, 1}, {0.2, 0, 1}, {0.1, 0, 0.01}},
                                    {{0, 1, 2}, {0, 1, 3}, {0, 1, 5}, {0, 4, 6}, {0, 0, 1}});
  const FaceBuffer b = rasterize(m.vertices, m.faces, plain_camera());
  for (const int f : b.face)
    EXPECT_EQ(f, -1);
  EXPECT_TRUE(rasterize(Vertices(0, 3), Faces(0, 3), plain_camera()).face[0] == -1);
  Faces bad = m.faces;
  bad(0, 0) = 100;
  EXPECT_THROW(rasterize(m.vertices, bad, plain_camera()), std::invalid_argument);
  EXPECT_THROW(rasterize(m.vertices, m.faces, plain_camera(), {1, 0}), std::invalid_argument);
  EXPECT_THROW(rasterize(m.vertices, m.faces, Camera{}), std::invalid_argument);
}

TEST(Rasterizer, PointsFarOutsideALensDoNotFoldIntoTheImage) {
  Camera camera = plain_camera();
  camera.distortion << -0.5, 0, 0, 0, 0; // folds at r = 0.816; (2, 2) would land at (-6, -6), (1.41, 0) in the centre
  const Mesh m = testing::make_mesh({{1.40, 0, 1}, {1.43, 0.02, 1}, {1.43, -0.02, 1}}, {{0, 1, 2}});
  for (const int f : rasterize(m.vertices, m.faces, camera).face)
    EXPECT_EQ(f, -1);
}

TEST(Rasterizer, SilhouetteAndIntersectionOverUnion) {
  const Mesh body = testing::figure_surface(0.04);
  const Image mask = silhouette(rasterize(body.vertices, body.faces, testing::camera_ring()[0]));
  EXPECT_EQ(mask_iou(mask, mask), 1);
  EXPECT_EQ(mask_iou(Image(4, 4, 1), Image(4, 4, 1)), 1);
  Image a(4, 1, 1), b(4, 1, 1);
  a.at(0, 0) = a.at(1, 0) = 255;
  b.at(1, 0) = b.at(2, 0) = 128;
  EXPECT_DOUBLE_EQ(mask_iou(a, b), 1 / 3.0);
  EXPECT_THROW(mask_iou(a, mask), std::invalid_argument);
}

} // namespace doublet
