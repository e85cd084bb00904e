#pragma once
// The simulated cloth as one camera sees it: which vertices make the outline, and where features lie.

#include "doublet/core/camera.h"
#include "doublet/simulate/character_simulator.h"
#include "lane_kernels.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <vector>

namespace doublet::fit {

/// An edge of the cloth and the faces beside it. Where more than two faces meet, or neighbours disagree about their outside,
/// the same edge is there several times.
struct ClothEdge {
  int a, b;
  int left, right; ///< the face that runs from a to b, and the one that runs from b to a, -1 = none
  bool hem;        ///< on a border of the valid faces of M
};

/// The faces that move with the cloth and their topology; fixed for a character. Local indices into `vertices`.
struct ClothTopology {
  std::vector<int> vertices;               ///< (D) index into M
  std::vector<int> region;                 ///< (D) -1 = the ring that follows the skeleton
  std::vector<int> row;                    ///< (D) of the region's state
  std::vector<int> corners;                ///< (G * 3) of the faces
  std::vector<int> face_region;            ///< (G)
  std::vector<ClothEdge> edges;            ///< (E)
  std::vector<std::uint8_t> face_is_cloth; ///< (F) of M: one of the above
  int vertex_count() const { return static_cast<int>(vertices.size()); }
  int face_count() const { return static_cast<int>(face_region.size()); }
  static constexpr int kNoCloth = -1;
  std::vector<int> region_of_faces() const; ///< (F) of M: the region of a face of the cloth, kNoCloth for the others
};
ClothTopology cloth_topology(const CharacterSimulator &simulator);

/// A rectangle of coarse pixels with the inverse depth (1/m along the optical axis) of what is nearest there, 0 = background.
struct CoarseBuffer {
  int x0 = 0, y0 = 0, width = 0, height = 0;
  std::vector<float> inverse_depth;
  bool holds(int x, int y) const { return x >= x0 && y >= y0 && x < x0 + width && y < y0 + height; }
  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y - y0) * width + (x - x0); }
  float at(int x, int y) const { return holds(x, y) ? inverse_depth[index(x, y)] : 0.f; }
};

/// A camera and the coarse raster laid over its image.
struct CoarseCamera {
  Camera camera;
  int width = 0, height = 0; ///< coarse pixels
  float scale_x = 1, scale_y = 1;
  Lens lens; ///< of the full image
  CoarseCamera(const Camera &camera, int larger_side);
  float coarse_x(float x) const { return (x + 0.5f) * scale_x - 0.5f; }
  float coarse_y(float y) const { return (y + 0.5f) * scale_y - 0.5f; }
};

/// Of an image, pixels.
inline float larger_side(const Camera &camera) {
  return static_cast<float>(std::max(camera.width, camera.height));
}

/// A rim vertex of one sample, and where it is in the image, pixels.
struct Rim {
  int lane, vertex;
  float x, y;
};

/// A rim edge of one sample on the outline; the region is that of the face beside it.
struct OutlineEdge {
  int lane, region;
  Segment segment;
};

/// Features on the cloth of every sample, and where they are seen in the next frame.
struct LocatedFeatures {
  int count = 0;
  std::vector<int> match;            ///< [count] index into the matches
  std::vector<float> seen_x, seen_y; ///< [count] pixels
  std::vector<int> face;             ///< [count][lanes] -1 = not on the cloth
  std::vector<float> weight;         ///< [count][3][lanes] of the corners, sum not 1
};

/// Of the kernels that a ClothView of so many samples takes.
int lanes_for(int samples);

/// The cloth of several samples as one camera sees it at one frame, a sample in each lane. A lane's results do not depend on the
/// others. Reused from frame to frame, so that nothing is allocated in the loop.
class ClothView {
public:
  /// For 1 to 16 samples. `kernels`: of at least as many lanes; by default the fastest that this processor has.
  ClothView(const ClothTopology &topology, int samples, const LaneKernels *kernels = nullptr);
  int lanes() const { return kernels_->lanes; }
  /// [D][3][lanes] world, m; lanes beyond the samples must be filled, too (with a copy of another).
  std::vector<float> &positions() { return positions_; }
  /// Everything below is about this camera.
  void set_camera(const CoarseCamera &camera);
  /// [D][3][lanes] pixels of the full image and inverse depth, 1/m; all 0 where it cannot be drawn.
  const std::vector<float> &image() const { return image_; }
  /// Rims by vertex, then lane: free vertices between a front and a back face or on a hem, inside the image, not hidden by
  /// `others`, and within 1.5 coarse pixels of the background, where there is neither cloth nor anything of `others`.
  void outline(const CoarseBuffer &others, std::vector<Rim> &result);
  /// The rim edges on the outline that outline() saw last.
  const std::vector<OutlineEdge> &outline_edges() const { return outline_edges_; }
  /// squared [samples][count]: squared distances of points (x, y) to the outline of one region in each sample, which outline()
  /// saw last, pixels^2, at most `largest`.
  void approach(int region, int count, const float *x, const float *y, float largest, std::vector<float> &squared) const;
  /// The points of the cloth under the features of the previous frame of each match; all matches, sorted by where they are.
  void locate(const std::vector<FeatureMatch> &matches, const CoarseBuffer &others, LocatedFeatures &result);
  /// [count][lanes] squared distances between where the located features are now and where they are seen, pixels^2, at most
  /// `largest` [count]; -1 = not on the cloth.
  const std::vector<float> &squared_errors(const LocatedFeatures &located, const std::vector<float> &largest);

private:
  /// An edge of one sample between a front and a back face, or on a hem.
  struct RimEdge {
    int a, b, lane, face;
    bool cloth_below; ///< where it runs to the right
  };
  bool coarse_box();
  void count_layers();
  void add_edge(const ClothEdge &edge, int lane, int layers);
  void mask_others(const CoarseBuffer &others);
  bool on_outline(const RimEdge &edge) const;
  void sort_features(const std::vector<FeatureMatch> &matches);

  const ClothTopology *topology_;
  int samples_;
  const LaneKernels *kernels_;
  const CoarseCamera *camera_ = nullptr;
  std::vector<float> positions_, image_;
  std::array<float, 4> box_{};      // around all vertices in all lanes, pixels
  std::vector<signed char> facing_; // [G + 1][lanes], the last row 0
  std::vector<RimEdge> rim_edges_;
  std::vector<OutlineEdge> outline_edges_;
  std::vector<std::uint16_t> rim_;               // [D] bit l: on the outline in lane l
  int x0_ = 0, y0_ = 0, width_ = 0, height_ = 0; // the box around the cloth in coarse pixels, of all lanes
  std::vector<std::uint8_t> layers_;  // [samples][height][width] how many faces of the cloth lie over each other, mod 256
  std::vector<std::uint8_t> covered_; // [height][width] 1 = by something that is not cloth, or outside the image
  // Features by cells of a grid over the image
  FeatureGrid grid_{};
  std::vector<int> cell_, first_, before_, order_;
  std::vector<float> feature_x_, feature_y_, nearest_, squared_;
};

} // namespace doublet::fit
