#pragma once
// What the bones of a baked animation have to carry, frame by frame, to have the vertices where they are.

#include "glb_parts.h"

namespace doublet {

using Floats3 = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// A skinned mesh and where it is in every frame; positions and poses are looked at, not kept.
struct BoundMesh {
  std::string name;
  glb::GlbMesh shown;
  Faces faces;      ///< of the vertices before corners were split: a normal is the same on both sides of a seam in the texture
  MatrixRM weights; ///< (original vertices, J): every blend of bones can be undone in every frame
  glb::Influences influences;
  const std::vector<Vertices> *positions; ///< [frame] (original vertices, 3) m
  const std::vector<Transforms> *poses;   ///< [frame] world from rest
};
BoundMesh bind_mesh(std::string name, glb::GlbMesh shown, Faces faces, MatrixRM weights, const std::vector<Vertices> &positions,
                    const std::vector<Transforms> &poses);

/// (shown vertices, 3) m, before the bones move it.
Floats3 shape_at(const BoundMesh &mesh, int frame);
/// (shown vertices, 3) unit, before the bones turn them.
Floats3 normals_at(const BoundMesh &mesh, int frame);
/// m, how far each shown vertex is from its place where the bones carry `shape`.
std::vector<double> errors_at(const BoundMesh &mesh, int frame, const Floats3 &shape);

} // namespace doublet
