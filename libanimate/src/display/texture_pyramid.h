#pragma once
// A texture and its halves, quarters, ...: seen from afar a sample is the mean of what a pixel covers (Williams 1983), and the
// texels of a picture lie close together in memory.

#include "doublet/core/image.h"

#include <Eigen/Core>

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
  /// Bilinear, clamped at the borders; u, v in [0, 1] over the image; R G B in [0, 1].
  Eigen::Vector3f sample(int level, float u, float v) const;

private:
  struct Level {
    int width, height;
    float scale;                                     ///< texels of this level to one of the image
    std::vector<std::array<std::uint8_t, 4>> texels; ///< B G R and an idle fourth
  };
  static Level half_of(const Level &finer);
  std::vector<Level> levels_; ///< from the image itself to a single texel
};

} // namespace doublet::detail
