#pragma once
// The forward model of Sect. 6.1: pose in, surface out. The estimator (libfit) runs exactly this.

#include "doublet/core/stage_values.h"
#include "doublet/pbd/cloth_solver.h"

#include <memory>
#include <span>
#include <vector>

namespace doublet {

/// A pose worked out once and shared by every sample: skinned surface, proxies.
struct PosedFrame {
  Vertices skinned;                   ///< (V, 3) M by dual quaternion skinning
  std::vector<pbd::Capsule> capsules; ///< proxies in the world
  Transforms world_from_rest;         ///< (J)
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

/// An index into the states of step_each, and one into their regions.
struct FailedRegion {
  int character, region;
};

class CharacterSimulator {
public:
  /// Throws as require_actor. A character without cloth (no region) is legal: skinning alone. make_solver: of each region.
  CharacterSimulator(const RiggedMesh &actor, const Segmentation &segmentation, const std::vector<TaperedCapsule> &proxies,
                     const pbd::ClothOptions &options = {}, const pbd::ClothSolverFactory &make_solver = {});

  const std::vector<ClothRegion> &regions() const { return regions_; }
  const RiggedMesh &actor() const { return actor_; }
  const pbd::ClothOptions &options() const { return options_; }
  /// Does cloth begin a motion at its rest shape, rather than at a captured surface?
  bool has_rest_shape() const { return rest_.rows() > 0; }
  PosedFrame pose(const Eigen::VectorXd &dofs) const;
  /// Cloth at rest: at `surface` (V, 3), e.g. a captured frame, if given; else spread out, at its skinned rest shape if the
  /// clothness has one; else at its skinned position.
  CharacterState start(const PosedFrame &frame, const Vertices *surface = nullptr) const;
  /// Lets the cloth fall into place in a still pose for `frames` frames.
  void settle(CharacterState &state, const PosedFrame &frame, const std::vector<pbd::Material> &materials, double dt,
              int frames) const;
  /// Advances every region from one posed frame to the next; materials: one a region.
  void step(CharacterState &state, const PosedFrame &previous, const PosedFrame &current,
            const std::vector<pbd::Material> &materials, double dt) const;
  /// The same for several characters side by side (see pbd::ClothSolver::step_each): each gets the bits of a step of its own. A
  /// region that comes out not finite stays as it was. Returns those, ordered by region, then character.
  std::vector<FailedRegion> step_each(std::span<CharacterState *const> states, const PosedFrame &previous,
                                      const PosedFrame &current, std::span<const std::vector<pbd::Material> *const> materials,
                                      double dt) const;
  /// (V, 3): skinned vertices, cloth vertices replaced by the simulated ones.
  Vertices surface(const CharacterState &state, const PosedFrame &frame) const;

private:
  RiggedMesh actor_;
  std::vector<TaperedCapsule> proxies_;
  pbd::ClothOptions options_;
  std::vector<ClothRegion> regions_;
  Vertices rest_; ///< (V, 3) of the clothness; may be empty
};

} // namespace doublet
