// Many simulations side by side: every lane of every width gives the bits that a simulation gives by itself.

#include "doublet/pbd/detail/lanes.h"
#include "scenes.h"

#include <algorithm>
#include <cstring>
#include <gtest/gtest.h>
#include <random>

namespace doublet::pbd {
namespace lanes_test {

using scenes::Sheet;
constexpr double kH = 1.0 / 40;

/// FNV-1a over the bits.
std::uint64_t hash(const ClothState &state) {
  std::uint64_t h = 1469598103934665603ull;
  for (const Vertices *m : {&state.positions, &state.velocities})
    for (Eigen::Index i = 0; i < m->size(); ++i) {
      std::uint64_t bits;
      std::memcpy(&bits, m->data() + i, sizeof bits);
      h = (h ^ bits) * 1099511628211ull;
    }
  return h;
}
std::vector<std::uint64_t> hashes(const std::vector<ClothState> &states) {
  std::vector<std::uint64_t> all;
  for (const ClothState &state : states)
    all.push_back(hash(state));
  return all;
}

/// Anywhere in the box, its faces included.
std::vector<Material> any_materials(int count) {
  std::mt19937 random(5);
  std::vector<Material> materials(count);
  for (int i = 0; i < count; ++i)
    for (const MaterialParameter &p : material_parameters()) {
      const double u = std::uniform_real_distribution<double>(-0.2, 1.2)(random);
      materials[i].*p.value = p.lower + (p.upper - p.lower) * std::min(1.0, std::max(0.0, u));
      if (p.value == &Material::k_stretch)
        materials[i].k_stretch = i % 3 == 0 ? 1 : std::max(0.3, materials[i].k_stretch);
      if (p.value == &Material::k_damping && i % 4 != 0)
        materials[i].k_damping = 0;
    }
  return materials;
}

/// What a frame's inputs point to.
struct Frame {
  Vertices before, after;
  std::vector<Capsule> capsules_before, capsules_after;
  StepInputs inputs;
  Frame(const Sheet &s, double t, const Eigen::RowVector3d &place = Eigen::RowVector3d::Zero()) {
    const scenes::Dancer dancer{1.4};
    before = dancer.targets(s.rest, t).rowwise() + place;
    after = dancer.targets(s.rest, t + kH).rowwise() + place;
    capsules_before = dancer.capsules(t);
    capsules_after = dancer.capsules(t + kH);
    for (std::vector<Capsule> *list : {&capsules_before, &capsules_after})
      for (Capsule &c : *list)
        c.p0 += place.transpose(), c.p1 += place.transpose();
    inputs.previous_targets = before;
    inputs.targets = after;
    inputs.previous_capsules = capsules_before;
    inputs.capsules = capsules_after;
    inputs.wind = {0.5, 0.1, -1};
  }
};

std::vector<int> play(const ClothSolver &solver, const Sheet &s, std::vector<ClothState> &states,
                      const std::vector<Material> &materials, int frames, int threads = 1) {
  std::vector<int> failed;
  for (int f = 0; f < frames; ++f) {
    const Frame frame(s, f * kH);
    for (int i : solver.step_batch(states, {&frame.inputs, 1}, materials, threads))
      failed.push_back(i);
  }
  return failed;
}
std::vector<ClothState> alone(const std::shared_ptr<const ClothModel> &model, const Sheet &s,
                              const std::vector<Material> &materials, int frames) {
  const auto solver = detail::create_with_lanes(model, 1);
  std::vector<ClothState> states(materials.size(), initial_state(s.rest));
  for (int f = 0; f < frames; ++f) {
    const Frame frame(s, f * kH);
    for (size_t i = 0; i < states.size(); ++i)
      solver->step(states[i], frame.inputs, materials[i]);
  }
  return states;
}

void expect_same_bits(const ClothOptions &options, int simulations, int frames) {
  const Sheet s = scenes::skirt(26, 10);
  const auto model = ClothModel::create(s.rest, s.faces, s.clothness, options);
  const std::vector<Material> materials = any_materials(simulations);
  const std::vector<std::uint64_t> expected = hashes(alone(model, s, materials, frames));
  for (int lanes : detail::supported_lanes()) {
    const auto solver = detail::create_with_lanes(model, lanes);
    std::vector<ClothState> states(materials.size(), initial_state(s.rest));
    EXPECT_TRUE(play(*solver, s, states, materials, frames).empty());
    EXPECT_EQ(hashes(states), expected) << lanes << " lanes";
  }
  const auto solver = ClothSolver::create(model); // every width, other places, other company, three threads
  std::vector<Material> turned(materials.rbegin(), materials.rend());
  std::vector<ClothState> states(materials.size(), initial_state(s.rest));
  play(*solver, s, states, turned, frames, 3);
  std::reverse(states.begin(), states.end());
  EXPECT_EQ(hashes(states), expected);
}

TEST(Lanes, EveryWidthPlaceAndThreadGivesTheSameBits) {
  ClothOptions options = ClothOptions::paper();
  options.self_thickness = 0.008; // plenty of contacts
  expect_same_bits(options, 19, 60);
}

TEST(Lanes, SubstepsRestitutionAndComplianceToo) {
  ClothOptions options = ClothOptions::paper();
  options.iterations = 6;
  options.substeps = 4;
  options.restitution = 0.5;
  options.stiffness = Stiffness::Compliance;
  expect_same_bits(options, 9, 40);
}

TEST(Lanes, EdgesThatCollideToo) {
  ClothOptions options;
  options.self_thickness = 0.008;
  options.edge_collision = true;
  options.restitution = 0.3;
  expect_same_bits(options, 9, 30);
}

/// Lanes may be windows: other frames, other places in the world.
TEST(Lanes, TakeTheirOwnInputs) {
  const Sheet s = scenes::skirt(26, 10);
  const auto model = ClothModel::create(s.rest, s.faces, s.clothness);
  const std::vector<Material> materials = any_materials(10);
  const auto place = [](int i) { return Eigen::RowVector3d(0.9 * i, 0, 40 - 7.3 * i); };
  std::vector<ClothState> start;
  for (int i = 0; i < 10; ++i)
    start.push_back(initial_state(scenes::Dancer{1.4}.targets(s.rest, i).rowwise() + place(i)));
  std::vector<ClothState> together = start;
  const auto wide = ClothSolver::create(model), single = detail::create_with_lanes(model, 1);
  for (int f = 0; f < 30; ++f) {
    std::vector<Frame> frames;
    frames.reserve(10); // inputs point into their frame
    std::vector<StepInputs> inputs;
    for (int i = 0; i < 10; ++i) {
      frames.emplace_back(s, i + f * kH, place(i));
      inputs.push_back(frames[i].inputs);
      single->step(start[i], inputs[i], materials[i]);
    }
    wide->step_batch(together, inputs, materials);
  }
  EXPECT_EQ(hashes(together), hashes(start));
  EXPECT_NE(hash(start[0]), hash(start[1]));
}

/// A simulation that blows up does not change its neighbours, and its own state stays as it was.
TEST(Lanes, AnExplosionStaysInItsLane) {
  const Sheet s = scenes::skirt(26, 10);
  const auto model = ClothModel::create(s.rest, s.faces, s.clothness);
  const std::vector<Material> materials = any_materials(7);
  const std::vector<ClothState> expected = alone(model, s, materials, 20);
  for (int lanes : detail::supported_lanes()) {
    const auto solver = detail::create_with_lanes(model, lanes);
    std::vector<ClothState> states(7, initial_state(s.rest));
    states[2].velocities.setConstant(1e38);
    const ClothState wild = states[2];
    EXPECT_EQ(play(*solver, s, states, materials, 20), std::vector<int>(20, 2)) << lanes;
    for (int i = 0; i < 7; ++i)
      EXPECT_EQ(hash(states[i]), hash(i == 2 ? wild : expected[i])) << lanes << " lanes, simulation " << i;
    const Frame frame(s, 0);
    EXPECT_THROW(solver->step(states[2], frame.inputs, materials[2]), std::runtime_error);
  }
}

TEST(Lanes, RefusesWidthsItDoesNotHave) {
  const Sheet s = scenes::grid(2, 2, 0.1);
  const auto model = ClothModel::create(s.rest, s.faces, s.clothness);
  EXPECT_THROW(detail::create_with_lanes(model, 3), std::invalid_argument);
  EXPECT_EQ(detail::supported_lanes().front(), 1);
}

} // namespace lanes_test
} // namespace doublet::pbd
