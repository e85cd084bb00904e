#include "texture_pyramid.h"

#include <algorithm>
#include <cmath>

namespace doublet::detail {

TexturePyramid::TexturePyramid(const Image &image) {
  Level whole{image.width, image.height, 1, {}};
  whole.texels.resize(static_cast<std::size_t>(image.width) * image.height);
  for (std::size_t i = 0; i < whole.texels.size(); ++i)
    whole.texels[i] = {image.data[3 * i + 2], image.data[3 * i + 1], image.data[3 * i], 0};
  levels_.push_back(std::move(whole));
  while (levels_.back().width > 1 || levels_.back().height > 1)
    levels_.push_back(half_of(levels_.back()));
}

/// Means of 2 x 2 texels; the last row and column of an odd size count twice.
TexturePyramid::Level TexturePyramid::half_of(const Level &finer) {
  Level half{(finer.width + 1) / 2, (finer.height + 1) / 2, finer.scale / 2, {}};
  half.texels.resize(static_cast<std::size_t>(half.width) * half.height);
  for (int y = 0; y < half.height; ++y) {
    const auto *above = &finer.texels[static_cast<std::size_t>(2 * y) * finer.width],
               *below = 2 * y + 1 < finer.height ? above + finer.width : above;
    for (int x = 0; x < half.width; ++x) {
      const int left = 2 * x, right = std::min(left + 1, finer.width - 1);
      for (int c = 0; c < 3; ++c)
        half.texels[static_cast<std::size_t>(y) * half.width + x][c] =
            static_cast<std::uint8_t>((above[left][c] + above[right][c] + below[left][c] + below[right][c] + 2) / 4);
    }
  }
  return half;
}

int TexturePyramid::level_for(float texels) const {
  return texels >= 4 ? std::min(std::ilogb(texels) / 2, static_cast<int>(levels_.size()) - 1) : 0;
}

} // namespace doublet::detail
