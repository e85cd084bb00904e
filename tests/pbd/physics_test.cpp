// The solver against closed forms and invariants.

#include "scenes.h"
#include "support/no_threads.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <gtest/gtest.h>
#include <numeric>
#include <random>
#include <thread>

namespace doublet::pbd {
namespace physics_test {

using scenes::Sheet;
constexpr double kG = 9.81, kH = 1.0 / 40;

Material inert(double k_stretch = 1, double k_bend = 0) {
  Material m;
  m.d_n = m.d_t = m.k_friction = 0;
  m.k_stretch = k_stretch;
  m.k_bend = k_bend;
  return m;
}
std::unique_ptr<ClothSolver> make(const Sheet &s, const ClothOptions &options = ClothOptions::paper()) {
  return ClothSolver::create(ClothModel::create(s.rest, s.faces, s.clothness, options));
}
ClothOptions weightless() {
  ClothOptions o = ClothOptions::paper();
  o.gravity.setZero();
  return o;
}
void run(const ClothSolver &solver, ClothState &state, const StepInputs &in, const Material &material, int frames) {
  for (int f = 0; f < frames; ++f)
    solver.step(state, in, material);
}
double worst_stretch(const Sheet &s, const Vertices &x) {
  double worst = 0;
  for (int f = 0; f < s.faces.rows(); ++f)
    for (int k = 0; k < 3; ++k) {
      const int a = s.faces(f, k), b = s.faces(f, (k + 1) % 3);
      worst = std::max(worst, (x.row(a) - x.row(b)).norm() / (s.rest.row(a) - s.rest.row(b)).norm() - 1);
    }
  return worst;
}

TEST(Cloth, MassesAreAThirdOfTheAreas) {
  Sheet s = scenes::grid(4, 3, 0.1);
  s.clothness[0] = 0;
  const auto model = ClothModel::create(s.rest, s.faces, s.clothness);
  EXPECT_EQ(model->inverse_masses()[0], 0);
  double mass = 0;
  for (int i = 1; i < model->vertex_count(); ++i)
    mass += 1 / model->inverse_masses()[i];
  const int faces_at_0 = (s.faces.array() == 0).rowwise().any().count();
  EXPECT_NEAR(mass, 4 * 3 * 0.01 - faces_at_0 * 0.005 / 3, 1e-12);
}

TEST(Cloth, LeavesTheCallersArithmeticAsItWas) {
  const Sheet s = scenes::grid(2, 2, 0.1);
  ClothState state = initial_state(s.rest);
  volatile float tiny = 1e-39f; // below the smallest normal one
  make(s)->step(state, {}, inert());
  EXPECT_GT(tiny * 0.5f, 0.f);
}

TEST(Cloth, FallsFreely) {
  const Sheet s = scenes::grid(6, 5, 0.03);
  for (int substeps : {1, 4}) {
    ClothOptions options = ClothOptions::paper();
    options.substeps = substeps;
    const auto solver = make(s, options);
    ClothState state = initial_state(s.rest);
    state.velocities.col(0).setConstant(1);
    run(*solver, state, {}, inert(1, 0.5), 40);
    const double h = kH / substeps, n = 40.0 * substeps;
    const Vertices moved = state.positions - s.rest;
    EXPECT_LT((moved.col(1).array() + kG * h * h * n * (n + 1) / 2).abs().maxCoeff(), 2e-4) << substeps; // of 5 m
    EXPECT_LT((moved.col(0).array() - 1).abs().maxCoeff(), 2e-4);
    EXPECT_LT((state.velocities.col(1).array() + kG).abs().maxCoeff(), 1e-3);
  }
}

TEST(Cloth, ReachesTerminalVelocityUnderNormalDrag) {
  const Sheet s = scenes::grid(6, 5, 0.03); // flat on the air
  for (double d : {0.5, 5.0, 32.0}) {
    Material m = inert();
    m.d_n = d;
    const auto solver = make(s);
    ClothState state = initial_state(s.rest);
    run(*solver, state, {}, m, 200);
    const double v = -state.velocities.col(1).mean();
    EXPECT_NEAR(v, std::sqrt(2 * kG / d + kG * kH / 2 * kG * kH / 2), 2e-3) << d; // what the scheme converges to
    EXPECT_NEAR(v, std::sqrt(2 * kG / d), 0.015 * v) << d;                        // m g = m d_n v^2 / 2
  }
}

TEST(Cloth, ReachesTerminalVelocityUnderTangentialDrag) {
  Sheet s = scenes::grid(6, 5, 0.03);
  s.rest.col(1) = s.rest.col(2).eval();
  s.rest.col(2).setZero(); // edge on
  for (double d : {2.0, 16.0, 32.0}) {
    Material m = inert();
    m.d_t = d;
    const auto solver = make(s);
    ClothState state = initial_state(s.rest);
    run(*solver, state, {}, m, 400);
    const double v = -state.velocities.col(1).mean();
    EXPECT_NEAR(v, kG * kH / 2 / std::tanh(d * kH / 4), 2e-3) << d;
    EXPECT_NEAR(v, 2 * kG / d, 0.015 * v) << d; // m g = m d_t v / 2
  }
}

TEST(Cloth, DragFollowsTheWind) {
  const Sheet s = scenes::grid(4, 4, 0.03);
  const auto solver = make(s, weightless());
  Material m = inert();
  m.d_n = m.d_t = 32;
  StepInputs in;
  in.wind = {3, 1, -2};
  ClothState state = initial_state(s.rest);
  run(*solver, state, in, m, 400);
  EXPECT_LT((state.velocities.rowwise() - Eigen::RowVector3d(3, 1, -2)).rowwise().norm().maxCoeff(), 0.05);
}

TEST(Cloth, HangingStripHangsStraightAndDoesNotStretch) {
  Sheet s = scenes::grid(4, 24, 0.03); // 0.72 m long
  s.rest.col(1) = -s.rest.col(2).eval();
  s.rest.col(2).setZero();
  s.clothness.head(5).setZero();
  const auto solver = make(s);
  ClothState state = initial_state(s.rest);
  Material m = inert(1, 0.3);
  m.d_n = 16;
  m.d_t = 16;
  StepInputs in;
  in.targets = s.rest;
  run(*solver, state, in, m, 400);
  EXPECT_LT((state.positions - s.rest).topRows(5).norm(), 1e-6);
  EXPECT_LT(worst_stretch(s, state.positions), 0.35); // 24 rows and 24 sweeps: the row that bears all the others
  const double length = state.positions(2, 1) - state.positions(24 * 5 + 2, 1);
  EXPECT_NEAR(length, 0.72, 0.08 * 0.72);
  EXPECT_LT(state.positions.col(2).cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_LT(state.velocities.rowwise().norm().maxCoeff(), 0.02);
  // stiffer in more sweeps, softer in k
  ClothOptions more = ClothOptions::paper();
  more.iterations = 200;
  ClothState stiff = initial_state(s.rest), soft = initial_state(s.rest);
  run(*make(s, more), stiff, in, m, 400);
  EXPECT_NEAR(stiff.positions(2, 1) - stiff.positions(122, 1), 0.72, 0.01 * 0.72);
  EXPECT_LT(worst_stretch(s, stiff.positions), 0.05);
  m.k_stretch = 0.9;
  run(*solver, soft, in, m, 400);
  EXPECT_GT(soft.positions(2, 1) - soft.positions(122, 1), length + 0.02);
}

/// A strip of `segments` hung by both ends at a distance `span` settles into the catenary of its length.
TEST(Cloth, SlackStripHangsInACatenary) {
  const int segments = 40;
  const double length = 1, span = 0.6, step = length / segments;
  Sheet s = scenes::grid(segments, 1, step);
  const int columns = segments + 1;
  Vertices start = s.rest; // a V with legs of half the length
  for (int i = 0; i < start.rows(); ++i) {
    const double along = (i % columns) * step, t = std::min(along, length - along);
    start(i, 0) = (along <= length / 2 ? -span / 2 + t * span / length : span / 2 - t * span / length);
    start(i, 1) = -t * std::sqrt(1 - span * span);
  }
  for (int i : {0, segments, columns, columns + segments})
    s.clothness[i] = 0;
  ClothOptions options = ClothOptions::paper();
  options.iterations = 300;
  const auto solver = make(s, options);
  ClothState state = initial_state(start);
  Material m = inert(1, 0);
  m.d_n = 4;
  m.d_t = 16;
  StepInputs in;
  in.targets = start;
  run(*solver, state, in, m, 600);
  double lo = 0.05, hi = 5; // a of y = a cosh(x / a): 2 a sinh(span / 2a) = length
  for (int i = 0; i < 100; ++i) {
    const double a = (lo + hi) / 2;
    (2 * a * std::sinh(span / (2 * a)) > length ? lo : hi) = a;
  }
  const double a = lo;
  for (int c = 0; c < columns; ++c) {
    const Eigen::RowVector3d p = (state.positions.row(c) + state.positions.row(c + columns)) / 2;
    EXPECT_NEAR(p[1], a * std::cosh(p[0] / a) - a * std::cosh(span / (2 * a)), 0.005) << c; // of a sag of 0.36 m
  }
  EXPECT_LT(state.velocities.rowwise().norm().maxCoeff(), 0.05);
}

/// A strip swings with the period of a compound pendulum of its length, sqrt(2 L / (3 g)) 2 pi, when it is too stiff to bend.
TEST(Cloth, StiffStripSwingsLikeAPendulum) {
  const int rows = 10;
  const double spacing = 0.03, length = rows * spacing;
  Sheet s = scenes::grid(2, rows, spacing);
  Vertices flat = s.rest;
  const double lean = 0.1;
  for (int i = 0; i < s.rest.rows(); ++i) {
    const double down = flat(i, 2) - flat(0, 2);
    s.rest.row(i) << flat(i, 0), -down * std::cos(lean), down * std::sin(lean);
  }
  s.clothness.head(3).setZero();
  ClothOptions options = ClothOptions::paper();
  options.iterations = 60;
  options.substeps = 8;
  const auto solver = make(s, options);
  ClothState state = initial_state(s.rest);
  StepInputs in;
  in.targets = s.rest;
  std::vector<double> crossings;
  double before = state.positions(s.rest.rows() - 1, 2);
  for (int f = 1; f < 200; ++f) {
    solver->step(state, in, inert(1, 1));
    const double now = state.positions(s.rest.rows() - 1, 2);
    if (before > 0 && now <= 0)
      crossings.push_back((f - 1 + before / (before - now)) * kH);
    before = now;
  }
  ASSERT_GE(crossings.size(), 3u);
  const double period = (crossings.back() - crossings.front()) / static_cast<double>(crossings.size() - 1);
  EXPECT_NEAR(period, 2 * scenes::kPi * std::sqrt(2 * length / (3 * kG)), 0.01); // of 0.9 s
}

TEST(Cloth, BlendSettlesWhereItsStiffnessSays) {
  // One step keeps delta of the way from the target: o = delta (o + g h^2), hence o = g h^2 delta / (1 - delta).
  double last = -1;
  for (double delta : {0.1, 0.3, 0.5, 0.7, 0.9}) {
    Sheet s = scenes::grid(3, 3, 0.03);
    s.clothness.setConstant(delta);
    const auto solver = make(s);
    ClothState state = initial_state(s.rest);
    StepInputs in;
    in.targets = s.rest;
    run(*solver, state, in, inert(), 400);
    const double sag = -state.positions.col(1).mean();
    EXPECT_NEAR(sag, kG * kH * kH * delta / (1 - delta), 1e-4) << delta;
    EXPECT_GT(sag, last);
    last = sag;
  }
}

TEST(Cloth, KeepsMomentum) {
  const Sheet s = scenes::grid(12, 12, 0.02);
  const auto model = ClothModel::create(s.rest, s.faces, s.clothness, weightless());
  const auto solver = ClothSolver::create(model);
  ClothState state = initial_state(s.rest);
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0, 1);
  for (int i = 0; i < state.velocities.size(); ++i)
    state.velocities.data()[i] = normal(random);
  const Eigen::VectorXd mass = model->inverse_masses().cwiseInverse();
  const auto momentum = [&] { return Eigen::RowVector3d(mass.transpose() * state.velocities); };
  const auto angular = [&] {
    Eigen::Vector3d l = Eigen::Vector3d::Zero();
    for (int i = 0; i < mass.size(); ++i)
      l += mass[i] * Eigen::Vector3d(state.positions.row(i)).cross(Eigen::Vector3d(state.velocities.row(i)));
    return l;
  };
  const double scale = mass.sum();
  Material m = inert(0.9, 0.8);
  m.k_friction = 0.5;
  const Eigen::RowVector3d p = momentum();
  run(*solver, state, {}, m, 30);
  EXPECT_LT((momentum() - p).norm(), 1e-4 * scale);
  // angular momentum: constraints keep it; the predictor moves along tangents, which x cross v does not see
  state = initial_state(s.rest);
  for (int i = 0; i < state.velocities.rows(); ++i)
    state.velocities.row(i) << -2 * s.rest(i, 2), 0.1 * normal(random), 2 * s.rest(i, 0);
  const Eigen::Vector3d l = angular();
  run(*solver, state, {}, m, 20);
  EXPECT_LT((angular() - l).norm(), 0.05 * l.norm());
}

TEST(Cloth, DampingKeepsRigidMotionAndStopsTheRest) {
  const Sheet s = scenes::grid(8, 8, 0.02);
  const auto solver = make(s, weightless());
  Material m = inert(1, 0.5);
  m.k_damping = 1;
  ClothState state = initial_state(s.rest);
  for (int i = 0; i < s.rest.rows(); ++i)
    state.velocities.row(i) << 1 - 0.5 * s.rest(i, 2), 0, 0.5 * s.rest(i, 0);
  ClothState rigid = state;
  run(*solver, rigid, {}, m, 10);
  EXPECT_NEAR(rigid.velocities.col(0).mean(), 1, 1e-3);
  EXPECT_NEAR(rigid.velocities.row(8)[2] - rigid.velocities.row(0)[2], 0.5 * 0.16, 0.01);
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0, 0.2);
  for (int i = 0; i < state.velocities.rows(); ++i)
    state.velocities(i, 1) += normal(random);
  run(*solver, state, {}, m, 5);
  const Eigen::VectorXd up = state.velocities.col(1).array() - state.velocities.col(1).mean();
  Eigen::MatrixX3d basis(up.size(), 3); // what is left of the shaking is a tilt at most
  basis << Eigen::VectorXd::Ones(up.size()), state.positions.col(0), state.positions.col(2);
  const Eigen::Vector3d fit = (basis.transpose() * basis).ldlt().solve(basis.transpose() * up);
  EXPECT_LT((up - basis * fit).cwiseAbs().maxCoeff(), 0.01);
}

/// The whole scene turned and moved gives the same motion turned and moved.
TEST(Cloth, IsEquivariant) {
  const Sheet s = scenes::skirt(24, 10);
  const scenes::Dancer dancer;
  const Material m;
  const auto play = [&](const Eigen::Matrix3d &r, const Eigen::RowVector3d &t) {
    ClothOptions options = ClothOptions::paper();
    options.gravity = r * options.gravity;
    const auto move = [&](const Vertices &x) { return Vertices((x * r.transpose()).rowwise() + t); };
    const auto solver = make(s, options);
    ClothState state = initial_state(move(s.rest));
    for (int f = 0; f < 12; ++f) {
      const Vertices a = move(dancer.targets(s.rest, f * kH)), b = move(dancer.targets(s.rest, (f + 1) * kH));
      std::vector<Capsule> ca = dancer.capsules(f * kH), cb = dancer.capsules((f + 1) * kH);
      for (auto *list : {&ca, &cb})
        for (Capsule &c : *list) {
          c.p0 = r * c.p0 + t.transpose();
          c.p1 = r * c.p1 + t.transpose();
        }
      StepInputs in;
      in.previous_targets = a;
      in.targets = b;
      in.previous_capsules = ca;
      in.capsules = cb;
      solver->step(state, in, m);
    }
    return Vertices((state.positions.rowwise() - t) * r);
  };
  const Vertices plain = play(Eigen::Matrix3d::Identity(), Eigen::RowVector3d::Zero());
  const Vertices moved = play(Eigen::Matrix3d::Identity(), {1000.25, -50.5, 30.125});
  const Vertices turned = play(Eigen::AngleAxisd(1.1, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix(), {1, 2, 3});
  EXPECT_GT((plain - s.rest).rowwise().norm().maxCoeff(), 0.05);
  EXPECT_LT((moved - plain).rowwise().norm().maxCoeff(), 2e-3); // float roundings grow in a dance
  EXPECT_LT((turned - plain).rowwise().norm().maxCoeff(), 2e-3);
}

/// The same bits from a copy, from a second solver, and from four threads that share one.
TEST(Cloth, ReplaysToTheBit) {
  const Sheet s = scenes::skirt(24, 10);
  const auto model = ClothModel::create(s.rest, s.faces, s.clothness);
  const auto solver = ClothSolver::create(model), other = ClothSolver::create(ClothModel::create(s.rest, s.faces, s.clothness));
  const scenes::Dancer dancer{1.5};
  const Material m;
  const auto play = [&](const ClothSolver &with, ClothState &state, int from, int to) {
    for (int f = from; f < to; ++f) {
      with.step(state, scenes::DancerFrame(dancer, s.rest, f * kH).inputs, m);
    }
  };
  ClothState state = initial_state(s.rest);
  play(*solver, state, 0, 30);
  const ClothState saved = state;
  play(*solver, state, 30, 60);
  std::vector<ClothState> again(4, saved);
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i)
    threads.emplace_back([&, i] { play(i == 3 ? *other : *solver, again[i], 30, 60); });
  for (std::thread &t : threads)
    t.join();
  for (const ClothState &a : again) {
    EXPECT_EQ(a.positions, state.positions);
    EXPECT_EQ(a.velocities, state.velocities);
  }
}

/// Those that the machine does not give are done without.
TEST(Cloth, FewerThreadsChangeNoBit) {
  const Sheet s = scenes::skirt(8, 6);
  const auto solver = make(s);
  const std::vector<Material> materials(19);
  const scenes::DancerFrame frame(scenes::Dancer{1.5}, s.rest, 0);
  std::vector<ClothState> with(materials.size(), initial_state(s.rest)), without = with;
  solver->step_batch(with, {&frame.inputs, 1}, materials, 4);
  const NoThreads none;
  solver->step_batch(without, {&frame.inputs, 1}, materials, 4);
  for (size_t i = 0; i < materials.size(); ++i)
    EXPECT_EQ(without[i].positions, with[i].positions) << i;
}

/// Simulations side by side know nothing of each other: any order and any company gives the same bits as each alone.
TEST(Cloth, CompanyChangesNoBit) {
  const Sheet s = scenes::skirt(20, 8);
  const auto solver = make(s);
  const scenes::Dancer dancer{1.5};
  const int count = 19; // more than any register holds, and no multiple of one
  std::vector<Material> materials;
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0, 1);
  for (int i = 0; i < count; ++i)
    materials.push_back({32 * unit(random), 32 * unit(random), unit(random), i % 3 ? 1 : 0.9 + 0.1 * unit(random), unit(random),
                         i % 4 ? 0 : unit(random)});
  const auto play = [&](std::vector<ClothState> &states, const std::vector<Material> &with) {
    for (int f = 0; f < 25; ++f) {
      const scenes::DancerFrame frame(dancer, s.rest, f * kH);
      solver->step_batch(states, {&frame.inputs, 1}, with);
    }
  };
  std::vector<ClothState> together(count, initial_state(s.rest));
  play(together, materials);
  std::vector<int> order(count);
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), random);
  std::vector<Material> shuffled;
  for (int i : order)
    shuffled.push_back(materials[i]);
  std::vector<ClothState> permuted(count, initial_state(s.rest));
  play(permuted, shuffled);
  for (int i = 0; i < count; ++i) {
    std::vector<ClothState> alone(1, initial_state(s.rest));
    play(alone, {materials[order[i]]});
    EXPECT_EQ(permuted[i].positions, together[order[i]].positions) << i;
    EXPECT_EQ(permuted[i].velocities, together[order[i]].velocities) << i;
    EXPECT_EQ(permuted[i].positions, alone[0].positions) << i;
    EXPECT_EQ(permuted[i].velocities, alone[0].velocities) << i;
  }
  EXPECT_GT((together[0].positions - together[1].positions).cwiseAbs().maxCoeff(), 1e-3); // the materials do differ
}

} // namespace physics_test
} // namespace doublet::pbd
