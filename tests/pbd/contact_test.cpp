// Cloth against proxies and against itself.

#include "../../libpbd/src/capsule_contacts.h"
#include "../../libpbd/src/capsule_motion.h"
#include "doublet/pbd/detail/lanes.h"
#include "scenes.h"

#include <gtest/gtest.h>

namespace doublet::pbd {
namespace contact_test {

using scenes::Sheet;
constexpr double kG = 9.81, kH = 1.0 / 40;

Material slick(double friction = 0) {
  Material m;
  m.d_n = m.d_t = 0;
  m.k_stretch = 1;
  m.k_bend = 0;
  m.k_friction = friction;
  return m;
}
std::unique_ptr<ClothSolver> make(const Sheet &s, const ClothOptions &options = ClothOptions::paper()) {
  return ClothSolver::create(ClothModel::create(s.rest, s.faces, s.clothness, options));
}
/// Least signed distance of all vertices to all capsules, m.
double clearance(const Vertices &x, const std::vector<Capsule> &capsules) {
  double least = 1e9;
  for (const Capsule &c : capsules) {
    const CapsuleShape shape = capsule_shape(c, Eigen::Vector3d::Zero());
    for (int i = 0; i < x.rows(); ++i)
      least = std::min(least, capsule_distance(shape, Vec3<double>{x(i, 0), x(i, 1), x(i, 2)}).value);
  }
  return least;
}
/// A log so thick that its ridge is a plane, along x, tilted by `angle`; its surface passes through the origin.
Capsule log_along_x(double angle) {
  const Eigen::Vector3d along(std::cos(angle), -std::sin(angle), 0), up(std::sin(angle), std::cos(angle), 0);
  return {-20 * along - 20 * up, 20 * along - 20 * up, 20, 20};
}
ClothState resting_on(const Sheet &s, double angle, double thickness) {
  ClothState state = initial_state(s.rest);
  const Eigen::RowVector3d along(std::cos(angle), -std::sin(angle), 0), up(std::sin(angle), std::cos(angle), 0);
  for (int i = 0; i < s.rest.rows(); ++i) {
    const double across = s.rest(i, 2),
                 sink = (20 + thickness) - std::sqrt((20 + thickness) * (20 + thickness) - across * across);
    state.positions.row(i) = s.rest(i, 0) * along + Eigen::RowVector3d(0, 0, across) + (thickness - sink) * up;
  }
  return state;
}

TEST(Contact, FrictionDampsTheSlideByOneMinusKEachStep) {
  const Sheet s = scenes::grid(6, 2, 0.03);
  const std::vector<Capsule> logs{log_along_x(0)};
  StepInputs in;
  in.capsules = logs;
  for (double k : {0.0, 0.1, 0.5, 1.0})
    for (int substeps : {1, 3}) {
      ClothOptions options = ClothOptions::paper();
      options.substeps = substeps;
      const auto solver = make(s, options);
      ClothState state = resting_on(s, 0, options.thickness);
      state.velocities.col(0).setConstant(1);
      double expected = 1;
      for (int f = 0; f < 8; ++f) {
        solver->step(state, in, slick(k));
        expected *= 1 - k;
        EXPECT_NEAR(state.velocities.col(0).mean(), expected, 2e-3) << "k " << k << " frame " << f;
      }
      EXPECT_LT(state.velocities.col(1).cwiseAbs().maxCoeff(), 2e-3);
    }
}

TEST(Contact, SlidesDownAnInclineAsTheModelSays) {
  const double angle = 0.4;
  const Sheet s = scenes::grid(6, 2, 0.03);
  const std::vector<Capsule> logs{log_along_x(angle)};
  StepInputs in;
  in.capsules = logs;
  for (double k : {0.0, 0.2, 0.7}) {
    const auto solver = make(s);
    ClothState state = resting_on(s, angle, 0.004);
    double expected = 0; // v <- (1 - k) (v + g sin(angle) h)
    for (int f = 0; f < 12; ++f) {
      solver->step(state, in, slick(k));
      expected = (1 - k) * (expected + kG * std::sin(angle) * kH);
    }
    const Eigen::Vector3d along(std::cos(angle), -std::sin(angle), 0);
    EXPECT_NEAR((state.velocities * along).mean(), expected, 0.01 * expected + 2e-3) << k;
  }
}

TEST(Contact, FrictionCarriesClothWithTheMovingSurface) {
  const Sheet s = scenes::grid(6, 2, 0.03);
  const auto solver = make(s);
  ClothState state = resting_on(s, 0, 0.004);
  for (int f = 0; f < 10; ++f) {
    std::vector<Capsule> before{log_along_x(0)}, after{log_along_x(0)};
    before[0].p0[0] += f * 0.025, before[0].p1[0] += f * 0.025; // 1 m/s along x
    after[0].p0[0] += (f + 1) * 0.025, after[0].p1[0] += (f + 1) * 0.025;
    StepInputs in;
    in.previous_capsules = before;
    in.capsules = after;
    solver->step(state, in, slick(1));
  }
  EXPECT_NEAR(state.velocities.col(0).mean(), 1, 1e-3);
}

TEST(Contact, RestitutionReflectsTheStatedShare) {
  const Sheet s = scenes::grid(4, 2, 0.02);
  const std::vector<Capsule> logs{log_along_x(0)};
  StepInputs in;
  in.capsules = logs;
  for (double e : {0.0, 0.5, 1.0}) {
    ClothOptions options = ClothOptions::paper();
    options.restitution = e;
    const auto solver = make(s, options);
    ClothState state = resting_on(s, 0, options.thickness);
    state.positions.col(1).array() += 0.01;
    state.velocities.col(1).setConstant(-3); // meets the log within the step
    solver->step(state, in, slick());
    EXPECT_NEAR(state.velocities.col(1).mean(), e * (3 + kG * kH), 0.02) << e;
  }
}

/// 10 m/s at 40 fps: the leg jumps 25 cm a frame, twice its thickness, and takes the cloth along.
TEST(Contact, FastLegCarriesTheClothAndNeverTunnels) {
  for (double friction : {0.0, 0.5})
    for (double speed : {2.0, 10.0, 20.0}) {
      Sheet s = scenes::grid(16, 16, 0.03);
      s.rest.col(1) = s.rest.col(2).eval();
      s.rest.col(2).setZero(); // upright in the plane z = 0
      ClothOptions options = ClothOptions::paper();
      options.gravity.setZero();
      const auto solver = make(s, options);
      ClothState state = initial_state(s.rest);
      double z = -0.2;
      for (int f = 0; f < 8; ++f) {
        const auto leg = [](double at) { return std::vector<Capsule>{{{0, 0.4, at}, {0, -0.4, at}, 0.075, 0.05}}; };
        const std::vector<Capsule> before = leg(z), after = leg(z + speed * kH);
        z += speed * kH;
        StepInputs in;
        in.previous_capsules = before;
        in.capsules = after;
        const Vertices start = state.positions;
        solver->step(state, in, slick(friction));
        EXPECT_GT(clearance(state.positions, after), options.thickness - 2e-4) << speed << " frame " << f;
        // Seen from the leg nothing passes through: a quarter turn round it cuts 0.3 radii deep, a passage one.
        const CapsuleShape shape = capsule_shape(before[0], Eigen::Vector3d::Zero());
        for (int i = 0; i < s.rest.rows(); ++i)
          for (double t = 0; t <= 1; t += 0.05) {
            const Eigen::RowVector3d q =
                (1 - t) * start.row(i) + t * (state.positions.row(i) - Eigen::RowVector3d(0, 0, speed * kH));
            ASSERT_GT(capsule_distance(shape, Vec3<double>{q[0], q[1], q[2]}).value, -0.04)
                << speed << " frame " << f << " vertex " << i;
          }
        if (z < 0.1 || z > 0.6) // later the free sheet may slip off sideways
          continue;
        for (int i = 0; i < s.rest.rows(); ++i)
          if (std::abs(s.rest(i, 0)) < 0.02 && std::abs(s.rest(i, 1)) < 0.15) {
            EXPECT_GT(state.positions(i, 2), z + 0.02) << speed << " frame " << f << " vertex " << i;
          }
      }
    }
}

/// Swings about one end: the tip moves at 10 m/s, and the swept volume is a fan.
TEST(Contact, KickingLegNeverTunnels) {
  Sheet s = scenes::grid(16, 16, 0.03);
  s.rest.col(1) = s.rest.col(2).eval();
  s.rest.col(2).setConstant(0.12);
  s.clothness.head(17).setZero(); // hangs from its lowest row index: put it on top
  s.rest.col(1) *= -1;
  const auto solver = make(s);
  ClothState state = initial_state(s.rest);
  const auto leg = [](double angle) {
    return std::vector<Capsule>{{{0, 0.35, 0}, {0, 0.35 - 0.8 * std::cos(angle), 0.8 * std::sin(angle)}, 0.07, 0.05}};
  };
  for (int f = 0; f < 6; ++f) {
    const std::vector<Capsule> before = leg(-0.3 + 0.3 * f), after = leg(-0.3 + 0.3 * (f + 1)); // 12 rad/s
    StepInputs in;
    in.targets = s.rest;
    in.previous_capsules = before;
    in.capsules = after;
    solver->step(state, in, slick(0.3));
    const CapsuleShape shape = capsule_shape(after[0], Eigen::Vector3d::Zero());
    for (int i = 17; i < s.rest.rows(); ++i) {
      EXPECT_GT(capsule_distance(shape, Vec3<double>{state.positions(i, 0), state.positions(i, 1), state.positions(i, 2)}).value,
                0.0035);
      if (std::abs(s.rest(i, 0)) < 0.02 && s.rest(i, 1) < 0.1) { // before the leg it stays
        const Eigen::Vector3d side(0, std::sin(-0.3 + 0.3 * (f + 1)), std::cos(-0.3 + 0.3 * (f + 1)));
        EXPECT_GT(side.dot(Eigen::Vector3d(state.positions.row(i)) - after[0].p0), 0.0) << f << " " << i;
      }
    }
  }
}

TEST(Contact, PenetrationAtTheStartOpensWithoutEnergy) {
  const Sheet s = scenes::grid(10, 10, 0.02);
  ClothOptions options = ClothOptions::paper();
  options.gravity.setZero();
  const auto solver = make(s, options);
  const std::vector<Capsule> capsules{{{-0.3, -0.03, 0}, {0.3, -0.03, 0}, 0.08, 0.08}}; // the sheet lies 5 cm inside
  StepInputs in;
  in.capsules = capsules;
  ClothState state = initial_state(s.rest);
  double fastest = 0;
  for (int f = 0; f < 20; ++f) {
    solver->step(state, in, slick());
    fastest = std::max(fastest, state.velocities.rowwise().norm().maxCoeff());
  }
  EXPECT_GT(clearance(state.positions, capsules), options.thickness - 1e-3);
  EXPECT_LT(fastest, 1.2); // thrown out in one step it would be 2 m/s and more
}

TEST(Contact, DegenerateCapsulesAreSpheres) {
  const Sheet s = scenes::grid(10, 10, 0.02, 0.2);
  for (const Capsule &c : {Capsule{{0, 0, 0}, {0, 0, 0}, 0.1, 0.1}, Capsule{{0, 0, 0}, {0, 0.02, 0}, 0.1, 0.03},
                           Capsule{{0, -0.05, 0}, {0, 0, 0}, 0.01, 0.1}, Capsule{{0, 0, 0}, {0, 0, 0}, 0, 0}}) {
    const auto solver = make(s);
    ClothState state = initial_state(s.rest);
    const std::vector<Capsule> capsules{c};
    StepInputs in;
    in.capsules = capsules;
    for (int f = 0; f < 15; ++f)
      solver->step(state, in, slick(0.5));
    EXPECT_TRUE(state.positions.allFinite());
    EXPECT_GT(clearance(state.positions, capsules), 0.0035);
    if (std::max(c.r0, c.r1) > 0) {
      EXPECT_GT(state.positions.col(1).maxCoeff(), 0.1); // it lies on the sphere
    }
  }
}

/// Fewer vertices than a row has: with the bits of one after the other.
TEST(Contact, EveryVertexOfASquareStaysOutside) {
  const Sheet s = scenes::grid(1, 1, 0.05, 0.13);
  const auto solver = make(s);
  const auto one_by_one =
      detail::create_with_lanes(ClothModel::create(s.rest, s.faces, s.clothness, solver->model().options()), 4);
  const std::vector<Capsule> ball{{{0, 0, 0}, {0, 0, 0}, 0.1, 0.1}};
  ClothState state = initial_state(s.rest), expected = state;
  StepInputs in;
  in.capsules = ball;
  for (int f = 0; f < 15; ++f) {
    solver->step(state, in, slick(0.5));
    one_by_one->step(expected, in, slick(0.5));
  }
  EXPECT_EQ(state.positions, expected.positions);
  EXPECT_GT(clearance(state.positions, ball), 0.0035);
  EXPECT_LT(clearance(state.positions, ball), 0.02); // it fell onto it
}

/// A vertex 2 cm deep in a ball, beside which stands another that it reaches only once the first has pushed it out.
struct TwoBalls {
  float weight = 1;
  int order = 0;
  LaneModel model{};
  Array<CapsuleMotion<float>> balls;
  Array<Point> x, p;
  VertexBoxes<float> boxes;
  Array<float> give, watched;
  Array<ContactOf<float>> contacts;
  explicit TwoBalls(double second_from) {
    model.vertex_count = 1;
    model.weights = &weight;
    model.vertex_order = &order;
    model.thickness = 0.01f;
    const Eigen::Vector3d second(second_from + 0.1, 0, 0);
    for (const Capsule &ball : {Capsule{{0, 0, 0}, {0, 0, 0}, 0.1, 0.1}, Capsule{second, second, 0.1, 0.1}})
      balls.push_back(capsule_motion(ball, ball, Eigen::Vector3d::Zero()));
    for (int i = 0; i < 1 + kSpareVertices; ++i) {
      x.push_back(Vec3f{0.08f, 0, 0});
      p.push_back(Vec3f{0.08f, 0, 0});
      give.push_back(0);
    }
  }
};

TEST(Contact, WhatOneProxyMovesIsSeenByTheNext) {
  TwoBalls scene(0.08 + 0.01 + kNear + 0.005); // 5 mm out of reach; the first opens 20 mm
  scene.boxes.set(scene.model, scene.x, scene.p);
  find_capsule_contacts(scene.model, scene.balls, scene.x, scene.p, 0.02f, scene.give, scene.boxes, scene.contacts);
  EXPECT_FLOAT_EQ(scene.p[0].x, 0.1f);
  ASSERT_EQ(scene.contacts.size(), 2);
  EXPECT_EQ(scene.contacts[1].capsule, 1);
}

TEST(Contact, AStrayThatOneProxyPushesOutIsSeenByTheNext) {
  TwoBalls scene(0.115); // from 0.105 on a vertex is too near; the first pushes it to 0.11
  push_out_strays(scene.model, scene.balls, scene.contacts, scene.p, scene.boxes, scene.watched);
  EXPECT_FLOAT_EQ(scene.p[0].x, 0.105f);
}

/// A small sheet thrown onto a large pinned one stays above it, at any speed, and lies still in the end.
TEST(SelfCollision, ThrownSheetStaysAbove) {
  Sheet lower = scenes::grid(12, 12, 0.03), upper = scenes::grid(5, 5, 0.023, 0.1);
  Sheet s;
  const int n = static_cast<int>(lower.rest.rows()), m = static_cast<int>(upper.rest.rows());
  s.rest.resize(n + m, 3);
  s.rest << lower.rest, upper.rest;
  s.faces.resize(lower.faces.rows() + upper.faces.rows(), 3);
  s.faces << lower.faces, (upper.faces.array() + n).matrix();
  s.clothness = Eigen::VectorXd::Ones(n + m);
  s.clothness.head(n).setZero();
  for (double speed : {0.0, 3.0, 10.0}) {
    const auto solver = make(s);
    ClothState state = initial_state(s.rest);
    state.velocities.bottomRows(m).col(1).setConstant(-speed);
    StepInputs in;
    in.targets = s.rest;
    for (int f = 0; f < 40; ++f) {
      solver->step(state, in, slick(0.5));
      EXPECT_GT(state.positions.bottomRows(m).col(1).minCoeff(), 0.003) << speed << " frame " << f;
    }
    EXPECT_LT(state.positions.bottomRows(m).col(1).maxCoeff(), 0.03) << speed;
    EXPECT_LT(state.velocities.rowwise().norm().maxCoeff(), 0.5) << speed;
  }
}

TEST(SelfCollision, SwitchedOffLetsItThrough) {
  Sheet lower = scenes::grid(4, 4, 0.03), upper = scenes::grid(2, 2, 0.023, 0.01);
  Sheet s;
  s.rest.resize(25 + 9, 3);
  s.rest << lower.rest, upper.rest;
  s.faces.resize(40, 3);
  s.faces << lower.faces, (upper.faces.array() + 25).matrix();
  s.clothness = Eigen::VectorXd::Ones(34);
  s.clothness.head(25).setZero();
  ClothOptions options = ClothOptions::paper();
  options.self_collision = false;
  const auto solver = make(s, options);
  ClothState state = initial_state(s.rest);
  StepInputs in;
  in.targets = s.rest;
  for (int f = 0; f < 10; ++f)
    solver->step(state, in, slick());
  EXPECT_LT(state.positions.bottomRows(9).maxCoeff(), 0.1);
  EXPECT_LT(state.positions.bottomRows(9).col(1).maxCoeff(), -0.1);
}

TEST(SelfCollision, LayersThatRestTogetherAreLeftAlone) {
  Sheet lower = scenes::grid(6, 6, 0.03), upper = scenes::grid(6, 6, 0.03, 0.001); // 1 mm apart at rest, thickness 4 mm
  Sheet s;
  s.rest.resize(98, 3);
  s.rest << lower.rest, upper.rest;
  s.faces.resize(144, 3);
  s.faces << lower.faces, (upper.faces.array() + 49).matrix();
  s.clothness = Eigen::VectorXd::Ones(98);
  ClothOptions options = ClothOptions::paper();
  options.gravity.setZero();
  const auto solver = make(s, options);
  ClothState state = initial_state(s.rest);
  for (int f = 0; f < 20; ++f)
    solver->step(state, {}, slick());
  EXPECT_LT((state.positions - s.rest).rowwise().norm().maxCoeff(), 1e-5);
}

} // namespace contact_test
} // namespace doublet::pbd
