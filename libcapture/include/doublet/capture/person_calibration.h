#pragma once
// Calibration without a board: bundle adjustment (Triggs et al. 2000) of cameras and joints over many frames, with the person as
// the object that all cameras see. A plane through two camera centres that is tangent to the silhouette in one view is tangent in
// the other (frontier points: Sinha, Pollefeys, McMillan 2004), which determines camera directions more precisely than joints do.
// Constant bone lengths determine the focal lengths, the person's height the scale, the standing person the up direction.

#include "doublet/capture/keypoints.h"
#include "doublet/core/camera.h"
#include "doublet/core/context.h"
#include "doublet/core/image.h"
#include "doublet/core/types.h"
#include "doublet/options/options.h"

namespace doublet {

struct PersonCalibrationOptions {
  double height = 1.7;
  double focal_error = 0.03;
  double keypoint_error = 0.006;
  int moments = 150;
  int iterations = 40;
  static constexpr auto describe() {
    using namespace options;
    using O = PersonCalibrationOptions;
    return Description{
        "PersonCalibrationOptions",
        option(&O::height, "height", Range{0.3, 3}, "m", "Height of the person, which fixes the scale"),
        option(&O::focal_error, "focal_error", above(0), "", "Expected relative error of a known focal length"),
        option(&O::keypoint_error, "keypoint_error", above(0), "",
               "Expected error of a keypoint, as a share of the image's larger side"),
        option(&O::moments, "moments", at_least(10), "", "Number of frames that are used, spread evenly over the take"),
        option(&O::iterations, "iterations", at_least(1), "", "Largest number of steps of the bundle adjustment"),
    };
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
};

/// What one camera shows of the person.
struct PersonView {
  std::string name;
  int width = 0, height = 0;  ///< px
  double focal = 0;           ///< px; 0 = unknown, it is estimated
  std::vector<Keypoint> seen; ///< T x kKeypoints, frame after frame; all views have the same frames
  /// [T] or empty: corners (px) of the convex hull of the silhouette, from silhouette_hull(); an empty hull = unknown. A few
  /// dozen frames spread over the take are enough.
  std::vector<std::vector<Eigen::Vector2d>> silhouettes;
};

/// Corners (px) of the convex hull of a silhouette, around its pixels; empty if the mask is empty, or touches a border of the
/// image, since the silhouette may then continue outside. Throws std::invalid_argument unless the mask has one channel.
std::vector<Eigen::Vector2d> silhouette_hull(const Image &mask);

/// Result for one camera.
struct PersonCamera {
  double agreeing = 0; ///< share of its keypoints within three expected errors of the projected joints
  double error = 0;    ///< px, median error of these; NaN if none agrees
  /// m, median distance, at the person, between the tangent planes of this camera and of another; NaN without silhouettes.
  double tangent_error = 0;
};

struct PersonCalibration {
  CameraRig rig; ///< m, +Y up, the floor at y = 0 under the person's feet; no distortion, the principal point in the middle
  std::vector<PersonCamera> cameras;
  Vertices joints;         ///< (moments x kKeypoints, 3) m; NaN where no two cameras agree
  std::vector<int> frames; ///< of the moments
};

/// Calibrates static cameras from the joints of one person who moves in front of them. Throws std::invalid_argument for views
/// that do not fit together, Error naming the camera if it has too few keypoints in common with the others, or they do not agree.
PersonCalibration calibrate_from_person(const std::vector<PersonView> &views, const PersonCalibrationOptions &options = {},
                                        const Context &context = {});

} // namespace doublet
