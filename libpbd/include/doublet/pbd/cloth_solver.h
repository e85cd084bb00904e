#pragma once
// Position-based cloth (Mueller et al. 2007; Stoll et al. 2010, Sect. 6). Immutable ClothModel + copyable ClothState; no globals.

#include "doublet/options/options.h"
#include "doublet/pbd/material.h"
#include "doublet/types/geometry.h"

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace doublet::pbd {

using doublet::Capsule;
using doublet::Faces;
using doublet::Vertices;
using doublet::VerticesView;

/// What k_bend and k_stretch of a Material mean.
enum class Stiffness {
  Sweeps, ///< Mueller et al. 2007, Sect. 3.3, and the paper: every sweep removes 1 - (1 - k)^(1 / iterations) of the violation
  Compliance, ///< XPBD, Macklin et al. 2016: k is the share that one step of 1/40 s removes from a constraint by itself, whatever
              ///< the number of sweeps and substeps; 1 = rigid
};

inline constexpr std::array kStiffnessNames{"sweeps", "compliance"}; ///< in the order of Stiffness

/// The defaults are 24 sweeps a frame, as in the paper, but in 4 substeps of 6, and a material means the same whatever they are:
/// at equal sweeps cloth stretches far less (docs/cloth.md).
struct ClothOptions {
  int iterations = 6;
  int substeps = 4;
  Stiffness stiffness = Stiffness::Compliance;
  double over_relaxation = 1.5;
  double rest_curvature = 0.0;
  Eigen::Vector3d gravity{0.0, -9.81, 0.0};
  double restitution = 0.0;
  double thickness = 0.012;
  double self_thickness = 0.004;
  bool self_collision = true;
  bool edge_collision = false;
  static constexpr auto describe() {
    using namespace options;
    using O = ClothOptions;
    return Description{
        "ClothOptions",
        option(&O::iterations, "iterations", Range{1, 10000}, "", "Number of Gauss-Seidel sweeps in a substep",
               "The paper has 24 a frame, in one step"),
        option(&O::substeps, "substeps", Range{1, 1000}, "", "Number of steps in a frame",
               "Targets and proxies are interpolated, friction and damping shared out"),
        option(&O::stiffness, "stiffness", kStiffnessNames,
               "Meaning of k_bend and k_stretch: XPBD's compliance, or by sweeps as in the paper",
               "Under 'compliance' a material means the same whatever the sweeps and substeps"),
        option(&O::over_relaxation, "over_relaxation", Range{1, 1.6}, "",
               "Factor of stretch corrections, at most 1 + 16^(-1/iterations); under 'compliance' alone",
               "The same sweeps come further"),
        option(&O::rest_curvature, "rest_curvature", Range{0, 1}, "",
               "Share of the rest mesh's angles that bending keeps; 0 = cut flat",
               "A garment's rest shape is blown up, not sewn so"),
        option(&O::gravity, "gravity", Range{-1000, 1000}, "m/s^2", "Acceleration of free cloth"),
        option(&O::restitution, "restitution", Range{0, 1}, "",
               "Share of the normal velocity that a contact reflects; 0 = inelastic",
               "Only of what arrives faster than two steps of gravity"),
        option(&O::thickness, "thickness", Range{0, 1}, "m", "Distance that is kept between cloth and proxies",
               "Its own, the sag of an edge round a shin, and what the proxies are slimmer than the body"),
        option(&O::self_thickness, "self_thickness", Range{0, 1}, "m", "Distance that is kept between cloth and itself",
               "Pairs that are closer at rest are left alone"),
        option(&O::self_collision, "self_collision", "Cloth collides with itself"),
        option(&O::edge_collision, "edge_collision", "Edges collide with edges, too, where cloth collides with itself"),
    };
  }
  /// 24 sweeps and one step, stiffness by sweeps, the angles of the rest mesh.
  static ClothOptions paper() {
    ClothOptions options;
    options.iterations = 24;
    options.substeps = 1;
    options.stiffness = Stiffness::Sweeps;
    options.over_relaxation = 1;
    options.rest_curvature = 1;
    options.thickness = 0.004;
    return options;
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
};

/// What a piece of cloth is: plain data that never changes, shared by any number of solvers and states. What a solver derives
/// from it (constraints, their order, neighbours) is the solver's own.
class ClothModel {
public:
  /// rest (N, 3) m: rest lengths and angles come from here. faces (F, 3). clothness (N) in [0, 1]: 0 = follows its target
  /// (infinite mass), 1 = free, between = blended with stiffness 1 - clothness.
  /// Throws std::invalid_argument on an empty or non-finite mesh, bad indices, degenerate faces, vertices without a face, wrong
  /// lengths.
  static std::shared_ptr<const ClothModel> create(const Vertices &rest, const Faces &faces, const Eigen::VectorXd &clothness,
                                                  const ClothOptions &options = {});
  int vertex_count() const { return static_cast<int>(rest_.rows()); }
  const Vertices &rest() const { return rest_; }                  ///< (N, 3) m
  const Faces &faces() const { return faces_; }                   ///< (F, 3)
  const Eigen::VectorXd &clothness() const { return clothness_; } ///< (N) in [0, 1]
  const ClothOptions &options() const { return options_; }
  /// (N) 1/m^2, 0 = pinned. A mass is one third of the areas around.
  const Eigen::VectorXd &inverse_masses() const { return inverse_masses_; }

private:
  ClothModel(const Vertices &rest, const Faces &faces, const Eigen::VectorXd &clothness, const ClothOptions &options);
  Vertices rest_;
  Faces faces_;
  Eigen::VectorXd clothness_, inverse_masses_;
  ClothOptions options_;
};

/// Everything that changes; copy it to save, assign it to restore.
struct ClothState {
  Vertices positions;  ///< (N, 3) m
  Vertices velocities; ///< (N, 3) m/s
};

/// What the world does during one frame. A solver of your own heeds all of it but `substeps`, if it has none. What it looks at
/// belongs to the caller and is looked at during the step alone.
struct StepInputs {
  VerticesView targets; ///< (N, 3) skinned positions at the end of the frame; may be empty if no vertex follows them
  /// (N, 3) at its start, from where pinned vertices move evenly; empty = they stand still in `targets`.
  VerticesView previous_targets;
  std::span<const Capsule> capsules; ///< proxies at the end of the frame; empty = there are none
  /// At its start, in the same order; empty = they stand still as `capsules`.
  std::span<const Capsule> previous_capsules;
  double dt = 1.0 / 40.0;                 ///< s, the frame
  Eigen::Vector3d wind{0.0, 0.0, 0.0};    ///< m/s, drag acts on the velocity relative to it
  std::optional<Eigen::Vector3d> gravity; ///< m/s^2; none = the model's
  /// Number of substeps that the frame is cut into, the same in all inputs of a call; 0 = the model's. For frames of another
  /// length than those a material was estimated in, whose substeps should be about as long. A vertex of clothness between 0 and 1
  /// follows its target in each of them as in one of the model's; k_friction and k_damping are shares of this frame.
  int substeps = 0;
};

/// The swap point: advances simulations of one model by a frame. Derive and define advance().
/// Threads: all methods are const and are called from several at once on one solver, with different states: what a solver derives
/// from its model is immutable, and memory that it uses again is its own to guard.
class ClothSolver {
public:
  /// Throws std::invalid_argument if there is no model.
  explicit ClothSolver(std::shared_ptr<const ClothModel> model);
  virtual ~ClothSolver() = default;
  /// Steps simulations side by side in the lanes of the widest registers that this processor has.
  static std::unique_ptr<ClothSolver> create(std::shared_ptr<const ClothModel> model);

  const ClothModel &model() const { return *model_; }
  /// One frame of several simulations that differ in state and material, or in inputs, too (windows of one motion): states[i] is
  /// stepped with inputs[i], or inputs[0] if there is but one, and materials[i]. The same bits as one step each, in any company
  /// and on any number of threads. Returns, ascending, the simulations that came out not finite, whose states are left alone.
  /// Throws std::invalid_argument, and steps none, if counts differ or an input is wrong; std::logic_error if the solver itself
  /// breaks its word (see advance()).
  std::vector<int> step_batch(std::span<ClothState> states, std::span<const StepInputs> inputs,
                              std::span<const Material> materials, int threads = 1) const;
  /// The same for one simulation; throws std::runtime_error if it comes out not finite.
  void step(ClothState &state, const StepInputs &inputs, const Material &material) const;
  template <class... A> [[deprecated("use step_batch")]] decltype(auto) step_each(A &&...a) const {
    return step_batch(std::forward<A>(a)...);
  }

private:
  /// What step_batch() promises, of arguments that have been checked: as many materials as states, sizes those of the model, all
  /// finite, targets there if a vertex follows them, equally many capsules at both ends of a frame and in all inputs. Must keep
  /// the sizes of the states and return ascending indices into them.
  virtual std::vector<int> advance(std::span<ClothState> states, std::span<const StepInputs> inputs,
                                   std::span<const Material> materials, int threads) const = 0;

  std::shared_ptr<const ClothModel> model_;
};

/// Makes the solver of a model: what those take who let the solver be swapped. Empty = ClothSolver::create.
using ClothSolverFactory = std::function<std::shared_ptr<const ClothSolver>(std::shared_ptr<const ClothModel>)>;

/// positions = rest positions of the model's targets, velocities zero.
ClothState initial_state(const Vertices &positions);

} // namespace doublet::pbd
