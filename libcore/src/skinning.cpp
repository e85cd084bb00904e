#include "doublet/core/skinning.h"

#include <array>
#include <cmath>
#include <stdexcept>

namespace doublet {

namespace {

using DualQuaternion = Eigen::Matrix<double, 8, 1>; ///< real w x y z, dual w x y z

void require_sizes(const char *caller, Eigen::Index vertices, const MatrixRM &weights, const Transforms &transforms) {
  if (weights.rows() != vertices || weights.cols() != static_cast<Eigen::Index>(transforms.size()))
    throw std::invalid_argument(std::string(caller) + ": expected weights (" + std::to_string(vertices) + ", " +
                                std::to_string(transforms.size()) + "), found (" + std::to_string(weights.rows()) + ", " +
                                std::to_string(weights.cols()) + ")");
}

/// Kavan et al. 2007, eq. (4): q = r + eps t r / 2.
DualQuaternion dual_quaternion(const Eigen::Isometry3d &transform) {
  const Eigen::Quaterniond r = Eigen::Quaterniond(transform.linear()).normalized();
  const Eigen::Vector3d t = 0.5 * transform.translation();
  const Eigen::Quaterniond d = Eigen::Quaterniond(0, t.x(), t.y(), t.z()) * r;
  DualQuaternion out;
  out << r.w(), r.vec(), d.w(), d.vec();
  return out;
}

/// Blends in the hemisphere of the joint with the largest weight, and normalises the real part.
class Blender {
public:
  explicit Blender(const Transforms &transforms) {
    for (const Eigen::Isometry3d &t : transforms)
      joints_.push_back(dual_quaternion(t));
  }

  DualQuaternion blend(const MatrixRM &weights, Eigen::Index v) const {
    const double *w = weights.data() + v * weights.cols();
    std::size_t pivot = 0;
    for (std::size_t j = 1; j < joints_.size(); ++j)
      if (w[j] > w[pivot])
        pivot = j;
    DualQuaternion sum = DualQuaternion::Zero();
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      if (w[j] == 0)
        continue;
      const bool opposite = joints_[j].head<4>().dot(joints_[pivot].head<4>()) < 0;
      sum += (opposite ? -w[j] : w[j]) * joints_[j];
    }
    const double norm = sum.head<4>().norm();
    if (!(norm > 0))
      throw std::invalid_argument("dual quaternion skinning: expected skin weights that sum to one, found none at vertex " +
                                  std::to_string(v));
    return sum / norm;
  }

private:
  std::vector<DualQuaternion> joints_;
};

/// Translation 2 (w_r d - w_d r + r x d) of a dual quaternion with unit real part.
Eigen::Vector3d translation_of(const DualQuaternion &q) {
  const Eigen::Vector3d r = q.segment<3>(1), d = q.segment<3>(5);
  return 2 * (q[0] * d - q[4] * r + r.cross(d));
}

} // namespace

Vertices dual_quaternion_skinning(const Vertices &rest, const MatrixRM &weights, const Transforms &world_from_rest) {
  require_sizes("dual_quaternion_skinning", rest.rows(), weights, world_from_rest);
  if (!rest.allFinite())
    throw std::invalid_argument("dual_quaternion_skinning: expected finite rest positions, found NaN or infinity");
  const Blender blender(world_from_rest);
  Vertices out(rest.rows(), 3);
  for (Eigen::Index v = 0; v < rest.rows(); ++v) {
    const DualQuaternion q = blender.blend(weights, v);
    const Eigen::Vector3d r = q.segment<3>(1), p = rest.row(v);
    out.row(v) = p + 2 * r.cross(r.cross(p) + q[0] * p) + translation_of(q);
  }
  return out;
}

Transforms dual_quaternion_blend(const MatrixRM &weights, const Transforms &world_from_rest) {
  require_sizes("dual_quaternion_blend", weights.rows(), weights, world_from_rest);
  const Blender blender(world_from_rest);
  Transforms out(weights.rows(), Eigen::Isometry3d::Identity());
  for (Eigen::Index v = 0; v < weights.rows(); ++v) {
    const DualQuaternion q = blender.blend(weights, v);
    out[v].linear() = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
    out[v].translation() = translation_of(q);
  }
  return out;
}

Vertices linear_blend_skinning(const Vertices &rest, const MatrixRM &weights, const Transforms &world_from_rest) {
  require_sizes("linear_blend_skinning", rest.rows(), weights, world_from_rest);
  Vertices out = Vertices::Zero(rest.rows(), 3);
  for (Eigen::Index v = 0; v < rest.rows(); ++v)
    for (Eigen::Index j = 0; j < weights.cols(); ++j)
      if (weights(v, j) != 0)
        out.row(v) += weights(v, j) * (world_from_rest[j] * rest.row(v).transpose()).transpose();
  return out;
}

} // namespace doublet
