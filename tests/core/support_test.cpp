// The test kit itself: what others build their tests on must be right.

#include "doublet/core/rasterizer.h"
#include "support/figure.h"
#include "support/temp_folder.h"

#include <gtest/gtest.h>

namespace doublet::testing {

double volume(const Mesh &m) {
  double sum = 0;
  for (int f = 0; f < m.faces.rows(); ++f) {
    const Eigen::Vector3d a = m.vertices.row(m.faces(f, 0)), b = m.vertices.row(m.faces(f, 1)), c = m.vertices.row(m.faces(f, 2));
    sum += a.dot(b.cross(c)) / 6;
  }
  return sum;
}

TEST(Support, SolidsAreClosedAndFaceOutwards) {
  EXPECT_NEAR(volume(sphere(0.5, {1, 2, 3}, 64, 128)), 4 / 3.0 * pi * 0.125, 1e-3);
  EXPECT_NEAR(volume(cylinder({0, 0, 0}, {1, 1, 0}, 0.2, 5, 256)), pi * 0.04 * std::sqrt(2), 1e-3);
  for (const Mesh &m : {sphere(1), cylinder({0, 0, 0}, {0, 1, 0}, 0.1), figure_surface(0.04)}) {
    const MeshReport r = report_mesh(m);
    EXPECT_TRUE(r.usable() && r.closed()) << r.to_string();
    EXPECT_EQ(r.degenerate_faces, 0);
    EXPECT_EQ(r.unused_vertices, 0);
  }
}

TEST(Support, SheetsFaceUpAndTubesFaceOutwards) {
  EXPECT_GT(face_normals(grid(1, 1, 3, 4).vertices, grid(1, 1, 3, 4).faces).col(1).minCoeff(), 0.999);
  const Mesh s = skirt();
  const Vertices n = vertex_normals(s.vertices, s.faces);
  for (int v = 0; v < n.rows(); ++v)
    EXPECT_GT(n(v, 0) * s.vertices(v, 0) + n(v, 2) * s.vertices(v, 2), 0);
}

TEST(Support, FigureIsOnePersonSeenWholeByEveryCamera) {
  const Mesh body = figure_surface(0.03);
  EXPECT_EQ(report_mesh(body).components, 1);
  EXPECT_NEAR(volume(body), 0.06, 0.02);
  for (const Camera &camera : camera_ring()) {
    const FaceBuffer view = rasterize(body.vertices, body.faces, camera);
    for (int x = 0; x < view.width; ++x) {
      EXPECT_LT(view.face_at(x, 0), 0);
      EXPECT_LT(view.face_at(x, view.height - 1), 0);
      EXPECT_LT(view.face_at(0, x), 0);
      EXPECT_LT(view.face_at(view.width - 1, x), 0);
    }
    EXPECT_GE(view.face_at(view.width / 2, view.height / 2), 0);
  }
}

} // namespace doublet::testing
