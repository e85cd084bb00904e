#include "nearest_points.h"

#include <flann/flann.hpp>

namespace doublet {

struct NearestPoints::Impl {
  explicit Impl(const Vertices &points)
      : data(points), index(flann::Matrix<double>(data.data(), data.rows(), 3), flann::KDTreeSingleIndexParams(8)) {
    index.buildIndex();
  }
  Vertices data;
  flann::Index<flann::L2_3D<double>> index;
};

NearestPoints::NearestPoints(const Vertices &points) : impl_(std::make_unique<Impl>(points)) {}
NearestPoints::~NearestPoints() = default;

int NearestPoints::nearest(const Eigen::Vector3d &query) const {
  Eigen::Vector3d point = query;
  int row = 0;
  double squared = 0;
  flann::Matrix<int> rows(&row, 1, 1);
  flann::Matrix<double> distances(&squared, 1, 1);
  flann::SearchParams exact(flann::FLANN_CHECKS_UNLIMITED);
  impl_->index.knnSearch(flann::Matrix<double>(point.data(), 1, 3), rows, distances, 1, exact);
  return row;
}

} // namespace doublet
