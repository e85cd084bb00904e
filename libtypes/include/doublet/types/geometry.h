#pragma once
// The geometry types of all libraries. Arrays are row-major, so that NumPy can view them without a copy.

#include <Eigen/Core>

#include <cstdint>
#include <vector>

namespace doublet {

/// (N, 3) positions, metres, +Y up, right-handed.
using Vertices = Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor>;
/// (F, 3) triangles as vertex indices, counter-clockwise seen from outside.
using Faces = Eigen::Matrix<int, Eigen::Dynamic, 3, Eigen::RowMajor>;
/// One flag per face, vertex or frame: 0 = no, anything else = yes. As an argument, empty = yes for all, where documented. Bytes,
/// since elements of a vector of bool have no address and threads may not write neighbouring ones.
using Mask = std::vector<std::uint8_t>;

/// A tapered capsule in the world, m: two spheres and the cone between them.
struct Capsule {
  Eigen::Vector3d p0, p1;
  double r0 = 0, r1 = 0;
};

/// A non-owning view of (N, 3) positions: pointer and count, passed by value. Empty by default. The positions must outlive the
/// call to which the view is passed.
class VerticesView {
public:
  VerticesView() = default;
  VerticesView(const Vertices &positions) : data_(positions.data()), rows_(positions.rows()) {}
  VerticesView(const Vertices &&) = delete; // a temporary is gone when the view is looked at
  /// `rows` times x y z, contiguous.
  VerticesView(const double *data, Eigen::Index rows) : data_(data), rows_(rows) {}
  bool empty() const { return rows_ == 0; }
  Eigen::Index rows() const { return rows_; }
  Eigen::Map<const Vertices> map() const { return {data_, rows_, 3}; }

private:
  const double *data_ = nullptr;
  Eigen::Index rows_ = 0;
};

} // namespace doublet
