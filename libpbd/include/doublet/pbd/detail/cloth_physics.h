#pragma once
// The physics tests of cloth_solver_conformance.h: small scenes whose outcome is known for any method, with tolerances for coarse
// ones. Bending, damping and self-collision are not required.

#include "doublet/options/options.h"
#include "doublet/pbd/cloth_solver.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

namespace doublet::testing::detail {

/// A banner of (8 + 1) x (6 + 1) vertices, 5 cm apart, hanging from its top row along z = 0; the row below is blended.
struct Banner {
  static constexpr int kAcross = 9, kDown = 7;
  pbd::Vertices rest{63, 3};
  pbd::Faces faces{96, 3};
  Eigen::VectorXd clothness = Eigen::VectorXd::Ones(63);
  Banner() {
    for (int i = 0; i < 63; ++i)
      rest.row(i) << 0.05 * (i % 9), 1 - 0.05 * (i / 9), 0;
    for (int q = 0; q < 48; ++q) {
      const int a = q / 8 * 9 + q % 8;
      faces.row(2 * q) << a, a + 9, a + 10;
      faces.row(2 * q + 1) << a, a + 10, a + 1;
    }
    clothness.head(9).setZero();
    clothness.segment(9, 9).setConstant(0.5);
  }
};

/// Adds a sentence to `broken` for each rule that the solvers of `make` break.
class ClothPhysics {
public:
  ClothPhysics(const pbd::ClothSolverFactory &make, std::vector<std::string> &broken) : make_(make), broken_(broken) {}

  /// Cloth falls as far in eight frames of 1/40 s as in sixteen of 1/80 s.
  void keeps_time() {
    const auto fallen = [this](int frames, double dt) {
      pbd::StepInputs in;
      in.dt = dt;
      return -moved(played(*free(), frames, in, dragging(0, 0))).y();
    };
    const double coarse = fallen(8, 1.0 / 40), fine = fallen(16, 1.0 / 80);
    expect(std::abs(coarse - fine) < 0.25 * coarse, "dt is not heeded: free cloth came down by " + metres(coarse) +
                                                        " in 8 frames of 1/40 s and by " + metres(fine) + " in 16 of 1/80 s");
  }

  /// Terminal velocities sqrt(2 g / d_n) broadside and 2 g / d_t edge on; neither drag acts across its direction.
  void meets_drag() {
    constexpr double kDrag = 16, kG = 9.81;
    const auto speed = [&](double d_n, double d_t, bool broadside, int frames) {
      pbd::StepInputs in;
      in.gravity = broadside ? Eigen::Vector3d(0, 0, -kG) : Eigen::Vector3d(0, -kG, 0);
      return played(*free(), frames, in, dragging(d_n, d_t)).velocities.colwise().mean().norm();
    };
    const auto ends_at = [&](const char *name, double found, double expected) {
      expect(std::abs(found - expected) < 0.25 * expected, std::string(name) + " does not slow cloth as it should: it falls at " +
                                                               number(found) + " m/s after 1.5 s with " + name +
                                                               " = 16, expected " + number(expected));
    };
    ends_at("d_n", speed(kDrag, 0, true, 60), std::sqrt(2 * kG / kDrag));
    ends_at("d_t", speed(0, kDrag, false, 60), 2 * kG / kDrag);
    const double freely = kG * 8 / 40;
    expect(speed(0, kDrag, true, 8) > 0.8 * freely, "d_t slows what falls broadside");
    expect(speed(kDrag, 0, false, 8) > 0.8 * freely, "d_n slows what falls edge on");
  }

  /// Drag acts on the velocity relative to the wind: without gravity cloth ends up as fast as the wind.
  void is_blown() {
    for (const Eigen::Vector3d &wind : {Eigen::Vector3d(0, 0, 5), Eigen::Vector3d(3, 0, 0)}) {
      pbd::StepInputs in;
      in.gravity = Eigen::Vector3d::Zero();
      in.wind = wind;
      const Eigen::Vector3d speed = played(*free(), 40, in, dragging(16, 16)).velocities.colwise().mean();
      const double along = speed.dot(wind) / wind.squaredNorm();
      expect(along > 0.7 && along < 1.05, "wind is not heeded: after 1 s free cloth moves at " + number(along) +
                                              " of its speed, " + (wind.z() != 0 ? "across" : "along") + " it");
    }
  }

  /// Cloth of which every vertex is blended hangs by its targets, the lower the looser it is.
  void is_blended() {
    const auto drop = [this](double clothness) {
      pbd::StepInputs in;
      in.targets = in.previous_targets = banner_.rest;
      return -moved(played(*solver(Eigen::VectorXd::Constant(banner_.clothness.size(), clothness)), 40, in, {})).y();
    };
    const double tight = drop(0.1), loose = drop(0.9);
    expect(std::abs(loose) < 0.1, "blended vertices are not drawn to their targets: of clothness 0.9 they are " + metres(loose) +
                                      " below them after 1 s");
    expect(loose > 1.5 * tight, "clothness between 0 and 1 is not heeded: of 0.9 vertices hang " + metres(loose) +
                                    " below their targets, of 0.1 " + metres(tight));
  }

  /// Hanging cloth keeps its length; the softer it is, the more it stretches.
  void keeps_its_length() {
    const auto length = [this](double k_stretch) {
      Eigen::VectorXd clothness = Eigen::VectorXd::Ones(banner_.clothness.size());
      clothness.head(Banner::kAcross).setZero();
      pbd::StepInputs in;
      in.targets = in.previous_targets = banner_.rest;
      pbd::Material material;
      material.k_stretch = k_stretch;
      const pbd::ClothState state = played(*solver(clothness), 60, in, material);
      return 1 - state.positions.col(1).tail(Banner::kAcross).mean();
    };
    const double rest = 0.05 * (Banner::kDown - 1), rigid = length(1), soft = length(0.05);
    expect(rigid > 0.9 * rest && rigid < 1.15 * rest,
           "cloth does not keep its length: of k_stretch 1, a banner of " + metres(rest) + " hangs to " + metres(rigid));
    expect(soft > 1.02 * rigid,
           "k_stretch is not heeded: a banner hangs to " + metres(rigid) + " with 1 and to " + metres(soft) + " with 0.05");
  }

  /// Cloth falls on two rods side by side and through neither.
  void stays_out() {
    const std::vector<pbd::Capsule> rods = two_rods(-0.08);
    pbd::StepInputs in = on_rods(rods, rods);
    pbd::ClothState state = pbd::initial_state(banner_.rest);
    const auto tested = free();
    double deepest[2] = {0, 0};
    for (int f = 0; f < 16; ++f) {
      tested->step(state, in, {});
      for (int r = 0; r < 2; ++r)
        deepest[r] = std::max(deepest[r], depth(state.positions, rods[r]));
    }
    for (int r = 0; r < 2; ++r)
      expect(deepest[r] < 0.006, "capsules do not hold: a vertex was " + metres(deepest[r]) + " inside capsule " +
                                     std::to_string(r) + ", which cloth fell on");
  }

  /// A rod that passes through the position of the cloth during a frame pushes it ahead.
  void is_pushed() {
    const auto rod = [](double z) { return std::vector<pbd::Capsule>{{{-0.5, 0.85, z}, {1, 0.85, z}, 0.1, 0.1}}; };
    const std::vector<pbd::Capsule> before = rod(-0.15), after = rod(0.05);
    pbd::StepInputs in = on_rods(before, after);
    in.gravity = Eigen::Vector3d::Zero();
    const pbd::ClothState state = played(*free(), 1, in, {});
    const double ahead = state.positions.col(2).segment(3 * Banner::kAcross, Banner::kAcross).mean();
    expect(ahead > 0.05, "previous_capsules are not heeded: a rod that went through where cloth was, and whose front is 15 cm "
                         "beyond, left it " +
                             metres(ahead) + " from there");
  }

  /// Cloth that slides along rods is stopped by friction; rods that slide under it carry it along.
  void rubs() {
    const auto slid = [this](double k_friction, double rods_speed, double speed) {
      pbd::ClothState state = pbd::initial_state(banner_.rest);
      state.velocities.col(0).setConstant(speed);
      const auto tested = free();
      pbd::Material material = dragging(0, 0);
      material.k_friction = k_friction;
      for (int f = 0; f < 10; ++f) {
        const std::vector<pbd::Capsule> before = two_rods(-0.072, rods_speed * f / 40),
                                        after = two_rods(-0.072, rods_speed * (f + 1) / 40);
        tested->step(state, on_rods(before, after), material);
      }
      return moved(state).x();
    };
    const double freely = slid(0, 0, 0.5), rubbed = slid(0.9, 0, 0.5), carried = slid(0.9, 0.5, 0), left = slid(0, 0.5, 0);
    expect(freely > 0.08, "cloth does not slide along capsules without friction: it went " + metres(freely) + " of 0.125");
    expect(rubbed < 0.7 * freely, "k_friction is not heeded: cloth that slid along capsules went " + metres(freely) +
                                      " with 0 and " + metres(rubbed) + " with 0.9");
    expect(carried > left + 0.03, "friction with capsules that move is not heeded: they went 0.125 m under cloth, which went " +
                                      metres(carried) + " with k_friction 0.9 and " + metres(left) + " with 0");
  }

  /// A pinned vertex moves evenly from previous_targets to targets.
  void moves_evenly() {
    const auto rail = [this](int f) -> pbd::Vertices { return banner_.rest.rowwise() + Eigen::RowVector3d(0.02 * f, 0, 0); };
    pbd::ClothState state = pbd::initial_state(banner_.rest);
    const auto tested = solver(banner_.clothness);
    for (int f = 0; f < 4; ++f) {
      const pbd::Vertices before = rail(f), after = rail(f + 1);
      pbd::StepInputs in;
      in.previous_targets = before, in.targets = after;
      tested->step(state, in, {});
    }
    const double speed = state.velocities.col(0).head(Banner::kAcross).mean();
    expect(std::abs(speed - 0.8) < 0.1, "previous_targets are not heeded: pinned vertices whose targets move at 0.8 m/s end a "
                                        "frame with " +
                                            number(speed) + " m/s");
  }

private:
  void expect(bool holds, const std::string &otherwise) {
    if (!holds)
      broken_.push_back(otherwise);
  }
  static std::string number(double value) { return options::to_text(value, 4); }
  static std::string metres(double value) { return number(value) + " m"; }
  static pbd::Material dragging(double d_n, double d_t) {
    pbd::Material material;
    material.d_n = d_n, material.d_t = d_t;
    return material;
  }

  std::shared_ptr<const pbd::ClothSolver> solver(const Eigen::VectorXd &clothness) const {
    return make_(pbd::ClothModel::create(banner_.rest, banner_.faces, clothness, {}));
  }
  std::shared_ptr<const pbd::ClothSolver> free() const { return solver(Eigen::VectorXd::Ones(banner_.clothness.size())); }
  pbd::ClothState played(const pbd::ClothSolver &tested, int frames, const pbd::StepInputs &in,
                         const pbd::Material &material) const {
    pbd::ClothState state = pbd::initial_state(banner_.rest);
    for (int f = 0; f < frames; ++f)
      tested.step(state, in, material);
    return state;
  }
  /// Of all vertices on average, m.
  Eigen::Vector3d moved(const pbd::ClothState &state) const { return (state.positions - banner_.rest).colwise().mean(); }

  /// Along x below two rows of the banner, which lies on them where gravity is along -z.
  static std::vector<pbd::Capsule> two_rods(double z, double x = 0) {
    return {{{x - 1, 0.9, z}, {x + 2, 0.9, z}, 0.06, 0.06}, {{x - 1, 0.8, z}, {x + 2, 0.8, z}, 0.06, 0.06}};
  }
  static pbd::StepInputs on_rods(const std::vector<pbd::Capsule> &before, const std::vector<pbd::Capsule> &after) {
    pbd::StepInputs in;
    in.previous_capsules = before, in.capsules = after;
    in.gravity = Eigen::Vector3d(0, 0, -9.81);
    return in;
  }
  /// m that the deepest vertex is inside a capsule of one radius.
  static double depth(const pbd::Vertices &positions, const pbd::Capsule &rod) {
    const Eigen::RowVector3d axis = (rod.p1 - rod.p0).transpose();
    double deepest = 0;
    for (Eigen::Index v = 0; v < positions.rows(); ++v) {
      const Eigen::RowVector3d from = positions.row(v) - rod.p0.transpose();
      const double along = std::clamp(from.dot(axis) / axis.squaredNorm(), 0.0, 1.0);
      deepest = std::max(deepest, rod.r0 - (from - along * axis).norm());
    }
    return deepest;
  }

  const pbd::ClothSolverFactory &make_;
  std::vector<std::string> &broken_;
  const Banner banner_;
};

} // namespace doublet::testing::detail
