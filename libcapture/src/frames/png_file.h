#pragma once
#include <opencv2/core.hpp>
#include <string>

namespace doublet::detail {

/// BGR of a PNG file's bytes. Throws Error saying what is wrong.
cv::Mat decode_png(const std::string &data);

} // namespace doublet::detail
