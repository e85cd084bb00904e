#include "texture_pyramid.h"

#include <algorithm>
#include <cmath>

namespace doublet::detail {

TexturePyramid::TexturePyramid(const Image &image) {
  Level whole{image.width, image.height, 1, {}};
  whole.texels.resize(static_cast<std::size_t>(image.width) * image.height);
  for (std::size_t i = 0; i < whole.texels.size(); ++i)
    whole.texels[i] = {image.data[3 * i], image.data[3 * i + 1], image.data[3 * i + 2], 0};
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

Eigen::Vector3f TexturePyramid::sample(int level, float u, float v) const {
  const Level &of = levels_[level];
  const float x = std::clamp(u * (of.scale * static_cast<float>(width())) - 0.5f, 0.0f, static_cast<float>(of.width - 1)),
              y = std::clamp(v * (of.scale * static_cast<float>(height())) - 0.5f, 0.0f, static_cast<float>(of.height - 1));
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const float a = x - static_cast<float>(x0), b = y - static_cast<float>(y0);
  const int right = x0 + 1 < of.width ? 1 : 0, below = y0 + 1 < of.height ? of.width : 0;
  const auto *at = &of.texels[static_cast<std::size_t>(y0) * of.width + x0];
  const std::array<std::uint8_t, 4> &p = at[0], &q = at[right], &r = at[below], &s = at[below + right];
  const float wp = (1 - a) * (1 - b), wq = a * (1 - b), wr = (1 - a) * b, ws = a * b;
  std::array<float, 4> sum; // four, so that it is one register
  for (int c = 0; c < 4; ++c)
    sum[c] = wp * p[c] + wq * q[c] + wr * r[c] + ws * s[c];
  return Eigen::Vector3f(sum[2], sum[1], sum[0]) / 255.0f;
}

} // namespace doublet::detail
