#pragma once
// What is known about the place of clothes on a body before any measurement.

#include "doublet/core/stage_values.h"

namespace doublet {

/// (V) log odds of cloth by place on the body, the same for all garments: -4 (2 %) on hands, feet and the head (rising to 0 at
/// the last joint of the limb), and on pieces of the scan that are not connected with the trunk (a shank below a hem); 0
/// elsewhere. Throws as require_actor.
Eigen::VectorXd cloth_prior(const RiggedMesh &actor);

/// (V) the vertex at the same place of the body's other side, -1 where there is none within 5 cm that faces the same way: bones
/// of joints "l_..." and "r_..." are mirrored onto each other, whatever the stance, others onto themselves. All -1 if no joint
/// has a side. Throws as require_actor, Error if no face is valid.
Eigen::VectorXi mirrored_vertices(const RiggedMesh &actor);

/// Everything is cloth except what is skin by its place (cloth_prior() in the lower half: hands, feet, head, pieces not connected
/// with the trunk). A body that is fitted to this segmentation lies within the surface, where the body model expects it. Throws
/// as cloth_prior().
Segmentation dressed_all_over(const RiggedMesh &actor);

} // namespace doublet
