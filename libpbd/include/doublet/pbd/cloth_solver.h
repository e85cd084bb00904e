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
  Compliance, ///< XPBD, Macklin et al. 2016: k is the share of the violation that one step of 1/40 s removes from a single
              ///< constraint, whatever the number of sweeps and substeps; 1 = rigid
};

inline constexpr std::array kStiffnessNames{"sweeps", "compliance"}; ///< in the order of Stiffness

/// The defaults are 24 sweeps per frame, as in the paper, but in 4 substeps of 6: with equally many sweeps cloth stretches far
/// less (docs/cloth.md). A material means the same for any number of sweeps and substeps.
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
        option(&O::iterations, "iterations", Range{1, 10000}, "", "Number of Gauss-Seidel sweeps per substep",
               "The paper has 24 per frame, in one step"),
        option(&O::substeps, "substeps", Range{1, 1000}, "", "Number of steps per frame",
               "Targets and proxies are interpolated; friction and damping are divided among them"),
        option(&O::stiffness, "stiffness", kStiffnessNames,
               "Meaning of k_bend and k_stretch: XPBD's compliance, or per sweep as in the paper",
               "With 'compliance' a material means the same for any number of sweeps and substeps"),
        option(&O::over_relaxation, "over_relaxation", Range{1, 1.6}, "",
               "Factor of stretch corrections, at most 1 + 16^(-1/iterations); only with 'compliance'",
               "The sweeps converge faster"),
        option(&O::rest_curvature, "rest_curvature", Range{0, 1}, "",
               "Rest angles of bending, as a share of the rest shape's dihedral angles; 0 = flat",
               "The rest shape of a garment is inflated, not sewn like that"),
        option(&O::gravity, "gravity", Range{-1000, 1000}, "m/s^2", "Acceleration of free cloth"),
        option(&O::restitution, "restitution", Range{0, 1}, "",
               "Share of the normal velocity that a contact reflects; 0 = inelastic",
               "Only above the velocity that gravity gives in two steps"),
        option(&O::thickness, "thickness", Range{0, 1}, "m", "Distance that is kept between cloth and proxies",
               "Covers the thickness of the cloth, edges that sag round a shin, and proxies slimmer than the body"),
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

/// The immutable data of a piece of cloth, shared by any number of solvers and states. Whatever a solver derives from it
/// (constraints, their order, neighbours) is stored in the solver.
class ClothModel {
public:
  /// rest (N, 3) m: defines rest lengths and angles. faces (F, 3). clothness (N) in [0, 1]: 0 = follows its target (infinite
  /// mass), 1 = free, between = pulled to its target with stiffness 1 - clothness. Throws std::invalid_argument on an empty or
  /// non-finite mesh, bad indices, degenerate faces, vertices without a face, wrong lengths.
  static std::shared_ptr<const ClothModel> create(const Vertices &rest, const Faces &faces, const Eigen::VectorXd &clothness,
                                                  const ClothOptions &options = {});
  int vertex_count() const { return static_cast<int>(rest_.rows()); }
  const Vertices &rest() const { return rest_; }                  ///< (N, 3) m
  const Faces &faces() const { return faces_; }                   ///< (F, 3)
  const Eigen::VectorXd &clothness() const { return clothness_; } ///< (N) in [0, 1]
  const ClothOptions &options() const { return options_; }
  /// (N) 1/m^2, 0 = pinned. The mass of a vertex is one third of the area of its faces.
  const Eigen::VectorXd &inverse_masses() const { return inverse_masses_; }

private:
  ClothModel(const Vertices &rest, const Faces &faces, const Eigen::VectorXd &clothness, const ClothOptions &options);
  Vertices rest_;
  Faces faces_;
  Eigen::VectorXd clothness_, inverse_masses_;
  ClothOptions options_;
};

/// Everything that changes during simulation; copy it to save, assign it to restore.
struct ClothState {
  Vertices positions;  ///< (N, 3) m
  Vertices velocities; ///< (N, 3) m/s
};

/// Inputs of one frame. A custom solver must respect all of them, except `substeps` if it has none. The data belongs to the
/// caller and is read only during the step.
struct StepInputs {
  VerticesView targets; ///< (N, 3) skinned positions at the end of the frame; may be empty if no vertex follows them
  /// (N, 3) the same at its start; pinned vertices move evenly from here; empty = they stand still at `targets`.
  VerticesView previous_targets;
  std::span<const Capsule> capsules; ///< proxies at the end of the frame; empty = there are none
  /// Proxies at its start, in the same order; empty = they stand still at `capsules`.
  std::span<const Capsule> previous_capsules;
  double dt = 1.0 / 40.0;                 ///< s, duration of the frame
  Eigen::Vector3d wind{0.0, 0.0, 0.0};    ///< m/s, drag acts on the velocity relative to it
  std::optional<Eigen::Vector3d> gravity; ///< m/s^2; none = the model's
  /// Number of substeps of the frame, the same in all inputs of a call; 0 = the model's. For frames of another duration than
  /// those with which a material was estimated: substeps should have about the same duration. In each substep a vertex of
  /// clothness between 0 and 1 follows its target as in one of the model's; k_friction and k_damping refer to the whole frame.
  int substeps = 0;
};

/// The swap point: advances simulations of one model by a frame. Derive from it and define advance().
/// Threads: all methods are const and are called from several at once on one solver, with different states: what a solver derives
/// from its model must be immutable, and memory that it reuses must be guarded.
class ClothSolver {
public:
  /// Throws std::invalid_argument if `model` is null.
  explicit ClothSolver(std::shared_ptr<const ClothModel> model);
  virtual ~ClothSolver() = default;
  /// The built-in solver; it steps simulations side by side in the lanes of the widest SIMD registers of this processor.
  static std::unique_ptr<ClothSolver> create(std::shared_ptr<const ClothModel> model);

  const ClothModel &model() const { return *model_; }
  /// Steps several simulations by one frame: states[i] with materials[i] and inputs[i], or inputs[0] if there is only one. The
  /// same bits as separate steps, whatever the other simulations and the number of threads. Returns, ascending, the indices of
  /// simulations that are not finite after the step; their states are unchanged. Throws std::invalid_argument, without stepping
  /// any, if counts differ or an input is wrong; std::logic_error if the solver violates the contract of advance().
  std::vector<int> step_batch(std::span<ClothState> states, std::span<const StepInputs> inputs,
                              std::span<const Material> materials, int threads = 1) const;
  /// The same for one simulation; throws std::runtime_error if it is not finite after the step.
  void step(ClothState &state, const StepInputs &inputs, const Material &material) const;
  template <class... A> [[deprecated("use step_batch")]] decltype(auto) step_each(A &&...a) const {
    return step_batch(std::forward<A>(a)...);
  }

private:
  /// Implements step_batch(). The arguments have been checked: as many materials as states, sizes of the model, all finite,
  /// targets present if a vertex follows them, equally many capsules at both ends of a frame and in all inputs. Must keep the
  /// sizes of the states and return ascending indices into them.
  virtual std::vector<int> advance(std::span<ClothState> states, std::span<const StepInputs> inputs,
                                   std::span<const Material> materials, int threads) const = 0;

  std::shared_ptr<const ClothModel> model_;
};

/// Creates the solver of a model; passed to classes whose solver can be swapped. Empty = ClothSolver::create.
using ClothSolverFactory = std::function<std::shared_ptr<const ClothSolver>(std::shared_ptr<const ClothModel>)>;

/// A state with these positions (N, 3), m, and velocities 0.
ClothState initial_state(const Vertices &positions);

} // namespace doublet::pbd
