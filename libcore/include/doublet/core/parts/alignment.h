#pragma once
// Rotations and similarity transforms that align directions and points. Eigen's templates are instantiated here once: each takes
// a compiler several seconds.

#include <Eigen/Core>

namespace doublet {

/// The rotation by the smallest angle that turns the direction of `from` to that of `to`.
Eigen::Matrix3d shortest_turn(const Eigen::Vector3d &from, const Eigen::Vector3d &to);

enum class AlignmentScale { One, Free };

/// The similarity transform (Free) or rigid motion (One) that maps the points `from` (3, N) closest to `to`, by least squares
/// (Umeyama 1991).
Eigen::Matrix4d nearest_similarity(const Eigen::Matrix3Xd &from, const Eigen::Matrix3Xd &to, AlignmentScale scale);

} // namespace doublet
