#include "doublet/animate/level_of_detail.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

using namespace doublet;

namespace {

constexpr int kCells = 24;

int grid_vertex(int x, int y) {
  return y * (kCells + 1) + x;
}

/// The unit square, flat; its left half lies in the left 0.4 of the texture, its right half in the right 0.4.
struct Square {
  Vertices vertices{(kCells + 1) * (kCells + 1), 3};
  TexturedFaces drawn;

  static Eigen::RowVector2d place(const Eigen::RowVector3d &p, bool right) {
    return {0.8 * p.x() + (right ? 0.2 : 0.0), 0.9 * p.y()};
  }

  Square() {
    for (int y = 0; y <= kCells; ++y)
      for (int x = 0; x <= kCells; ++x)
        vertices.row(grid_vertex(x, y)) << x / double(kCells), y / double(kCells), 0;
    drawn.faces.resize(2 * kCells * kCells, 3);
    drawn.texcoords.resize(3 * drawn.faces.rows(), 2);
    for (int y = 0, f = 0; y < kCells; ++y)
      for (int x = 0; x < kCells; ++x, f += 2) {
        const int a = grid_vertex(x, y), b = grid_vertex(x + 1, y), c = grid_vertex(x + 1, y + 1), d = grid_vertex(x, y + 1);
        drawn.faces.row(f) << a, b, c;
        drawn.faces.row(f + 1) << a, c, d;
        for (int corner = 0; corner < 6; ++corner)
          drawn.texcoords.row(3 * f + corner) = place(vertices.row(drawn.faces(f + corner / 3, corner % 3)), x >= kCells / 2);
      }
  }
};

double area(const Vertices &vertices, const Faces &faces) {
  double sum = 0;
  for (Eigen::Index f = 0; f < faces.rows(); ++f) {
    const Eigen::Vector3d a = vertices.row(faces(f, 0)), b = vertices.row(faces(f, 1)), c = vertices.row(faces(f, 2));
    sum += (b - a).cross(c - a).z() / 2; // a face that is turned over counts against it
  }
  return sum;
}

} // namespace

TEST(LevelOfDetail, FlatClothKeepsItsRimItsSeamAndItsTexture) {
  const Square square;
  const TexturedFaces reduced = reduce_faces(square.vertices, square.drawn, 60);
  EXPECT_LE(reduced.faces.rows(), 60);
  EXPECT_GE(reduced.faces.rows(), 50);
  EXPECT_NEAR(area(square.vertices, reduced.faces), 1, 1e-12);
  ASSERT_EQ(reduced.texcoords.rows(), 3 * reduced.faces.rows());
  for (Eigen::Index f = 0; f < reduced.faces.rows(); ++f) {
    double middle = 0, least = 1, most = 0;
    for (int k = 0; k < 3; ++k) {
      const double x = square.vertices(reduced.faces(f, k), 0);
      middle += x / 3;
      least = std::min(least, x);
      most = std::max(most, x);
    }
    EXPECT_FALSE(least < 0.5 && most > 0.5) << "face " << f << " lies across the seam";
    for (int k = 0; k < 3; ++k) {
      const Eigen::RowVector2d place = Square::place(square.vertices.row(reduced.faces(f, k)), middle > 0.5);
      EXPECT_LT((reduced.texcoords.row(3 * f + k) - place).norm(), 1e-12) << "face " << f;
    }
  }
}

TEST(LevelOfDetail, CurvesOfRimsGoLast) {
  Square square;
  for (Eigen::Index v = 0; v < square.vertices.rows(); ++v) // a hem that swings
    square.vertices(v, 1) += 0.1 * std::sin(6 * square.vertices(v, 0)) * (1 - square.vertices(v, 1));
  const double before = area(square.vertices, square.drawn.faces);
  const TexturedFaces reduced = reduce_faces(square.vertices, square.drawn, 100);
  EXPECT_LE(reduced.faces.rows(), 100);
  EXPECT_NEAR(area(square.vertices, reduced.faces), before, 0.003 * before);
}

TEST(LevelOfDetail, WhatMakesTheSurfaceNonManifoldStays) {
  Square square;
  Faces &faces = square.drawn.faces;
  faces.conservativeResize(faces.rows() + 1, 3);
  faces.bottomRows(1) << grid_vertex(5, 5), grid_vertex(6, 5), grid_vertex(15, 20); // a third face at an edge
  square.drawn.texcoords.resize(0, 2);
  const TexturedFaces reduced = reduce_faces(square.vertices, square.drawn, 60);
  EXPECT_EQ(reduced.texcoords.rows(), 0);
  EXPECT_LE(reduced.faces.rows(), 70);
  EXPECT_EQ(reduced.faces.bottomRows(1), faces.bottomRows(1));
}

TEST(LevelOfDetail, FacesThatCannotBeJoinedStayAndNothingIsSaidOfThem) {
  Square square;
  const int rim = grid_vertex(0, 12), inside = grid_vertex(5, 5), first = static_cast<int>(square.vertices.rows());
  square.vertices.conservativeResize(first + 3, 3);
  square.vertices.bottomRows(3) << -0.1, 0.5, 0.1, -0.1, 0.4, 0, -0.1, 0.6, 0;
  Faces &faces = square.drawn.faces;
  const Eigen::Index joined = faces.rows() + 2;
  faces.conservativeResize(joined + 3, 3);
  faces.bottomRows(5) << rim, first, first + 1, rim, first + 1, first + 2, //
      rim, first + 2, first,                                               // closes a second fan at a vertex
      inside, first, first + 1,                                            // at a vertex that is surrounded
      rim, rim, first;
  square.drawn.texcoords.resize(0, 2);
  ::testing::internal::CaptureStderr();
  const TexturedFaces reduced = reduce_faces(square.vertices, square.drawn, 60);
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "");
  EXPECT_LE(reduced.faces.rows(), 70);
  EXPECT_EQ(reduced.faces.bottomRows(3), faces.bottomRows(3));
}

TEST(LevelOfDetail, WhatDoesNotFitIsRefused) {
  Square square;
  EXPECT_THROW(reduce_faces(square.vertices, square.drawn, 3), std::invalid_argument);
  TexturedFaces wrong = square.drawn;
  wrong.faces(7, 1) = static_cast<int>(square.vertices.rows());
  EXPECT_THROW(reduce_faces(square.vertices, wrong, 60), std::invalid_argument);
  wrong = square.drawn;
  wrong.texcoords.conservativeResize(12, 2);
  EXPECT_THROW(reduce_faces(square.vertices, wrong, 60), std::invalid_argument);
  square.vertices(4, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(reduce_faces(square.vertices, square.drawn, 60), std::invalid_argument);
}
