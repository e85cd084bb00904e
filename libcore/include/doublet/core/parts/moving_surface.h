#pragma once
// Closest points on a surface that moves, frame by frame.

#include "doublet/core/mesh.h"

#include <array>
#include <optional>

namespace doublet {

/// The nearest point of a mesh whose faces stay and whose vertices come anew with every frame: a tree of boxes over the faces,
/// built once, which is fitted to them. Once made it allocates nothing. RayScene is for surfaces that stay: it is built anew.
class MovingSurface {
public:
  struct Point {
    int face;
    Eigen::Vector3d point;       ///< m
    Eigen::Vector3d barycentric; ///< of the face's corners
    double distance;             ///< m, unsigned
  };

  /// Faces with face_valid[f] == 0 are not there (empty = all are). Throws Error if the mesh is not usable(), or none is.
  explicit MovingSurface(const Mesh &mesh, const Mask &face_valid = {});
  /// vertices (V, 3) m; throws std::invalid_argument for another number of them, or one that is not within 1e15 m.
  void move_to(const Vertices &vertices);
  /// The nearest point, of the lowest face if there are several; nothing if it is `within` m or further away. `hint`: a face that
  /// may be near, such as the answer of the frame before; it saves time and changes nothing. -1 = none.
  std::optional<Point> closest(const Eigen::Vector3d &point, double within, int hint = -1) const;

private:
  /// Four boxes side by side, each around a node or a single face; the others are empty.
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
