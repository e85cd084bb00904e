#include "limb_ends.h"

namespace doublet::detail {

std::vector<LimbEnd> limb_ends(const RiggedMesh &actor) {
  std::vector<LimbEnd> ends;
  for (int leaf = 0; leaf < actor.skeleton.joint_count(); ++leaf) {
    if (!actor.skeleton.is_leaf(leaf))
      continue;
    const int mover = actor.weights.col(leaf).maxCoeff() > 0.1 ? leaf : actor.skeleton.joints[leaf].parent;
    if (mover >= 0 && actor.skeleton.joints[mover].parent >= 0)
      ends.push_back({leaf, mover});
  }
  return ends;
}

} // namespace doublet::detail
