// Bad meshes, bad inputs, wild materials, and the conformance kit.

#include "scenes.h"

#include <doublet/pbd/detail/lanes.h>
#include <doublet/testing/cloth_solver_conformance.h>

#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <random>

namespace doublet::pbd {
namespace robustness_test {

using scenes::Sheet;

std::string refusal(const std::function<void()> &act) {
  try {
    act();
  } catch (const std::invalid_argument &e) {
    return e.what();
  }
  return "";
}
std::string model_refusal(const Sheet &s, const ClothOptions &options = ClothOptions::paper()) {
  return refusal([&] { ClothModel::create(s.rest, s.faces, s.clothness, options); });
}
::testing::AssertionResult says(const std::string &message, const std::string &part) {
  return message.find(part) != std::string::npos ? ::testing::AssertionSuccess()
                                                 : ::testing::AssertionFailure() << '"' << message << '"';
}

TEST(Robustness, RefusesBadMeshes) {
  const Sheet good = scenes::grid(3, 3, 0.03);
  Sheet s;
  EXPECT_TRUE(says(model_refusal(s), "empty"));
  s = good;
  s.rest(5, 1) = std::nan("");
  EXPECT_TRUE(says(model_refusal(s), "vertex 5"));
  s = good;
  s.faces(2, 1) = 99;
  EXPECT_TRUE(says(model_refusal(s), "face 2 has index 99"));
  s.faces(2, 1) = -1;
  EXPECT_TRUE(says(model_refusal(s), "face 2 has index -1"));
  s = good;
  s.faces.row(3) << 1, 1, 2;
  EXPECT_TRUE(says(model_refusal(s), "face 3 is degenerate"));
  s = good;
  s.clothness.conservativeResize(4);
  EXPECT_TRUE(says(model_refusal(s), "clothness must have one value a vertex (16), found 4"));
  s = good;
  s.clothness[7] = 1.5;
  EXPECT_TRUE(says(model_refusal(s), "at vertex 7"));
  s = good;
  s.rest.conservativeResize(17, 3);
  s.rest.row(16) << 1, 1, 1;
  s.clothness = Eigen::VectorXd::Ones(17);
  EXPECT_TRUE(says(model_refusal(s), "vertex 16 belongs to no face"));
}

TEST(Robustness, RefusesBadOptionsAndMaterials) {
  const Sheet s = scenes::grid(3, 3, 0.03);
  const auto with = [&](auto &&change) {
    ClothOptions o = ClothOptions::paper();
    change(o);
    return model_refusal(s, o);
  };
  EXPECT_TRUE(says(with([](ClothOptions &o) { o.iterations = 0; }), "iterations"));
  EXPECT_TRUE(says(with([](ClothOptions &o) { o.substeps = -1; }), "substeps"));
  EXPECT_TRUE(says(with([](ClothOptions &o) { o.gravity[0] = std::nan(""); }), "gravity"));
  EXPECT_TRUE(says(with([](ClothOptions &o) { o.restitution = 2; }), "restitution"));
  EXPECT_TRUE(says(with([](ClothOptions &o) { o.thickness = -1; }), "thickness"));
  EXPECT_TRUE(says(with([](ClothOptions &o) { o.self_thickness = 7; }), "self_thickness"));
  for (const MaterialParameter &p : material_parameters())
    for (double bad : {p.lower - 1, p.upper + 1, std::nan("")}) {
      Material m;
      m.*p.value = bad;
      EXPECT_TRUE(says(refusal([&] { validate(m); }), p.name));
    }
  Material m;
  m.k_stretch = 0;
  EXPECT_TRUE(says(refusal([&] { validate(m); }), "k_stretch: expected a number in (0, 1]"));
}

TEST(Robustness, RefusesBadInputs) {
  Sheet s = scenes::grid(3, 3, 0.03);
  s.clothness[0] = 0;
  const auto solver = ClothSolver::create(ClothModel::create(s.rest, s.faces, s.clothness));
  const ClothState start = initial_state(s.rest);
  const auto with = [&](auto &&change) {
    ClothState state = start;
    StepInputs in;
    in.targets = s.rest;
    change(state, in);
    return refusal([&] { solver->step(state, in, {}); });
  };
  const Vertices few = s.rest.topRows(3);
  const std::vector<Capsule> one(1, Capsule{{0, 0, 0}, {0, 1, 0}, 0.1, 0.1}), two(2, one[0]);
  std::vector<Capsule> negative = one;
  negative[0].r1 = -1;
  EXPECT_EQ(with([](ClothState &, StepInputs &) {}), "");
  EXPECT_TRUE(says(with([](ClothState &, StepInputs &in) { in.targets = {}; }), "targets are missing"));
  EXPECT_TRUE(says(with([&](ClothState &, StepInputs &in) { in.previous_targets = few; }),
                   "previous_targets must have 16 rows, found 3"));
  EXPECT_TRUE(says(with([](ClothState &state, StepInputs &) { state.positions(3, 1) = std::nan(""); }), "state.positions"));
  EXPECT_TRUE(says(with([](ClothState &state, StepInputs &) { state.velocities.resize(2, 3); }), "state.velocities"));
  EXPECT_TRUE(says(with([](ClothState &, StepInputs &in) { in.dt = 0; }), "dt"));
  EXPECT_TRUE(says(with([](ClothState &, StepInputs &in) { in.wind[1] = INFINITY; }), "wind"));
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_TRUE(
        says(with([&](ClothState &, StepInputs &in) { in.gravity = std::nan("") * Eigen::Vector3d::Unit(axis); }), "gravity"))
        << axis;
  EXPECT_TRUE(says(with([&](ClothState &, StepInputs &in) { in.capsules = one, in.previous_capsules = two; }), "equally many"));
  EXPECT_TRUE(says(with([&](ClothState &, StepInputs &in) { in.capsules = negative; }), "capsule 0"));
  EXPECT_TRUE(says(with([&](ClothState &, StepInputs &in) { in.previous_capsules = one; }), "found 0 and 1"));
  EXPECT_TRUE(says(with([](ClothState &, StepInputs &in) { in.substeps = -1; }), "substeps must lie in [0, 1000], found -1"));
  std::vector<ClothState> states(2, start);
  std::vector<StepInputs> unlike(2);
  unlike[0].targets = unlike[1].targets = s.rest;
  unlike[1].substeps = 2;
  EXPECT_TRUE(says(refusal([&] { solver->step_batch(states, unlike, std::vector<Material>(2)); }), "substeps, found 0 and 2"));
  const std::vector<Material> materials(3);
  EXPECT_TRUE(says(refusal([&] { solver->step_batch(states, std::vector<StepInputs>(1), materials); }), "equally many"));
  EXPECT_TRUE(says(refusal([] { ClothSolver::create(nullptr); }), "expected a model, found none"));
}

TEST(Robustness, SimulatesUglyMeshes) {
  Sheet s = scenes::grid(5, 5, 0.03);
  const int f = static_cast<int>(s.faces.rows()), n = static_cast<int>(s.rest.rows());
  s.faces.conservativeResize(f + 3, 3);
  s.rest.conservativeResize(n + 2, 3);
  s.clothness = Eigen::VectorXd::Ones(n + 2);
  s.rest.row(n) << 0.01, 0.03, 0.01;
  s.rest.row(n + 1) << 0.015, 1e-7, 0;                               // a sliver
  s.faces.row(f) << s.faces(7, 0), s.faces(7, 1), n;                 // a third face on an edge
  s.faces.row(f + 1) << s.faces(8, 2), s.faces(8, 1), s.faces(8, 0); // a face twice, flipped
  s.faces.row(f + 2) << 20, 21, n + 1;
  const auto solver = ClothSolver::create(ClothModel::create(s.rest, s.faces, s.clothness));
  ClothState state = initial_state(s.rest);
  const std::vector<Capsule> post{{{0, -0.15, 0}, {0, -0.2, 0}, 0.08, 0.05}};
  StepInputs in;
  in.capsules = post;
  for (int i = 0; i < 100; ++i)
    solver->step(state, in, {});
  EXPECT_TRUE(state.positions.allFinite());
  EXPECT_LT(state.velocities.rowwise().norm().maxCoeff(), 50);
}

TEST(Robustness, SurvivesFacesTooSmallToBend) {
  Sheet s;
  const double tiny = 1e-5; // m: two needles beside a short edge, as decimation leaves them
  s.rest.resize(4, 3);
  s.rest << 0, 0, 0, tiny, 0, 0, 0, 0, tiny, 0, 0, -tiny;
  s.faces.resize(2, 3);
  s.faces << 0, 2, 1, 0, 1, 3;
  s.clothness = Eigen::VectorXd::Ones(4);
  const auto solver = ClothSolver::create(ClothModel::create(s.rest, s.faces, s.clothness));
  ClothState state = initial_state(s.rest);
  for (int i = 0; i < 10; ++i)
    solver->step(state, StepInputs{}, {});
  EXPECT_TRUE(state.positions.allFinite());
  EXPECT_LT(state.positions.col(1).maxCoeff(), 0);
}

TEST(Robustness, OneTriangleIsCloth) {
  Sheet s;
  s.rest.resize(3, 3);
  s.rest << 0, 0, 0, 0.1, 0, 0, 0, 0, 0.1;
  s.faces.resize(1, 3);
  s.faces << 0, 1, 2;
  s.clothness = Eigen::Vector3d(0, 1, 1);
  const auto solver = ClothSolver::create(ClothModel::create(s.rest, s.faces, s.clothness));
  ClothState state = initial_state(s.rest);
  StepInputs in;
  in.targets = s.rest;
  for (int i = 0; i < 100; ++i)
    solver->step(state, in, {});
  EXPECT_LT(state.positions(1, 1), -0.05);
}

/// Random corners of the material box in a wild dance, with and without substeps: nothing becomes NaN, nothing flies off.
TEST(Robustness, SurvivesTheCornersOfTheBox) {
  const Sheet s = scenes::skirt(26, 10);
  std::mt19937 random(11);
  for (int round = 0; round < 12; ++round) {
    Material m;
    for (const MaterialParameter &p : material_parameters())
      m.*p.value = random() % 2 ? p.upper : p.lower;
    if (m.k_stretch == 0)
      m.k_stretch = 1e-3;
    ClothOptions options = ClothOptions::paper();
    options.substeps = round % 3 == 0 ? 3 : 1;
    options.restitution = round % 4 == 0 ? 1 : 0;
    const auto solver = ClothSolver::create(ClothModel::create(s.rest, s.faces, s.clothness, options));
    const scenes::Dancer dancer{3};
    ClothState state = initial_state(s.rest);
    std::uniform_real_distribution<double> jump(-0.3, 0.3);
    Vertices previous = s.rest, targets;
    std::vector<Capsule> previous_capsules = dancer.capsules(0), capsules;
    for (int f = 1; f <= 120; ++f) {
      targets = dancer.targets(s.rest, f / 40.0);
      capsules = dancer.capsules(f / 40.0);
      if (f % 20 == 0) { // the tracker slips: everything jumps
        const Eigen::RowVector3d slip(jump(random), jump(random), jump(random));
        targets.rowwise() += slip;
        for (Capsule &c : capsules)
          c.p0 += slip.transpose(), c.p1 -= slip.transpose();
      }
      StepInputs in;
      in.targets = targets;
      in.previous_targets = previous;
      in.capsules = capsules;
      in.previous_capsules = previous_capsules;
      ASSERT_NO_THROW(solver->step(state, in, m)) << "round " << round << " frame " << f;
      ASSERT_LE(state.velocities.rowwise().norm().maxCoeff(), 100.001) << "round " << round << " frame " << f;
      // A rubber skirt (k_stretch near 0) falls as far as its fall lasts; any other stays about the dancer.
      if (m.k_stretch == 1) {
        ASSERT_LT((state.positions.rowwise() - targets.row(0)).rowwise().norm().maxCoeff(), 3)
            << "round " << round << " frame " << f;
      }
      previous = targets;
      previous_capsules = capsules;
    }
  }
}

TEST(Conformance, OurSolverConforms) {
  for (const std::string &broken : doublet::testing::cloth_solver_violations(&ClothSolver::create))
    ADD_FAILURE() << broken;
}

/// Ours, spoilt in one thing.
class Spoilt : public ClothSolver {
public:
  enum Fault { Forgetful, Deaf, Frozen, Crowded, Explosive, Shrinking, Unordered };
  Spoilt(std::shared_ptr<const ClothModel> cloth, Fault fault)
      : ClothSolver(cloth), real_(ClothSolver::create(std::move(cloth))), fault_(fault) {}

private:
  std::vector<int> advance(std::span<ClothState> states, std::span<const StepInputs> inputs, std::span<const Material> materials,
                           int threads) const override {
    if (fault_ == Frozen)
      return {};
    std::vector<int> failed = real_->step_batch(states, inputs, materials, threads);
    for (ClothState &state : states)
      if (fault_ == Forgetful)
        state.positions.col(2).array() += 1e-3 * ++calls_;
      else if (fault_ == Deaf)
        state.positions.row(0) = model().rest().row(0);
      else if (fault_ == Crowded)
        state.positions(40, 0) += 1e-12 * static_cast<double>(states.size());
      else if (fault_ == Explosive && materials.size() == 64)
        state.velocities(3, 1) = std::nan("");
      else if (fault_ == Shrinking)
        state.positions.conservativeResize(2, 3);
    if (fault_ == Unordered)
      failed = {0, 0};
    return failed;
  }
  std::unique_ptr<ClothSolver> real_;
  Fault fault_;
  mutable int calls_ = 0;
};

std::string violations(Spoilt::Fault fault) {
  std::string all;
  for (const std::string &broken : doublet::testing::cloth_solver_violations(
           [&](std::shared_ptr<const ClothModel> model) { return std::make_shared<Spoilt>(std::move(model), fault); }))
    all += broken + "; ";
  return all;
}

/// The kit finds what it is for.
TEST(Conformance, TheKitCatchesBrokenSolvers) {
  EXPECT_TRUE(says(violations(Spoilt::Forgetful), "rest state does not rest"));
  EXPECT_TRUE(says(violations(Spoilt::Forgetful), "does not replay"));
  EXPECT_TRUE(says(violations(Spoilt::Deaf), "pinned vertices do not obey"));
  EXPECT_TRUE(says(violations(Spoilt::Frozen), "does not fall"));
  EXPECT_TRUE(says(violations(Spoilt::Crowded), "differs in company"));
  EXPECT_TRUE(says(violations(Spoilt::Explosive), "corner 63 "));
}

/// Ours with one piece of the physics taken out.
class Without : public ClothSolver {
public:
  enum Piece {
    Capsules,
    SecondCapsule,
    PreviousCapsules,
    PreviousTargets,
    Wind,
    Gravity,
    Time,
    Blend,
    NormalDrag,
    TangentialDrag,
    Stretch,
    Softness,
    Friction,
    Constraints,
  };
  Without(const std::shared_ptr<const ClothModel> &cloth, Piece piece)
      : ClothSolver(cloth), real_(ClothSolver::create(piece == Blend ? unblended(*cloth) : cloth)), piece_(piece) {}

private:
  static std::shared_ptr<const ClothModel> unblended(const ClothModel &cloth) {
    const Eigen::VectorXd all_or_nothing = (cloth.clothness().array() > 0).cast<double>();
    return ClothModel::create(cloth.rest(), cloth.faces(), all_or_nothing, cloth.options());
  }
  std::vector<int> advance(std::span<ClothState> states, std::span<const StepInputs> inputs, std::span<const Material> materials,
                           int threads) const override {
    if (piece_ == Constraints)
      return fallen(states, inputs);
    std::vector<StepInputs> own(inputs.begin(), inputs.end());
    std::vector<std::vector<Capsule>> firsts(2 * own.size());
    for (std::size_t i = 0; i < own.size(); ++i)
      spoil(own[i], firsts[2 * i], firsts[2 * i + 1]);
    std::vector<Material> of(materials.begin(), materials.end());
    for (Material &material : of)
      spoil(material);
    return real_->step_batch(states, own, of, threads);
  }
  void spoil(StepInputs &in, std::vector<Capsule> &first, std::vector<Capsule> &first_before) const {
    if (piece_ == Capsules)
      in.capsules = in.previous_capsules = {};
    if (piece_ == SecondCapsule && in.capsules.size() > 1) {
      first = {in.capsules.front()};
      first_before = {(in.previous_capsules.empty() ? in.capsules : in.previous_capsules).front()};
      in.capsules = first, in.previous_capsules = first_before;
    }
    if (piece_ == PreviousCapsules)
      in.previous_capsules = in.capsules;
    if (piece_ == PreviousTargets)
      in.previous_targets = in.targets;
    if (piece_ == Wind)
      in.wind.setZero();
    if (piece_ == Gravity)
      in.gravity.reset();
    if (piece_ == Time)
      in.dt = 1.0 / 40;
  }
  void spoil(Material &material) const {
    if (piece_ == NormalDrag)
      material.d_n = 0;
    if (piece_ == TangentialDrag)
      material.d_t = 0;
    if (piece_ == Stretch)
      material.k_stretch = 1e-6;
    if (piece_ == Softness)
      material.k_stretch = 1;
    if (piece_ == Friction)
      material.k_friction = 0;
  }
  /// Every vertex for itself.
  std::vector<int> fallen(std::span<ClothState> states, std::span<const StepInputs> inputs) const {
    for (std::size_t i = 0; i < states.size(); ++i) {
      const StepInputs &in = inputs[inputs.size() == 1 ? 0 : i];
      ClothState &state = states[i];
      state.velocities.rowwise() += in.dt * in.gravity.value_or(model().options().gravity).transpose();
      state.positions += in.dt * state.velocities;
      for (Eigen::Index v = 0; v < in.targets.rows(); ++v)
        if (model().inverse_masses()[v] == 0)
          state.positions.row(v) = in.targets.map().row(v);
    }
    return {};
  }
  std::unique_ptr<ClothSolver> real_;
  Piece piece_;
};

/// Ours with other settings than the model's.
class Set : public ClothSolver {
public:
  Set(const std::shared_ptr<const ClothModel> &cloth, const ClothOptions &options)
      : ClothSolver(cloth),
        real_(ClothSolver::create(ClothModel::create(cloth->rest(), cloth->faces(), cloth->clothness(), options))) {}

private:
  std::vector<int> advance(std::span<ClothState> states, std::span<const StepInputs> inputs, std::span<const Material> materials,
                           int threads) const override {
    return real_->step_batch(states, inputs, materials, threads);
  }
  std::unique_ptr<ClothSolver> real_;
};

TEST(Conformance, TheKitMissesEveryPieceOfThePhysics) {
  const auto missed = [](Without::Piece piece) {
    std::string all;
    for (const std::string &broken : doublet::testing::cloth_solver_violations(
             [&](std::shared_ptr<const ClothModel> model) { return std::make_shared<Without>(model, piece); }))
      all += broken + "; ";
    return all;
  };
  EXPECT_TRUE(says(missed(Without::Capsules), "capsules do not hold: a vertex was"));
  EXPECT_TRUE(says(missed(Without::SecondCapsule), "inside capsule 1"));
  EXPECT_TRUE(says(missed(Without::PreviousCapsules), "previous_capsules are not heeded"));
  EXPECT_TRUE(says(missed(Without::PreviousCapsules), "friction with capsules that move is not heeded"));
  EXPECT_TRUE(says(missed(Without::PreviousTargets), "previous_targets are not heeded"));
  EXPECT_TRUE(says(missed(Without::Wind), "wind is not heeded"));
  EXPECT_TRUE(says(missed(Without::Gravity), "where the gravity of its inputs points"));
  EXPECT_TRUE(says(missed(Without::Time), "dt is not heeded"));
  EXPECT_TRUE(says(missed(Without::Blend), "blended vertices are not drawn to their targets"));
  EXPECT_TRUE(says(missed(Without::NormalDrag), "d_n does not slow"));
  EXPECT_TRUE(says(missed(Without::TangentialDrag), "d_t does not slow"));
  EXPECT_TRUE(says(missed(Without::Stretch), "cloth does not keep its length"));
  EXPECT_TRUE(says(missed(Without::Softness), "k_stretch is not heeded"));
  EXPECT_TRUE(says(missed(Without::Friction), "k_friction is not heeded"));
  EXPECT_TRUE(says(missed(Without::Constraints), "cloth does not keep its length"));
}

/// Nor is an honest one condemned, whatever its settings.
TEST(Conformance, OurSolverConformsInEverySetting) {
  ClothOptions fine, plain = ClothOptions::paper();
  fine.iterations = 2, fine.substeps = 12;
  plain.substeps = 2;
  for (const ClothOptions &options : {ClothOptions::paper(), plain, fine}) {
    const auto make = [&](const std::shared_ptr<const ClothModel> &asked) {
      ClothOptions own = options;
      own.gravity = asked->options().gravity;
      return std::shared_ptr<const ClothSolver>(std::make_shared<Set>(asked, own));
    };
    for (const std::string &broken : doublet::testing::cloth_solver_violations(make))
      ADD_FAILURE() << options.iterations << " x " << options.substeps << ": " << broken;
  }
  for (const int lanes : {1, 4})
    for (const std::string &broken : doublet::testing::cloth_solver_violations(
             [&](std::shared_ptr<const ClothModel> model) { return detail::create_with_lanes(std::move(model), lanes); }))
      ADD_FAILURE() << lanes << " lanes: " << broken;
}

/// A solver that breaks its word is stopped before what it left is used.
TEST(Conformance, BrokenPromisesAreErrors) {
  EXPECT_TRUE(says(violations(Spoilt::Shrinking), "with 2 positions and 63 velocities, expected 63"));
  EXPECT_TRUE(says(violations(Spoilt::Unordered), "must return ascending indices"));
}

std::vector<std::filesystem::path> sources_of(const std::string &room) {
  std::vector<std::filesystem::path> paths;
  for (const auto &entry : std::filesystem::recursive_directory_iterator(DOUBLET_SOURCE_DIR "/" + room))
    if (entry.is_regular_file() && (entry.path().extension() == ".h" || entry.path().extension() == ".cpp"))
      paths.push_back(entry.path());
  return paths;
}

/// The room depends on Eigen, itself, the descriptions of options and the types that all have in common, which depend on nothing.
TEST(House, IncludesNothingButItselfOptionsEigenAndTheStandardLibrary) {
  std::vector<std::filesystem::path> paths = sources_of("libpbd");
  for (const char *room : {"liboptions", "libtypes"})
    for (const std::filesystem::path &path : sources_of(room))
      paths.push_back(path);
  for (const std::filesystem::path &path : paths) {
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) {
      if (line.rfind("#include", 0) != 0)
        continue;
      const std::string name = line.substr(10, line.find_last_of("\">") - 10);
      const bool compilers = name == "immintrin.h" || name == "wasm_simd128.h"; // of x86, of WebAssembly
      const bool standard = name.find_first_of("/.") == std::string::npos || compilers;
      const bool own = name.rfind("doublet/pbd/", 0) == 0 || name.rfind("doublet/options/", 0) == 0 ||
                       name.rfind("doublet/types/", 0) == 0 || (line[9] == '"' && name.find('/') == std::string::npos);
      EXPECT_TRUE(standard || own || name.rfind("Eigen/", 0) == 0) << path << ": " << line;
    }
  }
}

} // namespace robustness_test
} // namespace doublet::pbd
