#pragma once
// A z-buffer: the visible face at each pixel and its depth. Used for silhouettes, visibility, lifting features and rendering.

#include "doublet/core/camera.h"
#include "doublet/core/image.h"
#include "doublet/core/mesh.h"

namespace doublet {

struct FaceBuffer {
  int width = 0, height = 0;
  std::vector<int> face;    ///< height * width, -1 = background
  std::vector<float> depth; ///< height * width, m along the optical axis, +infinity = background
  int face_at(int x, int y) const { return face[static_cast<std::size_t>(y) * width + x]; }
  float depth_at(int x, int y) const { return depth[static_cast<std::size_t>(y) * width + x]; }
};

/// Draws both sides of every face (with `face_valid[f]` zero left out; empty = draw all). Vertices are projected with
/// distortion, edges are straight between them. Faces that reach behind the near plane (0.05 m) are left out. Sampled at pixel
/// centres. Throws std::invalid_argument for wrong sizes and indices, Error for an invalid camera.
FaceBuffer rasterize(const Vertices &vertices, const Faces &faces, const Camera &camera, const Mask &face_valid = {});

/// A part of an image; its first pixel is (x, y) of the whole.
struct FaceWindow {
  FaceBuffer buffer;
  int x = 0, y = 0;
};

/// As rasterize(), with the same faces and depths, but only for the part of the image that contains vertices, plus `margin`
/// pixels; an empty buffer if no vertex is in the image.
FaceWindow rasterize_window(const Vertices &vertices, const Faces &faces, const Camera &camera, const Mask &face_valid = {},
                            int margin = 0);

/// Perspective-correct barycentric coordinates, on face `f`, of the ray through `pixel` (not clamped to the triangle).
Eigen::Vector3d barycentric_at(const Vertices &vertices, const Faces &faces, int f, const Camera &camera,
                               const Eigen::Vector2d &pixel);

/// 255 where a face is.
Image silhouette(const FaceBuffer &buffer);

/// Intersection over union of two masks of one size (> 0 counts as inside); 1 if both are empty.
double mask_iou(const Image &a, const Image &b);

} // namespace doublet
