#pragma once
// 8-bit images as plain data; libraries wrap the same memory without a copy.

#include <cstdint>
#include <vector>

namespace doublet {

/// Interleaved 8-bit image: channels 1 (mask or grey; mask: 255 = actor, 0 = background) or 3 (B G R, OpenCV's order).
struct Image {
  int width = 0, height = 0, channels = 1;
  std::vector<std::uint8_t> data; ///< height * width * channels, rows from the top

  Image() = default;
  Image(int w, int h, int c, std::uint8_t value = 0)
      : width(w), height(h), channels(c), data(static_cast<std::size_t>(w) * h * c, value) {}
  bool empty() const { return data.empty(); }
  std::uint8_t &at(int x, int y, int c = 0) { return data[(static_cast<std::size_t>(y) * width + x) * channels + c]; }
  std::uint8_t at(int x, int y, int c = 0) const { return data[(static_cast<std::size_t>(y) * width + x) * channels + c]; }
};

} // namespace doublet
