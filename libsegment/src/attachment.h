#pragma once
// What of the cloth is carried by the body, and what hangs free.

#include "doublet/segment/garment_mesher.h"

#include <vector>

namespace doublet::detail {

/// (V) in [0, 1]: 1 where the cloth's slack is below `snug_slack`, so that the body carries it, 0 where it hangs free; pieces
/// smaller than `min_piece_area` go with what is around them. 0 everywhere if the slack was not measured.
Eigen::VectorXd attachment_of(const RiggedMesh &actor, const Segmentation &segmentation, const GarmentOptions &options);

/// [R] of which regions anything hangs free.
std::vector<char> free_regions(const RiggedMesh &actor, const Segmentation &segmentation, const Eigen::VectorXd &attachment);

/// The segmentation in which the regions that are not `kept` [R] are skin.
Segmentation with_regions(const Segmentation &segmentation, const std::vector<char> &kept);

} // namespace doublet::detail
