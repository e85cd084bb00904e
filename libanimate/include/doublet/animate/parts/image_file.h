#pragma once
// Images as PNG or JPEG files in memory, the two forms that a GLB can hold.

#include "doublet/core/image.h"

namespace doublet {

/// PNG (lossless) of a 1- or 3-channel image. Throws std::invalid_argument if the image is empty.
std::vector<std::uint8_t> encode_png(const Image &image);
/// JPEG at the highest quality, without chroma subsampling: a fifth of the PNG for photographs.
std::vector<std::uint8_t> encode_jpeg(const Image &image);
/// 3 channels B G R. Throws Error if the bytes are no PNG or JPEG.
Image decode_image(const std::vector<std::uint8_t> &bytes);

} // namespace doublet
