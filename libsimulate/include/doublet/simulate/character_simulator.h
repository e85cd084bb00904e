#pragma once
// The forward model of Sect. 6.1: pose in, surface out. The estimator (libfit) runs exactly this.

#include "doublet/core/skinning.h"
#include "doublet/core/stage_values.h"
#include "doublet/pbd/cloth_solver.h"

#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace doublet {

/// A posed character without cloth simulation, computed once and shared by all samples: skinned surface, proxies.
struct PosedFrame {
  Vertices skinned;                   ///< (V, 3) M by dual quaternion skinning
  std::vector<Capsule> capsules;      ///< proxies in the world
  Transforms world_from_rest;         ///< (J)
  std::vector<DualQuaternion> joints; ///< (J) the same, with signs along the skeleton
};

/// What acts on the cloth during a step.
struct StepEnvironment {
  double dt = 1.0 / 40;                   ///< s, from one posed frame to the next
  Eigen::Vector3d wind{0.0, 0.0, 0.0};    ///< m/s
  std::optional<Eigen::Vector3d> gravity; ///< m/s^2; none = that of the cloth's options
  int substeps = 0;                       ///< of the step, see pbd::StepInputs; 0 = those of the cloth's options
};

/// Memory of a step; if it is reused for the next one, nothing is allocated.
struct StepBuffers {
  std::vector<Vertices> targets, previous_targets; ///< [region]
};

/// One piece of cloth: the valid faces of M with a vertex of this region, including the rigid vertices that it is attached to.
struct ClothRegion {
  std::vector<int> vertex_from_cloth; ///< (N) index into M
  std::shared_ptr<const pbd::ClothModel> model;
  std::shared_ptr<const pbd::ClothSolver> solver;
};

/// Simulation state of all regions.
struct CharacterState {
  std::vector<pbd::ClothState> regions;
};

/// Index of a state of step_batch, and of one of its regions.
struct DivergedRegion {
  int character, region;
};

/// Copies share models and solvers. All methods throw std::invalid_argument for a frame of another character.
/// Threads: all methods are const and may be called from several at once, with different states and buffers.
class CharacterSimulator {
public:
  /// make_solver: called for each region. A character without cloth (no region) is allowed: it is only skinned. Throws as
  /// require_actor.
  CharacterSimulator(const RiggedMesh &actor, const Segmentation &segmentation, const std::vector<TaperedCapsule> &proxies,
                     const pbd::ClothOptions &options = {}, const pbd::ClothSolverFactory &make_solver = {});

  const std::vector<ClothRegion> &regions() const { return regions_; }
  const RiggedMesh &actor() const { return actor_; }
  const pbd::ClothOptions &options() const { return options_; }
  /// True if cloth begins a motion at its rest shape, not at a captured surface.
  bool has_rest_shape() const { return start_shape_.rows() > 0; }
  PosedFrame pose(const Eigen::VectorXd &dofs) const;
  /// The same into a frame whose memory is reused.
  void pose(const Eigen::VectorXd &dofs, PosedFrame &frame) const;
  /// Cloth with velocity 0. Its positions: `surface` (V, 3), e.g. a captured frame, if given; else the skinned rest shape if the
  /// segmentation has one and it is penetrated by no more bones than the scan's cloth (so that an arm that is outside its sleeve
  /// in the scan stays outside); else the skinned positions.
  CharacterState start(const PosedFrame &frame, const Vertices *surface = nullptr) const;
  /// Starts the cloth at poses[0] with start() and simulates it through all poses (see lead_in_poses), which are world.dt s
  /// apart. Throws std::invalid_argument if `poses` is empty, and as step().
  CharacterState drape_along(std::span<const PosedFrame> poses, const std::vector<pbd::Material> &materials,
                             const StepEnvironment &world) const;
  /// Moves the cloth from one pose to another as one rigid body, with the root.
  void move_rigidly(CharacterState &state, const PosedFrame &from, const PosedFrame &to) const;
  /// Simulates `frames` frames in a fixed pose, so that the cloth settles.
  void settle(CharacterState &state, const PosedFrame &frame, const std::vector<pbd::Material> &materials, double dt,
              int frames) const;
  /// Advances every region from one posed frame to the next; materials: one per region. Throws Error if a region is not finite
  /// after the step; its state is then unchanged.
  void step(CharacterState &state, const PosedFrame &previous, const PosedFrame &current,
            const std::vector<pbd::Material> &materials, double dt) const;
  /// The same with wind and gravity, without allocations once the buffers have been used.
  void step(CharacterState &state, const PosedFrame &previous, const PosedFrame &current,
            const std::vector<pbd::Material> &materials, const StepEnvironment &world, StepBuffers &buffers) const;
  /// The same for several states side by side (see pbd::ClothSolver::step_batch), with the same bits as separate steps. Returns
  /// the regions that are not finite after the step, ordered by region, then state; their states are unchanged.
  std::vector<DivergedRegion> step_batch(std::span<CharacterState *const> states, const PosedFrame &previous,
                                         const PosedFrame &current, std::span<const std::vector<pbd::Material> *const> materials,
                                         double dt) const;
  /// The same with a motion for each state: previous[i], current[i] belong to states[i].
  std::vector<DivergedRegion> step_batch(std::span<CharacterState *const> states, std::span<const PosedFrame *const> previous,
                                         std::span<const PosedFrame *const> current,
                                         std::span<const std::vector<pbd::Material> *const> materials,
                                         std::span<const StepEnvironment> worlds, int threads = 1) const;
  /// step_batch() for one region only, all states with the same poses: for callers that use a different simulator for each
  /// region, such as one with another rest shape. Returns the indices of states that are not finite after the step.
  std::vector<int> step_region(int region, std::span<CharacterState *const> states, const PosedFrame &previous,
                               const PosedFrame &current, std::span<const std::vector<pbd::Material> *const> materials,
                               double dt) const;
  /// Throws std::invalid_argument naming `caller` unless the state has the character's regions and vertices.
  void require_state(const CharacterState &state, const char *caller) const;
  /// (V, 3): skinned vertices, cloth vertices replaced by the simulated ones.
  Vertices surface(const CharacterState &state, const PosedFrame &frame) const;
  void surface(const CharacterState &state, const PosedFrame &frame, Vertices &surface) const;
  template <class... A> [[deprecated("use step_batch")]] decltype(auto) step_each(A &&...a) const {
    return step_batch(std::forward<A>(a)...);
  }
  template <class... A> [[deprecated("use drape_along")]] decltype(auto) put_on(A &&...a) const {
    return drape_along(std::forward<A>(a)...);
  }
  template <class... A> [[deprecated("use move_rigidly")]] decltype(auto) carry(A &&...a) const {
    return move_rigidly(std::forward<A>(a)...);
  }

private:
  std::vector<int> step_region(int region, std::span<CharacterState *const> states, std::span<const PosedFrame *const> previous,
                               std::span<const PosedFrame *const> current,
                               std::span<const std::vector<pbd::Material> *const> materials,
                               std::span<const StepEnvironment> worlds, int threads) const;
  void pin(CharacterState &state, const PosedFrame &frame) const;
  /// As many vertices and joints as the character's; else std::invalid_argument naming the caller.
  void require_frame(const PosedFrame &frame, const char *caller) const;
  RiggedMesh actor_;
  std::vector<TaperedCapsule> proxies_;
  pbd::ClothOptions options_;
  std::vector<ClothRegion> regions_;
  SkinBinding skin_;
  Vertices start_shape_; ///< (V, 3) from which cloth falls into place, in the rest pose; empty = has no rest shape
};

/// Poses (D) from the rest pose, with the root of `dofs`, to `dofs`, `dt` s apart, in 0.6 s, for CharacterSimulator::drape_along.
/// Only `dofs` if no angle differs by more than 20 degrees from the rest pose. The reason: a rest shape that is skinned to a
/// lunge or a crouch is stretched several times, and would spring back through itself.
std::vector<Eigen::VectorXd> lead_in_poses(const Skeleton &skeleton, const Eigen::VectorXd &dofs, double dt);

// Deprecated names.
using FailedRegion [[deprecated("use DivergedRegion")]] = DivergedRegion;
using World [[deprecated("use StepEnvironment")]] = StepEnvironment;
template <class... A> [[deprecated("use lead_in_poses")]] decltype(auto) way_in(A &&...a) {
  return lead_in_poses(std::forward<A>(a)...);
}

} // namespace doublet
