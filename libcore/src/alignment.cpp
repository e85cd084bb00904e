#include "doublet/core/parts/alignment.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>

namespace doublet {

Eigen::Matrix3d shortest_turn(const Eigen::Vector3d &from, const Eigen::Vector3d &to) {
  return Eigen::Quaterniond::FromTwoVectors(from, to).toRotationMatrix();
}

Eigen::Matrix4d nearest_similarity(const Eigen::Matrix3Xd &from, const Eigen::Matrix3Xd &to, AlignmentScale scale) {
  return Eigen::umeyama(from, to, scale == AlignmentScale::Free);
}

} // namespace doublet
