#pragma once
// What of the actor's surface is garment, and where that hangs.

#include "doublet/segment/garment_mesher.h"
#include "surface_piece.h"

namespace doublet::detail {

/// (F) 1 for the sheet that closes the scan below a hem: the invalid faces, what is left beside them that faces the way the
/// garment ends, and cloth beside skin that does, as between a cuff and the ankle.
std::vector<char> closing_sheet(const RiggedMesh &actor, const Segmentation &segmentation);

/// (F) 1 for pieces that `covered` (F) leaves, smaller than `largest` m^2, of which nothing lies on the body: undersides of the
/// cloth, and of the sheet. None without a body.
std::vector<char> scraps(const RiggedMesh &actor, const Mask &covered, const Mesh &body, double largest);

/// (V) above kCut where the region's garment is, below elsewhere; `sheet` (F) is none of it.
Eigen::VectorXd garment_field(const RiggedMesh &actor, const std::vector<char> &sheet, const Segmentation &segmentation,
                              int region, const GarmentOptions &options);

/// (N) at the vertices of the piece: 1 where the cut runs along skin, 0 where the surface beyond it is invented (a hem).
/// `smoothing`, m.
Eigen::VectorXd skin_around(const RiggedMesh &actor, const std::vector<char> &sheet, const Eigen::VectorXd &field,
                            const Piece &piece, double smoothing);

/// (N) at the boundary of the piece: cosine between the way out of it and the way along the surface that leads from its top, the
/// crown of the head, 1 at hems and cuffs, -1 at a waist or a collar, however that slopes. 0 inside.
Eigen::VectorXd leads_from_top(const RiggedMesh &actor, const Piece &piece);

/// (N) 1 at the vertices of the piece whose faces a limb moves most, 0 on the trunk.
Eigen::VectorXd on_limbs(const RiggedMesh &actor, const Piece &piece);

} // namespace doublet::detail
