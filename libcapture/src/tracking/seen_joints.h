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
/// median of those in which the pose is not far off. How sure the program is of it is learnt, too: a knee under a dress is a
/// guess.
class KeypointPlaces {
public:
  /// `tolerance`: m, of a joint that the program is sure of.
  KeypointPlaces(const Skeleton &skeleton, double tolerance);
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
  static Eigen::Vector3d usually_beside(const Place &place);
  double tolerance_of(const Place &place, const Eigen::Vector3d &usual) const;

  const Skeleton &skeleton_;
  double tolerance_;
  std::vector<Place> places_;
};

} // namespace doublet::detail
