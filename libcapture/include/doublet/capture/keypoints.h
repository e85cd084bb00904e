#pragma once
// 2D joints of the person from a keypoint detector (OpenPose, RTMPose, MediaPipe), which a session may have in addition to
// silhouettes.

#include "doublet/types/geometry.h"

#include <array>

namespace doublet {

/// A point of the person, such as a joint, detected in an image.
struct Keypoint {
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  double confidence = 0; ///< in [0, 1]
  bool counts() const { return confidence >= 0.3 && pixel.allFinite(); }
};

/// The joints that all such detectors find, in the order of lists of keypoints. Skeletons use the same names.
inline constexpr std::array kKeypointNames{"l_shoulder", "r_shoulder", "l_elbow", "r_elbow", "l_wrist", "r_wrist",
                                           "l_hip",      "r_hip",      "l_knee",  "r_knee",  "l_ankle", "r_ankle"};
inline constexpr int kKeypoints = static_cast<int>(kKeypointNames.size());

} // namespace doublet
