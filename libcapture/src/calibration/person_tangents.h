#pragma once
// Frontier points: what silhouettes say of where two cameras are, whatever the person's shape.

#include "doublet/core/camera.h"

#include <vector>

namespace doublet::detail {

/// Corners of the silhouettes' hulls in two cameras through which a plane of both centres touches the person.
struct TangentPair {
  int first = 0, second = 0;
  Eigen::Vector2d in_first = Eigen::Vector2d::Zero(), in_second = Eigen::Vector2d::Zero(); ///< px
  double lever = 0; ///< m, from the line of the centres to the person
};

/// Of the pairs of cameras that both have a hull; not of those one of which looks along the line of the centres. hulls: [camera],
/// nullptr or empty = none. `person`: about where she is, m.
std::vector<TangentPair> match_tangents(const CameraRig &rig, const std::vector<const std::vector<Eigen::Vector2d> *> &hulls,
                                        const Eigen::Vector3d &person);

/// How far the two planes are apart at the person, m.
double tangent_residual(const Camera &first, const Camera &second, const TangentPair &pair);

} // namespace doublet::detail
