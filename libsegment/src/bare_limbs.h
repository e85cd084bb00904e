#pragma once
// Limbs below a hem that were tracked badly, and are one surface with the garment.

#include "doublet/core/context.h"
#include "doublet/core/stage_values.h"
#include "surface_patches.h"

namespace doublet::detail {

/// Does nothing follow on the joint? It then marks the end of a hand, a foot or the head.
bool is_leaf(const Skeleton &skeleton, int joint);

/// (V) 1 for the limb that ends in `end` (vertices of a foot or a hand), up to where what is around it gets suddenly wider: a
/// hem. Where it does not, the answer is empty. A limb widens, too, but slowly.
std::vector<char> limb_below_hem(const Surface &surface, const std::vector<int> &end);

/// Nobody wears loose cloth on hands and feet, of which the tracker has most to get wrong. If more than half of one is cloth, the
/// limb below the hem is none (limb_below_hem), and the context says so. `pose`: the vertices of the segmentation.
void strip_bare_limbs(const RiggedMesh &actor, const Mesh &pose, Segmentation &segmentation, const Context &context);

} // namespace doublet::detail
