#pragma once
// Cloth that lies on the body, beside cloth that does not.

#include "doublet/core/context.h"
#include "doublet/segment/cloth_segmenter.h"
#include "surface_patches.h"

namespace doublet::detail {

/// (V) m, how far each vertex slides over the body: the RMS deviation, along the surface, of its place in the scan pose
/// (`unposed`) from its mean. Without the frames of `trim` in which it is farthest.
Eigen::VectorXd sliding_deviation(const std::vector<Vertices> &unposed, const Vertices &normals, double trim,
                                  const Context &context);

/// `cloth` (V) and what of the surface beside it is more like it than like skin. Skin moves a little, too, but what it moves, the
/// noise of the capture and the errors of its weights, is much the same in a neighbourhood: cloth is what moves `contrast` times
/// as much as the skin nearest to it, in the mean of sigma and `slide` (their ratios multiplied, the root of it). Grows from
/// `cloth` along the surface, not through seams.
std::vector<char> with_snug_cloth(const Surface &surface, const Eigen::VectorXd &sigma, const Eigen::VectorXd &slide,
                                  std::vector<char> cloth, const SegmentOptions &options);

} // namespace doublet::detail
