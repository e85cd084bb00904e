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

/// A pose worked out once and shared by every sample: skinned surface, proxies.
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

/// Memory of a step; who keeps it from one to the next has nothing allocated.
struct StepBuffers {
  std::vector<Vertices> targets, previous_targets; ///< [region]
};

/// One piece of cloth: the valid faces of M with a vertex of this region, and the rigid ring they hang from.
struct ClothRegion {
  std::vector<int> vertex_from_cloth; ///< (N) index into M
  std::shared_ptr<const pbd::ClothModel> model;
  std::shared_ptr<const pbd::ClothSolver> solver;
};

/// Simulated state of all regions.
struct CharacterState {
  std::vector<pbd::ClothState> regions;
};

/// An index into the states of step_batch, and one into their regions.
struct DivergedRegion {
  int character, region;
};

/// A copy is cheap beside what it does: models and solvers are shared.
/// A frame of another character is refused with std::invalid_argument.
/// Threads: all methods are const and may be called from several at once, with different states and buffers.
class CharacterSimulator {
public:
  /// Throws as require_actor. A character without cloth (no region) is legal: skinning alone. make_solver: of each region.
  CharacterSimulator(const RiggedMesh &actor, const Segmentation &segmentation, const std::vector<TaperedCapsule> &proxies,
                     const pbd::ClothOptions &options = {}, const pbd::ClothSolverFactory &make_solver = {});

  const std::vector<ClothRegion> &regions() const { return regions_; }
  const RiggedMesh &actor() const { return actor_; }
  const pbd::ClothOptions &options() const { return options_; }
  /// Does cloth begin a motion at its rest shape, rather than at a captured surface?
  bool has_rest_shape() const { return start_shape_.rows() > 0; }
  PosedFrame pose(const Eigen::VectorXd &dofs) const;
  /// The same into a frame whose memory is used again.
  void pose(const Eigen::VectorXd &dofs, PosedFrame &frame) const;
  /// Cloth at rest: at `surface` (V, 3), e.g. a captured frame, if given; else spread out, at its skinned rest shape if the
  /// clothness has one, and bones pass through it no more than through the scan's cloth (an arm that is not in its sleeve there
  /// stays out of it); else at its skinned position.
  CharacterState start(const PosedFrame &frame, const Vertices *surface = nullptr) const;
  /// Starts the cloth at poses[0], as start() does, and simulates it through all poses (see lead_in_poses), world.dt s apart.
  /// Throws std::invalid_argument if there is no pose, and as step().
  CharacterState drape_along(std::span<const PosedFrame> poses, const std::vector<pbd::Material> &materials,
                             const StepEnvironment &world) const;
  /// Moves the cloth from one pose to another as one rigid body, with the root.
  void move_rigidly(CharacterState &state, const PosedFrame &from, const PosedFrame &to) const;
  /// Lets the cloth fall into place in a still pose for `frames` frames.
  void settle(CharacterState &state, const PosedFrame &frame, const std::vector<pbd::Material> &materials, double dt,
              int frames) const;
  /// Advances every region from one posed frame to the next; materials: one a region. Throws Error if a region comes out not
  /// finite; it stays as it was.
  void step(CharacterState &state, const PosedFrame &previous, const PosedFrame &current,
            const std::vector<pbd::Material> &materials, double dt) const;
  /// The same in a world with wind, and without an allocation once warm.
  void step(CharacterState &state, const PosedFrame &previous, const PosedFrame &current,
            const std::vector<pbd::Material> &materials, const StepEnvironment &world, StepBuffers &buffers) const;
  /// The same for several characters side by side (see pbd::ClothSolver::step_batch): each gets the bits of a step of its own. A
  /// region that comes out not finite stays as it was. Returns those, ordered by region, then character.
  std::vector<DivergedRegion> step_batch(std::span<CharacterState *const> states, const PosedFrame &previous,
                                         const PosedFrame &current, std::span<const std::vector<pbd::Material> *const> materials,
                                         double dt) const;
  /// The same for characters that move each in its own way: previous[i], current[i] are those of states[i].
  std::vector<DivergedRegion> step_batch(std::span<CharacterState *const> states, std::span<const PosedFrame *const> previous,
                                         std::span<const PosedFrame *const> current,
                                         std::span<const std::vector<pbd::Material> *const> materials,
                                         std::span<const StepEnvironment> worlds, int threads = 1) const;
  /// Of one region of several characters alone, all with the same poses: what step_batch() does region by region, for those who
  /// step each region of a character with another simulator, such as one of another rest shape. Returns the states that failed.
  std::vector<int> step_region(int region, std::span<CharacterState *const> states, const PosedFrame &previous,
                               const PosedFrame &current, std::span<const std::vector<pbd::Material> *const> materials,
                               double dt) const;
  /// As many regions and vertices as the character's; else std::invalid_argument naming the caller.
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

/// Poses (D) that lead in from the rest pose, with its root where `dofs` has it, to `dofs`, `dt` s apart, in 0.6 s: there the
/// cloth is draped first (CharacterSimulator::drape_along). `dofs` alone where no angle is over 20 degrees from the rest pose.
/// A rest shape that the skin weights carry to a lunge or a crouch is several times as long as at rest, and would spring back
/// through itself.
std::vector<Eigen::VectorXd> lead_in_poses(const Skeleton &skeleton, const Eigen::VectorXd &dofs, double dt);

// Deprecated names.
using FailedRegion [[deprecated("use DivergedRegion")]] = DivergedRegion;
using World [[deprecated("use StepEnvironment")]] = StepEnvironment;
template <class... A> [[deprecated("use lead_in_poses")]] decltype(auto) way_in(A &&...a) {
  return lead_in_poses(std::forward<A>(a)...);
}

} // namespace doublet
