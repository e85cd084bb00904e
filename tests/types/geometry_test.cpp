#include "doublet/types/geometry.h"

#include "doublet/version.h"

#include <gtest/gtest.h>

#include <string>
#include <type_traits>

namespace doublet {

TEST(VerticesView, LooksAtPositionsWhereTheyAre) {
  Vertices positions(2, 3);
  positions << 1, 2, 3, 4, 5, 6;
  const VerticesView view = positions;
  EXPECT_EQ(view.rows(), 2);
  positions(1, 2) = 7;
  EXPECT_EQ(view.map()(1, 2), 7);
  const double packed[] = {0, 1, 2, 3, 4, 5, 6, 7, 8};
  EXPECT_EQ(VerticesView(packed, 3).map().row(2), Eigen::RowVector3d(6, 7, 8));
}

TEST(VerticesView, IsEmptyUnlessTold) {
  EXPECT_TRUE(VerticesView().empty());
  EXPECT_EQ(VerticesView().map().rows(), 0);
}

TEST(VerticesView, DoesNotLookAtTemporaries) {
  static_assert(std::is_constructible_v<VerticesView, const Vertices &>);
  static_assert(!std::is_constructible_v<VerticesView, Vertices>);
  static_assert(!std::is_constructible_v<VerticesView, const Vertices>);
}

TEST(Version, IsANumberThatCanBeCompared) {
  EXPECT_EQ(DOUBLET_VERSION, std::to_string(DOUBLET_VERSION_NUMBER / 10000) + "." +
                                 std::to_string(DOUBLET_VERSION_NUMBER / 100 % 100) + "." +
                                 std::to_string(DOUBLET_VERSION_NUMBER % 100));
  static_assert(DOUBLET_VERSION_AT_LEAST(DOUBLET_VERSION_MAJOR, DOUBLET_VERSION_MINOR, DOUBLET_VERSION_PATCH));
  static_assert(DOUBLET_VERSION_AT_LEAST(0, 0, 99));
  static_assert(!DOUBLET_VERSION_AT_LEAST(DOUBLET_VERSION_MAJOR, DOUBLET_VERSION_MINOR, DOUBLET_VERSION_PATCH + 1));
  static_assert(!DOUBLET_VERSION_AT_LEAST(DOUBLET_VERSION_MAJOR + 1, 0, 0));
}

} // namespace doublet
