#pragma once
// The bodies of LaneKernels: plain loops over the lanes, written so that the compiler turns them into vector instructions. They
// call nothing and hold no names outside DOUBLET_FIT_ISA: were the names the same for two instruction sets, the linker would keep
// one copy of each, and might keep one that the processor cannot run.

#include "lane_kernels.h"

namespace doublet::fit {
namespace DOUBLET_FIT_ISA {

inline int smaller(int a, int b) {
  return a < b ? a : b;
}
inline int larger(int a, int b) {
  return a > b ? a : b;
}
inline float smallest(float a, float b, float c) {
  const float ab = a < b ? a : b;
  return ab < c ? ab : c;
}
inline float largest(float a, float b, float c) {
  const float ab = a > b ? a : b;
  return ab > c ? ab : c;
}

/// Brown 1971, as Camera::project.
inline void distort(const float *k, float &x, float &y) {
  const float r2 = x * x + y * y;
  const float radial = 1.f + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  const float dx = x * radial + 2.f * k[2] * x * y + k[3] * (r2 + 2.f * x * x);
  const float dy = y * radial + k[2] * (r2 + 2.f * y * y) + 2.f * k[3] * x * y;
  x = dx, y = dy;
}

template <bool distorted> struct Seen {
  float x, y, depth;
  Seen(const Lens &c, float px, float py, float pz) {
    const float cam_x = c.R[0] * px + c.R[1] * py + c.R[2] * pz + c.t[0];
    const float cam_y = c.R[3] * px + c.R[4] * py + c.R[5] * pz + c.t[1];
    depth = c.R[6] * px + c.R[7] * py + c.R[8] * pz + c.t[2];
    float nx = cam_x / depth, ny = cam_y / depth;
    if (distorted)
      distort(c.k, nx, ny);
    x = c.fx * nx + c.skew * ny + c.cx;
    y = c.fy * ny + c.cy;
  }
};

template <int L, bool distorted> void project_all(const Lens &lens, int count, const float *positions, float *image, float *box) {
  float x0[L], y0[L], x1[L], y1[L];
  for (int l = 0; l < L; ++l)
    x0[l] = y0[l] = kFarOut, x1[l] = y1[l] = -kFarOut;
  for (int v = 0; v < count; ++v) {
    const float *p = positions + v * 3 * L;
    float *q = image + v * 3 * L;
    for (int l = 0; l < L; ++l) {
      const Seen<distorted> seen(lens, p[l], p[L + l], p[2 * L + l]);
      const bool drawable =
          (seen.depth > kNear) & (seen.x < kFarOut) & (seen.x > -kFarOut) & (seen.y < kFarOut) & (seen.y > -kFarOut);
      const float x = drawable ? seen.x : 0.f, y = drawable ? seen.y : 0.f;
      q[l] = x;
      q[L + l] = y;
      q[2 * L + l] = drawable ? 1.f / seen.depth : 0.f;
      x0[l] = x < x0[l] ? x : x0[l], x1[l] = x > x1[l] ? x : x1[l];
      y0[l] = y < y0[l] ? y : y0[l], y1[l] = y > y1[l] ? y : y1[l];
    }
  }
  box[0] = x0[0], box[1] = y0[0], box[2] = x1[0], box[3] = y1[0];
  for (int l = 1; l < L; ++l) {
    box[0] = x0[l] < box[0] ? x0[l] : box[0], box[2] = x1[l] > box[2] ? x1[l] : box[2];
    box[1] = y0[l] < box[1] ? y0[l] : box[1], box[3] = y1[l] > box[3] ? y1[l] : box[3];
  }
}

template <int L> void project(const Lens &lens, int count, const float *positions, float *image, float *box) {
  if (lens.distorted)
    project_all<L, true>(lens, count, positions, image, box);
  else
    project_all<L, false>(lens, count, positions, image, box);
}

template <int L> void turn(int count, const int *corners, const float *image, signed char *facing) {
  for (int f = 0; f < count; ++f) {
    const float *a = image + corners[3 * f] * 3 * L, *b = image + corners[3 * f + 1] * 3 * L,
                *c = image + corners[3 * f + 2] * 3 * L;
    int sign[L];
    for (int l = 0; l < L; ++l) {
      const float area = (b[l] - a[l]) * (c[L + l] - a[L + l]) - (b[L + l] - a[L + l]) * (c[l] - a[l]);
      const bool drawable = (a[2 * L + l] > 0) & (b[2 * L + l] > 0) & (c[2 * L + l] > 0);
      sign[l] = drawable ? (area > 0) - (area < 0) : 0;
    }
    for (int l = 0; l < L; ++l)
      facing[f * L + l] = static_cast<signed char>(sign[l]);
  }
}

/// One face and one feature in one lane.
template <int L>
inline void test_feature(float x, float y, int face, float sign, const float *a, const float *b, const float *c, float *nearest,
                         int *nearest_face, float *weight) {
  const float ax = a[0] - x, ay = a[L] - y, bx = b[0] - x, by = b[L] - y, cx = c[0] - x, cy = c[L] - y;
  const float wa = sign * (bx * cy - by * cx), wb = sign * (cx * ay - cy * ax), wc = sign * (ax * by - ay * bx);
  const float sum = wa + wb + wc;
  if (!((wa >= 0) & (wb >= 0) & (wc >= 0) & (sum > 0)))
    return;
  const float ta = wa * a[2 * L], tb = wb * b[2 * L], tc = wc * c[2 * L];
  const float inverse_depth = (ta + tb + tc) / sum;
  if (!(inverse_depth > *nearest))
    return;
  *nearest = inverse_depth;
  *nearest_face = face;
  weight[0] = ta, weight[L] = tb, weight[2 * L] = tc;
}

/// The cell that a pixel lies in, or the nearest one of the grid.
inline int cell_of(float pixel, float origin, float size, int count) {
  const float cell = (pixel - origin) / size;
  const float kept = cell > 0 ? cell : 0.f; // the conversion to integers rounds towards 0
  return smaller(static_cast<int>(kept), count - 1);
}

/// Most faces lie over no feature at all, and those that do are not the same in every lane: so all lanes look up how many
/// features the cells around the face hold, and only where there are some each lane goes through its own.
template <int L>
void locate(const FeatureGrid &grid, int count, const int *corners, const float *image, const signed char *facing,
            Places places) {
  if (grid.width <= 0 || grid.height <= 0)
    return;
  const float left = static_cast<float>(grid.x0), top = static_cast<float>(grid.y0), size = static_cast<float>(grid.cell);
  const int pitch = grid.width + 1;
  for (int f = 0; f < count; ++f) {
    const float *a = image + corners[3 * f] * 3 * L, *b = image + corners[3 * f + 1] * 3 * L,
                *c = image + corners[3 * f + 2] * 3 * L;
    float x0[L], y0[L], x1[L], y1[L];
    int column0[L], row0[L], column1[L], row1[L], found[L], any = 0;
    for (int l = 0; l < L; ++l) {
      x0[l] = smallest(a[l], b[l], c[l]), x1[l] = largest(a[l], b[l], c[l]);
      y0[l] = smallest(a[L + l], b[L + l], c[L + l]), y1[l] = largest(a[L + l], b[L + l], c[L + l]);
      column0[l] = cell_of(x0[l], left, size, grid.width), column1[l] = cell_of(x1[l], left, size, grid.width);
      row0[l] = cell_of(y0[l], top, size, grid.height), row1[l] = cell_of(y1[l], top, size, grid.height);
    }
    for (int l = 0; l < L; ++l) {
      const int above = row0[l] * pitch, below = (row1[l] + 1) * pitch;
      found[l] = grid.before[below + column1[l] + 1] - grid.before[above + column1[l] + 1] - grid.before[below + column0[l]] +
                 grid.before[above + column0[l]];
      found[l] = facing[f * L + l] == 0 ? 0 : found[l];
      any |= found[l];
    }
    if (!any)
      continue;
    for (int l = 0; l < L; ++l) {
      if (!found[l])
        continue;
      const float sign = static_cast<float>(facing[f * L + l]);
      for (int row = row0[l]; row <= row1[l]; ++row)
        for (int i = grid.first[row * grid.width + column0[l]]; i < grid.first[row * grid.width + column1[l] + 1]; ++i) {
          const float x = grid.x[i], y = grid.y[i];
          if ((x >= x0[l]) & (x <= x1[l]) & (y >= y0[l]) &
              (y <= y1[l])) // by rounding a sliver may seem to hold a point beside it
            test_feature<L>(x, y, f, sign, a + l, b + l, c + l, places.inverse_depth + i * L + l, places.face + i * L + l,
                            places.weight + i * 3 * L + l);
        }
    }
  }
}

template <int L, bool distorted>
void carry_all(const Lens &lens, int count, const float *x, const float *y, const int *corners, const float *positions,
               const int *face, const float *weight, const float *largest, float *squared) {
  for (int i = 0; i < count; ++i) {
    float px[L], py[L], pz[L];
    for (int l = 0; l < L; ++l) {
      const float *w = weight + i * 3 * L + l;
      const int *corner = corners + 3 * larger(0, face[i * L + l]);
      const float *a = positions + corner[0] * 3 * L + l, *b = positions + corner[1] * 3 * L + l,
                  *c = positions + corner[2] * 3 * L + l;
      const float scale = 1.f / (w[0] + w[L] + w[2 * L]);
      const float wa = w[0] * scale, wb = w[L] * scale, wc = w[2 * L] * scale;
      px[l] = wa * a[0] + wb * b[0] + wc * c[0];
      py[l] = wa * a[L] + wb * b[L] + wc * c[L];
      pz[l] = wa * a[2 * L] + wb * b[2 * L] + wc * c[2 * L];
    }
    for (int l = 0; l < L; ++l) {
      const Seen<distorted> seen(lens, px[l], py[l], pz[l]);
      const float dx = seen.x - x[i], dy = seen.y - y[i];
      const float distance = dx * dx + dy * dy;
      const float kept = ((seen.depth > kNear) & (distance < largest[i])) ? distance : largest[i];
      squared[i * L + l] = face[i * L + l] < 0 ? -1.f : kept;
    }
  }
}

template <int L>
void squared_errors(const Lens &lens, int count, const float *x, const float *y, const int *corners, const float *positions,
                    const int *face, const float *weight, const float *largest, float *squared) {
  if (lens.distorted)
    carry_all<L, true>(lens, count, x, y, corners, positions, face, weight, largest, squared);
  else
    carry_all<L, false>(lens, count, x, y, corners, positions, face, weight, largest, squared);
}

inline void approach(int count, const float *__restrict x, const float *__restrict y, Segment segment,
                     float *__restrict squared) {
  const float dx = segment.bx - segment.ax, dy = segment.by - segment.ay, length = dx * dx + dy * dy;
  const float inverse = length > 0 ? 1.f / length : 0.f;
  for (int i = 0; i < count; ++i) {
    const float px = x[i] - segment.ax, py = y[i] - segment.ay;
    const float along = (px * dx + py * dy) * inverse;
    const float after = along > 0.f ? along : 0.f, part = after < 1.f ? after : 1.f;
    const float ex = px - part * dx, ey = py - part * dy, distance = ex * ex + ey * ey;
    squared[i] = distance < squared[i] ? distance : squared[i];
  }
}

static const LaneKernels kWidths[3] = {{4, project<4>, turn<4>, locate<4>, squared_errors<4>, approach},
                                       {8, project<8>, turn<8>, locate<8>, squared_errors<8>, approach},
                                       {16, project<16>, turn<16>, locate<16>, squared_errors<16>, approach}};

} // namespace DOUBLET_FIT_ISA
} // namespace doublet::fit
