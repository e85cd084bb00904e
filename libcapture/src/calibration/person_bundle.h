#pragma once
// Bundle adjustment of cameras, joints and the lengths of the bones between them.

#include "doublet/capture/person_calibration.h"
#include "person_tangents.h"

#include <algorithm>
#include <array>
#include <optional>

namespace doublet::detail {

/// A bone between two joints of kKeypointNames; `length` counts the bones that are alike, left and right.
struct CalibrationBone {
  int from, to, length;
};
inline constexpr std::array<CalibrationBone, 12> kCalibrationBones{{{0, 2, 0},
                                                                    {1, 3, 0},
                                                                    {2, 4, 1},
                                                                    {3, 5, 1},
                                                                    {6, 8, 2},
                                                                    {7, 9, 2},
                                                                    {8, 10, 3},
                                                                    {9, 11, 3},
                                                                    {0, 6, 4},
                                                                    {1, 7, 4},
                                                                    {0, 1, 5},
                                                                    {6, 7, 6}}};
/// What a length is as a share of the height, how much people and programs differ in it, and how much it seems to change while
/// she moves, both as deviations of its logarithm: so no scale is dearer than another.
struct CalibrationLength {
  double share, deviation, change;
};
/// Upper arm, forearm, thigh, shank, side of the trunk, shoulders, hips. Shares and deviations are those of the joints of the 550
/// people that the body model was learnt from (docs/body-model.md), the deviations a little wider: programs differ in where they
/// mark a joint.
inline constexpr std::array<CalibrationLength, 7> kCalibrationLengths{{{0.146, 0.08, 0.06},
                                                                       {0.142, 0.08, 0.08},
                                                                       {0.234, 0.07, 0.05},
                                                                       {0.247, 0.07, 0.05},
                                                                       {0.283, 0.07, 0.06},
                                                                       {0.204, 0.12, 0.1},
                                                                       {0.123, 0.15, 0.15}}};
inline constexpr int kBoneLengths = static_cast<int>(kCalibrationLengths.size());

/// Where the joints are in one frame; none where cameras do not agree.
using JointPoints = std::array<std::optional<Eigen::Vector3d>, kKeypoints>;

/// What is estimated, and what was seen of it.
struct PersonBundle {
  CameraRig rig;
  std::vector<double> known_focal;                 ///< px; 0 = not known, then the share of the larger side is about `log_focal`
  double focal_error = 0;                          ///< of known ones, as a share
  double log_focal = 0;                            ///< logarithm of the share that cameras have in common
  std::vector<std::vector<const Keypoint *>> seen; ///< [moment][camera]: of the camera's joints
  std::vector<JointPoints> joints;                 ///< [moment]
  std::array<double, kBoneLengths> log_lengths{};  ///< of m
  double keypoint_error = 0;                       ///< share of an image's larger side
  std::vector<TangentPair> tangents;
  double tangent_scale = 0; ///< m, of Geman and McClure

  /// Finds every joint anew from the cameras that agree on it.
  void triangulate_joints();
  /// Levenberg-Marquardt steps until the cost falls by less than a thousandth; returns the cost. Keypoints that no found joint
  /// explains cost as much as one can.
  double adjust(int iterations, double height);
  /// What adjust() lowers.
  double cost(double height) const;
  /// Of the cost by the joints of each moment (3 kKeypoints each), the cameras (7 each: CameraStep without distortion),
  /// log_lengths and log_focal.
  Eigen::VectorXd cost_gradient(double height) const;
};

/// In expected errors; infinite behind the camera.
double keypoint_residual(const Camera &camera, const Keypoint &seen, const Eigen::Vector3d &joint, double keypoint_error);
/// px, of what a camera or a view sees: what shares of an image are shares of.
template <class Seen> double larger_side(const Seen &seen) {
  return std::max(seen.width, seen.height);
}
/// Within which a keypoint agrees with a joint, in expected errors.
inline constexpr double kAgreeing = 3;

} // namespace doublet::detail
