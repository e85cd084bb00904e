#include "draw_face.h"

#include <algorithm>
#include <utility>

#ifdef __x86_64__
#include <immintrin.h>
#endif

namespace doublet::detail {
namespace {

/// Twice the signed area of (a, b, p); positive on one side of a -> b. Steps in x and y are constant.
struct EdgeFunction {
  std::int64_t value, step_x, step_y;
  std::int64_t least; ///< from which on a sample is within
  EdgeFunction(const ScreenVertex &a, const ScreenVertex &b, std::int64_t px, std::int64_t py)
      : value((b.x - a.x) * (py - a.y) - (b.y - a.y) * (px - a.x)), step_x(-((b.y - a.y) << kSubpixelBits)),
        step_y((b.x - a.x) << kSubpixelBits) {
    // A sample exactly on a shared edge belongs to one of the two faces: the one for which the edge is a top or left one.
    const bool top_left = (b.y - a.y) < 0 || (b.y == a.y && b.x > a.x);
    least = top_left ? 0 : 1;
  }
};

/// The pixels whose centres may lie in a face.
struct Box {
  int x0, y0, x1, y1;
};

/// A face that covers an area, in its box.
struct DrawnFace {
  int index;
  bool small; ///< double precision holds its edge functions
  bool cut;   ///< by the right border of the picture
  Box box;
  EdgeFunction a, b, c;             ///< at the box's first pixel, of the edges that face these corners
  double share_a, share_b, share_c; ///< 1/z, which is linear in the image, is the sum of these times the edge functions
};

void draw_pixels(DrawnFace face, FaceBuffer &buffer) {
  EdgeFunction &a = face.a, &b = face.b, &c = face.c;
  for (int y = face.box.y0; y <= face.box.y1; ++y, a.value += a.step_y, b.value += b.step_y, c.value += c.step_y) {
    std::int64_t va = a.value, vb = b.value, vc = c.value;
    const std::size_t row = static_cast<std::size_t>(y) * buffer.width;
    for (int x = face.box.x0; x <= face.box.x1; ++x, va += a.step_x, vb += b.step_x, vc += c.step_x) {
      if (((va - a.least) | (vb - b.least) | (vc - c.least)) < 0)
        continue;
      const float depth = static_cast<float>(1 / (face.share_a * va + face.share_b * vb + face.share_c * vc));
      if (depth < buffer.depth[row + x]) {
        buffer.depth[row + x] = depth;
        buffer.face[row + x] = face.index;
      }
    }
  }
}

#ifdef __x86_64__
/// Behind the box there must be pixels to fill up four, none of them within.
bool goes_in_fours(const DrawnFace &face, const FaceBuffer &buffer) {
  return face.small && !face.cut && face.box.y1 + 1 < buffer.height && buffer.width >= 4;
}

/// An edge function at four pixels of a row.
struct FourValues {
  __m256d value, step_x, step_y, least;
};

__attribute__((target("avx2"))) inline FourValues four_values(const EdgeFunction &edge) {
  const __m256d step = _mm256_set1_pd(static_cast<double>(edge.step_x));
  return {_mm256_add_pd(_mm256_set1_pd(static_cast<double>(edge.value)), _mm256_mul_pd(step, _mm256_set_pd(3, 2, 1, 0))),
          _mm256_mul_pd(step, _mm256_set1_pd(4)), _mm256_set1_pd(static_cast<double>(edge.step_y)),
          _mm256_set1_pd(static_cast<double>(edge.least))};
}

/// As draw_pixels(), without a branch: whether a pixel is within, and nearer, is no pattern that a processor could foresee. Up to
/// three pixels behind the box are written as they were.
__attribute__((target("avx2"))) void draw_in_fours(const DrawnFace &face, FaceBuffer &buffer) {
  FourValues a = four_values(face.a), b = four_values(face.b), c = four_values(face.c);
  const __m256d share_a = _mm256_set1_pd(face.share_a), share_b = _mm256_set1_pd(face.share_b),
                share_c = _mm256_set1_pd(face.share_c), one = _mm256_set1_pd(1);
  const __m256i low_halves = _mm256_set_epi32(0, 0, 0, 0, 6, 4, 2, 0);
  const __m128i index = _mm_set1_epi32(face.index);
  for (int y = face.box.y0; y <= face.box.y1; ++y) {
    const std::size_t row = static_cast<std::size_t>(y) * buffer.width;
    __m256d va = a.value, vb = b.value, vc = c.value;
    for (int x = face.box.x0; x <= face.box.x1; x += 4) {
      float *depths = &buffer.depth[row + x];
      auto *faces = reinterpret_cast<__m128i *>(&buffer.face[row + x]);
      const __m256d within =
          _mm256_and_pd(_mm256_and_pd(_mm256_cmp_pd(va, a.least, _CMP_GE_OQ), _mm256_cmp_pd(vb, b.least, _CMP_GE_OQ)),
                        _mm256_cmp_pd(vc, c.least, _CMP_GE_OQ));
      const __m256d inverse_depth =
          _mm256_add_pd(_mm256_add_pd(_mm256_mul_pd(share_a, va), _mm256_mul_pd(share_b, vb)), _mm256_mul_pd(share_c, vc));
      const __m128 depth = _mm256_cvtpd_ps(_mm256_div_pd(one, inverse_depth)), before = _mm_loadu_ps(depths);
      const __m128 drawn =
          _mm_castsi128_ps(_mm256_castsi256_si128(_mm256_permutevar8x32_epi32(_mm256_castpd_si256(within), low_halves)));
      const __m128 nearer = _mm_and_ps(drawn, _mm_cmplt_ps(depth, before));
      _mm_storeu_ps(depths, _mm_blendv_ps(before, depth, nearer));
      _mm_storeu_si128(faces, _mm_blendv_epi8(_mm_loadu_si128(faces), index, _mm_castps_si128(nearer)));
      va = _mm256_add_pd(va, a.step_x), vb = _mm256_add_pd(vb, b.step_x), vc = _mm256_add_pd(vc, c.step_x);
    }
    a.value = _mm256_add_pd(a.value, a.step_y);
    b.value = _mm256_add_pd(b.value, b.step_y);
    c.value = _mm256_add_pd(c.value, c.step_y);
  }
}

bool has_avx2() {
  static const bool has = __builtin_cpu_supports("avx2");
  return has;
}
#endif

template <class Draw>
void draw(FaceBuffer &buffer, int f, const ScreenVertex &a, ScreenVertex b, ScreenVertex c, const Draw &draw_it) {
  // Most faces of a small picture hold no pixel's centre and end here.
  const std::int64_t left = std::min({a.x, b.x, c.x}), right = std::max({a.x, b.x, c.x}), top = std::min({a.y, b.y, c.y}),
                     bottom = std::max({a.y, b.y, c.y});
  const Box box{std::max(0, ceil_pixel(left)), std::max(0, ceil_pixel(top)), std::min(buffer.width - 1, floor_pixel(right)),
                std::min(buffer.height - 1, floor_pixel(bottom))};
  if (box.x0 > box.x1 || box.y0 > box.y1)
    return;
  std::int64_t area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  if (area == 0)
    return;
  if (area < 0) {
    std::swap(b, c);
    area = -area;
  }
  const auto whole = static_cast<double>(area);
  const std::int64_t px = static_cast<std::int64_t>(box.x0) << kSubpixelBits, py = static_cast<std::int64_t>(box.y0)
                                                                                   << kSubpixelBits;
  constexpr std::int64_t kSmall = std::int64_t{1} << 22; // subpixels, 4096 pixels: edge functions are below 2^47 in its box
  draw_it(DrawnFace{f,
                    right - left < kSmall && bottom - top < kSmall,
                    floor_pixel(right) >= buffer.width,
                    box,
                    {b, c, px, py},
                    {c, a, px, py},
                    {a, b, px, py},
                    a.inverse_depth / whole,
                    b.inverse_depth / whole,
                    c.inverse_depth / whole});
}

} // namespace

void draw_face(FaceBuffer &buffer, int f, const ScreenVertex &a, const ScreenVertex &b, const ScreenVertex &c) {
#ifdef __x86_64__
  if (has_avx2()) {
    draw(buffer, f, a, b, c, [&](const DrawnFace &face) {
      if (goes_in_fours(face, buffer))
        draw_in_fours(face, buffer);
      else
        draw_pixels(face, buffer);
    });
    return;
  }
#endif
  draw_face_plainly(buffer, f, a, b, c);
}

void draw_face_plainly(FaceBuffer &buffer, int f, const ScreenVertex &a, const ScreenVertex &b, const ScreenVertex &c) {
  draw(buffer, f, a, b, c, [&](const DrawnFace &face) { draw_pixels(face, buffer); });
}

} // namespace doublet::detail
