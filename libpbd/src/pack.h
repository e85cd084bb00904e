#pragma once
// N floats that go through a kernel together (see lane.h): N simulations side by side, or four constraints of one that share no
// vertex. GCC/Clang vector extensions, and the processor's own instructions where those have no word for it. Every lane gets the
// bits that the kernel gives for float: the arithmetic is IEEE in all of them and what is fused (mul_add) is fused in all.

#include "lane.h"
#include "lane_model.h"

#if defined(__SSE2__)
#include <immintrin.h>
#endif

namespace doublet::pbd {
inline namespace DOUBLET_PBD_ISA {

template <int N> struct Registers; // GCC drops vector_size(4 * N)
template <> struct Registers<4> {
  typedef float Floats __attribute__((vector_size(16)));
  typedef int Ints __attribute__((vector_size(16)));
};
template <> struct Registers<8> {
  typedef float Floats __attribute__((vector_size(32)));
  typedef int Ints __attribute__((vector_size(32)));
};
template <> struct Registers<16> {
  typedef float Floats __attribute__((vector_size(64)));
  typedef int Ints __attribute__((vector_size(64)));
};

template <int N> struct Mask { typename Registers<N>::Ints bits; };
template <int N> struct Pack {
  using Lanes = typename Registers<N>::Floats;
  Lanes lanes;

  Pack() = default;
  Pack(float all) : lanes(all - Lanes{}) {}
  explicit Pack(Lanes l) : lanes(l) {}
  static Pack load(const float *from) {
    Pack p;
    __builtin_memcpy(&p.lanes, from, sizeof p.lanes);
    return p;
  }

  friend Pack operator+(Pack a, Pack b) { return Pack(a.lanes + b.lanes); }
  friend Pack operator-(Pack a, Pack b) { return Pack(a.lanes - b.lanes); }
  friend Pack operator*(Pack a, Pack b) { return Pack(a.lanes * b.lanes); }
  friend Pack operator/(Pack a, Pack b) { return Pack(a.lanes / b.lanes); }
  friend Pack operator-(Pack a) { return Pack(-a.lanes); }
  friend Pack &operator+=(Pack &a, Pack b) { return a = a + b; }
  friend Pack &operator-=(Pack &a, Pack b) { return a = a - b; }
};

/// As integers of the same bits, and back.
template <int N> inline typename Registers<N>::Ints to_bits(Pack<N> p) {
  return reinterpret_cast<typename Registers<N>::Ints>(p.lanes);
}
template <int N> inline Pack<N> from_bits(typename Registers<N>::Ints b) {
  return Pack<N>(reinterpret_cast<typename Registers<N>::Floats>(b));
}

template <int N> inline Mask<N> operator<(Pack<N> a, Pack<N> b) {
  return {a.lanes < b.lanes};
}
template <int N> inline Mask<N> operator<=(Pack<N> a, Pack<N> b) {
  return {a.lanes <= b.lanes};
}
template <int N> inline Mask<N> operator&(Mask<N> a, Mask<N> b) {
  return {a.bits & b.bits};
}
template <int N> inline Mask<N> operator|(Mask<N> a, Mask<N> b) {
  return {a.bits | b.bits};
}
template <int N> inline Mask<N> operator^(Mask<N> a, Mask<N> b) {
  return {a.bits ^ b.bits};
}
template <int N> inline Mask<N> operator!(Mask<N> a) {
  return {~a.bits};
}
template <int N> inline Pack<N> select(Mask<N> m, Pack<N> yes, Pack<N> no) {
  return from_bits<N>((m.bits & to_bits(yes)) | (~m.bits & to_bits(no)));
}
template <int N> inline Pack<N> only(Mask<N> m, Pack<N> a) {
  return from_bits<N>(m.bits & to_bits(a));
}
template <int N> inline Pack<N> negated(Mask<N> m, Pack<N> a) {
  const int sign_bit = static_cast<int>(0x80000000u);
  return from_bits<N>(to_bits(a) ^ (m.bits & sign_bit));
}
template <int N> inline Pack<N> lane_sqrt(Pack<N> a) {
  for (int l = 0; l < N; ++l)
    a.lanes[l] = __builtin_sqrtf(a.lanes[l]);
  return a;
}
template <int N> inline bool any(Mask<N> m) {
  int bits = 0;
  for (int l = 0; l < N; ++l)
    bits |= m.bits[l];
  return bits != 0;
}
/// Bit l: lane l.
inline int lane_bits(Mask<4> m) {
#if defined(__SSE2__)
  return _mm_movemask_ps(reinterpret_cast<__m128>(m.bits));
#elif defined(__wasm_simd128__)
  return static_cast<int>(wasm_i32x4_bitmask(static_cast<v128_t>(m.bits)));
#else
  return (m.bits[0] & 1) | (m.bits[1] & 2) | (m.bits[2] & 4) | (m.bits[3] & 8);
#endif
}
#ifdef __AVX2__
inline int lane_bits(Mask<8> m) {
  return _mm256_movemask_ps(reinterpret_cast<__m256>(m.bits));
}
#endif
template <int N> inline Pack<N> lane_abs(Pack<N> a) {
  return from_bits<N>(to_bits(a) & 0x7fffffff);
}
template <int N> inline Pack<N> with_sign(Pack<N> a, Pack<N> sign) {
  const int sign_bit = static_cast<int>(0x80000000u);
  return from_bits<N>((to_bits(a) & 0x7fffffff) | (to_bits(sign) & sign_bit));
}

template <int N> inline Pack<N> mul_add(Pack<N> a, Pack<N> b, Pack<N> c) {
  for (int l = 0; l < N; ++l)
    c.lanes[l] = mul_add(a.lanes[l], b.lanes[l], c.lanes[l]);
  return c;
}

// max and min return the second if either is not a number: a > b ? a : b, as for float.
#ifdef __SSE2__
inline Pack<4> lane_sqrt(Pack<4> a) {
  return Pack<4>(_mm_sqrt_ps(a.lanes));
}
inline Pack<4> lane_max(Pack<4> a, Pack<4> b) {
  return Pack<4>(_mm_max_ps(a.lanes, b.lanes));
}
inline Pack<4> lane_min(Pack<4> a, Pack<4> b) {
  return Pack<4>(_mm_min_ps(a.lanes, b.lanes));
}
inline bool any(Mask<4> m) {
  return _mm_movemask_ps(reinterpret_cast<__m128>(m.bits)) != 0;
}
#endif
#ifdef __wasm_simd128__
inline Pack<4> lane_sqrt(Pack<4> a) {
  return Pack<4>(static_cast<Pack<4>::Lanes>(wasm_f32x4_sqrt(static_cast<v128_t>(a.lanes))));
}
inline Pack<4> lane_max(Pack<4> a, Pack<4> b) {
  return Pack<4>(static_cast<Pack<4>::Lanes>(wasm_f32x4_pmax(static_cast<v128_t>(b.lanes), static_cast<v128_t>(a.lanes))));
}
inline Pack<4> lane_min(Pack<4> a, Pack<4> b) {
  return Pack<4>(static_cast<Pack<4>::Lanes>(wasm_f32x4_pmin(static_cast<v128_t>(b.lanes), static_cast<v128_t>(a.lanes))));
}
inline bool any(Mask<4> m) {
  return wasm_v128_any_true(static_cast<v128_t>(m.bits));
}
inline Pack<4> mul_add(Pack<4> a, Pack<4> b, Pack<4> c) { // rounded twice, as float's there
  return a * b + c;
}
#endif
#ifdef __FMA__
inline Pack<4> mul_add(Pack<4> a, Pack<4> b, Pack<4> c) {
  return Pack<4>(_mm_fmadd_ps(a.lanes, b.lanes, c.lanes));
}
inline Pack<4> mul_sub(Pack<4> a, Pack<4> b, Pack<4> c) {
  return Pack<4>(_mm_fmsub_ps(a.lanes, b.lanes, c.lanes));
}
inline Pack<4> neg_mul_add(Pack<4> a, Pack<4> b, Pack<4> c) {
  return Pack<4>(_mm_fnmadd_ps(a.lanes, b.lanes, c.lanes));
}
inline Pack<8> mul_add(Pack<8> a, Pack<8> b, Pack<8> c) {
  return Pack<8>(_mm256_fmadd_ps(a.lanes, b.lanes, c.lanes));
}
inline Pack<8> mul_sub(Pack<8> a, Pack<8> b, Pack<8> c) {
  return Pack<8>(_mm256_fmsub_ps(a.lanes, b.lanes, c.lanes));
}
inline Pack<8> neg_mul_add(Pack<8> a, Pack<8> b, Pack<8> c) {
  return Pack<8>(_mm256_fnmadd_ps(a.lanes, b.lanes, c.lanes));
}
#endif
#ifdef __AVX2__
inline Pack<8> lane_sqrt(Pack<8> a) {
  return Pack<8>(_mm256_sqrt_ps(a.lanes));
}
inline Pack<8> lane_max(Pack<8> a, Pack<8> b) {
  return Pack<8>(_mm256_max_ps(a.lanes, b.lanes));
}
inline Pack<8> lane_min(Pack<8> a, Pack<8> b) {
  return Pack<8>(_mm256_min_ps(a.lanes, b.lanes));
}
inline Pack<8> select(Mask<8> m, Pack<8> yes, Pack<8> no) {
  return Pack<8>(_mm256_blendv_ps(no.lanes, yes.lanes, reinterpret_cast<__m256>(m.bits)));
}
inline bool any(Mask<8> m) {
  return _mm256_movemask_ps(reinterpret_cast<__m256>(m.bits)) != 0;
}
#endif
#ifdef __AVX512F__
// The forms without a mask make GCC 12 warn about its own header (its bug 105593).
constexpr __mmask16 kAll = 0xffff;
template <> struct Mask<16> { __mmask16 bits; };
inline Mask<16> operator<(Pack<16> a, Pack<16> b) {
  return {_mm512_cmp_ps_mask(a.lanes, b.lanes, _CMP_LT_OQ)};
}
inline Mask<16> operator<=(Pack<16> a, Pack<16> b) {
  return {_mm512_cmp_ps_mask(a.lanes, b.lanes, _CMP_LE_OQ)};
}
inline Mask<16> operator&(Mask<16> a, Mask<16> b) {
  return {static_cast<__mmask16>(a.bits & b.bits)};
}
inline Mask<16> operator|(Mask<16> a, Mask<16> b) {
  return {static_cast<__mmask16>(a.bits | b.bits)};
}
inline Mask<16> operator^(Mask<16> a, Mask<16> b) {
  return {static_cast<__mmask16>(a.bits ^ b.bits)};
}
inline Mask<16> operator!(Mask<16> a) {
  return {static_cast<__mmask16>(~a.bits)};
}
inline Pack<16> select(Mask<16> m, Pack<16> yes, Pack<16> no) {
  return Pack<16>(_mm512_mask_blend_ps(m.bits, no.lanes, yes.lanes));
}
inline Pack<16> only(Mask<16> m, Pack<16> a) {
  return Pack<16>(_mm512_maskz_mov_ps(m.bits, a.lanes));
}
inline Pack<16> negated(Mask<16> m, Pack<16> a) {
  const __m512i bits = _mm512_castps_si512(a.lanes);
  const int sign_bit = static_cast<int>(0x80000000u);
  return Pack<16>(_mm512_castsi512_ps(_mm512_mask_xor_epi32(bits, m.bits, bits, _mm512_set1_epi32(sign_bit))));
}
inline Pack<16> mul_add(Pack<16> a, Pack<16> b, Pack<16> c) {
  return Pack<16>(_mm512_fmadd_ps(a.lanes, b.lanes, c.lanes));
}
inline Pack<16> mul_sub(Pack<16> a, Pack<16> b, Pack<16> c) {
  return Pack<16>(_mm512_fmsub_ps(a.lanes, b.lanes, c.lanes));
}
inline Pack<16> neg_mul_add(Pack<16> a, Pack<16> b, Pack<16> c) {
  return Pack<16>(_mm512_fnmadd_ps(a.lanes, b.lanes, c.lanes));
}
inline Pack<16> lane_sqrt(Pack<16> a) {
  return Pack<16>(_mm512_maskz_sqrt_ps(kAll, a.lanes));
}
inline Pack<16> lane_max(Pack<16> a, Pack<16> b) {
  return Pack<16>(_mm512_maskz_max_ps(kAll, a.lanes, b.lanes));
}
inline Pack<16> lane_min(Pack<16> a, Pack<16> b) {
  return Pack<16>(_mm512_maskz_min_ps(kAll, a.lanes, b.lanes));
}
inline bool any(Mask<16> m) {
  return m.bits != 0;
}
#endif

template <int N> inline Mask<N> operator>(Pack<N> a, Pack<N> b) {
  return b < a;
}
template <int N> inline Mask<N> operator>=(Pack<N> a, Pack<N> b) {
  return b <= a;
}

/// A position of a single simulation: sixteen bytes, so that four of them load and turn into x, y and z lanes.
struct alignas(16) Point : Vec3f {
  float pad;
  Point() = default;
  Point(Vec3f p) : Vec3f(p), pad(0) {}
};
/// How the solver keeps a position.
template <class T> struct PlaceOf { using Type = Vec3<T>; };
template <> struct PlaceOf<float> { using Type = Point; };
template <class T> using Place = typename PlaceOf<T>::Type;

using Lanes4 = Registers<4>::Floats;
using Order4 = Registers<4>::Ints;
inline Lanes4 shuffle(Lanes4 a, Lanes4 b, Order4 order) {
#ifdef __clang__
  return Lanes4{order[0] < 4 ? a[order[0]] : b[order[0] - 4], order[1] < 4 ? a[order[1]] : b[order[1] - 4],
                order[2] < 4 ? a[order[2]] : b[order[2] - 4], order[3] < 4 ? a[order[3]] : b[order[3] - 4]};
#else
  return __builtin_shuffle(a, b, order);
#endif
}
/// Rows to columns.
inline void transpose(const Pack<4> *row, Pack<4> (&column)[4]) {
  const Lanes4 a = row[0].lanes, b = row[1].lanes, c = row[2].lanes, d = row[3].lanes;
  const Lanes4 ab = shuffle(a, b, Order4{0, 4, 1, 5}), cd = shuffle(c, d, Order4{0, 4, 1, 5}); // a0 b0 a1 b1
  const Lanes4 ab_high = shuffle(a, b, Order4{2, 6, 3, 7}), cd_high = shuffle(c, d, Order4{2, 6, 3, 7});
  column[0] = Pack<4>(shuffle(ab, cd, Order4{0, 1, 4, 5}));
  column[1] = Pack<4>(shuffle(ab, cd, Order4{2, 3, 6, 7}));
  column[2] = Pack<4>(shuffle(ab_high, cd_high, Order4{0, 1, 4, 5}));
  column[3] = Pack<4>(shuffle(ab_high, cd_high, Order4{2, 3, 6, 7}));
}
template <int N> Vec3<Pack<N>> gather(const Point *p, const int *v); ///< points p[v[0]], ..., p[v[N - 1]]
template <int N> void scatter(Point *p, const int *v, const Vec3<Pack<N>> &x);
template <> inline Vec3<Pack<4>> gather<4>(const Point *p, const int *v) {
  const Pack<4> point[] = {Pack<4>::load(&p[v[0]].x), Pack<4>::load(&p[v[1]].x), Pack<4>::load(&p[v[2]].x),
                           Pack<4>::load(&p[v[3]].x)};
  Pack<4> axis[4];
  transpose(point, axis);
  return {axis[0], axis[1], axis[2]};
}

template <> inline void scatter<4>(Point *p, const int *v, const Vec3<Pack<4>> &x) {
  const Lanes4 zero{0, 0, 0, 0};
  const Lanes4 xy_lo = shuffle(x.x.lanes, x.y.lanes, Order4{0, 4, 1, 5}),
               xy_hi = shuffle(x.x.lanes, x.y.lanes, Order4{2, 6, 3, 7});
  const Lanes4 z_lo = shuffle(x.z.lanes, zero, Order4{0, 4, 1, 5}), z_hi = shuffle(x.z.lanes, zero, Order4{2, 6, 3, 7});
  const auto store = [](Point &to, Lanes4 from) { __builtin_memcpy(&to.x, &from, sizeof from); };
  store(p[v[0]], shuffle(xy_lo, z_lo, Order4{0, 1, 4, 5}));
  store(p[v[1]], shuffle(xy_lo, z_lo, Order4{2, 3, 6, 7}));
  store(p[v[2]], shuffle(xy_hi, z_hi, Order4{0, 1, 4, 5}));
  store(p[v[3]], shuffle(xy_hi, z_hi, Order4{2, 3, 6, 7}));
}

/// What a single simulation does side by side: the boxes or the pairs that it looks at.
#ifdef __AVX2__
constexpr int kRow = 8;
template <> inline Vec3<Pack<8>> gather<8>(const Point *p, const int *v) {
  const auto points = [&](int l) { return _mm256_loadu2_m128(&p[v[l + 4]].x, &p[v[l]].x); };
  const __m256 a = points(0), b = points(1), c = points(2), d = points(3);
  const __m256 ab = _mm256_unpacklo_ps(a, b), cd = _mm256_unpacklo_ps(c, d); // ax bx ay by
  const __m256 ab_z = _mm256_unpackhi_ps(a, b), cd_z = _mm256_unpackhi_ps(c, d);
  return {Pack<8>(_mm256_shuffle_ps(ab, cd, 0x44)), Pack<8>(_mm256_shuffle_ps(ab, cd, 0xee)),
          Pack<8>(_mm256_shuffle_ps(ab_z, cd_z, 0x44))};
}
template <> inline void scatter<8>(Point *p, const int *v, const Vec3<Pack<8>> &x) {
  const __m256 zero = _mm256_setzero_ps();
  const __m256 xy_low = _mm256_unpacklo_ps(x.x.lanes, x.y.lanes), xy_high = _mm256_unpackhi_ps(x.x.lanes, x.y.lanes);
  const __m256 z_low = _mm256_unpacklo_ps(x.z.lanes, zero), z_high = _mm256_unpackhi_ps(x.z.lanes, zero);
  const auto store = [&](int l, __m256 points) { _mm256_storeu2_m128(&p[v[l + 4]].x, &p[v[l]].x, points); };
  store(0, _mm256_shuffle_ps(xy_low, z_low, 0x44));
  store(1, _mm256_shuffle_ps(xy_low, z_low, 0xee));
  store(2, _mm256_shuffle_ps(xy_high, z_high, 0x44));
  store(3, _mm256_shuffle_ps(xy_high, z_high, 0xee));
}
#else
constexpr int kRow = 4;
#endif
using Row = Pack<kRow>;
/// What constraints that share no vertex are projected as: of one simulation a row, of many one after the other.
template <class T> struct SideBySide { using Type = T; };
template <> struct SideBySide<float> { using Type = Row; };
template <class T> using Side = typename SideBySide<T>::Type;
template <class T> inline constexpr int kSide = sizeof(Side<T>) / sizeof(T);
static_assert(kRow <= kSpareInList);
/// The points p[v[0]], ... p[v[kSide - 1]], and back.
template <class T> inline Vec3<Side<T>> points_at(const Place<T> *p, const int *v) {
  if constexpr (kSide<T> == 1)
    return p[*v];
  else
    return gather<kRow>(p, v);
}
template <class T> inline void move_points(Place<T> *p, const int *v, const Vec3<Side<T>> &to) {
  if constexpr (kSide<T> == 1)
    p[*v] = to;
  else
    scatter<kRow>(p, v, to);
}
/// The values at v[0], ... v[kSide - 1], and back.
template <class T> inline Side<T> values_at(const T *values, const int *v) {
  if constexpr (kSide<T> == 1)
    return values[*v];
  else {
    float row[kRow];
    for (int l = 0; l < kRow; ++l)
      row[l] = values[v[l]];
    return Row::load(row);
  }
}
template <class T> inline void set_values(T *values, const int *v, const Side<T> &to) {
  if constexpr (kSide<T> == 1)
    values[*v] = to;
  else
    for (int l = 0; l < kRow; ++l)
      values[v[l]] = to.lanes[l];
}
/// What the l-th of them has.
template <class T> inline T lane_of(const Side<T> &values, int l) {
  if constexpr (kSide<T> == 1)
    return values;
  else
    return values.lanes[l];
}
/// Calls use(l) for every bit l that is set, in their order.
template <class Use> inline void for_each_bit(int bits, const Use &use) {
  for (; bits != 0; bits &= bits - 1)
    use(__builtin_ctz(static_cast<unsigned>(bits)));
}
/// Bit l: one of the lists has one of the values at l.
template <int lists, int values> inline int equal_bits(const int *const (&list)[lists], int at, const int (&value)[values]) {
  typename Registers<kRow>::Ints equal{};
  for (int k = 0; k < lists; ++k) {
    Registers<kRow>::Ints row;
    __builtin_memcpy(&row, list[k] + at, sizeof row);
    for (int n = 0; n < values; ++n)
      equal |= row == value[n];
  }
  return lane_bits(Mask<kRow>{equal});
}

} // namespace DOUBLET_PBD_ISA
} // namespace doublet::pbd
