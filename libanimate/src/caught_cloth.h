#pragma once
// Whether cloth is caught: has passed through itself, or has a limb through it.

#include "doublet/animate/character.h"
#include "doublet/simulate/character_simulator.h"

#include <vector>

namespace doublet::detail {

/// Looks at the cloth of one character.
class CaughtCloth {
public:
  /// Both must outlive it.
  CaughtCloth(const Character &character, const CharacterSimulator &simulator);
  /// Is all of it in a knot, or does a bone pass through it? A quick look: some edges, and the bones that do not pass through the
  /// cloth in the scan pose. `surfaces`: for a while; once it has been used nothing is allocated.
  bool is_caught(const CharacterState &cloth, const PosedFrame &posed, std::vector<Mesh> &surfaces) const;
  /// The share of the faces that pass through others, unless that is small, and as much as a knot of all of it for each proxy
  /// whose axis passes through the cloth: where the body passes through itself one may be through any cloth.
  double faults_of(const CharacterState &cloth, const PosedFrame &posed) const;

private:
  const Skeleton &skeleton_;
  const CharacterSimulator &simulator_;
  std::vector<std::vector<Eigen::Vector2i>> edges_; ///< [region] some of its edges
  std::vector<int> bones_;                          ///< joints at whose end they are
};

} // namespace doublet::detail
