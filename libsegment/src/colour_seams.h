#pragma once
// Garments that touch: two of different fabrics are two regions.

#include "colour_evidence.h"
#include "doublet/segment/cloth_segmenter.h"

namespace doublet::detail {

/// (V) vertices along which cloth of two looks meets and moves little: a shirt and the skirt that it ends at. Both sides are at
/// least a garment (`min_piece_area`), each looks little like the other, and the seam moves less (`segmentation.sigma`, m) than
/// what it holds: a hem that flies in front of another garment is none, nor is a fold's shade. `inputs` have colours.
std::vector<char> colour_seams(const Surface &surface, const SegmentInputs &inputs, const Segmentation &segmentation);

} // namespace doublet::detail
