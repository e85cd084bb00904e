#pragma once
// The loops of ClothView over the samples that it looks at together, one in each lane. Compiled once for each instruction set
// (lanes_*.cpp), so this header holds plain data alone: see lane_loops.h. Arrays end in [lanes]; every lane gets the same bits
// whatever the instruction set, the number of lanes and the other lanes.

namespace doublet::fit {

constexpr float kNear = 0.05f;  // m, as rasterize()
constexpr float kFarOut = 1e6f; // pixels; beyond it nothing is drawn

/// A camera in single precision: see Camera.
struct Lens {
  float R[9], t[3];
  float fx, skew, cx, fy, cy;
  float k[5];
  bool distorted;
};

/// Features of one camera, sorted by the cell of a grid over the image that they lie in, row by row.
struct FeatureGrid {
  int x0, y0, width, height; ///< pixels of the first cell's corner; cells
  int cell;                  ///< pixels
  const int *first;          ///< [height * width + 1] the first feature of each cell
  const int *before;         ///< [height + 1][width + 1] how many features lie in the rows above and the columns to the left
  const float *x, *y;        ///< [features] pixels
};

/// Where the features lie on the cloth: the face, -1 = not on it, and three weights whose sum is not 1.
struct Places {
  float *inverse_depth; ///< [features][lanes] 1/m, of what is nearest so far
  int *face;            ///< [features][lanes]
  float *weight;        ///< [features][3][lanes]
};

/// A piece of an outline in the image, pixels.
struct Segment {
  float ax, ay, bx, by;
};

struct LaneKernels {
  int lanes;
  /// positions [count][3][lanes], m -> image [count][3][lanes]: pixels of the full image and inverse depth, all 0 where it cannot
  /// be drawn; box [4]: around all of them, pixels, x0 y0 x1 y1.
  void (*project)(const Lens &lens, int count, const float *positions, float *image, float *box);
  /// corners [count][3] -> facing [count][lanes]: sign of the area in the image (y points down: -1 = seen from outside), 0 =
  /// none.
  void (*turn)(int count, const int *corners, const float *image, signed char *facing);
  /// Takes for every feature the nearest face over it that is nearer than what `places` holds.
  void (*locate)(const FeatureGrid &grid, int count, const int *corners, const float *image, const signed char *facing,
                 Places places);
  /// The squared distance in the image between where each place is now and where it was seen (x, y), at most `largest` [count];
  /// -1 = the feature is not on the cloth. squared [count][lanes], pixels^2.
  void (*squared_errors)(const Lens &lens, int count, const float *x, const float *y, const int *corners, const float *positions,
                         const int *face, const float *weight, const float *largest, float *squared);
  /// Lowers squared [count], pixels^2, to the squared distance of each point (x, y) to the segment between two ends. The lanes
  /// are the points here: a sample has outlines of its own.
  void (*approach)(int count, const float *x, const float *y, Segment segment, float *squared);
};

// 0, 1, 2 = 4, 8, 16 lanes; nullptr where this program was built for a processor that has no such instructions.
const LaneKernels *baseline_kernels(int width);
const LaneKernels *avx2_kernels(int width);
const LaneKernels *avx512_kernels(int width);

} // namespace doublet::fit
