#include "seen_joints.h"

#include "doublet/capture/triangulation.h"
#include "doublet/core/parts/quantile.h"

#include <algorithm>

namespace doublet::detail {

SeenJoints seen_joints(const std::vector<ViewMeasurement> &views, const CameraRig &rig) {
  std::vector<CalibratedCamera> cameras;
  std::vector<const std::vector<Keypoint> *> shown;
  for (std::size_t v = 0; v < views.size(); ++v)
    if (!views[v].keypoints.empty()) {
      cameras.push_back({rig[v], {}, 0});
      shown.push_back(&views[v].keypoints);
    }
  SeenJoints joints;
  if (cameras.size() < 2)
    return joints;
  std::vector<Keypoint> seen(cameras.size());
  for (int k = 0; k < kKeypoints; ++k) {
    for (std::size_t c = 0; c < cameras.size(); ++c)
      seen[c] = shown[c]->at(static_cast<std::size_t>(k));
    joints[static_cast<std::size_t>(k)] = triangulate(cameras, seen);
  }
  return joints;
}

KeypointPlaces::KeypointPlaces(const Skeleton &skeleton, double tolerance) : skeleton_(skeleton), tolerance_(tolerance) {
  for (int k = 0; k < kKeypoints; ++k)
    for (const Joint &joint : skeleton.joints)
      if (joint.parent >= 0 && joint.name == kKeypointNames[static_cast<std::size_t>(k)])
        places_.push_back({k, joint.parent, joint.rest, {}});
}

void KeypointPlaces::learn(const SeenJoints &seen, const Eigen::VectorXd &dofs) {
  constexpr double kFar = 0.15; // m; there the limb is lost, or what was seen is another joint
  const Transforms world_from_rest = forward_kinematics(skeleton_, dofs);
  for (Place &place : places_)
    if (const auto &at = seen[static_cast<std::size_t>(place.keypoint)]) {
      const Eigen::Vector3d beside = world_from_rest[place.carrier].inverse() * *at - place.rest;
      if (beside.norm() < kFar)
        place.beside.push_back(beside);
    }
}

std::vector<SeenPoint> KeypointPlaces::points(const SeenJoints &seen) const {
  std::vector<SeenPoint> points;
  for (const Place &place : places_)
    if (const auto &at = seen[static_cast<std::size_t>(place.keypoint)]) {
      const Eigen::Vector3d beside = usually_beside(place);
      points.push_back({place.carrier, place.rest + beside, *at, tolerance_of(place, beside)});
    }
  return points;
}

double KeypointPlaces::distance(const SeenJoints &seen, const Eigen::VectorXd &dofs) const {
  const Transforms world_from_rest = forward_kinematics(skeleton_, dofs);
  double sum = 0, count = 0;
  for (const SeenPoint &point : points(seen)) {
    sum += (world_from_rest[point.joint] * point.rest - point.seen).norm();
    count += 1;
  }
  return sum / count;
}

double KeypointPlaces::tolerance_of(const Place &place, const Eigen::Vector3d &usual) const {
  constexpr double kMostly = 3; // of normal deviates 19 of 20 are within three times the median distance in space
  std::vector<double> off;
  for (const Eigen::Vector3d &beside : place.beside)
    off.push_back((beside - usual).norm());
  return off.empty() ? tolerance_ : std::max(tolerance_, kMostly * median(std::move(off)));
}

Eigen::Vector3d KeypointPlaces::usually_beside(const Place &place) {
  Eigen::Vector3d usual = Eigen::Vector3d::Zero();
  for (int axis = 0; axis < 3 && !place.beside.empty(); ++axis) {
    std::vector<double> values;
    for (const Eigen::Vector3d &beside : place.beside)
      values.push_back(beside[axis]);
    usual[axis] = median(std::move(values));
  }
  return usual;
}

} // namespace doublet::detail
