#pragma once
// How far inside a silhouette a pixel lies, what the screen shows of itself there left out.

#include "doublet/core/image.h"

#include <vector>

namespace doublet::detail {

/// (H W) pixels to walk, along rows and columns, from each pixel out of the mask (0 = outside); the image's border is no rim.
std::vector<int> silhouette_depth(const Image &mask);

/// The masks of several cameras, one an image, without the gaps through which these show the screen: between fingers, between an
/// arm and the body, which whoever made the masks has closed. The screen's colour is the hue that half of an image outside the
/// mask shares. Pixels tinted by it are gaps if they lie within `reach` (a share of the image's smaller side) of the mask's rim,
/// and deeper inside if next to none of the actor has that colour there. As they are where the actor wears it, in the cameras all
/// together, and where there is no screen. Empty images and masks: no camera.
std::vector<Image> without_screen(const std::vector<Image> &images, const std::vector<Image> &masks, double reach);

} // namespace doublet::detail
