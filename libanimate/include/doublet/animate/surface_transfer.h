#pragma once
// The display mesh follows the coarse one (as in de Aguiar et al. 2008): every fine vertex has coordinates in the frames of a few
// nearby coarse triangles (in-plane coordinates stretch with the triangle, the height above it is in metres); the resulting
// positions are blended.

#include "doublet/core/mesh.h"

#include <Eigen/SparseCore>

#include <cstdint>
#include <vector>

namespace doublet {

using SparseRows = Eigen::SparseMatrix<double, Eigen::RowMajor>;
/// Rows of three numbers and an unused fourth, so that a row fills two SIMD registers.
using PaddedRows = Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>;
/// out = weights * rows.
void multiply(const SparseRows &weights, const PaddedRows &rows, Eigen::Ref<Vertices> out);

/// Immutable after construction; apply() is exact in the rest pose and under rigid motion.
class SurfaceTransfer {
public:
  /// coarse and fine in the same pose. `coarse_valid` (F) and `fine_valid` (F'), empty = all: vertices of valid fine triangles
  /// are bound to valid coarse triangles only. Throws Error on unusable meshes, wrong sizes, or if no coarse triangle is valid.
  SurfaceTransfer(const Mesh &coarse, const Mask &coarse_valid, const Mesh &fine, const Mask &fine_valid);

  /// (V', 3) fine vertices for the coarse vertices (V, 3), m.
  Vertices apply(const Vertices &coarse) const;
  /// The same into existing rows; allocates nothing once `buffer` has been used.
  void apply(const Vertices &coarse, Eigen::Ref<Vertices> fine, PaddedRows &buffer) const;
  /// (V', C) per-vertex values of the coarse mesh (V, C) at the closest coarse point of each fine vertex, e.g. skin weights.
  MatrixRM sample(const MatrixRM &coarse_values) const;

private:
  Faces coarse_faces_;
  int coarse_vertices_ = 0;
  /// (V', V + F): of the coarse vertices, and, below them, of the coarse faces' unit normals (m). A point in the frame of a
  /// triangle, in-plane along two edges and up along the normal, is linear in those.
  SparseRows weights_;
  std::vector<int> closest_face_; ///< (V')
  Vertices closest_;              ///< (V', 3) barycentric
};

} // namespace doublet
