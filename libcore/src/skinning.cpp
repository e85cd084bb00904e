#include "doublet/core/skinning.h"

#include <array>
#include <cmath>
#include <stdexcept>

namespace doublet {

namespace {

void require_sizes(const char *caller, Eigen::Index vertices, const MatrixRM &weights, Eigen::Index joints) {
  if (weights.rows() != vertices || weights.cols() != joints)
    throw std::invalid_argument(std::string(caller) + ": expected weights (" + std::to_string(vertices) + ", " +
                                std::to_string(joints) + "), found (" + std::to_string(weights.rows()) + ", " +
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

/// What a vertex takes of each joint that moves it, in ascending order of the joints.
struct Shares {
  const int *joints;
  const double *weights;
  int count;
  int pivot; ///< the joint with the largest weight, the first of equal ones
};

/// Which sign a joint has in a vertex's blend; q and -q are the same transform.
enum class Signs {
  Pivot, ///< that of the hemisphere of the vertex's heaviest joint
  Given, ///< its own, see dual_quaternions()
};

/// Blends, and normalises the real part.
DualQuaternion blend(const std::vector<DualQuaternion> &joints, Signs signs, const Shares &of, Eigen::Index vertex) {
  constexpr double kNothing = 1e-9; // joints a whole turn apart cancel: between them the pivot is as good as any
  DualQuaternion sum = DualQuaternion::Zero();
  double weight = 0;
  for (int k = 0; k < of.count; ++k) {
    const DualQuaternion &joint = joints[of.joints[k]];
    const bool opposite = signs == Signs::Pivot && joint.head<4>().dot(joints[of.pivot].head<4>()) < 0;
    sum += (opposite ? -of.weights[k] : of.weights[k]) * joint;
    weight += of.weights[k];
  }
  const double norm = sum.head<4>().norm();
  if (norm > kNothing * weight)
    return sum / norm;
  if (!(weight > 0) || !std::isfinite(norm))
    throw std::invalid_argument("dual quaternion skinning: expected skin weights that sum to one, found none at vertex " +
                                std::to_string(vertex));
  return joints[of.pivot];
}

/// Stores what row v of the weights (V, J) holds beside zeros in `joints` and `values`, which have room for J. Without a branch:
/// where the zeros are, no processor could foresee.
Shares shares_of(const MatrixRM &weights, Eigen::Index v, int *joints, double *values) {
  const double *row = weights.data() + v * weights.cols();
  int count = 0, pivot = 0;
  double heaviest = weights.cols() > 0 ? row[0] : 0;
  for (int j = 0; j < weights.cols(); ++j) {
    joints[count] = j;
    values[count] = row[j];
    count += row[j] != 0;
    pivot = row[j] > heaviest ? j : pivot;
    heaviest = row[j] > heaviest ? row[j] : heaviest;
  }
  return {joints, values, count, pivot};
}

/// The blend of every vertex, in turn.
template <class Use>
void blend_each(const MatrixRM &weights, const std::vector<DualQuaternion> &joints, Signs signs, const Use &use) {
  std::vector<int> used(weights.cols());
  std::vector<double> values(weights.cols());
  for (Eigen::Index v = 0; v < weights.rows(); ++v)
    use(v, blend(joints, signs, shares_of(weights, v, used.data(), values.data()), v));
}

/// Translation 2 (w_r d - w_d r + r x d) of a dual quaternion with unit real part.
Eigen::Vector3d translation_of(const DualQuaternion &q) {
  const Eigen::Vector3d r = q.segment<3>(1), d = q.segment<3>(5);
  return 2 * (q[0] * d - q[4] * r + r.cross(d));
}

Eigen::Vector3d moved(const DualQuaternion &q, const Eigen::Vector3d &p) {
  const Eigen::Vector3d r = q.segment<3>(1);
  return p + 2 * r.cross(r.cross(p) + q[0] * p) + translation_of(q);
}

void require_finite_rest(const Vertices &rest, const char *caller) {
  if (!rest.allFinite())
    throw std::invalid_argument(std::string(caller) + ": expected finite rest positions, found NaN or infinity");
}

Vertices skinned(const Vertices &rest, const MatrixRM &weights, const std::vector<DualQuaternion> &joints, Signs signs) {
  require_sizes("dual_quaternion_skinning", rest.rows(), weights, static_cast<Eigen::Index>(joints.size()));
  require_finite_rest(rest, "dual_quaternion_skinning");
  Vertices out(rest.rows(), 3);
  blend_each(weights, joints, signs, [&](Eigen::Index v, const DualQuaternion &q) { out.row(v) = moved(q, rest.row(v)); });
  return out;
}

Transforms blended(const MatrixRM &weights, const std::vector<DualQuaternion> &joints, Signs signs) {
  require_sizes("dual_quaternion_blend", weights.rows(), weights, static_cast<Eigen::Index>(joints.size()));
  Transforms out(weights.rows(), Eigen::Isometry3d::Identity());
  blend_each(weights, joints, signs, [&](Eigen::Index v, const DualQuaternion &q) {
    out[v].linear() = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).toRotationMatrix();
    out[v].translation() = translation_of(q);
  });
  return out;
}

/// Of transforms that nothing is known about.
std::vector<DualQuaternion> unrelated(const Transforms &world_from_rest) {
  std::vector<DualQuaternion> joints;
  for (const Eigen::Isometry3d &transform : world_from_rest)
    joints.push_back(dual_quaternion(transform));
  return joints;
}
std::vector<DualQuaternion> along(const Skeleton &skeleton, const Transforms &world_from_rest) {
  std::vector<DualQuaternion> joints;
  dual_quaternions(skeleton, world_from_rest, joints);
  return joints;
}

} // namespace

void dual_quaternions(const Skeleton &skeleton, const Transforms &world_from_rest, std::vector<DualQuaternion> &joints) {
  if (static_cast<int>(world_from_rest.size()) != skeleton.joint_count())
    throw std::invalid_argument("dual_quaternions: expected " + std::to_string(skeleton.joint_count()) + " transforms, found " +
                                std::to_string(world_from_rest.size()));
  joints.clear();
  for (std::size_t j = 0; j < world_from_rest.size(); ++j) {
    joints.push_back(dual_quaternion(world_from_rest[j]));
    const int parent = skeleton.joints[j].parent;
    if (parent >= 0 && joints[j].head<4>().dot(joints[parent].head<4>()) < 0)
      joints[j] = -joints[j];
  }
}

SkinBinding::SkinBinding(const Vertices &rest, const MatrixRM &weights) : rest_(rest), joint_count_(weights.cols()), first_{0} {
  require_sizes("SkinBinding", rest.rows(), weights, weights.cols());
  require_finite_rest(rest, "SkinBinding");
  std::vector<int> used(weights.cols());
  std::vector<double> values(weights.cols());
  for (Eigen::Index v = 0; v < rest.rows(); ++v) {
    if (!(weights.row(v).sum() > 0))
      throw std::invalid_argument("SkinBinding: expected skin weights that sum to one, found none at vertex " +
                                  std::to_string(v));
    const Shares shares = shares_of(weights, v, used.data(), values.data());
    pivots_.push_back(shares.pivot);
    joints_.insert(joints_.end(), shares.joints, shares.joints + shares.count);
    weights_.insert(weights_.end(), shares.weights, shares.weights + shares.count);
    first_.push_back(static_cast<int>(joints_.size()));
  }
}

void SkinBinding::pose(const std::vector<DualQuaternion> &joints, Vertices &skinned) const {
  if (static_cast<Eigen::Index>(joints.size()) != joint_count_)
    throw std::invalid_argument("SkinBinding::pose: expected " + std::to_string(joint_count_) + " dual quaternions, found " +
                                std::to_string(joints.size()));
  skinned.resize(rest_.rows(), 3);
  for (Eigen::Index v = 0; v < rest_.rows(); ++v) {
    const int first = first_[v];
    const Shares shares{joints_.data() + first, weights_.data() + first, first_[v + 1] - first, pivots_[v]};
    skinned.row(v) = moved(blend(joints, Signs::Given, shares, v), rest_.row(v));
  }
}

Vertices dual_quaternion_skinning(const Vertices &rest, const MatrixRM &weights, const Transforms &world_from_rest) {
  return skinned(rest, weights, unrelated(world_from_rest), Signs::Pivot);
}
Vertices dual_quaternion_skinning(const Vertices &rest, const MatrixRM &weights, const Skeleton &skeleton,
                                  const Transforms &world_from_rest) {
  return skinned(rest, weights, along(skeleton, world_from_rest), Signs::Given);
}

Transforms dual_quaternion_blend(const MatrixRM &weights, const Transforms &world_from_rest) {
  return blended(weights, unrelated(world_from_rest), Signs::Pivot);
}
Transforms dual_quaternion_blend(const MatrixRM &weights, const Skeleton &skeleton, const Transforms &world_from_rest) {
  return blended(weights, along(skeleton, world_from_rest), Signs::Given);
}

Vertices linear_blend_skinning(const Vertices &rest, const MatrixRM &weights, const Transforms &world_from_rest) {
  require_sizes("linear_blend_skinning", rest.rows(), weights, static_cast<Eigen::Index>(world_from_rest.size()));
  Vertices out = Vertices::Zero(rest.rows(), 3);
  for (Eigen::Index v = 0; v < rest.rows(); ++v)
    for (Eigen::Index j = 0; j < weights.cols(); ++j)
      if (weights(v, j) != 0)
        out.row(v) += weights(v, j) * (world_from_rest[j] * rest.row(v).transpose()).transpose();
  return out;
}

} // namespace doublet
