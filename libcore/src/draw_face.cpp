#include "draw_face.h"

#include <algorithm>
#include <cstdlib>

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

} // namespace

void draw_face_plainly(FaceBuffer &buffer, int f, const ScreenVertex &a, const ScreenVertex &first, const ScreenVertex &second) {
  const std::int64_t left = std::min({a.x, first.x, second.x}), right = std::max({a.x, first.x, second.x}),
                     top = std::min({a.y, first.y, second.y}), bottom = std::max({a.y, first.y, second.y});
  const Box box{std::max(0, ceil_pixel(left)), std::max(0, ceil_pixel(top)), std::min(buffer.width - 1, floor_pixel(right)),
                std::min(buffer.height - 1, floor_pixel(bottom))};
  if (box.x0 > box.x1 || box.y0 > box.y1) // most faces of a small picture hold no pixel's centre
    return;
  const std::int64_t area = (first.x - a.x) * (second.y - a.y) - (first.y - a.y) * (second.x - a.x);
  if (area == 0)
    return;
  const ScreenVertex &b = area < 0 ? second : first, &c = area < 0 ? first : second;
  const auto whole = static_cast<double>(std::abs(area));
  const std::int64_t px = static_cast<std::int64_t>(box.x0) << kSubpixelBits, py = static_cast<std::int64_t>(box.y0)
                                                                                   << kSubpixelBits;
  EdgeFunction of_a(b, c, px, py), of_b(c, a, px, py), of_c(a, b, px, py);
  // 1/z, which is linear in the image, is the sum of these times the edge functions.
  const double share_a = a.inverse_depth / whole, share_b = b.inverse_depth / whole, share_c = c.inverse_depth / whole;
  for (int y = box.y0; y <= box.y1; ++y) {
    std::int64_t va = of_a.value, vb = of_b.value, vc = of_c.value;
    const std::size_t row = static_cast<std::size_t>(y) * buffer.width;
    for (int x = box.x0; x <= box.x1; ++x, va += of_a.step_x, vb += of_b.step_x, vc += of_c.step_x) {
      if (((va - of_a.least) | (vb - of_b.least) | (vc - of_c.least)) < 0)
        continue;
      const float depth = static_cast<float>(1 / (share_a * va + share_b * vb + share_c * vc));
      if (depth < buffer.depth[row + x]) {
        buffer.depth[row + x] = depth;
        buffer.face[row + x] = f;
      }
    }
    of_a.value += of_a.step_y, of_b.value += of_b.step_y, of_c.value += of_c.step_y;
  }
}

#ifdef __x86_64__
namespace {

#define DOUBLET_AVX2 __attribute__((target("avx2")))

constexpr double kPixel = 1 << kSubpixelBits;

/// One lane of a vector, four times.
template <int lane> DOUBLET_AVX2 inline __m256d spread(__m256d lanes) {
  return _mm256_permute4x64_pd(lanes, 0x55 * lane);
}
/// A number at four pixels of a row.
template <int lane> DOUBLET_AVX2 inline __m256d at_four(__m256d first, __m256d step) {
  return _mm256_add_pd(spread<lane>(first), _mm256_mul_pd(spread<lane>(step), _mm256_set_pd(3, 2, 1, 0)));
}

DOUBLET_AVX2 inline __m128d place(const ScreenVertex &v) {
  return _mm_set_pd(static_cast<double>(v.y), static_cast<double>(v.x));
}

/// Of the edges that face a, b and c, in lanes 0, 1 and 2: EdgeFunction at the box's first pixel, and shares of 1/z.
struct ThreeEdges {
  __m256d value, step_x, step_y, least, share;
};

/// `px`, `py`: the box's first pixel, subpixels.
DOUBLET_AVX2 inline ThreeEdges edges(__m128d a, __m128d b, __m128d c, double px, double py) {
  const __m256d from_x = _mm256_set_pd(0, a[0], c[0], b[0]), from_y = _mm256_set_pd(0, a[1], c[1], b[1]);
  const __m256d dx = _mm256_sub_pd(_mm256_set_pd(0, b[0], a[0], c[0]), from_x),
                dy = _mm256_sub_pd(_mm256_set_pd(0, b[1], a[1], c[1]), from_y);
  const __m256d zero = _mm256_setzero_pd();
  const __m256d top_left = _mm256_or_pd(_mm256_cmp_pd(dy, zero, _CMP_LT_OQ),
                                        _mm256_and_pd(_mm256_cmp_pd(dy, zero, _CMP_EQ_OQ), _mm256_cmp_pd(dx, zero, _CMP_GT_OQ)));
  return {_mm256_sub_pd(_mm256_mul_pd(dx, _mm256_sub_pd(_mm256_set1_pd(py), from_y)),
                        _mm256_mul_pd(dy, _mm256_sub_pd(_mm256_set1_pd(px), from_x))),
          _mm256_mul_pd(dy, _mm256_set1_pd(-kPixel)), _mm256_mul_pd(dx, _mm256_set1_pd(kPixel)),
          _mm256_andnot_pd(top_left, _mm256_set1_pd(1)), zero};
}

/// Without a branch: whether a pixel is within, and nearer, is no pattern that a processor could foresee.
DOUBLET_AVX2 inline void fill(FaceBuffer &buffer, int f, const Box &box, const ThreeEdges &edges) {
  const __m256d least_a = spread<0>(edges.least), least_b = spread<1>(edges.least), least_c = spread<2>(edges.least);
  const __m256d share_a = spread<0>(edges.share), share_b = spread<1>(edges.share), share_c = spread<2>(edges.share);
  const __m256d down_a = spread<0>(edges.step_y), down_b = spread<1>(edges.step_y), down_c = spread<2>(edges.step_y);
  const __m256d four_steps = _mm256_mul_pd(edges.step_x, _mm256_set1_pd(4)), one = _mm256_set1_pd(1);
  const __m256d right_a = spread<0>(four_steps), right_b = spread<1>(four_steps), right_c = spread<2>(four_steps);
  __m256d row_a = at_four<0>(edges.value, edges.step_x), row_b = at_four<1>(edges.value, edges.step_x),
          row_c = at_four<2>(edges.value, edges.step_x);
  const __m256i low_halves = _mm256_set_epi32(0, 0, 0, 0, 6, 4, 2, 0);
  const __m128i index = _mm_set1_epi32(f);
  for (int y = box.y0; y <= box.y1; ++y) {
    __m256d a = row_a, b = row_b, c = row_c;
    const std::size_t start = static_cast<std::size_t>(y) * buffer.width + box.x0;
    float *depths = buffer.depth.data() + start;
    auto *faces = buffer.face.data() + start;
    for (int x = box.x0; x <= box.x1; x += 4, depths += 4, faces += 4) {
      const __m256d within =
          _mm256_and_pd(_mm256_and_pd(_mm256_cmp_pd(a, least_a, _CMP_GE_OQ), _mm256_cmp_pd(b, least_b, _CMP_GE_OQ)),
                        _mm256_cmp_pd(c, least_c, _CMP_GE_OQ));
      const __m256d inverse_depth =
          _mm256_add_pd(_mm256_add_pd(_mm256_mul_pd(share_a, a), _mm256_mul_pd(share_b, b)), _mm256_mul_pd(share_c, c));
      const __m128 depth = _mm256_cvtpd_ps(_mm256_div_pd(one, inverse_depth)), before = _mm_loadu_ps(depths);
      const __m128 drawn =
          _mm_castsi128_ps(_mm256_castsi256_si128(_mm256_permutevar8x32_epi32(_mm256_castpd_si256(within), low_halves)));
      const __m128 nearer = _mm_and_ps(drawn, _mm_cmplt_ps(depth, before));
      auto *four_faces = reinterpret_cast<__m128i *>(faces);
      _mm_storeu_ps(depths, _mm_blendv_ps(before, depth, nearer));
      _mm_storeu_si128(four_faces, _mm_blendv_epi8(_mm_loadu_si128(four_faces), index, _mm_castps_si128(nearer)));
      a = _mm256_add_pd(a, right_a), b = _mm256_add_pd(b, right_b), c = _mm256_add_pd(c, right_c);
    }
    row_a = _mm256_add_pd(row_a, down_a), row_b = _mm256_add_pd(row_b, down_b), row_c = _mm256_add_pd(row_c, down_c);
  }
}

/// As draw_face_plainly(), four pixels at a time; up to three pixels behind the box are written as they were. False, and nothing
/// is drawn: the face is too large for edge functions in double precision, or there are no pixels behind the box to fill up four.
DOUBLET_AVX2 bool draw_in_fours(FaceBuffer &buffer, int f, const ScreenVertex &corner, const ScreenVertex &first,
                                const ScreenVertex &second) {
  constexpr double kSmall = 4096; // pixels: edge functions are below 2^47 in the box
  const __m128d a = place(corner), p = place(first), q = place(second), per_pixel = _mm_set1_pd(1 / kPixel);
  const __m128d low = _mm_mul_pd(_mm_min_pd(_mm_min_pd(a, p), q), per_pixel),
                high = _mm_mul_pd(_mm_max_pd(_mm_max_pd(a, p), q), per_pixel);
  const __m128d last = _mm_set_pd(buffer.height - 1, buffer.width - 1), end = _mm_floor_pd(high),
                begin = _mm_max_pd(_mm_ceil_pd(low), _mm_setzero_pd());
  if (_mm_movemask_pd(_mm_cmpgt_pd(begin, _mm_min_pd(end, last))) != 0) // most faces of a small picture hold no pixel's centre
    return true;
  const bool fills_up = _mm_movemask_pd(_mm_cmpgt_pd(end, _mm_sub_pd(last, _mm_set_pd(1, 0)))) == 0 && buffer.width >= 4;
  const bool small = _mm_movemask_pd(_mm_cmpge_pd(_mm_sub_pd(high, low), _mm_set1_pd(kSmall))) == 0;
  if (!fills_up || !small)
    return false;
  const __m128d to_p = _mm_sub_pd(p, a), to_q = _mm_sub_pd(q, a);
  const double area = to_p[0] * to_q[1] - to_p[1] * to_q[0];
  if (area == 0)
    return true;
  const bool turned = area < 0;
  ThreeEdges three = edges(a, turned ? q : p, turned ? p : q, begin[0] * kPixel, begin[1] * kPixel);
  three.share = _mm256_div_pd(
      _mm256_set_pd(0, (turned ? first : second).inverse_depth, (turned ? second : first).inverse_depth, corner.inverse_depth),
      _mm256_set1_pd(turned ? -area : area));
  fill(buffer, f, {static_cast<int>(begin[0]), static_cast<int>(begin[1]), static_cast<int>(end[0]), static_cast<int>(end[1])},
       three);
  return true;
}

bool has_avx2() {
  static const bool has = __builtin_cpu_supports("avx2");
  return has;
}

} // namespace
#endif

void draw_face(FaceBuffer &buffer, int f, const ScreenVertex &a, const ScreenVertex &b, const ScreenVertex &c) {
#ifdef __x86_64__
  if (has_avx2() && draw_in_fours(buffer, f, a, b, c))
    return;
#endif
  draw_face_plainly(buffer, f, a, b, c);
}

} // namespace doublet::detail
