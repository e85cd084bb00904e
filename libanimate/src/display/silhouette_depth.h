#pragma once
// How far inside a silhouette a pixel lies, what the screen shows of itself there left out.

#include "doublet/core/image.h"

#include <vector>

namespace doublet::detail {

/// (H W) pixels to walk, along rows and columns, from each pixel out of the mask (0 = outside); the image's border is no rim.
std::vector<int> silhouette_depth(const Image &mask);

/// `mask` without the pixels tinted by the screen that lie within `reach` (a share of the image's smaller side) of its rim:
/// gaps between fingers that whoever made the mask has closed. The screen's colour is the hue that half of the image outside
/// the mask shares. As it is where there is none, and where the actor wears it: where pixels deeper inside have it, too.
Image without_screen(const Image &image, const Image &mask, double reach);

} // namespace doublet::detail
