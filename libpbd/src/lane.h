#pragma once
// The scalar vocabulary of the kernels. A kernel is a template over T, the type of one value in every lane: float, Pack<4>,
// Pack<8>, Pack<16> (the solver), double (the gradient tests). Kernels never branch on a T: a contact that one lane has must not
// act in another, so they compute both sides and select.
//
// The same functions are compiled for several instruction sets. Each set has its own namespace (a file defines
// DOUBLET_PBD_ISA before its includes and is compiled with that set's flags): were the names the same, the linker would keep
// one copy of each, and might keep one that the processor cannot run. For the same reason these headers use no function of the
// standard library.

#ifndef DOUBLET_PBD_ISA
#define DOUBLET_PBD_ISA baseline
#endif

#ifdef __wasm_simd128__
#include <wasm_simd128.h>
#endif

namespace doublet::pbd {
inline namespace DOUBLET_PBD_ISA {

inline float select(bool mask, float yes, float no) {
  return mask ? yes : no;
}
inline double select(bool mask, double yes, double no) {
  return mask ? yes : no;
}
inline bool any(bool mask) {
  return mask;
}
template <class T> inline T lane_max(T a, T b) {
  return select(a > b, a, b);
}
template <class T> inline T lane_min(T a, T b) {
  return select(a < b, a, b);
}
#ifdef __wasm_simd128__
// A select of floats is a jump in a browser, these are not.
inline float lane_max(float a, float b) {
  return wasm_f32x4_extract_lane(wasm_f32x4_pmax(wasm_f32x4_splat(b), wasm_f32x4_splat(a)), 0);
}
inline float lane_min(float a, float b) {
  return wasm_f32x4_extract_lane(wasm_f32x4_pmin(wasm_f32x4_splat(b), wasm_f32x4_splat(a)), 0);
}
#endif
inline float lane_abs(float a) {
  return __builtin_fabsf(a);
}
inline double lane_abs(double a) {
  return __builtin_fabs(a);
}
/// `a`, or 0 outside the mask.
inline float only(bool mask, float a) {
  return mask ? a : 0;
}
inline double only(bool mask, double a) {
  return mask ? a : 0;
}
/// -a where the mask is set.
inline float negated(bool mask, float a) {
  return mask ? -a : a;
}
inline double negated(bool mask, double a) {
  return mask ? -a : a;
}
/// Size of the first with the sign of the second: by bits, where a select would cost a mispredicted jump every other time.
inline float with_sign(float a, float sign) {
  return __builtin_copysignf(a, sign);
}
inline double with_sign(double a, double sign) {
  return __builtin_copysign(a, sign);
}
inline float lane_sqrt(float a) {
  return __builtin_sqrtf(a);
}
/// a b + c, rounded once: in hardware, or (x86 without FMA) through double, whose last bit is made odd where the sum is inexact,
/// so that the second rounding goes the way of the first (Boldo, Melquiond 2008). The same bits. WebAssembly has no such
/// instruction, and a browser no time for the way through double: there it is rounded twice, and the last bits are others.
inline float mul_add(float a, float b, float c) {
#if defined(__FMA__) || defined(__aarch64__)
  return __builtin_fmaf(a, b, c);
#elif defined(__wasm__)
  return a * b + c;
#else
  const double product = static_cast<double>(a) * b, sum = product + c, c_share = sum - product,
               error = (product - (sum - c_share)) + (c - c_share);
  long long bits;
  __builtin_memcpy(&bits, &sum, sizeof bits);
  if ((error < 0 || error > 0) && !(bits & 1))
    bits += (error > 0) == (sum > 0) ? 1 : -1;
  double odd;
  __builtin_memcpy(&odd, &bits, sizeof odd);
  return static_cast<float>(odd);
#endif
}
inline double mul_add(double a, double b, double c) {
  return __builtin_fma(a, b, c);
}
/// a b - c and c - a b, rounded once.
template <class T> inline T mul_sub(T a, T b, T c) {
  return mul_add(a, b, -c);
}
template <class T> inline T neg_mul_add(T a, T b, T c) {
  return mul_add(-a, b, c);
}
inline double lane_sqrt(double a) {
  return __builtin_sqrt(a);
}

template <class T> struct Vec3 { T x, y, z; };
using Vec3f = Vec3<float>;

template <class T> inline Vec3<T> operator+(Vec3<T> a, Vec3<T> b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class T> inline Vec3<T> operator-(Vec3<T> a, Vec3<T> b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class T> inline Vec3<T> operator*(T s, Vec3<T> a) {
  return {s * a.x, s * a.y, s * a.z};
}
template <class T> inline Vec3<T> &operator+=(Vec3<T> &a, Vec3<T> b) {
  return a = a + b;
}
template <class T> inline Vec3<T> &operator-=(Vec3<T> &a, Vec3<T> b) {
  return a = a - b;
}
template <class T> inline Vec3<T> mul_add(T s, Vec3<T> a, Vec3<T> b) {
  return {mul_add(s, a.x, b.x), mul_add(s, a.y, b.y), mul_add(s, a.z, b.z)};
}
template <class T> inline Vec3<T> neg_mul_add(T s, Vec3<T> a, Vec3<T> b) {
  return {neg_mul_add(s, a.x, b.x), neg_mul_add(s, a.y, b.y), neg_mul_add(s, a.z, b.z)};
}
template <class T> inline T dot(Vec3<T> a, Vec3<T> b) {
  return mul_add(a.x, b.x, mul_add(a.y, b.y, a.z * b.z));
}
template <class T> inline Vec3<T> cross(Vec3<T> a, Vec3<T> b) {
  return {mul_sub(a.y, b.z, a.z * b.y), mul_sub(a.z, b.x, a.x * b.z), mul_sub(a.x, b.y, a.y * b.x)};
}
template <class M, class T> inline Vec3<T> select(M mask, Vec3<T> yes, Vec3<T> no) {
  return {select(mask, yes.x, no.x), select(mask, yes.y, no.y), select(mask, yes.z, no.z)};
}

/// atan2 by a minimax polynomial on [0, 1] (ours; error below 3e-7 rad in float): the same bits on every machine and in every
/// lane, and 0 at (0, 0). The polynomial is summed in pairs (Estrin), and what does not depend on it is ready before it: the
/// solver waits for this function more than for any other.
template <class T> inline T lane_atan2(T y, T x) {
  const T ax = lane_abs(x), ay = lane_abs(y);
  const T small = lane_min(ax, ay), big = lane_max(ax, ay);
  const T a = small / lane_max(big, T(1.17549435e-38f));
  const auto steep = ay > ax, behind = x < T(0);
  const T offset = select(steep, T(1.57079632679489662), only(behind, T(3.14159265358979324)));
  const T turned = negated(steep ^ behind, a);
  const T s = a * a, s2 = s * s;
  const T low = mul_add(mul_add(T(-0.142036453f), s, T(0.199926198f)), s2, mul_add(T(-0.333330721f), s, T(1.0f)));
  const T top = mul_add(T(0.00284988387f), s2, mul_add(T(-0.0160686094f), s, T(0.042691499f)));
  const T high = mul_add(top, s2, mul_add(T(-0.0750429332f), s, T(0.106409341f)));
  return with_sign(mul_add(mul_add(high, s2 * s2, low), turned, offset), y);
}

} // namespace DOUBLET_PBD_ISA
} // namespace doublet::pbd
