#pragma once
// Four floats that go through a kernel together (see lane.h): here four constraints that share no vertex. GCC/Clang vector
// extensions, so that it is SSE2 on any x86-64 and NEON on any ARM64; every lane gets the bits that the kernel gives for float.

#include "lane.h"

#include <cstring>
#ifdef __SSE2__
#include <emmintrin.h>
#endif

namespace doublet::pbd {

struct Mask4 {
  typedef int Bits __attribute__((vector_size(16)));
  Bits bits;
};

struct Pack4 {
  typedef float Lanes __attribute__((vector_size(16)));
  Lanes lanes;

  Pack4() = default;
  Pack4(float all) : lanes{all, all, all, all} {}
  explicit Pack4(Lanes l) : lanes(l) {}
  static Pack4 load(const float *four) {
    Pack4 p;
    std::memcpy(&p.lanes, four, sizeof p.lanes);
    return p;
  }
};

inline Pack4 operator+(Pack4 a, Pack4 b) {
  return Pack4(a.lanes + b.lanes);
}
inline Pack4 operator-(Pack4 a, Pack4 b) {
  return Pack4(a.lanes - b.lanes);
}
inline Pack4 operator*(Pack4 a, Pack4 b) {
  return Pack4(a.lanes * b.lanes);
}
inline Pack4 operator/(Pack4 a, Pack4 b) {
  return Pack4(a.lanes / b.lanes);
}
inline Pack4 operator-(Pack4 a) {
  return Pack4(-a.lanes);
}
inline Mask4 operator<(Pack4 a, Pack4 b) {
  return {a.lanes < b.lanes};
}
inline Mask4 operator>(Pack4 a, Pack4 b) {
  return {a.lanes > b.lanes};
}

inline Pack4 from_bits(Mask4::Bits b) {
  Pack4 p;
  std::memcpy(&p.lanes, &b, sizeof b);
  return p;
}
inline Mask4::Bits to_bits(Pack4 p) {
  Mask4::Bits b;
  std::memcpy(&b, &p.lanes, sizeof b);
  return b;
}
inline Pack4 select(Mask4 m, Pack4 yes, Pack4 no) {
  return from_bits((m.bits & to_bits(yes)) | (~m.bits & to_bits(no)));
}
inline Pack4 lane_abs(Pack4 a) {
  return from_bits(to_bits(a) & 0x7fffffff);
}
inline Pack4 with_sign(Pack4 a, Pack4 sign) {
  const int sign_bit = static_cast<int>(0x80000000u);
  return from_bits((to_bits(a) & 0x7fffffff) | (to_bits(sign) & sign_bit));
}
#ifdef __SSE2__
inline Pack4 lane_sqrt(Pack4 a) {
  return Pack4(Pack4::Lanes(_mm_sqrt_ps(a.lanes)));
}
inline Pack4 lane_max(Pack4 a, Pack4 b) {
  return Pack4(Pack4::Lanes(_mm_max_ps(a.lanes, b.lanes)));
} // a > b ? a : b, as for float
inline Pack4 lane_min(Pack4 a, Pack4 b) {
  return Pack4(Pack4::Lanes(_mm_min_ps(a.lanes, b.lanes)));
}
#else
inline Pack4 lane_sqrt(Pack4 a) {
  return Pack4(Pack4::Lanes{std::sqrt(a.lanes[0]), std::sqrt(a.lanes[1]), std::sqrt(a.lanes[2]), std::sqrt(a.lanes[3])});
}
#endif

/// A position as the solver stores it: sixteen bytes, so that four of them load and turn into x, y and z lanes.
struct alignas(16) Point : Vec3f {
  float pad = 0;
  Point() : Vec3f{0, 0, 0} {}
  Point(Vec3f p) : Vec3f(p) {}
};

inline Pack4::Lanes shuffle(Pack4::Lanes a, Pack4::Lanes b, Mask4::Bits order) {
#ifdef __clang__
  return Pack4::Lanes{order[0] < 4 ? a[order[0]] : b[order[0] - 4], order[1] < 4 ? a[order[1]] : b[order[1] - 4],
                      order[2] < 4 ? a[order[2]] : b[order[2] - 4], order[3] < 4 ? a[order[3]] : b[order[3] - 4]};
#else
  return __builtin_shuffle(a, b, order);
#endif
}
inline Vec3<Pack4> gather(const Point *p, const int (&v)[4]) {
  const Pack4::Lanes a = Pack4::load(&p[v[0]].x).lanes, b = Pack4::load(&p[v[1]].x).lanes, c = Pack4::load(&p[v[2]].x).lanes,
                     d = Pack4::load(&p[v[3]].x).lanes;
  const Pack4::Lanes ab = shuffle(a, b, Mask4::Bits{0, 4, 1, 5}), cd = shuffle(c, d, Mask4::Bits{0, 4, 1, 5}); // x x y y
  const Pack4::Lanes ab_z = shuffle(a, b, Mask4::Bits{2, 6, 3, 7}), cd_z = shuffle(c, d, Mask4::Bits{2, 6, 3, 7});
  return {Pack4(shuffle(ab, cd, Mask4::Bits{0, 1, 4, 5})), Pack4(shuffle(ab, cd, Mask4::Bits{2, 3, 6, 7})),
          Pack4(shuffle(ab_z, cd_z, Mask4::Bits{0, 1, 4, 5}))};
}
inline void scatter(Point *p, const int (&v)[4], const Vec3<Pack4> &x) {
  const Pack4::Lanes zero{0, 0, 0, 0};
  const Pack4::Lanes xy_lo = shuffle(x.x.lanes, x.y.lanes, Mask4::Bits{0, 4, 1, 5}),
                     xy_hi = shuffle(x.x.lanes, x.y.lanes, Mask4::Bits{2, 6, 3, 7});
  const Pack4::Lanes z_lo = shuffle(x.z.lanes, zero, Mask4::Bits{0, 4, 1, 5}),
                     z_hi = shuffle(x.z.lanes, zero, Mask4::Bits{2, 6, 3, 7});
  const auto store = [](Point &to, Pack4::Lanes from) { std::memcpy(&to.x, &from, sizeof from); };
  store(p[v[0]], shuffle(xy_lo, z_lo, Mask4::Bits{0, 1, 4, 5}));
  store(p[v[1]], shuffle(xy_lo, z_lo, Mask4::Bits{2, 3, 6, 7}));
  store(p[v[2]], shuffle(xy_hi, z_hi, Mask4::Bits{0, 1, 4, 5}));
  store(p[v[3]], shuffle(xy_hi, z_hi, Mask4::Bits{2, 3, 6, 7}));
}

} // namespace doublet::pbd
