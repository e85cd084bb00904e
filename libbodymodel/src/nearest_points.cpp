#include "nearest_points.h"

#include <nanoflann.hpp>

namespace doublet {

struct NearestPoints::Impl {
  using Tree = nanoflann::KDTreeEigenMatrixAdaptor<Vertices, 3, nanoflann::metric_L2_Simple>;
  explicit Impl(const Vertices &points) : data(points), tree(3, data, 8) {}
  Vertices data;
  Tree tree; // refers to data
};

NearestPoints::NearestPoints(const Vertices &points) : impl_(std::make_unique<Impl>(points)) {}
NearestPoints::~NearestPoints() = default;

int NearestPoints::nearest(const Eigen::Vector3d &query) const {
  Impl::Tree::IndexType row = 0;
  double squared = 0;
  impl_->tree.query(query.data(), 1, &row, &squared);
  return static_cast<int>(row);
}

} // namespace doublet
