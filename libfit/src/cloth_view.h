#pragma once
// The simulated cloth as one camera sees it: who is in front at each (coarse) pixel, which vertices make the outline, where
// features lie.

#include "doublet/animate/character_simulator.h"
#include "doublet/core/camera.h"

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace doublet::fit {

/// The faces that move with the cloth and their topology; fixed for a character. Local indices into `vertices`.
struct ClothTopology {
  std::vector<int> vertices;                  ///< (D) index into M
  std::vector<int> region;                    ///< (D) -1 = the ring that follows the skeleton
  std::vector<std::uint8_t> hem;              ///< (D) on a border of the valid faces of M
  std::vector<std::array<int, 3>> faces;      ///< (G)
  std::vector<int> face_region;               ///< (G)
  std::vector<std::array<int, 3>> neighbours; ///< (G) face across the edge opposite to each corner, -1 = none
  std::vector<std::uint8_t> face_is_cloth;    ///< (F) of M: one of the above
};
ClothTopology cloth_topology(const CharacterSimulator &simulator);

/// A rectangle of coarse pixels with the nearest inverse depth (1/m along the optical axis, 0 = background) and the cloth face
/// there.
struct CoarseBuffer {
  int x0 = 0, y0 = 0, width = 0, height = 0;
  std::vector<float> inverse_depth;
  std::vector<int> face; ///< -1 = background, or something that is not cloth; empty where only depth matters
  bool holds(int x, int y) const { return x >= x0 && y >= y0 && x < x0 + width && y < y0 + height; }
  std::size_t index(int x, int y) const { return static_cast<std::size_t>(y - y0) * width + (x - x0); }
};

/// A camera and the coarse raster laid over its image.
struct CoarseCamera {
  Camera camera;
  int width = 0, height = 0; ///< coarse pixels
  float scale_x = 1, scale_y = 1;
  CoarseCamera(const Camera &camera, int larger_side);
  float coarse_x(float x) const { return (x + 0.5f) * scale_x - 0.5f; }
  float coarse_y(float y) const { return (y + 0.5f) * scale_y - 0.5f; }
};

struct Projected {
  float x = 0, y = 0;      ///< pixels of the full image
  float inverse_depth = 0; ///< 1/m; 0 = behind the near plane, not drawable
};

/// A place on the cloth: face and barycentric coordinates of its corners.
struct SurfacePoint {
  int face = -1;
  Eigen::Vector3f barycentric;
};

/// One view of one simulated frame; reused from frame to frame, so that nothing is allocated in the loop.
class ClothView {
public:
  explicit ClothView(const ClothTopology &topology) : topology_(&topology) {}
  /// Projects and draws the cloth of `surface` (V, 3) over `others`, what is not cloth.
  void draw(const Vertices &surface, const CoarseCamera &camera, const CoarseBuffer &others);
  const std::vector<Projected> &projected() const { return projected_; }
  /// Local indices of the free vertices that lie on the outline of the whole character: between front and back faces or on a hem,
  /// inside the image, within 1.5 coarse pixels of the background, and not hidden.
  void outline(std::vector<int> &result) const;
  /// The visible point of the cloth under a pixel of the full image.
  std::optional<SurfacePoint> locate(const Eigen::Vector2f &pixel) const;

private:
  void project(const Vertices &surface);
  void clear(const CoarseBuffer &others);
  void draw_face(int face);
  bool on_outline(int vertex) const;

  const ClothTopology *topology_;
  const CoarseCamera *camera_ = nullptr;
  std::vector<Projected> projected_, coarse_; // (D)
  std::vector<std::uint8_t> facing_;          // (D) bit 0: touches a front face, bit 1: a back face
  CoarseBuffer buffer_;
};

/// The proxies as a closed triangle mesh: they stand for the legs that M lacks under the garment.
Mesh capsule_mesh(const std::vector<pbd::Capsule> &capsules);

} // namespace doublet::fit
