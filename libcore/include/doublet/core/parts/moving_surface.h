#pragma once
// Closest points on a surface that moves, frame by frame.

#include "doublet/core/mesh.h"

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
  explicit MovingSurface(const Mesh &mesh, const std::vector<std::uint8_t> &face_valid = {});
  /// vertices (V, 3) m; throws std::invalid_argument for another number of them, or one that is not finite.
  void move_to(const Vertices &vertices);
  /// The nearest point, of the lowest face if there are several; nothing if it is `within` m or further away. `hint`: a face that
  /// may be near, such as the answer of the frame before; it saves time and changes nothing. -1 = none.
  std::optional<Point> closest(const Eigen::Vector3d &point, double within, int hint = -1) const;

private:
  struct Node {
    Eigen::Array3d low = Eigen::Array3d::Zero(), high = Eigen::Array3d::Zero();
    int skip = 0;            ///< the first node behind this one's descendants
    int first = 0, last = 0; ///< of a leaf, into order_; of others 0, 0
  };
  void add(int first, int last, const Vertices &centres);
  void fit();
  void try_face(int face, const Eigen::Vector3d &point, Point &best) const;

  Vertices vertices_;
  Faces faces_;
  std::vector<std::uint8_t> valid_; ///< [face]
  std::vector<int> order_;          ///< valid faces as they lie in the leaves
  std::vector<Node> nodes_;         ///< in the order of a walk from the root
};

} // namespace doublet
