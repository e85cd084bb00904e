#pragma once
#include <opencv2/core.hpp>
#include <string>

namespace doublet::detail {

/// BGR of a JPEG file's bytes, turned as its EXIF data say. Throws Error saying what is wrong.
cv::Mat decode_jpeg(const std::string &data);

} // namespace doublet::detail
