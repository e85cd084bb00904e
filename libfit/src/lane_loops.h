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

template <int L, bool distorted> void project_all(const Lens &lens, int count, const float *positions, float *image, int *range) {
  for (int v = 0; v < count; ++v) {
    const float *p = positions + v * 3 * L;
    float *q = image + v * 3 * L;
    int column[L], row[L];
    for (int l = 0; l < L; ++l) {
      const Seen<distorted> seen(lens, p[l], p[L + l], p[2 * L + l]);
      const bool drawable =
          (seen.depth > kNear) & (seen.x < kFarOut) & (seen.x > -kFarOut) & (seen.y < kFarOut) & (seen.y > -kFarOut);
      q[l] = drawable ? seen.x : 0.f;
      q[L + l] = drawable ? seen.y : 0.f;
      q[2 * L + l] = drawable ? 1.f / seen.depth : 0.f;
      column[l] = static_cast<int>(q[l]);
      row[l] = static_cast<int>(q[L + l]);
    }
    int x0 = column[0], y0 = row[0], x1 = column[0], y1 = row[0];
    for (int l = 1; l < L; ++l) {
      x0 = smaller(x0, column[l]), x1 = larger(x1, column[l]);
      y0 = smaller(y0, row[l]), y1 = larger(y1, row[l]);
    }
    int *box = range + v * 4; // the conversion to integers rounds towards 0
    box[0] = x0 - 1, box[1] = y0 - 1, box[2] = x1 + 1, box[3] = y1 + 1;
  }
}

template <int L> void project(const Lens &lens, int count, const float *positions, float *image, int *range) {
  if (lens.distorted)
    project_all<L, true>(lens, count, positions, image, range);
  else
    project_all<L, false>(lens, count, positions, image, range);
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

/// One face and one feature. Everything is worked out for all lanes, and kept in those where the face is over the feature.
template <int L>
void test_feature(float x, float y, int face, const float *a, const float *b, const float *c, const signed char *facing,
                  float *nearest, int *nearest_face, float *weight) {
  float wa[L], wb[L], wc[L], inverse_depth[L];
  int hit[L], any = 0;
  for (int l = 0; l < L; ++l) {
    const float sign = static_cast<float>(facing[l]);
    const float ax = a[l] - x, ay = a[L + l] - y, bx = b[l] - x, by = b[L + l] - y, cx = c[l] - x, cy = c[L + l] - y;
    wa[l] = sign * (bx * cy - by * cx);
    wb[l] = sign * (cx * ay - cy * ax);
    wc[l] = sign * (ax * by - ay * bx);
    const float sum = wa[l] + wb[l] + wc[l];
    const int inside = (wa[l] >= 0) & (wb[l] >= 0) & (wc[l] >= 0) & (sum > 0);
    wa[l] = wa[l] * a[2 * L + l], wb[l] = wb[l] * b[2 * L + l], wc[l] = wc[l] * c[2 * L + l];
    inverse_depth[l] = (wa[l] + wb[l] + wc[l]) / sum;
    hit[l] = inside & (inverse_depth[l] > nearest[l]);
    any |= hit[l];
  }
  if (!any)
    return;
  for (int l = 0; l < L; ++l) {
    // By rounding a sliver may seem to hold a point beside it; whether that is tested at all depends on the other lanes.
    const bool in_box = (x >= smallest(a[l], b[l], c[l])) & (x <= largest(a[l], b[l], c[l])) &
                        (y >= smallest(a[L + l], b[L + l], c[L + l])) & (y <= largest(a[L + l], b[L + l], c[L + l]));
    const bool take = hit[l] & in_box;
    nearest[l] = take ? inverse_depth[l] : nearest[l];
    nearest_face[l] = take ? face : nearest_face[l];
    weight[l] = take ? wa[l] : weight[l];
    weight[L + l] = take ? wb[l] : weight[L + l];
    weight[2 * L + l] = take ? wc[l] : weight[2 * L + l];
  }
}

template <int L>
void locate(const FeatureGrid &grid, int count, const int *corners, const float *image, const int *range,
            const signed char *facing, Places places) {
  const int right = grid.x0 + grid.width * grid.cell - 1, bottom = grid.y0 + grid.height * grid.cell - 1;
  for (int f = 0; f < count; ++f) {
    const int va = corners[3 * f], vb = corners[3 * f + 1], vc = corners[3 * f + 2];
    const int *ra = range + va * 4, *rb = range + vb * 4, *rc = range + vc * 4;
    const int x0 = larger(grid.x0, smaller(ra[0], smaller(rb[0], rc[0]))),
              y0 = larger(grid.y0, smaller(ra[1], smaller(rb[1], rc[1])));
    const int x1 = smaller(right, larger(ra[2], larger(rb[2], rc[2]))), y1 = smaller(bottom, larger(ra[3], larger(rb[3], rc[3])));
    if (x0 > x1 || y0 > y1)
      continue;
    const int first_column = (x0 - grid.x0) / grid.cell, last_column = (x1 - grid.x0) / grid.cell;
    const int first_row = (y0 - grid.y0) / grid.cell, last_row = (y1 - grid.y0) / grid.cell;
    const float left = static_cast<float>(x0), top = static_cast<float>(y0), end_x = static_cast<float>(x1),
                end_y = static_cast<float>(y1);
    for (int row = first_row; row <= last_row; ++row)
      for (int i = grid.first[row * grid.width + first_column]; i < grid.first[row * grid.width + last_column + 1]; ++i) {
        const float x = grid.x[i], y = grid.y[i];
        if (x >= left && x <= end_x && y >= top && y <= end_y)
          test_feature<L>(x, y, f, image + va * 3 * L, image + vb * 3 * L, image + vc * 3 * L, facing + f * L,
                          places.inverse_depth + i * L, places.face + i * L, places.weight + i * 3 * L);
      }
  }
}

template <int L, bool distorted>
void carry_all(const Lens &lens, int count, const float *x, const float *y, const int *corners, const float *positions,
               const int *face, const float *weight, float largest, float *squared) {
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
      const float kept = (seen.depth > kNear) & (distance < largest) ? distance : largest;
      squared[i * L + l] = face[i * L + l] < 0 ? -1.f : kept;
    }
  }
}

template <int L>
void carry(const Lens &lens, int count, const float *x, const float *y, const int *corners, const float *positions,
           const int *face, const float *weight, float largest, float *squared) {
  if (lens.distorted)
    carry_all<L, true>(lens, count, x, y, corners, positions, face, weight, largest, squared);
  else
    carry_all<L, false>(lens, count, x, y, corners, positions, face, weight, largest, squared);
}

static const LaneKernels kWidths[3] = {{4, project<4>, turn<4>, locate<4>, carry<4>},
                                       {8, project<8>, turn<8>, locate<8>, carry<8>},
                                       {16, project<16>, turn<16>, locate<16>, carry<16>}};

} // namespace DOUBLET_FIT_ISA
} // namespace doublet::fit
