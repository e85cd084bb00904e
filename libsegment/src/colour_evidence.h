#pragma once
// What a surface's colours say about what it is.

#include "surface_patches.h"

namespace doublet::detail {

/// (V) in [-1, 1]: how much more the colours around each vertex are like those of the first kind (1) or of the second (-1), which
/// each vertex is of by the weights `first` and `second` (V); 0 where they tell nothing. What no camera sees takes what its
/// surroundings say. `colours` as SegmentInputs::colours, of `faces`. The likelihood ratio of the histograms of both
/// (doublet/core/parts/colour_histogram.h).
Eigen::VectorXd colour_evidence(const Surface &surface, const Faces &faces, const std::vector<std::uint8_t> &face_valid,
                                const Vertices &colours, const Eigen::VectorXd &first, const Eigen::VectorXd &second);

} // namespace doublet::detail
