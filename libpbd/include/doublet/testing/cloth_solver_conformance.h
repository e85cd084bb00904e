#pragma once
// What every ClothSolver must do, for those who write their own: call it in a test of any framework and expect an empty list.

#include "doublet/options/options.h"
#include "doublet/pbd/cloth_solver.h"
#include "doublet/pbd/detail/cloth_physics.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

namespace doublet::testing {

namespace detail {

/// Inputs of one frame of the banner, valid as long as this object: the rail that it hangs from sways, a rod swings through it.
struct BannerFrame {
  pbd::Vertices before, after;
  std::vector<pbd::Capsule> rod_before, rod_after;
  pbd::StepInputs inputs;
  BannerFrame(const pbd::Vertices &rest, int frame) : before(rail(rest, frame)), after(rail(rest, frame + 1)) {
    rod_before = rod(frame), rod_after = rod(frame + 1);
    inputs.previous_targets = before, inputs.targets = after;
    inputs.previous_capsules = rod_before, inputs.capsules = rod_after;
  }
  BannerFrame(const BannerFrame &) = delete;

private:
  static pbd::Vertices rail(const pbd::Vertices &rest, int f) {
    return rest.rowwise() + Eigen::RowVector3d(0.1 * std::sin(0.5 * f), 0, 0.2 * std::sin(0.35 * f));
  }
  static std::vector<pbd::Capsule> rod(int f) {
    const double z = 0.3 * std::cos(0.4 * f);
    return {{{-0.2, 0.8, z}, {0.6, 0.8, z}, 0.04, 0.03}};
  }
};

inline bool same(const pbd::ClothState &a, const pbd::ClothState &b) {
  return a.positions == b.positions && a.velocities == b.velocities;
}
inline bool finite(const pbd::ClothState &state) {
  return state.positions.allFinite() && state.velocities.allFinite();
}

/// The rules and the violations that they found.
class ClothSolverKit {
public:
  explicit ClothSolverKit(const pbd::ClothSolverFactory &make) : make_(make) {
    check("the rest state rests", [this] { rests(); });
    check("cloth falls", [this] { falls(); });
    check("pinned vertices obey", [this] { obeys(); });
    check("a copied state replays", [this] { replays(); });
    check("company and threads change nothing", [this] { keeps_to_itself(); });
    check("the corners of the material box stay finite", [this] { stays_finite(); });
    check("wrong input is refused", [this] { refuses(); });
    ClothPhysics physics(make, broken_);
    check("the time of a frame counts", [&] { physics.keeps_time(); });
    check("drag slows", [&] { physics.meets_drag(); });
    check("wind blows", [&] { physics.is_blown(); });
    check("blended vertices are drawn to their targets", [&] { physics.is_blended(); });
    check("cloth keeps its length", [&] { physics.keeps_its_length(); });
    check("capsules hold", [&] { physics.stays_out(); });
    check("moving capsules push", [&] { physics.is_pushed(); });
    check("friction holds and carries", [&] { physics.rubs(); });
    check("pinned vertices move evenly", [&] { physics.moves_evenly(); });
  }
  const std::vector<std::string> &broken() const { return broken_; }

private:
  template <class Rule> void check(const std::string &rule, const Rule &holds) {
    try {
      holds();
    } catch (const std::exception &error) {
      broken_.push_back(rule + ": the solver threw: " + error.what());
    }
  }
  std::shared_ptr<const pbd::ClothSolver> solver(const Eigen::VectorXd &clothness, const pbd::ClothOptions &options = {}) const {
    return make_(pbd::ClothModel::create(banner_.rest, banner_.faces, clothness, options));
  }

  void rests() {
    pbd::ClothOptions weightless;
    weightless.gravity.setZero();
    const auto tested = solver(banner_.clothness, weightless);
    pbd::ClothState state = pbd::initial_state(banner_.rest);
    pbd::StepInputs still;
    still.targets = banner_.rest;
    for (int f = 0; f < 40; ++f)
      tested->step(state, still, {});
    const double moved = (state.positions - banner_.rest).rowwise().norm().maxCoeff();
    if (!(moved < 1e-4))
      broken_.push_back("the rest state does not rest: without gravity a vertex moved " + options::to_text(moved, 4) +
                        " m in 40 frames");
  }

  void falls() {
    const auto tested = solver(Eigen::VectorXd::Ones(banner_.clothness.size()));
    pbd::ClothState state = pbd::initial_state(banner_.rest);
    for (int f = 0; f < 8; ++f)
      tested->step(state, {}, {});
    const double fallen = (banner_.rest - state.positions).col(1).mean(), freely = 0.5 * 9.81 * 0.2 * 0.2;
    if (!(fallen > 0.2 * freely && fallen < 1.5 * freely))
      broken_.push_back("cloth does not fall: free cloth came down by " + options::to_text(fallen, 4) +
                        " m in 0.2 s, a stone by " + options::to_text(freely, 4));
    state = pbd::initial_state(banner_.rest);
    pbd::StepInputs sideways;
    sideways.gravity = Eigen::Vector3d(0, 0, 9.81);
    for (int f = 0; f < 8; ++f)
      tested->step(state, sideways, {});
    const Eigen::RowVector3d way = (state.positions - banner_.rest).colwise().mean();
    if (!(way.z() > 0.2 * freely && std::abs(way.y()) < 0.1 * way.z()))
      broken_.push_back("cloth does not fall where the gravity of its inputs points: it went " + options::to_text(way.z(), 4) +
                        " m that way in 0.2 s, and " + options::to_text(-way.y(), 4) + " m down");
  }

  void obeys() {
    pbd::ClothState state = pbd::initial_state(banner_.rest);
    const pbd::Vertices moved = banner_.rest.rowwise() + Eigen::RowVector3d(0.02, 0.01, -0.03);
    pbd::StepInputs move;
    move.previous_targets = banner_.rest, move.targets = moved;
    solver(banner_.clothness)->step(state, move, {});
    const double off = (state.positions - moved).topRows(9).rowwise().norm().maxCoeff();
    if (!(off < 1e-5))
      broken_.push_back("pinned vertices do not obey: one is " + options::to_text(off, 4) + " m from its target");
  }

  void replays() {
    const auto tested = solver(banner_.clothness);
    pbd::ClothState state = pbd::initial_state(banner_.rest), copy;
    for (int f = 0; f < 40; ++f) {
      if (f == 20)
        copy = state;
      tested->step(state, BannerFrame(banner_.rest, f).inputs, {});
    }
    for (int f = 20; f < 40; ++f)
      tested->step(copy, BannerFrame(banner_.rest, f).inputs, {});
    if (!same(state, copy))
      broken_.push_back("a copied state does not replay to the same bits");
  }

  /// Simulations with inputs and a material each, one of them thrown off at 1e38 m/s: alone, together, on three threads.
  void keeps_to_itself() {
    constexpr int kCount = 5, kWild = 2;
    const auto tested = solver(banner_.clothness);
    std::vector<pbd::Material> materials(kCount);
    for (int i = 0; i < kCount; ++i)
      materials[i].d_n = 1 + i, materials[i].k_bend = 0.2 * i;
    std::vector<pbd::ClothState> alone(kCount, pbd::initial_state(banner_.rest));
    alone[kWild].velocities.setConstant(1e38);
    std::vector<pbd::ClothState> together = alone, threaded = alone;
    for (int f = 0; f < 10; ++f) {
      std::vector<std::unique_ptr<BannerFrame>> frames;
      std::vector<pbd::StepInputs> inputs;
      std::vector<int> failed;
      const std::vector<pbd::ClothState> before = together;
      for (int i = 0; i < kCount; ++i) {
        frames.push_back(std::make_unique<BannerFrame>(banner_.rest, f + 3 * i));
        inputs.push_back(frames.back()->inputs);
        if (!tested->step_batch({&alone[i], 1}, {&inputs[i], 1}, {&materials[i], 1}).empty())
          failed.push_back(i);
      }
      if (tested->step_batch(together, inputs, materials) != failed ||
          tested->step_batch(threaded, inputs, materials, 3) != failed)
        broken_.push_back("other simulations are named as not finite in company, or on several threads, than alone");
      for (int i = 0; i < kCount; ++i)
        if (!same(together[i], alone[i]) || !same(threaded[i], alone[i]))
          return broken_.push_back("simulation " + std::to_string(i) + " differs in company, or on several threads, from alone");
      for (int i : failed)
        if (!same(together[i], before[i]))
          return broken_.push_back("a simulation that came out not finite was not left as it was");
    }
  }

  void stays_finite() {
    const auto tested = solver(banner_.clothness);
    std::vector<pbd::Material> corners(64);
    for (int corner = 0; corner < 64; ++corner) {
      for (int k = 0; k < 6; ++k) {
        const pbd::MaterialParameter &p = pbd::material_parameters()[k];
        corners[corner].*p.value = corner >> k & 1 ? p.upper : p.lower;
      }
      if (corners[corner].k_stretch == 0)
        corners[corner].k_stretch = 0.01;
    }
    std::vector<pbd::ClothState> states(64, pbd::initial_state(banner_.rest));
    std::vector<int> failed;
    for (int f = 0; f < 30 && failed.empty() && std::all_of(states.begin(), states.end(), finite); ++f)
      failed = shaken(*tested, states, f, corners);
    for (int corner = 0; corner < 64; ++corner)
      if (!finite(states[corner]) || std::find(failed.begin(), failed.end(), corner) != failed.end())
        broken_.push_back("corner " + std::to_string(corner) + " of the material box gives values that are not finite");
  }

  std::vector<int> shaken(const pbd::ClothSolver &tested, std::vector<pbd::ClothState> &states, int f,
                          const std::vector<pbd::Material> &materials) const {
    const BannerFrame frame(banner_.rest, f);
    return tested.step_batch(states, {&frame.inputs, 1}, materials);
  }

  /// Each input has one error; nothing may have moved.
  void refuses() {
    const auto tested = solver(banner_.clothness);
    const BannerFrame frame(banner_.rest, 0);
    const pbd::ClothState start = pbd::initial_state(banner_.rest);
    pbd::ClothState few = start, wild = start;
    few.positions.conservativeResize(5, 3);
    wild.velocities(7, 1) = std::nan("");
    pbd::StepInputs no_targets = frame.inputs, still_time = frame.inputs;
    no_targets.targets = no_targets.previous_targets = {};
    still_time.dt = 0;
    pbd::Material negative;
    negative.d_n = -1;
    refuse(*tested, "a state with too few vertices", few, frame.inputs, {});
    refuse(*tested, "a velocity that is not a number", wild, frame.inputs, {});
    refuse(*tested, "targets that are missing", start, no_targets, {});
    refuse(*tested, "a frame of 0 s", start, still_time, {});
    refuse(*tested, "negative drag", start, frame.inputs, negative);
  }
  void refuse(const pbd::ClothSolver &tested, const std::string &what, const pbd::ClothState &state,
              const pbd::StepInputs &inputs, const pbd::Material &material) {
    // Together with a valid simulation, which must not have moved either.
    std::vector<pbd::ClothState> states{pbd::initial_state(banner_.rest), state};
    const BannerFrame frame(banner_.rest, 0);
    const std::vector<pbd::StepInputs> both{frame.inputs, inputs};
    try {
      tested.step_batch(states, both, std::vector<pbd::Material>{{}, material});
    } catch (const std::invalid_argument &) {
      if (!same(states[0], pbd::initial_state(banner_.rest)))
        broken_.push_back(what + " was refused too late: another simulation has been stepped");
      return;
    }
    broken_.push_back(what + " is not refused with std::invalid_argument");
  }

  const pbd::ClothSolverFactory &make_;
  const Banner banner_;
  std::vector<std::string> broken_;
};

} // namespace detail

/// One sentence for each rule that the solvers of `make` break; the rules are the names in detail::ClothSolverKit.
inline std::vector<std::string> cloth_solver_violations(const pbd::ClothSolverFactory &make) {
  return detail::ClothSolverKit(make).broken();
}

} // namespace doublet::testing
