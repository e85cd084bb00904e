// The sheets that close a scan.

#include "doublet/core/parts/invalid_faces.h"
#include "support/meshes.h"

#include <gtest/gtest.h>

using namespace doublet;

namespace {

/// A leg that comes out of a garment: two tubes about y, joined at y = 0.5 by a ring that faces down.
Mesh leg_in_garment() {
  return doublet::testing::closed_tube(
      {0, 0, 0}, {0, 1, 0}, [](double s) { return s < 0.5 ? 0.04 : 0.1; }, 41, 24);
}

bool faces_down(const Mesh &mesh, int f) {
  return face_normals(mesh.vertices, mesh.faces)(f, 1) < -0.8;
}

bool at_the_hem(const Mesh &mesh, int f) {
  for (int c = 0; c < 3; ++c)
    if (std::abs(mesh.vertices(mesh.faces(f, c), 1) - 0.5) > 0.03)
      return false;
  return true;
}

} // namespace

TEST(Sheets, GrowOverWhatFacesTheSameWayBesideThem) {
  const Mesh mesh = leg_in_garment();
  std::vector<std::uint8_t> valid(mesh.faces.rows(), 1);
  int sheet = 0, first = -1;
  for (int f = 0; f < mesh.faces.rows(); ++f)
    if (at_the_hem(mesh, f) && faces_down(mesh, f)) {
      first = first < 0 ? f : first;
      ++sheet;
    }
  ASSERT_GT(sheet, 20);
  EXPECT_EQ(extend_invalid_faces(mesh, valid), valid); // no sheet, nothing to extend
  valid[first] = 0;                                    // all that was marked of the ring
  const std::vector<std::uint8_t> extended = extend_invalid_faces(mesh, valid);
  for (int f = 0; f < mesh.faces.rows(); ++f)
    EXPECT_EQ(extended[f] == 0, at_the_hem(mesh, f) && faces_down(mesh, f))
        << f; // the foot's sole faces down, too, but elsewhere
  EXPECT_TRUE(extend_invalid_faces(mesh, {}).empty());
}

TEST(Sheets, AHoleInASurfaceIsNoSheet) {
  const Mesh mesh = leg_in_garment();
  std::vector<std::uint8_t> valid(mesh.faces.rows(), 1);
  for (int f = 0; f < mesh.faces.rows(); ++f)
    if (mesh.vertices(mesh.faces(f, 0), 1) > 0.7) {
      valid[f] = 0; // on the garment's side, which goes on far beyond it
      break;
    }
  EXPECT_EQ(extend_invalid_faces(mesh, valid), valid);
}
