#pragma once
// One face into a z-buffer: the inner loop of rasterize().

#include "doublet/core/rasterizer.h"

#include <cstdint>

namespace doublet::detail {

constexpr int kSubpixelBits = 10; // corners are rounded to 1/1024 pixel, so that edge functions are exact in integers

struct ScreenVertex {
  std::int64_t x = 0, y = 0; ///< pixel * 2^kSubpixelBits
  double inverse_depth = 0;
  bool drawable = false;
};

inline int floor_pixel(std::int64_t v) {
  return static_cast<int>(v >> kSubpixelBits);
}
inline int ceil_pixel(std::int64_t v) {
  return static_cast<int>((v + (1 << kSubpixelBits) - 1) >> kSubpixelBits);
}

/// Face `f` with corners a, b and c where it is nearer than what the buffer holds.
void draw_face(FaceBuffer &buffer, int f, const ScreenVertex &a, const ScreenVertex &b, const ScreenVertex &c);

/// The same, pixel by pixel, as for processors without AVX2.
void draw_face_plainly(FaceBuffer &buffer, int f, const ScreenVertex &a, const ScreenVertex &b, const ScreenVertex &c);

} // namespace doublet::detail
