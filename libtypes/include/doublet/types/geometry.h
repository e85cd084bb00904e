#pragma once
// The shapes that every library speaks of. Arrays are row-major, so that NumPy sees them without a copy.

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace doublet {

/// (N, 3) positions, metres, +Y up, right-handed.
using Vertices = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
/// (F, 3) triangles as vertex indices, counter-clockwise seen from outside.
using Faces = Eigen::Matrix<int, Eigen::Dynamic, 3, Eigen::RowMajor>;
/// Yes or no of every face, vertex or frame: 0 = no, anything else = yes. As an argument, empty = yes of all, where the function
/// says so. Bytes, since the elements of a vector of bool have no address and two threads may not write neighbours.
using Mask = std::vector<std::uint8_t>;

/// A tapered capsule in the world, m: two spheres and the cone between them.
struct Capsule {
  Eigen::Vector3d p0, p1;
  double r0 = 0, r1 = 0;
};

/// (N, 3) positions that belong to somebody else: where they are and how many, passed by value. Empty unless told otherwise.
/// Whoever makes one sees to it that the positions stay until the call that it is an argument of is over.
class VerticesView {
public:
  VerticesView() = default;
  VerticesView(const Vertices &positions) : data_(positions.data()), rows_(positions.rows()) {}
  VerticesView(const Vertices &&) = delete; // a temporary is gone when the view is looked at
  /// `rows` times x y z, one behind the other.
  VerticesView(const double *data, Eigen::Index rows) : data_(data), rows_(rows) {}
  bool empty() const { return rows_ == 0; }
  Eigen::Index rows() const { return rows_; }
  Eigen::Map<const Vertices> map() const { return {data_, rows_, 3}; }

private:
  const double *data_ = nullptr;
  Eigen::Index rows_ = 0;
};

} // namespace doublet
