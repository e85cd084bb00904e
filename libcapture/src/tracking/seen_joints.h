#pragma once
// Keypoints of all cameras: where in space the joints are that they show, and which points of the skeleton those are.

#include "view_measurement.h"

#include <array>
#include <optional>
#include <vector>

namespace doublet::detail {

/// Of one frame, m: the joints of kKeypointNames that two cameras or more agree on.
using SeenJoints = std::array<std::optional<Eigen::Vector3d>, kKeypoints>;
SeenJoints seen_joints(const std::vector<ViewMeasurement> &views, const CameraRig &rig);

/// A program sees a joint beside where the skeleton has it, always in the same place of the bones: learnt as the frames come, the
/// median of those in which the pose is not far off.
class KeypointPlaces {
public:
  explicit KeypointPlaces(const Skeleton &skeleton);
  void learn(const SeenJoints &seen, const Eigen::VectorXd &dofs);
  /// Of the joints that the skeleton has.
  std::vector<SeenPoint> points(const SeenJoints &seen) const;

  /// m, mean distance of these points from where they are seen; NaN without any.
  double distance(const SeenJoints &seen, const Eigen::VectorXd &dofs) const;

private:
  struct Place {
    int keypoint;
    int carrier; // the joint before it, which moves it
    Eigen::Vector3d rest;
    std::vector<Eigen::Vector3d> beside; // m, rest pose, of every frame
  };
  Eigen::Vector3d usually_beside(const Place &place) const;

  const Skeleton &skeleton_;
  std::vector<Place> places_;
};

} // namespace doublet::detail
