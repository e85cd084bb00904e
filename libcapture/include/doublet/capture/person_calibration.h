#pragma once
// Cameras without a board: bundle adjustment (Triggs et al. 2000) of cameras and joints over many moments, the person being the
// object that all cameras see. Planes through two cameras' centres that touch her silhouette in one touch it in the other
// (frontier points: Sinha, Pollefeys, McMillan 2004), which tells directions finer than joints do. Her bones keep their lengths,
// which tells focal lengths; how tall she is tells the scale, how she stands which way is up.

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
        option(&O::height, "height", Range{0.3, 3}, "m", "Height of the person, which tells the scale"),
        option(&O::focal_error, "focal_error", above(0), "", "Expected error of a focal length that is known, as a share of it"),
        option(&O::keypoint_error, "keypoint_error", above(0), "",
               "Expected error of a keypoint, as a share of the image's larger side"),
        option(&O::moments, "moments", at_least(10), "", "Number of frames that are used, spread evenly over the take"),
        option(&O::iterations, "iterations", at_least(1), "", "Largest number of steps of the bundle adjustment"),
    };
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
};

/// What one camera saw of the person.
struct PersonView {
  std::string name;
  int width = 0, height = 0;  ///< px
  double focal = 0;           ///< px; 0 = not known, it is looked for
  std::vector<Keypoint> seen; ///< T x kKeypoints, frame after frame; all views have the same frames
  /// Of T frames, or of none: corners (px) of the convex hull of her silhouette, silhouette_hull(); empty = not known. A few
  /// dozen frames spread over the take are enough.
  std::vector<std::vector<Eigen::Vector2d>> silhouettes;
};

/// Corners (px) of the convex hull of a silhouette, around its pixels; empty if there is none, or if it touches a border of the
/// image, beyond which nobody knows. Throws std::invalid_argument unless the mask has one channel.
std::vector<Eigen::Vector2d> silhouette_hull(const Image &mask);

/// What became of one camera.
struct PersonCamera {
  double agreeing = 0; ///< share of its keypoints that lie within three expected errors of where the cameras have the joint
  double error = 0;    ///< px, median of these; NaN if none agrees
  /// m, median: how far the planes that touch her in this camera and in another are apart at her; NaN without silhouettes.
  double tangent_error = 0;
};

struct PersonCalibration {
  CameraRig rig; ///< m, +Y up, the floor at y = 0 under the person's feet; no distortion, the principal point in the middle
  std::vector<PersonCamera> cameras;
  Vertices joints;         ///< (moments x kKeypoints, 3) m; NaN where no two cameras agree
  std::vector<int> frames; ///< of the moments
};

/// Cameras that stand still, from the joints of one person who moves before them. Throws std::invalid_argument for views that do
/// not go together, Error naming the camera where too few keypoints are common or do not agree.
PersonCalibration calibrate_from_person(const std::vector<PersonView> &views, const PersonCalibrationOptions &options = {},
                                        const Context &context = {});

} // namespace doublet
