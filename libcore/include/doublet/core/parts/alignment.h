#pragma once
// Rotations and similarities that bring directions and points onto others. Eigen's own are instantiated here once: each takes a
// compiler several seconds.

#include <Eigen/Core>

namespace doublet {

/// The rotation by the smallest angle that turns the direction of `from` to that of `to`.
Eigen::Matrix3d shortest_turn(const Eigen::Vector3d &from, const Eigen::Vector3d &to);

enum class AlignmentScale { One, Free };

/// The similarity, or the rigid motion, that brings the points (3, N) of `from` nearest to those of `to`: least squares (Umeyama
/// 1991).
Eigen::Matrix4d nearest_similarity(const Eigen::Matrix3Xd &from, const Eigen::Matrix3Xd &to, AlignmentScale scale);

} // namespace doublet
