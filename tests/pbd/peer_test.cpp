// Our projections beside those of another engine, PositionBasedDynamics: peer_projections.csv is what
// benchmarks/peers/projections.py had pyPBD 2.2.2 do.

#include "../../libpbd/src/kernels.h"

#include <array>
#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <sstream>
#include <string>
#include <vector>

namespace doublet::pbd {
namespace peer_test {

using V = Vec3<double>;
struct Case {
  std::string kind;
  double stiffness;
  std::vector<double> w;              ///< inverse masses
  std::vector<V> rest, before, after; ///< 2 or 4 points, m
};

std::vector<Case> read_cases() {
  std::ifstream file(DOUBLET_SOURCE_DIR "/tests/pbd/peer_projections.csv");
  std::vector<Case> cases;
  std::string line;
  std::getline(file, line); // the head
  while (std::getline(file, line)) {
    std::istringstream fields(line);
    Case c;
    std::getline(fields, c.kind, ',');
    const auto number = [&] {
      std::string field;
      std::getline(fields, field, ',');
      return std::stod(field);
    };
    const int points = c.kind == "bend" ? 4 : 2;
    c.stiffness = number();
    for (int i = 0; i < points; ++i) {
      const double mass = number();
      c.w.push_back(mass == 0 ? 0 : 1 / mass);
    }
    for (std::vector<V> *list : {&c.rest, &c.before, &c.after})
      for (int i = 0; i < points; ++i) {
        const double x = number(), y = number(), z = number();
        list->push_back({x, y, z});
      }
    cases.push_back(c);
  }
  return cases;
}
double distance(const V &a, const V &b) {
  return std::sqrt(dot(a - b, a - b));
}
/// Largest of the distances, and how far the peer moved anything.
std::array<double, 2> deviation(const Case &c, const std::vector<V> &ours) {
  std::array<double, 2> r{0, 0};
  for (std::size_t i = 0; i < ours.size(); ++i)
    r = {std::max(r[0], distance(ours[i], c.after[i])), std::max(r[1], distance(c.before[i], c.after[i]))};
  return r;
}

TEST(Peer, StretchProjectsAsPositionBasedDynamics) {
  int compared = 0;
  for (const Case &c : read_cases()) {
    if (c.kind != "stretch")
      continue;
    std::vector<V> x = c.before;
    const double sum = c.w[0] + c.w[1];
    project_stretch(x[0], x[1], c.w[0] / sum, c.w[1] / sum, distance(c.rest[0], c.rest[1]), c.stiffness);
    const auto [off, moved] = deviation(c, x);
    EXPECT_LT(off, 1e-6 * moved) << compared; // but for the 10 digits of the file
    EXPECT_GT(moved, 1e-5);
    ++compared;
  }
  EXPECT_EQ(compared, 50);
}

TEST(Peer, BendProjectsAsPositionBasedDynamics) {
  int compared = 0;
  for (const Case &c : read_cases()) {
    if (c.kind != "bend")
      continue;
    BendRest<double> rest{c.w[0], c.w[1], c.w[2], c.w[3], 1, 0, 0, 0};
    const double phi = bend_value(bend_terms(c.rest[0], c.rest[1], c.rest[2], c.rest[3], rest));
    rest.cos = std::cos(phi), rest.sin = std::sin(phi);
    std::vector<V> x = c.before;
    project_bend(x[0], x[1], x[2], x[3], rest, c.stiffness);
    const auto [off, moved] = deviation(c, x);
    EXPECT_LT(off, 1e-5 * moved + 1e-8) << compared; // our arc tangent is a polynomial, good to 1e-7 rad
    EXPECT_GT(moved, 1e-6);
    ++compared;
  }
  EXPECT_EQ(compared, 50);
}

} // namespace peer_test
} // namespace doublet::pbd
