#pragma once
#include "doublet/core/image.h"

namespace doublet {

/// Drops foreground islands, then background holes, with fewer than `min_blob_area` pixels (of an image of 1004 x 1004).
void clean_mask(Image &mask, int min_blob_area);

/// Throws std::invalid_argument unless the image has three channels and pixels.
void require_colour(const Image &image);

} // namespace doublet
