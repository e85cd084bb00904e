#pragma once
// A texture and its halves, quarters, ...: seen from afar a sample is the mean of what a pixel covers (Williams 1983), and the
// texels of a picture lie close together in memory.

#include "doublet/core/image.h"

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace doublet::detail {

class TexturePyramid {
public:
  /// `image`: B G R, not empty.
  explicit TexturePyramid(const Image &image);
  int width() const { return levels_[0].width; }
  int height() const { return levels_[0].height; }
  /// The coarsest level of which a pixel that covers so many texels (an area) still covers one.
  int level_for(float texels) const;
  /// Bilinear, clamped at the borders; u, v in [0, 1] over the image; R G B in [0, 1], and an idle fourth.
  Eigen::Vector4f sample(int level, float u, float v) const;

private:
  struct Level {
    int width, height;
    float scale;                                     ///< texels of this level to one of the image
    std::vector<std::array<std::uint8_t, 4>> texels; ///< R G B and an idle fourth
  };
  static Level half_of(const Level &finer);
  std::vector<Level> levels_; ///< from the image itself to a single texel
};

// For each pixel of a picture: in the header, so that it becomes a part of the painter's loop.
inline Eigen::Vector4f TexturePyramid::sample(int level, float u, float v) const {
  const Level &of = levels_[level];
  const float x = std::clamp(u * (of.scale * static_cast<float>(width())) - 0.5f, 0.0f, static_cast<float>(of.width - 1)),
              y = std::clamp(v * (of.scale * static_cast<float>(height())) - 0.5f, 0.0f, static_cast<float>(of.height - 1));
  const int x0 = static_cast<int>(x), y0 = static_cast<int>(y);
  const float a = x - static_cast<float>(x0), b = y - static_cast<float>(y0);
  const int right = x0 + 1 < of.width ? 1 : 0, below = y0 + 1 < of.height ? of.width : 0;
  const auto *at = &of.texels[static_cast<std::size_t>(y0) * of.width + x0];
  const auto texel = [at](int i) { return Eigen::Map<const Eigen::Matrix<std::uint8_t, 4, 1>>(at[i].data()).cast<float>(); };
  const Eigen::Vector4f above = (1 - a) * texel(0) + a * texel(right), under = (1 - a) * texel(below) + a * texel(below + right);
  return ((1 - b) * above + b * under) * (1 / 255.0f);
}

} // namespace doublet::detail
