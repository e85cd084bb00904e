#pragma once
// The actor as the tracker takes it.

#include "doublet/core/stage_values.h"

namespace doublet {

struct TrackedActor {
  RiggedMesh actor;
  std::vector<int> kept; ///< (D) where each degree of freedom of the actor given is in this one
};

/// The actor with two changes.
///
/// Where a limb ends with a single hinge (an ankle), what follows may turn about the bone before it as well, by `most_turn` (rad)
/// each way: "l_ankle.turn". A foot turns in and out; a skeleton that denies it has to turn the whole leg, and the knee with it.
///
/// Its sheets are extended (extend_invalid_faces), so that a garment does not drag at the limb that it touches.
TrackedActor track_actor(const RiggedMesh &actor, double most_turn);

/// Bones of limbs: the joint at the end of each is a hinge (knee, ankle, elbow, wrist). (J) the end of the bone that starts at a
/// joint, -1 if that is no bone of a limb.
std::vector<int> limb_bones(const Skeleton &skeleton);

} // namespace doublet
