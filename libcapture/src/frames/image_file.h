#pragma once
// One image file of any format.

#include "doublet/core/error.h"

#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <opencv2/core.hpp>

namespace doublet::detail {

/// BGR, 8 bits per channel; 16 bits lose the lower ones, alpha is left out, EXIF data turn it. PNG, JPEG, PPM and BMP are decoded
/// here, whatever else ffmpeg knows by that. Throws FileNotFound, or Error naming the file.
cv::Mat read_image(const std::filesystem::path &path);

/// The next binary PPM of 8 bits in a file or pipe; false if there is none, or not a whole one.
bool read_ppm(std::FILE *file, cv::Mat &image);
class Oversized : public Error {
public:
  using Error::Error;
};
/// Throws Oversized for an image that is larger than any camera's, before there is memory for it.
void require_bounded(std::int64_t width, std::int64_t height);

} // namespace doublet::detail
