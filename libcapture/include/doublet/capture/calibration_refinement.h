#pragma once
// Cameras refined by what the take shows: bundle adjustment (Triggs et al. 2000) of cameras and poses over the outlines of many
// moments, the rigged template being the object that all cameras see.

#include "doublet/capture/outline.h"
#include "doublet/core/context.h"
#include "doublet/core/stage_values.h"
#include "doublet/options/options.h"

#include <numbers>

namespace doublet {

struct CalibrationRefinementOptions {
  int moments = 20;
  int iterations = 20;
  int rims_per_view = 300;
  int raster_size = 512;
  double rotation = 0.5 * std::numbers::pi / 180;
  double position = 0.01;
  double focal = 0.005;
  double distortion = 0.01;
  double late = 1.0;
  double min_change = 0.0025;
  static constexpr auto describe() {
    using namespace options;
    using O = CalibrationRefinementOptions;
    return Description{
        "CalibrationRefinementOptions",
        option(&O::moments, "moments", at_least(1), "", "Number of frames that are used, spread evenly over the take"),
        option(&O::iterations, "iterations", at_least(1), "", "Number of renderings, each with new matches"),
        option(&O::rims_per_view, "rims_per_view", at_least(10), "", "Number of correspondences a view and direction"),
        option(&O::raster_size, "raster_size", at_least(64), "px", "Longest side of the renderings in which rims are found"),
        option(&O::rotation, "rotation", Range{0, 0.1, Open::Below}, "rad", "Expected error of a camera's direction",
               "The default is half a degree"),
        option(&O::position, "position", above(0), "m", "Expected error of a camera's position, on each axis"),
        option(&O::focal, "focal", above(0), "", "Expected error of a focal length, as a share of it"),
        option(&O::distortion, "distortion", at_least(0), "",
               "Expected error of the first distortion term, of lenses that have any; 0 = it stays"),
        option(&O::late, "late", at_least(0), "frames", "Expected delay of a camera against the others; 0 = there is none"),
        option(&O::min_change, "min_change", at_least(0), "m",
               "Cameras stay as they are if the actor would move by less, in the mean of all"),
    };
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
};

/// A small change of a camera: turn about its centre (rad, axes of the camera), move of its centre (m, world), logarithm of the
/// focal lengths' factor, change of the first distortion term.
using CameraStep = Eigen::Matrix<double, 8, 1>;
Camera stepped(const Camera &camera, const CameraStep &step);
/// d stepped(camera, step).project(point) / d step at no step, pixels.
Eigen::Matrix<double, 2, 8> step_jacobian(const Camera &camera, const Eigen::Vector3d &point);

/// One frame in which all cameras saw the actor.
struct CalibrationMoment {
  int row = 0;                                    ///< of the poses
  const std::vector<Outline> *outlines = nullptr; ///< measured, one a camera; empty = no part
  Vertices offset = Vertices(0, 3);               ///< (V, 3) m, rest pose: where cloth hangs; empty = as in the scan
  bool in_scan_pose = false;                      ///< the actor stands where the scan does, to a centimetre
};

struct CalibrationProblem {
  const RiggedMesh *actor = nullptr;
  CameraRig given; ///< as calibrated, which is what errors are expected about
  CameraRig rig;   ///< where to begin
  std::vector<CalibrationMoment> moments;
  MatrixRM poses;              ///< (T, D) of all frames, one behind the other: what is seen in between follows from them
  Eigen::VectorXd reliability; ///< (V) in [0, 1]: how well a vertex tells the pose; low on loose cloth
  bool timed = true;           ///< cameras may be late
};

/// What became of one camera.
struct RefinedCamera {
  std::string camera;
  bool seen = false;    ///< the actor was, in some moment; otherwise all below is 0
  double moved = 0;     ///< m, RMS over the actor's outlines: how far they appear from where the given camera has them, but for
                        ///< what a motion of all cameras together explains
  double sure = 0;      ///< m, the standard deviation of that
  double turned = 0;    ///< degrees
  double shifted = 0;   ///< m, of the centre
  double focal = 0;     ///< change as a share
  double late = 0;      ///< frames by which it shows things later than the others
  int delay = 0;        ///< whole frames of that which were made good: frame t + delay of its film is frame t of the take
  double late_sure = 0; ///< frames, standard deviation of that
};

struct CalibrationEstimate {
  CameraRig rig;
  std::vector<RefinedCamera> cameras;
  double change = 0;                  ///< m, RMS over the cameras: as RefinedCamera::moved, but from where it began
  double sure = 0;                    ///< m, RMS over the cameras
  double before_px = 0, after_px = 0; ///< mean |residual| of the outlines
};

/// Cameras, delays and the moments' poses that explain the outlines best, errors of the calibration being expected as `options`
/// say. A camera that sees nothing stays, and so does the whole rig but for what the prior leaves open: its place in the world is
/// that of the given cameras in the mean, and of the scan where a moment shows it. Throws std::invalid_argument for parts that do
/// not go together.
CalibrationEstimate refine_calibration(const CalibrationProblem &problem, const CalibrationRefinementOptions &options,
                                       const Context &context);

} // namespace doublet
