// What stiffness means: the same cloth in any number of sweeps and substeps, or not.

#include "scenes.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <gtest/gtest.h>
#include <stdexcept>
#include <vector>

namespace doublet::pbd {
namespace stiffness_test {

using scenes::Sheet;

constexpr double kLargest = 1.6; // over-relaxation that is accepted

Material damped(double k_stretch, double k_bend) {
  Material m;
  m.d_n = m.d_t = 8;
  m.k_friction = 0;
  m.k_stretch = k_stretch;
  m.k_bend = k_bend;
  return m;
}

/// 24 sweeps a frame, shared out in the first `count` of these ways.
std::vector<ClothOptions> budgets(Stiffness stiffness, int count = 4) {
  std::vector<ClothOptions> all(count, ClothOptions::paper());
  const int counts[][2] = {{24, 1}, {12, 2}, {6, 4}, {3, 8}, {2, 12}, {1, 24}};
  for (int i = 0; i < count; ++i) {
    all[i].iterations = counts[i][0];
    all[i].substeps = counts[i][1];
    all[i].stiffness = stiffness;
  }
  return all;
}
std::vector<ClothOptions> over_relaxed_budgets(double over_relaxation) {
  std::vector<ClothOptions> all = budgets(Stiffness::Compliance, 6);
  for (ClothOptions &options : all)
    options.over_relaxation = over_relaxation;
  return all;
}

/// The capsules when the share t of the frame is over.
std::vector<Capsule> between(const scenes::DancerFrame &frame, double t) {
  std::vector<Capsule> capsules = frame.capsules_after;
  for (std::size_t i = 0; i < capsules.size(); ++i) {
    capsules[i].p0 = frame.capsules_before[i].p0 + t * (capsules[i].p0 - frame.capsules_before[i].p0);
    capsules[i].p1 = frame.capsules_before[i].p1 + t * (capsules[i].p1 - frame.capsules_before[i].p1);
  }
  return capsules;
}

/// The sheet after `frames` frames from rest; its pinned vertices stay where they are.
Vertices settled(const Sheet &s, const ClothOptions &options, const Material &material, int frames) {
  const auto solver = ClothSolver::create(ClothModel::create(s.rest, s.faces, s.clothness, options));
  ClothState state = initial_state(s.rest);
  StepInputs in;
  in.targets = s.rest;
  for (int f = 0; f < frames; ++f)
    solver->step(state, in, material);
  return state.positions;
}

/// Of a strip of 0.24 m that hangs, m.
double sag(const ClothOptions &options) {
  Sheet s = scenes::grid(3, 8, 0.03);
  s.rest.col(1) = -s.rest.col(2).eval();
  s.rest.col(2).setZero();
  s.clothness.head(4).setZero();
  const Vertices x = settled(s, options, damped(0.9, 0.1), 300);
  return (s.rest.bottomRows(4) - x.bottomRows(4)).col(1).mean();
}

/// Of the free end of a strip that is held level at the other; all but the first row of `rows` stick out, 0.03 m each.
double droop_of(int rows, double k_bend, const ClothOptions &options) {
  Sheet s = scenes::grid(3, rows, 0.03);
  s.clothness.head(8).setZero();
  return -settled(s, options, damped(1, k_bend), 400).bottomRows(4).col(1).mean();
}
double droop(const ClothOptions &options) {
  return droop_of(4, 0.5, options);
}

/// How far below their targets blended vertices come to rest: all of a sheet, or those of a strip held level at one end.
double lag(const ClothOptions &options) {
  Sheet s = scenes::grid(3, 3, 0.03);
  s.clothness.setConstant(0.9);
  return -settled(s, options, damped(1, 0), 400).col(1).mean();
}
double lag_of_strip(const ClothOptions &options) {
  Sheet s = scenes::grid(3, 8, 0.03);
  s.clothness.setConstant(0.9);
  s.clothness.head(8).setZero();
  return -settled(s, options, damped(0.98, 0.5), 400).bottomRows(4).col(1).mean();
}

/// Largest over smallest answer.
template <class Measure> double disagreement(const std::vector<ClothOptions> &budgets, const Measure &measure) {
  std::vector<double> answers;
  for (const ClothOptions &options : budgets)
    answers.push_back(measure(options));
  const auto [least, most] = std::minmax_element(answers.begin(), answers.end());
  EXPECT_GT(*least, 0);
  return *most / *least;
}
template <class Measure> double disagreement(Stiffness stiffness, const Measure &measure) {
  return disagreement(budgets(stiffness), measure);
}

TEST(Stiffness, AMaterialMeansTheSameWhateverSweepsAndSubsteps) {
  EXPECT_LT(disagreement(Stiffness::Compliance, sag), 1.07);   // 1.045
  EXPECT_LT(disagreement(Stiffness::Compliance, droop), 1.02); // 1.006
  EXPECT_GT(sag(budgets(Stiffness::Compliance)[0]), 0.02);
  EXPECT_GT(droop(budgets(Stiffness::Compliance)[0]), 0.05);
  // The more substeps, the stiffer: what the other meaning is for.
  EXPECT_GT(disagreement(Stiffness::Sweeps, sag), 20);
  EXPECT_GT(disagreement(Stiffness::Sweeps, droop), 5);
}

/// A lone compliant constraint gets all but (1 - over_relaxation)^iterations of its force, which one or two sweeps must not feel.
TEST(Stiffness, AMaterialMeansTheSameOverRelaxedToo) {
  EXPECT_LT(disagreement(over_relaxed_budgets(ClothOptions{}.over_relaxation), sag), 1.12);   // 1.097
  EXPECT_LT(disagreement(over_relaxed_budgets(ClothOptions{}.over_relaxation), droop), 1.02); // 1.010
}

TEST(Stiffness, ABlendDoesToo) {
  EXPECT_LT(disagreement(Stiffness::Compliance, lag), 1.015);          // 1.005
  EXPECT_LT(disagreement(Stiffness::Compliance, lag_of_strip), 1.015); // 1.006
  EXPECT_GT(disagreement(Stiffness::Sweeps, lag), 5);
  // One step keeps 0.9 of the way from the target: o = 0.9 (o + g h^2).
  for (const ClothOptions &options : budgets(Stiffness::Compliance))
    EXPECT_NEAR(lag(options), 9.81 / 1600 * 9, 0.001) << options.substeps;
}

/// Nearly rigid bends take more sweeps than there are: what a strip that sticks out 21 cm droops depends on their number
/// (docs/cloth.md has the numbers).
TEST(Stiffness, StiffBendsMeanTheSameUpToTheSweepsThereAre) {
  std::vector<ClothOptions> all = over_relaxed_budgets(ClothOptions{}.over_relaxation);
  all.push_back(all[0]);
  all.back().iterations = 50, all.back().substeps = 16;
  const auto droop_at = [](double k_bend) { return [=](const ClothOptions &options) { return droop_of(8, k_bend, options); }; };
  EXPECT_LT(disagreement(all, droop_at(0.5)), 1.02); // 1.009
  EXPECT_LT(disagreement(all, droop_at(0.9)), 1.04); // 1.027
  const double stiffest = disagreement(all, droop_at(0.995));
  EXPECT_LT(stiffest, 2.7); // 2.50
  EXPECT_GT(stiffest, 2);   // which docs/cloth.md says
}

/// Rigid cloth in few sweeps hangs too long. Over-relaxed sweeps come nearer to what many sweeps end at, which is the same.
TEST(Stiffness, OverRelaxedSweepsComeFurtherToTheSameAnswer) {
  Sheet s = scenes::grid(3, 24, 0.03);
  s.rest.col(1) = -s.rest.col(2).eval();
  s.rest.col(2).setZero();
  s.clothness.head(4).setZero();
  const auto sag = [&](Stiffness stiffness, int iterations, double over_relaxation) {
    ClothOptions options;
    options.stiffness = stiffness;
    options.iterations = iterations;
    options.over_relaxation = over_relaxation;
    const Vertices x = settled(s, options, damped(1, 0.1), 100);
    return (s.rest.bottomRows(4) - x.bottomRows(4)).col(1).mean();
  };
  const double plain = sag(Stiffness::Compliance, 6, 1);
  EXPECT_GT(plain, 0.005);
  EXPECT_LT(sag(Stiffness::Compliance, 6, 1.5), 0.6 * plain);
  EXPECT_NEAR(sag(Stiffness::Compliance, 100, 1.5), sag(Stiffness::Compliance, 100, 1), 1e-3);
  EXPECT_EQ(sag(Stiffness::Sweeps, 6, 1.5), sag(Stiffness::Sweeps, 6, 1));
}

/// The largest that is accepted amplifies nothing, however few the sweeps are.
TEST(Stiffness, TheLargestOverRelaxationHoldsAStrip) {
  ClothOptions more;
  more.over_relaxation = kLargest + 0.01;
  EXPECT_THROW(more.validate(), std::invalid_argument);
  Sheet s = scenes::grid(3, 24, 0.03);
  s.rest.col(1) = -s.rest.col(2).eval();
  s.rest.col(2).setZero();
  s.clothness.head(4).setZero();
  for (ClothOptions options : over_relaxed_budgets(kLargest)) {
    options.rest_curvature = 0;
    const Vertices x = settled(s, options, damped(1, 0.1), 100);
    EXPECT_NEAR((s.rest.bottomRows(4) - x.bottomRows(4)).col(1).mean(), 0, 0.025 * 0.72) << options.iterations; // 2.3 to 15.3 mm
  }
}

/// Whatever is asked for, at any number of sweeps and substeps and any stiffness: a strip that falls into its pins ends where
/// plain sweeps end, and comes to rest. What stretches by two thirds and more may tremble in one or two substeps.
TEST(Stiffness, NoOverRelaxationAmplifies) {
  Sheet s = scenes::grid(2, 6, 0.03);
  s.rest.col(1) = -s.rest.col(2).eval();
  s.rest.col(2).setZero();
  s.clothness.head(3).setZero();
  std::vector<Material> materials;
  for (const double k : {0.1, 0.3, 0.5, 0.6, 0.9, 1.0})
    materials.push_back(damped(k, 0.1));
  const auto hung = [&](int iterations, int substeps, double over_relaxation) {
    ClothOptions options;
    options.iterations = iterations, options.substeps = substeps, options.over_relaxation = over_relaxation;
    const auto solver = ClothSolver::create(ClothModel::create(s.rest, s.faces, s.clothness, options));
    std::vector<ClothState> states(materials.size(), initial_state(s.rest));
    StepInputs in;
    in.targets = s.rest;
    for (int f = 0; f < 300; ++f)
      EXPECT_TRUE(solver->step_batch(states, {&in, 1}, materials, 1).empty());
    return states;
  };
  const auto longer = [&](const ClothState &state) { return (s.rest - state.positions).bottomRows(3).col(1).mean() / 0.18; };
  for (const int iterations : {1, 2, 3, 4, 6, 16, 48})
    for (const int substeps : {1, 2, 4, 24}) {
      const std::vector<ClothState> plain = hung(iterations, substeps, 1);
      for (const double over_relaxation : {ClothOptions{}.over_relaxation, kLargest}) {
        const std::vector<ClothState> states = hung(iterations, substeps, over_relaxation);
        for (std::size_t i = 0; i < states.size(); ++i) {
          const double k = materials[i].k_stretch, speed = states[i].velocities.rowwise().norm().maxCoeff(); // m/s
          const std::string which = std::to_string(iterations) + " x " + std::to_string(substeps) + ", " +
                                    std::to_string(over_relaxation) + ", k_stretch " + std::to_string(k);
          EXPECT_LT(speed, k < 0.6 ? 0.4 : 0.01) << which;
          EXPECT_GT(longer(states[i]), -0.001) << which;
          EXPECT_LT(longer(states[i]), 1.1 * longer(plain[i]) + 0.001) << which;
        }
      }
    }
}

/// What a vertex on an edge weighs stretches it as a spring of that constant would.
TEST(Stiffness, AnEdgeIsASpringOfItsConstant) {
  Sheet s;
  s.rest.resize(3, 3);
  s.rest << 0, 0, 0, 0.1, 0, 0, 0.05, -0.1, 0;
  s.faces.resize(1, 3);
  s.faces << 0, 1, 2;
  s.clothness = Eigen::Vector3d(0, 0, 1);
  const double w = ClothModel::create(s.rest, s.faces, s.clothness)->inverse_masses()[2];
  ClothOptions options;
  options.iterations = 100;
  const double k = 0.6, spring = spring_constant(k, w); // N/m where the vertex weighs 1/w kg
  const double stretch = -0.1 - settled(s, options, damped(k, 0), 400)(2, 1);
  const double length = std::hypot(0.05, 0.1 + stretch), pull = 2 * spring * (length - std::hypot(0.05, 0.1));
  EXPECT_NEAR(pull * (0.1 + stretch) / length, 9.81 / w, 0.02 * 9.81 / w);
  EXPECT_NEAR(stiffness_of_spring(spring, w), k, 1e-12);
  EXPECT_EQ(stiffness_of_spring(spring_constant(1, w), w), 1);
  EXPECT_EQ(spring_constant(0, w), 0);
  EXPECT_THROW(spring_constant(1.1, w), std::invalid_argument);
  EXPECT_THROW(spring_constant(0.5, 0), std::invalid_argument);
  EXPECT_THROW(stiffness_of_spring(-1, w), std::invalid_argument);
  EXPECT_THROW(stiffness_of_spring(1, std::nan("")), std::invalid_argument);
}

/// A corner of the material box in a dance with gusts: folds closed at once would pump each other up, and go on for good.
TEST(Stiffness, RigidBendsComeToRest) {
  const Sheet s = scenes::skirt(26, 10);
  Material material = damped(1, 1);
  material.d_n = material.d_t = 32;
  ClothOptions options;
  options.self_collision = false;
  for (int substeps : {1, 4}) {
    options.substeps = substeps;
    const auto solver = ClothSolver::create(ClothModel::create(s.rest, s.faces, s.clothness, options));
    ClothState state = initial_state(s.rest);
    for (int f = 0; f < 80 + 160; ++f) { // the last pose is held
      const bool dances = f < 80;
      const scenes::DancerFrame frame({3}, s.rest, std::min(f, 80) / 40.0);
      StepInputs in;
      in.targets = dances ? frame.after : frame.before;
      in.previous_targets = frame.before;
      in.wind = dances ? Eigen::Vector3d(20 * std::sin(f), 20 * std::sin(2 * f + 1), 20 * std::sin(3 * f + 2)) : in.wind;
      solver->step(state, in, material);
    }
    EXPECT_LT(state.velocities.rowwise().norm().maxCoeff(), 0.02) << substeps << " substeps"; // m/s: 0.008, 2e-5
  }
}

/// A frame in pieces of one substep each: blends, compliances and drag are those of the frame's substeps, friction and damping
/// shares of what a piece is.
TEST(Stiffness, AFrameInPiecesIsAFrame) {
  const Sheet s = scenes::skirt(26, 10); // of which two rows are blended
  Material material = damped(0.9, 0.5);
  material.k_friction = 0.5, material.k_damping = 0.2;
  Material of_a_piece = material;
  for (double *share : {&of_a_piece.k_friction, &of_a_piece.k_damping})
    *share = 1 - std::pow(1 - *share, 0.25);
  for (const Stiffness stiffness : {Stiffness::Compliance, Stiffness::Sweeps}) {
    ClothOptions options;
    options.stiffness = stiffness;
    options.self_collision = false;
    const auto solver = ClothSolver::create(ClothModel::create(s.rest, s.faces, s.clothness, options));
    ClothState whole = initial_state(s.rest), pieces = whole;
    for (int f = 0; f < 20; ++f) {
      const scenes::DancerFrame frame({}, s.rest, f / 40.0);
      solver->step(whole, frame.inputs, material);
      for (int i = 0; i < 4; ++i) {
        StepInputs in;
        in.dt = 1.0 / 160;
        in.substeps = 1;
        const Vertices way = frame.after - frame.before, first = frame.before + i / 4.0 * way,
                       last = frame.before + (i + 1) / 4.0 * way;
        in.previous_targets = first, in.targets = last;
        const std::vector<Capsule> begin = between(frame, i / 4.0), end = between(frame, (i + 1) / 4.0);
        in.previous_capsules = begin, in.capsules = end;
        solver->step(pieces, in, of_a_piece);
      }
    }
    EXPECT_LT((whole.positions - pieces.positions).rowwise().norm().maxCoeff(), 1e-4); // m
    EXPECT_GT((whole.positions - s.rest).rowwise().norm().maxCoeff(), 0.05);
  }
}

/// `share` of the rest mesh's angles is what an unloaded strip keeps: its chord is that of a polygon with these angles.
TEST(Stiffness, RestCurvatureIsTheShareOfTheAnglesThatIsKept) {
  constexpr int kRows = 12;
  constexpr double kLength = 0.03, kAngle = 0.12; // of a row, m; between two, rad
  Sheet s = scenes::grid(2, kRows, kLength);
  double y = 0, z = 0;
  for (int r = 0; r <= kRows; ++r) {
    for (int c = 0; c < 3; ++c)
      s.rest.row(3 * r + c).tail<2>() << y, z;
    y += kLength * std::sin(kAngle * r);
    z += kLength * std::cos(kAngle * r);
  }
  for (Stiffness stiffness : {Stiffness::Sweeps, Stiffness::Compliance})
    for (double share : {0.0, 0.5, 1.0}) {
      ClothOptions options = ClothOptions::paper();
      options.gravity.setZero();
      options.stiffness = stiffness;
      options.rest_curvature = share;
      Material material = damped(1, 0.5);
      material.k_damping = 0.1;
      const Vertices x = settled(s, options, material, 1000);
      const double turn = share * kAngle / 2,
                   chord = turn > 0 ? kLength * std::sin(kRows * turn) / std::sin(turn) : kRows * kLength;
      EXPECT_NEAR((x.row(3 * kRows + 1) - x.row(1)).norm(), chord, 0.002)
          << kStiffnessNames[static_cast<std::size_t>(stiffness)] << " " << share;
      if (share == 1) { // its shape, wherever rounding has let it drift
        for (Eigen::Index i = 0; i < x.rows(); ++i)
          EXPECT_NEAR((x.row(i) - x.row(0)).norm(), (s.rest.row(i) - s.rest.row(0)).norm(), 1e-4) << i;
      }
      if (share == 0) { // in one plane
        const Vertices about_mean = x.rowwise() - x.colwise().mean();
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(about_mean.transpose() * about_mean);
        EXPECT_LT(axes.eigenvalues()[0], 0.003 * 0.003);
      }
    }
}

} // namespace stiffness_test
} // namespace doublet::pbd
