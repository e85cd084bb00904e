#include "../../libanimate/src/display/body_weld.h"

#include "support/meshes.h"

#include <gtest/gtest.h>

#include <cmath>

using namespace doublet;
using namespace doublet::testing;

namespace {

Mesh trunk(int rings, int segments) {
  return tube(
      {0, 0, 0}, {0, 1, 0}, [](double) { return 0.2; }, rings, segments);
}

/// A coat with open fronts: all around but for a strip of such a width, m.
bool covered(const Eigen::RowVector3d &p, double strip) {
  return p.y() > 0.3 && p.y() < 0.7 && 0.2 * std::abs(std::atan2(p.z(), p.x())) > strip / 2;
}

std::optional<detail::WeldedSkin> welded_beside_fronts(double strip) {
  Mesh skin = trunk(120, 160);
  const Mesh body = trunk(40, 40);
  std::vector<int> bare;
  for (int f = 0; f < skin.faces.rows(); ++f)
    if (!covered(skin.vertices(skin.faces.row(f).transpose(), Eigen::all).colwise().mean(), strip))
      bare.push_back(f);
  std::vector<std::uint8_t> hidden;
  for (const auto &p : body.vertices.rowwise())
    hidden.push_back(covered(p, strip));
  return detail::weld_body(submesh(skin, bare), body, hidden);
}

} // namespace

TEST(BodyWeld, SkinBetweenTheFrontsOfACoatMayHaveAnyWidth) {
  for (double strip = 0.03; strip < 0.08; strip += 0.004)
    EXPECT_TRUE(welded_beside_fronts(strip)) << strip;
}
