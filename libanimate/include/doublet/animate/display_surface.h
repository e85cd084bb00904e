#pragma once
// The surface of a character that is drawn: M_high, which follows M. If the garment has a mesh of its own: the skin of M_high,
// and the garment's mesh as a displaced subdivision surface (Lee, Moreton & Hoppe, SIGGRAPH 2000): hem and seam are smooth
// curves, no triangle bridges a fold, and the scan's detail is a height along the normal.

#include "doublet/animate/surface_transfer.h"
#include "doublet/core/skinning.h"
#include "doublet/core/stage_values.h"

#include <optional>
#include <utility>

namespace doublet {

struct Character;
namespace detail {
struct GarmentPart;
}

struct DisplayMesh {
  Mesh mesh;  ///< (VH, 3) m in the scan pose, (FH, 3)
  Mask valid; ///< (FH) 0 = not drawn
  /// n: the last 4^n H faces are the garment's H faces, subdivided n times; -1 = `mesh` is one surface, as scanned.
  int garment_subdivisions = -1;
};

/// `high`: M_high as scanned, closed. Its faces are drawn where the nearest face of M is valid. If the actor wears a garment
/// (`segmentation` has a rest shape), the garment replaces the faces that it covers, at the resolution of `high`; the skin
/// continues below the seam, sunk under the garment, so that no gap opens. With a body, surface that lies on the body like skin
/// is not mistaken for the surface that closes the scan below a hem. Throws Error on unusable meshes.
DisplayMesh build_display_mesh(const RiggedMesh &actor, const Segmentation &segmentation, const Mesh &high,
                               const Mesh &body = {});

/// Memory that DisplaySurface::apply() reuses.
struct DisplayBuffers {
  PaddedRows skin_rows, garment_rows;
  Vertices garment, garment_normals, cloth, cloth_normals, carried;
  std::vector<DualQuaternion> joints;
};

struct WeightedVertex {
  int vertex;
  double weight;
};

/// Immutable after construction; apply() is exact in the scan pose and under rigid motion.
class DisplaySurface {
public:
  /// Throws Error if the character has no M_high, or one that does not fit its garment.
  explicit DisplaySurface(const Character &character);

  /// (VH, 3) m, vertices of M_high for the vertices (V, 3) of M.
  Vertices apply(const Vertices &surface) const;
  /// The same into `high`; allocates nothing once `high` and the buffers have been used.
  void apply(const Vertices &surface, Vertices &high, DisplayBuffers &buffers) const;
  /// The same in a known pose, `joints` from dual_quaternions(): the body that is welded to the skin is skinned with them. The
  /// other overloads infer the motion of each joint from that of its skin.
  void apply(const Vertices &surface, const std::vector<DualQuaternion> &joints, Vertices &high, DisplayBuffers &buffers) const;
  /// (VH, C) values of M's vertices (V, C), e.g. skin weights, interpolated at M_high's.
  MatrixRM sample(const MatrixRM &values) const;
  /// (VH, J) skin weights of M_high from M's (V, J); the body that is welded to it has its own.
  MatrixRM skin_weights(const MatrixRM &weights) const;

private:
  void carry(const Character &character, const Mask &valid, const Mesh &skin, const detail::GarmentPart &part);
  void joints_of(const Vertices &surface, std::vector<DualQuaternion> &joints) const;

  std::optional<SurfaceTransfer> skin_; ///< of the vertices before the garment's; none = no such vertices
  Eigen::Index skin_vertices_ = 0, scan_vertices_ = 0, coarse_vertices_ = 0; ///< the scan's are the first of the skin's
  std::optional<SkinBinding> binding_;  ///< of the body in M_high, and of the scan's skin beside it ...
  std::vector<WeightedVertex> carried_; ///< ... of M_high, which go so far with it
  MatrixRM carried_weights_;            ///< of those, (., J)
  std::vector<int> nearest_;            ///< of M, to each vertex of the body
  Vertices rest_;                       ///< of M
  Skeleton skeleton_;
  std::vector<std::vector<WeightedVertex>> told_by_; ///< [joint] of M
  std::vector<int> garment_vertices_;                ///< [G] of M
  Faces garment_faces_;                              ///< (H, 3) of those
  SparseRows subdivide_;                             ///< (G', G)
  Eigen::VectorXd heights_;                          ///< (G') m over the subdivided garment
};

// Deprecated names.
using Display [[deprecated("use DisplayMesh")]] = DisplayMesh;
template <class... A> [[deprecated("use build_display_mesh")]] decltype(auto) make_display(A &&...a) {
  return build_display_mesh(std::forward<A>(a)...);
}

} // namespace doublet
