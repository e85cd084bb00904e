#pragma once
// What is known of clothes before any is seen.

#include "doublet/core/stage_values.h"

namespace doublet {

/// (V) log odds of loose cloth by place on the body, the same for all garments: below 0 on hands, feet and the head (beyond the
/// last joint of each limb), and on pieces of the scan that do not hang together with the trunk (a shank below a hem); 0
/// elsewhere. pose: the actor's surface in the scan pose. Throws as require_actor, std::invalid_argument if pose is of another
/// mesh, Error if it is unusable.
Eigen::VectorXd cloth_prior(const RiggedMesh &actor, const Mesh &pose);

/// (V) the vertex at the same place of the body's other side, -1 where there is none within 5 cm that faces the same way: bones
/// of joints "l_..." and "r_..." are mirrored onto each other, whatever the stance, others onto themselves. All -1 if no joint
/// has a side. Throws as require_actor, Error if no face is valid.
Eigen::VectorXi mirrored_vertices(const RiggedMesh &actor);

/// All is cloth but what surely is none (cloth_prior(): hands, feet, head, what hangs on no trunk): to a body that is fitted to
/// it nothing else is skin, so that it is within the surface and where the body model expects it to be. Throws as cloth_prior().
Segmentation dressed_all_over(const RiggedMesh &actor, const Mesh &pose);

} // namespace doublet
