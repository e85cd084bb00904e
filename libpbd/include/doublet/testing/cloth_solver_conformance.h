#pragma once
// What every ClothSolver must do, for those who write their own: call it in a test of any framework and expect an empty list.

#include "doublet/pbd/cloth_solver.h"

#include <cmath>
#include <functional>
#include <string>
#include <vector>

namespace doublet::testing {

/// Makes the solver under test for a model.
using ClothSolverFactory = std::function<std::unique_ptr<pbd::ClothSolver>(std::shared_ptr<const pbd::ClothModel>)>;

namespace detail {

/// A banner of (8 + 1) x (6 + 1) vertices, 5 cm apart, hanging from its top row along z = 0; the row below is blended.
struct Banner {
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

inline pbd::StepInputs inputs(const pbd::Vertices &previous, const pbd::Vertices &targets,
                              const std::vector<pbd::Capsule> &previous_capsules, const std::vector<pbd::Capsule> &capsules) {
  pbd::StepInputs in;
  in.targets = &targets;
  in.previous_targets = &previous;
  in.capsules = &capsules;
  in.previous_capsules = &previous_capsules;
  return in;
}

/// Shakes the banner for `frames` frames from frame `first` on while a rod beats through it.
inline void shake(const pbd::ClothSolver &solver, pbd::ClothState &state, const pbd::Vertices &rest,
                  const pbd::Material &material, int first, int frames) {
  const auto targets_at = [&](int f) {
    return pbd::Vertices(rest.rowwise() + Eigen::RowVector3d(0.1 * std::sin(0.5 * f), 0, 0.2 * std::sin(0.35 * f)));
  };
  const auto capsules_at = [](int f) {
    const double z = 0.3 * std::cos(0.4 * f);
    return std::vector<pbd::Capsule>{{{-0.2, 0.8, z}, {0.6, 0.8, z}, 0.04, 0.03}};
  };
  for (int f = first; f < first + frames; ++f) {
    const pbd::Vertices a = targets_at(f), b = targets_at(f + 1);
    const std::vector<pbd::Capsule> ca = capsules_at(f), cb = capsules_at(f + 1);
    solver.step(state, inputs(a, b, ca, cb), material);
  }
}

} // namespace detail

/// One sentence for each rule the solver breaks: rest state rests, pinned vertices obey, a copied state replays to the same bits,
/// step_many equals step, nothing becomes NaN at any corner of the material box.
inline std::vector<std::string> cloth_solver_violations(const ClothSolverFactory &make) {
  using namespace pbd;
  std::vector<std::string> broken;
  const detail::Banner banner;
  const std::vector<Capsule> none;
  const Material material;

  ClothOptions weightless;
  weightless.gravity.setZero();
  {
    const auto solver = make(ClothModel::create(banner.rest, banner.faces, banner.clothness, weightless));
    ClothState state = initial_state(banner.rest);
    for (int f = 0; f < 40; ++f)
      solver->step(state, detail::inputs(banner.rest, banner.rest, none, none), material);
    const double moved = (state.positions - banner.rest).rowwise().norm().maxCoeff();
    if (!(moved < 1e-4))
      broken.push_back("the rest state does not rest: without gravity a vertex moved " + std::to_string(moved) +
                       " m in 40 frames");
  }
  const auto model = ClothModel::create(banner.rest, banner.faces, banner.clothness);
  const auto solver = make(model);
  {
    ClothState state = initial_state(banner.rest);
    const Vertices moved = banner.rest.rowwise() + Eigen::RowVector3d(0.02, 0.01, -0.03);
    solver->step(state, detail::inputs(banner.rest, moved, none, none), material);
    const double off = (state.positions - moved).topRows(9).rowwise().norm().maxCoeff();
    if (!(off < 1e-5))
      broken.push_back("pinned vertices do not obey: one is " + std::to_string(off) + " m from its target");
  }
  {
    ClothState state = initial_state(banner.rest);
    detail::shake(*solver, state, banner.rest, material, 0, 20);
    ClothState copy = state;
    detail::shake(*solver, state, banner.rest, material, 20, 20);
    detail::shake(*solver, copy, banner.rest, material, 20, 20);
    if (state.positions != copy.positions || state.velocities != copy.velocities)
      broken.push_back("a copied state does not replay to the same bits");
  }
  {
    std::vector<ClothState> many(3, initial_state(banner.rest));
    std::vector<Material> materials(3, material);
    materials[1].d_n = 3;
    materials[2].k_bend = 0.1;
    solver->step_many(many, detail::inputs(banner.rest, banner.rest, none, none), materials);
    for (int i = 0; i < 3; ++i) {
      ClothState one = initial_state(banner.rest);
      solver->step(one, detail::inputs(banner.rest, banner.rest, none, none), materials[i]);
      if (one.positions != many[i].positions || one.velocities != many[i].velocities)
        broken.push_back("step_many differs from step for simulation " + std::to_string(i));
    }
  }
  for (int corner = 0; corner < 64; ++corner) {
    Material wild;
    for (int k = 0; k < 6; ++k) {
      const MaterialParameter &p = material_parameters()[k];
      wild.*p.value = corner >> k & 1 ? p.upper : p.lower;
    }
    if (wild.k_stretch == 0)
      wild.k_stretch = 0.01;
    ClothState state = initial_state(banner.rest);
    detail::shake(*solver, state, banner.rest, wild, 0, 30);
    if (!state.positions.allFinite() || !state.velocities.allFinite())
      broken.push_back("corner " + std::to_string(corner) + " of the material box gives values that are not finite");
  }
  return broken;
}

} // namespace doublet::testing
