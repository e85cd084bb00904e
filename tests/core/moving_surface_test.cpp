// The tree against all faces, before and after the surface moves.

#include "doublet/core/error.h"
#include "doublet/core/parts/moving_surface.h"
#include "support/meshes.h"

#include <gtest/gtest.h>
#include <random>

namespace doublet::testing {
namespace {

/// The nearest of all faces, each asked alone.
std::optional<MovingSurface::Point> plainly(const Mesh &mesh, const std::vector<std::uint8_t> &valid, const Eigen::Vector3d &p,
                                            double within) {
  std::optional<MovingSurface::Point> best;
  for (int f = 0; f < mesh.faces.rows(); ++f) {
    if (!valid[f])
      continue;
    const Mesh one{mesh.vertices, mesh.faces.row(f)};
    const auto found = MovingSurface(one).closest(p, within);
    if (found && (!best || found->distance < best->distance)) {
      best = found;
      best->face = f;
    }
  }
  return best;
}

TEST(MovingSurface, FindsWhatAllFacesGive) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  Mesh mesh = sphere(1.0, {0, 0, 0}, 10, 14);
  std::vector<std::uint8_t> valid(mesh.faces.rows(), 1);
  for (std::size_t f = 0; f < valid.size(); f += 3)
    valid[f] = 0;
  MovingSurface surface(mesh, valid);
  std::vector<int> hints(40, -1);
  int found_some = 0;
  for (int frame = 0; frame < 4; ++frame) {
    for (Eigen::Index v = 0; v < mesh.vertices.rows(); ++v) // crumples, turns and flies
      mesh.vertices.row(v) += Eigen::RowVector3d(0.3 + 0.1 * unit(random), 0.1 * unit(random), 0.2 * mesh.vertices(v, 0));
    surface.move_to(mesh.vertices);
    std::mt19937 points(7);
    for (int &hint : hints) {
      const Eigen::Vector3d p(1.5 * unit(points) + 0.3 * frame, 1.5 * unit(points), 1.5 * unit(points));
      const auto expected = plainly(mesh, valid, p, 0.5), found = surface.closest(p, 0.5, hint);
      ASSERT_EQ(found.has_value(), expected.has_value());
      hint = found ? found->face : -1;
      if (!found)
        continue;
      ++found_some;
      EXPECT_EQ(found->face, expected->face);
      EXPECT_EQ(found->point, expected->point);
      EXPECT_EQ(found->distance, expected->distance);
    }
  }
  EXPECT_GT(found_some, 40);
}

TEST(MovingSurface, WrongInputIsRefused) {
  const Mesh mesh = sphere(1.0, {0, 0, 0}, 6, 8);
  std::vector<std::uint8_t> valid(mesh.faces.rows(), 1);
  valid[5] = 0;
  MovingSurface surface(mesh, valid);
  EXPECT_THROW(MovingSurface(mesh, {1, 0}), std::invalid_argument);
  EXPECT_THROW(MovingSurface(mesh, std::vector<std::uint8_t>(mesh.faces.rows(), 0)), Error);
  EXPECT_THROW(surface.move_to(mesh.vertices.topRows(4)), std::invalid_argument);
  EXPECT_THROW(surface.move_to(mesh.vertices * std::nan("")), std::invalid_argument);
  EXPECT_THROW(surface.closest({std::nan(""), 0, 0}, 1), std::invalid_argument);
  EXPECT_THROW(surface.closest({0, 0, 0}, 0), std::invalid_argument);
  EXPECT_THROW(surface.closest({0, 0, 0}, 1, 5), std::invalid_argument);
  EXPECT_THROW(surface.closest({0, 0, 0}, 1, static_cast<int>(mesh.faces.rows())), std::invalid_argument);
}

} // namespace
} // namespace doublet::testing
