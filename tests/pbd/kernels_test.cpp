// Every constraint's gradient against central differences, and every projection against what it must achieve. Kernels in double.

#include "../../libpbd/src/capsule_motion.h"
#include "../../libpbd/src/constraint_order.h"
#include "../../libpbd/src/kernels.h"
#include "../../libpbd/src/pack.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <gtest/gtest.h>
#include <random>

namespace doublet::pbd {
namespace kernels_test {

using V = Vec3<double>;
double &component(V &v, int k) {
  return k == 0 ? v.x : k == 1 ? v.y : v.z;
}

/// d value / d x by central differences.
V differences(const std::function<double()> &value, V &x) {
  V g{};
  for (int k = 0; k < 3; ++k) {
    const double keep = component(x, k), h = 1e-6;
    component(x, k) = keep + h;
    const double up = value();
    component(x, k) = keep - h;
    const double down = value();
    component(x, k) = keep;
    component(g, k) = (up - down) / (2 * h);
  }
  return g;
}
void expect_near(V a, V b, double tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

struct Random {
  std::mt19937 engine{7};
  double operator()(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(engine); }
  V point(double size) { return {(*this)(-size, size), (*this)(-size, size), (*this)(-size, size)}; }
};

TEST(Kernels, Atan2MatchesTheStandardOne) {
  Random random;
  for (int i = 0; i < 100000; ++i) {
    const double y = random(-2, 2), x = random(-2, 2);
    ASSERT_NEAR(lane_atan2(y, x), std::atan2(y, x), 1.5e-7);
    ASSERT_NEAR(lane_atan2(static_cast<float>(y), static_cast<float>(x)),
                std::atan2(static_cast<float>(y), static_cast<float>(x)), 4e-7);
  }
  EXPECT_EQ(lane_atan2(0.0f, 0.0f), 0.0f);
  EXPECT_FLOAT_EQ(lane_atan2(0.0f, -1.0f), 3.14159265f);
  EXPECT_FLOAT_EQ(lane_atan2(-1.0f, 0.0f), -1.57079633f);
}

TEST(Kernels, StretchProjectionFollowsTheGradientAndReachesTheLength) {
  Random random;
  for (int i = 0; i < 200; ++i) {
    V a = random.point(0.1), b = random.point(0.1);
    const double wa = random(0, 3), wb = random(0.1, 3), rest = random(0.01, 0.2);
    const auto value = [&] { return std::sqrt(dot(a - b, a - b)) - rest; };
    const double c = value();
    const V ga = differences(value, a), gb = differences(value, b);
    const double lambda = -0.3 * c / (wa * dot(ga, ga) + wb * dot(gb, gb)); // Mueller et al. 2007, eq. (8)
    V pa = a, pb = b;
    project_stretch(pa, pb, wa / (wa + wb), wb / (wa + wb), rest, 0.3);
    expect_near(pa - a, (wa * lambda) * ga, 1e-8);
    expect_near(pb - b, (wb * lambda) * gb, 1e-8);
    project_stretch(a, b, wa / (wa + wb), wb / (wa + wb), rest, 1.0);
    EXPECT_NEAR(value(), 0, 1e-12);
  }
}

struct Bend {
  double value;
  V g0{0, 0, 0}, g1{0, 0, 0}, g2{0, 0, 0}, g3{0, 0, 0};
};
/// C and its gradients: what a unit multiplier takes from the origin.
Bend bend_constraint(V x0, V x1, V x2, V x3, double rest_cos, double rest_sin) {
  const BendRest<double> unit{1, 1, 1, 1, rest_cos, rest_sin, 0, 0};
  const BendTerms<double> c = bend_terms(x0, x1, x2, x3, unit);
  Bend b{bend_value(c)};
  move_bend(c, unit, -c.length / c.scale, b.g0, b.g1, b.g2, b.g3);
  return b;
}

TEST(Kernels, StretchesThatAreViolatedAreBroughtBackToTheirSlack) {
  const auto length_after = [](double length, double compliance, double multiplier) {
    V a{0, 0, 0}, b{length, 0, 0};
    project_violated_stretch(a, b, 0.25, 0.75, 0.02, compliance, 0.1, multiplier);
    EXPECT_NEAR(0.75 * a.x + 0.25 * b.x, 0.25 * length, 1e-15); // the momentum
    return b.x - a.x;
  };
  EXPECT_NEAR(length_after(0.05, 0, 0), 0.022, 1e-15);
  EXPECT_EQ(length_after(0.0219, 0, 0), 0.0219);
  EXPECT_EQ(length_after(0.05, 2, -0.02), 0.05); // its force has it at 0.06
  EXPECT_EQ(length_after(0.05, 2, 0.02), 0.05);  // at less than nothing
}

TEST(Kernels, BendGradientsMatchDifferences) {
  Random random;
  for (int i = 0; i < 500; ++i) {
    V x0 = random.point(0.05), x1 = random.point(0.05), x2 = random.point(0.05), x3 = random.point(0.05);
    const double phi = random(-3, 3);
    const auto value = [&] { return bend_constraint(x0, x1, x2, x3, std::cos(phi), std::sin(phi)).value; };
    const Bend b = bend_constraint(x0, x1, x2, x3, std::cos(phi), std::sin(phi));
    const V e = x1 - x0, n1 = cross(e, x2 - x0), n2 = cross(x3 - x0, e);
    if (dot(n1, n1) < 1e-7 || dot(n2, n2) < 1e-7 || std::abs(b.value) > 3.1)
      continue; // slivers and the seam at pi have no useful differences
    const double scale = std::sqrt(std::max({dot(b.g0, b.g0), dot(b.g1, b.g1), dot(b.g2, b.g2), dot(b.g3, b.g3)}));
    // the angle itself is a polynomial, exact to 1e-7: its slope is good to about 1e-5
    const double tolerance = 2e-5 * scale + 1e-3;
    expect_near(b.g0, differences(value, x0), tolerance);
    expect_near(b.g1, differences(value, x1), tolerance);
    expect_near(b.g2, differences(value, x2), tolerance);
    expect_near(b.g3, differences(value, x3), tolerance);
    expect_near(b.g0 + b.g1 + b.g2 + b.g3, V{0, 0, 0}, 1e-9 * scale);

    const BendRest<double> rest{0.2, 1, 0, 0.7, std::cos(phi), std::sin(phi), 0, 0}; // Mueller et al. 2007, eq. (8)-(9)
    const double sum = 0.2 * dot(b.g0, b.g0) + dot(b.g1, b.g1) + 0.7 * dot(b.g3, b.g3),
                 floor = 0.25 * (dot(b.g2, b.g2) + dot(b.g3, b.g3)), lambda = -0.3 * b.value / std::max(sum, floor);
    V y0 = x0, y1 = x1, y2 = x2, y3 = x3;
    project_bend(y0, y1, y2, y3, rest, 0.3);
    expect_near(y0 - x0, (0.2 * lambda) * b.g0, 1e-10);
    expect_near(y1 - x1, lambda * b.g1, 1e-10);
    expect_near(y2 - x2, V{0, 0, 0}, 0);
    expect_near(y3 - x3, (0.7 * lambda) * b.g3, 1e-10);
  }
}

/// Eq. (3) as printed: acos(n_l . n_r) - phi, unsigned.
double paper_bend_angle(V x0, V x1, V x2, V x3) {
  const V n1 = cross(x1 - x0, x2 - x0), n2 = cross(x3 - x0, x1 - x0);
  return std::acos(std::clamp(dot(n1, n2) / std::sqrt(dot(n1, n1) * dot(n2, n2)), -1.0, 1.0));
}

TEST(Kernels, BendIsThePapersAngleUpToSign) {
  Random random;
  for (int i = 0; i < 1000; ++i) {
    const V x0 = random.point(1), x1 = random.point(1), x2 = random.point(1), x3 = random.point(1);
    const double angle = bend_constraint(x0, x1, x2, x3, 1.0, 0.0).value;
    EXPECT_NEAR(std::abs(angle), paper_bend_angle(x0, x1, x2, x3), 1e-6);
    EXPECT_NEAR(bend_constraint(x0, x1, x2, x3, std::cos(angle), std::sin(angle)).value, 0, 1e-6);
  }
}

TEST(Kernels, BendProjectionReachesTheRestAngle) {
  for (double phi : {-2.0, -0.5, 0.0, 0.3, 1.5}) {
    V x0{0, 0, 0}, x1{0.03, 0, 0}, x2{0.01, 0.03, 0.004}, x3{0.02, -0.03, 0.006};
    const V before = x0 + x1 + x2 + x3;
    for (int i = 0; i < 50; ++i)
      project_bend(x0, x1, x2, x3, BendRest<double>{1, 1, 1, 1, std::cos(phi), std::sin(phi), 0, 0}, 1.0);
    EXPECT_NEAR(bend_constraint(x0, x1, x2, x3, std::cos(phi), std::sin(phi)).value, 0, 1e-6) << phi;
    expect_near(x0 + x1 + x2 + x3, before, 1e-12); // equal masses: the centre stays
  }
}

TEST(Kernels, BendWithoutALeverThrowsNothing) {
  // Folded flat on itself, all pinned but one end of the edge: that end has no lever on the angle.
  for (float gap : {1e-2f, 1e-4f, 1e-6f, 0.0f}) {
    Vec3f x0{0, 0, 0}, x1{0.03f, 0, 0}, x2{0.015f, 0.03f, gap}, x3{0.015f, 0.03f, -gap};
    project_bend(x0, x1, x2, x3, BendRest<float>{1, 0, 0, 0, 1, 0, 500, 0}, 1.0f);
    EXPECT_LT(lane_sqrt(dot(x0, x0)), 0.2f) << gap;
  }
}

TEST(Kernels, FoldedUpFacesStayFinite) {
  Vec3f x0{0, 0, 0}, x1{0.03f, 0, 0}, x2{0.01f, 0, 0}, x3{0.02f, 0, 0}; // both faces are lines
  project_bend(x0, x1, x2, x3, BendRest<float>{1, 1, 1, 1, 1, 0, 500, 0}, 1.0f);
  for (const Vec3f &x : {x0, x1, x2, x3})
    EXPECT_TRUE(std::isfinite(x.x) && std::isfinite(x.y) && std::isfinite(x.z));
  Vec3f a{0, 0, 0}, b{0, 0, 0};
  project_stretch(a, b, 0.5f, 0.5f, 0.1f, 1.0f);
  EXPECT_TRUE(std::isfinite(a.x) && std::isfinite(b.x));
}

/// Without the instruction a fused multiply-add goes through double, and must round as the instruction does: once.
TEST(Kernels, FusedMultiplyAddRoundsOnce) {
  std::mt19937 random(3);
  const auto any_float = [&] {
    const std::uint32_t bits = random();
    float f;
    std::memcpy(&f, &bits, sizeof f);
    return f;
  };
  int rounded_twice = 0;
  for (int i = 0; i < 1000000; ++i) {
    // Anything at all; what cancels all but the rounding of the product; just below the middle between two floats.
    const float tiny = static_cast<float>(random() % 8 + 1) * 1.1920929e-7f, sign = random() % 2 ? 1.0f : -1.0f;
    const float a = i % 3 == 0 ? any_float() : 1 + tiny;
    const float b = i % 3 == 0 ? any_float() : sign * (1 - tiny);
    const float c = i % 3 == 0 ? any_float() : i % 3 == 1 ? -sign : static_cast<float>(16777216 + 2 * (random() % 4)) * sign;
    const float expected = std::fma(a, b, c), found = mul_add(a, b, c);
    if (std::isnan(expected)) {
      ASSERT_TRUE(std::isnan(found)) << a << " " << b << " " << c;
      continue;
    }
    ASSERT_EQ(std::memcmp(&found, &expected, sizeof found), 0) << a << " " << b << " " << c;
    rounded_twice += expected != static_cast<float>(static_cast<double>(a) * b + c);
  }
  EXPECT_GT(rounded_twice, 10); // the naive way is seen to differ
}

/// Four constraints side by side come out as one by one, to the bit.
TEST(Kernels, PacksGiveTheBitsOfFloats) {
  Random random;
  const auto f = [&](double lo, double hi) { return static_cast<float>(random(lo, hi)); };
  for (int i = 0; i < 2000; ++i) {
    Point p[16], q[16];
    int v[4][4];
    float w[4][4], angle[4], c[4], s[4];
    for (int k = 0; k < 16; ++k) {
      p[k] = q[k] = Vec3f{f(-0.05, 0.05), f(-0.05, 0.05), i % 3 ? f(-0.05, 0.05) : 0.0f};
      v[k / 4][k % 4] = (k * 7) % 16;
      w[k / 4][k % 4] = f(0, 1);
      angle[k % 4] = f(-3, 3);
      c[k % 4] = std::cos(angle[k % 4]);
      s[k % 4] = std::sin(angle[k % 4]);
    }
    using Four = Pack<4>;
    Vec3<Four> x[4];
    for (int k = 0; k < 4; ++k)
      x[k] = gather<4>(p, v[k]);
    const BendRest<Four> rest{Four::load(w[0]), Four::load(w[1]), Four::load(w[2]), Four::load(w[3]),
                              Four::load(c),    Four::load(s),    Four(100.0f),     Four(0.0f)};
    project_bend(x[0], x[1], x[2], x[3], rest, Four(0.3f));
    for (int k = 0; k < 4; ++k)
      scatter<4>(p, v[k], x[k]);
    for (int l = 0; l < 4; ++l)
      project_bend<float>(q[v[0][l]], q[v[1][l]], q[v[2][l]], q[v[3][l]],
                          BendRest<float>{w[0][l], w[1][l], w[2][l], w[3][l], c[l], s[l], 100, 0}, 0.3f);
    for (int k = 0; k < 16; ++k) {
      ASSERT_EQ(p[k].x, q[k].x) << i;
      ASSERT_EQ(p[k].y, q[k].y) << i;
      ASSERT_EQ(p[k].z, q[k].z) << i;
    }
  }
}

TEST(Kernels, BlendMovesTheStatedShare) {
  V p{1, 2, 3};
  project_blend(p, V{2, 2, 2}, 0.25);
  expect_near(p, V{1.25, 2, 2.75}, 1e-12);
}

TEST(Kernels, CapsuleDistanceIsExactAndItsGradientTheNormal) {
  Random random;
  for (int i = 0; i < 100; ++i) {
    Capsule c;
    c.p0 = Eigen::Vector3d(random(-0.3, 0.3), random(-0.3, 0.3), random(-0.3, 0.3));
    c.p1 = Eigen::Vector3d(random(-0.3, 0.3), random(-0.3, 0.3), random(-0.3, 0.3));
    c.r0 = random(0.01, 0.4); // now and then one sphere holds the other
    c.r1 = random(0.01, 0.2);
    const CapsuleShape<float> shape = capsule_shape(c, Eigen::Vector3d::Zero());
    for (int k = 0; k < 20; ++k) {
      V p = random.point(0.8);
      // The hull is the union of all spheres in between, and outside it the distance is the least of theirs.
      double reference = 1e9;
      for (int s = 0; s <= 4000; ++s) {
        const double t = s / 4000.0;
        const Eigen::Vector3d centre = c.p0 + t * (c.p1 - c.p0);
        reference = std::min(reference, (Eigen::Vector3d(p.x, p.y, p.z) - centre).norm() - (c.r0 + t * (c.r1 - c.r0)));
      }
      const Distance<double> d = capsule_distance(shape, p);
      EXPECT_NEAR(d.value, reference, 2e-6);
      EXPECT_NEAR(dot(d.normal, d.normal), 1, 1e-6);
      const V g = differences([&] { return capsule_distance(shape, p).value; }, p);
      expect_near(d.normal, g, 1e-3); // kinks where the foot passes an end are C1, not C2
    }
  }
}

TEST(Kernels, CapsuleDistanceOnTheAxisHasANormal) {
  const CapsuleShape<float> rod = capsule_shape({{0, 0, 0}, {0, 1, 0}, 0.1, 0.1}, Eigen::Vector3d::Zero());
  const Distance<float> d = capsule_distance(rod, Vec3f{0, 0.5f, 0});
  EXPECT_NEAR(d.value, -0.1, 1e-6);
  EXPECT_NEAR(dot(d.normal, d.normal), 1, 1e-6);
  EXPECT_NEAR(d.normal.y, 0, 1e-6);
  const CapsuleShape<float> point = capsule_shape({{0, 0, 0}, {0, 0, 0}, 0, 0}, Eigen::Vector3d::Zero());
  EXPECT_NEAR(capsule_distance(point, Vec3f{0, 0, 2}).value, 2, 1e-6);
}

TEST(Kernels, EntryTimeIsWhereTheSegmentMeetsTheProxy) {
  Random random;
  int hits = 0;
  for (int i = 0; i < 2000; ++i) {
    Capsule c{{random(-0.1, 0.1), random(-0.1, 0.1), 0}, {random(-0.1, 0.1), 0.4, 0}, random(0.02, 0.1), random(0.02, 0.1)};
    const CapsuleShape<float> shape = capsule_shape(c, Eigen::Vector3d::Zero());
    const auto f = [](V v) { return Vec3f{static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)}; };
    const Vec3f q0 = f(random.point(0.5)), q1 = f(random.point(0.5));
    if (capsule_distance(shape, q0).value < 0.005)
      continue;
    double first = 2, least = 1;
    for (int s = 0; s <= 2000; ++s) {
      const float t = static_cast<float>(s) / 2000;
      const double gap = capsule_distance(shape, q0 + t * (q1 - q0)).value - 0.004;
      least = std::min(least, gap);
      if (gap <= 0 && first == 2)
        first = t;
    }
    if (std::abs(least) < 1e-4)
      continue; // grazing: the samples cannot tell
    const double t = entry_time(shape, q0, q1, 0.004f, true);
    EXPECT_NEAR(t, first, first == 2 ? 0 : 1e-3);
    hits += first < 2;
  }
  EXPECT_GT(hits, 100);
}

TEST(Kernels, SelfContactFollowsTheGradientAndReachesTheThickness) {
  Random random;
  for (int i = 0; i < 200; ++i) {
    V a{0, 0, 0}, b{0.03, 0.001, 0}, c{0.002, 0, 0.03};
    double b1 = random(0.05, 0.45), b2 = random(0.05, 0.45), b0 = 1 - b1 - b2;
    const V n = cross(b - a, c - a);
    const double side = i % 2 ? 1 : -1, depth = random(0, 0.003);
    V q = b0 * a + b1 * b + b2 * c + (side * depth / std::sqrt(dot(n, n))) * n;
    // C = side (q - a) . n / |n|, Mueller et al. 2007, Sect. 4.4; over the foot its gradients are n and -b_i n.
    const auto value = [&] {
      const V m = cross(b - a, c - a);
      return side * dot(q - a, m) / std::sqrt(dot(m, m));
    };
    const Distance<double> d = self_distance(q, a, b, c, b0, b1, b2, side);
    EXPECT_NEAR(d.value, value(), 1e-12);
    expect_near(differences(value, q), d.normal, 1e-6);
    expect_near(differences(value, a), (-b0) * d.normal, 1e-6);
    expect_near(differences(value, b), (-b1) * d.normal, 1e-6);
    expect_near(differences(value, c), (-b2) * d.normal, 1e-6);
    SelfContact<double> s{0, 1, 2, 3, 2, 1, 0.5f, 0, 1, b0, b1, b2, side, 0.004, 0, 0};
    s.wc = i % 3 ? 4 : 0; // free, and now and then pinned
    s.inverse_sum = contact_response(s);
    const double lambda = (0.004 - d.value) / (2 + b0 * b0 + 0.5 * b1 * b1 + s.wc * b2 * b2);
    const V q0 = q, a0 = a, b_0 = b, c0 = c;
    project_self(q, a, b, c, s);
    EXPECT_EQ(s.touched, 1);
    expect_near(q - q0, (2 * lambda) * d.normal, 1e-12); // Mueller et al. 2007, eq. (8), with the gradients above
    expect_near(a - a0, (-b0 * lambda) * d.normal, 1e-12);
    expect_near(b - b_0, (-0.5 * b1 * lambda) * d.normal, 1e-12);
    expect_near(c - c0, (-s.wc * b2 * lambda) * d.normal, 1e-12);
    EXPECT_NEAR(self_distance(q, a, b, c, b0, b1, b2, side).value, 0.004, 3e-4); // the normal turns a little
  }
}

TEST(Kernels, EdgeContactFollowsTheGradientAndReachesTheThickness) {
  Random random;
  for (int i = 0; i < 200; ++i) {
    V a{-0.02, 0, 0.001}, b{0.03, 0.001, 0}, c{0.003, 0.004, -0.03}, d{0.002, 0.004, 0.02};
    const double s = random(0.1, 0.9), t = random(0.1, 0.9), side = i % 2 ? 1 : -1, depth = random(0, 0.003);
    V n = cross(b - a, d - c);
    n = (side / std::sqrt(dot(n, n))) * n;
    const V apart = mul_add(t, d - c, c) - mul_add(s, b - a, a), moved = depth * n - apart; // the two points meet, then `depth`
    c += moved;
    d += moved;
    const auto value = [&] {
      const V m = cross(b - a, d - c);
      return side * dot(c - a, m) / std::sqrt(dot(m, m));
    };
    const Distance<double> now = edge_distance(a, b, c, d, s, t, side);
    EXPECT_NEAR(now.value, value(), 1e-12);
    expect_near(differences(value, a), (s - 1) * now.normal, 1e-6);
    expect_near(differences(value, b), -s * now.normal, 1e-6);
    expect_near(differences(value, c), (1 - t) * now.normal, 1e-6);
    expect_near(differences(value, d), t * now.normal, 1e-6);
    EdgeContact<double> e{0, 1, 2, 3, 2, 1, 0.5f, 0, 1, s, t, side, 0.004, 0, 0};
    e.wd = i % 3 ? 4 : 0;
    e.inverse_sum = contact_response(e);
    const V sum = 0.5 * a + b + (e.wc > 0 ? 2.0 : 0.0) * c + (e.wd > 0 ? 0.25 : 0.0) * d;
    project_edges(a, b, c, d, e);
    EXPECT_EQ(e.touched, 1);
    EXPECT_NEAR(edge_distance(a, b, c, d, s, t, side).value, 0.004, 4e-4); // the normal turns a little
    if (e.wd > 0)
      expect_near(0.5 * a + b + 2.0 * c + 0.25 * d, sum, 1e-12); // the centre of mass stays
  }
}

TEST(Kernels, DragNeverReversesAndKeepsItsClosedForm) {
  Random random;
  for (int i = 0; i < 1000; ++i) {
    const V u = random.point(50), n{0, 1, 0};
    const double dn = random(0, 32), dt = random(0, 32), h = random(0.001, 0.1);
    const V r = apply_drag(u, n, 0.5 * dn * h, std::exp(-0.5 * dt * h));
    EXPECT_NEAR(r.x, u.x * std::exp(-0.5 * dt * h), 1e-12);
    EXPECT_NEAR(r.y, u.y / (1 + 0.5 * dn * h * std::abs(u.y)), 1e-12);
    EXPECT_GE(r.x * u.x, 0);
    EXPECT_GE(r.y * u.y, 0);
    EXPECT_LE(std::abs(r.y), std::abs(u.y));
  }
}

TEST(Order, LeavesVerticesAloneAndKeepsLevels) {
  // Edges of a 30 x 30 grid of vertices, level = row.
  std::vector<int> vertices, levels;
  for (int r = 0; r < 30; ++r)
    for (int c = 0; c < 30; ++c) {
      if (c < 29)
        vertices.insert(vertices.end(), {r * 30 + c, r * 30 + c + 1}), levels.push_back(r);
      if (r < 29)
        vertices.insert(vertices.end(), {r * 30 + c, r * 30 + c + 30}), levels.push_back(r);
    }
  const std::vector<int> order = spread_order(vertices, 2, levels, 900, kStretchGap);
  std::vector<int> sorted = order;
  std::sort(sorted.begin(), sorted.end());
  for (int i = 0; i < static_cast<int>(sorted.size()); ++i)
    ASSERT_EQ(sorted[i], i);
  std::vector<int> last(900, -100);
  int crowded = 0;
  for (int i = 0; i < static_cast<int>(order.size()); ++i)
    for (int k = 0; k < 2; ++k) {
      int &l = last[vertices[order[i] * 2 + k]];
      crowded += i - l - 1 < kStretchGap;
      l = i;
    }
  EXPECT_LT(crowded, 40); // the last few find no company
  double inversions = 0;
  for (int i = 1; i < static_cast<int>(order.size()); ++i)
    inversions = std::max(inversions, static_cast<double>(levels[order[i - 1]] - levels[order[i]]));
  EXPECT_LE(inversions, 8); // nearly sorted by level
}

} // namespace kernels_test
} // namespace doublet::pbd
