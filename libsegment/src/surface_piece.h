#pragma once
// A part of the actor's surface, cut out along a line of equal values.

#include "doublet/core/mesh.h"

#include <array>
#include <string>
#include <vector>

namespace doublet::detail {

/// Of the diffused indicator of garment: the middle of the step from skin to cloth.
constexpr double kCut = 0.5;

/// Every corner of every face knows its place on the actor.
struct Piece {
  Mesh mesh;
  std::vector<int> actor_face;                         ///< [F]
  std::vector<std::array<Eigen::Vector3d, 3>> corners; ///< [F] barycentric on the actor's face
};

/// The surface where `field` (V) > kCut (marching triangles). No value of the field may be kCut.
Piece cut_out(const Mesh &mesh, const Eigen::VectorXd &field);

/// (N, 3) where the piece's vertices are when the actor's are at `actor_vertices`.
Vertices placed(const Piece &piece, const Faces &actor_faces, const Vertices &actor_vertices);

/// Throws Error unless every directed edge has one face at most and the faces around every vertex hang together: who walks around
/// a vertex of another surface, or along its boundary, does not come back.
void require_manifold(const Mesh &mesh, const std::string &what);

} // namespace doublet::detail
