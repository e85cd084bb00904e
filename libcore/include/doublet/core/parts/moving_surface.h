#pragma once
// Closest points on a surface that deforms from frame to frame.

#include "doublet/core/mesh.h"

#include <array>
#include <optional>

namespace doublet {

/// Closest point on a mesh with constant faces and new vertices in every frame: a tree of boxes over the faces, built once and
/// refitted for each frame. Allocates nothing after construction. For static surfaces use RayScene, which would have to be
/// rebuilt.
class MovingSurface {
public:
  struct Point {
    int face;
    Eigen::Vector3d point;       ///< m
    Eigen::Vector3d barycentric; ///< of the face's corners
    double distance;             ///< m, unsigned
  };

  /// Faces with face_valid[f] == 0 are ignored (empty = all are valid). Throws Error if the mesh is not usable(), or no face is
  /// valid.
  explicit MovingSurface(const Mesh &mesh, const Mask &face_valid = {});
  /// vertices (V, 3) m; throws std::invalid_argument for another number of them, or one that is not within 1e15 m.
  void move_to(const Vertices &vertices);
  /// The closest point, on the face with the lowest index if there are several; none if it is `within` (m) or further away.
  /// `hint`: a face that may be close, such as the result of the previous frame; it saves time without changing the result. -1 =
  /// none.
  std::optional<Point> closest(const Eigen::Vector3d &point, double within, int hint = -1) const;

private:
  /// Up to four boxes, each around a node or a single face; unused ones are empty.
  struct Node {
    std::array<Eigen::Array4f, 3> low, high; ///< along x, y, z, m
    std::array<int, 4> child;                ///< a node, or the complement (~) of a face
  };
  int add(int first, int last, const Vertices &centres, std::vector<int> &order);
  void fit();
  void try_face(int face, const Eigen::Vector3d &point, Point &best) const;

  Vertices vertices_;
  Faces faces_;
  Mask valid_;              ///< [face]
  std::vector<Node> nodes_; ///< the root first, children behind their parents
  double largest_ = 0;      ///< of all coordinates, m
};

} // namespace doublet
