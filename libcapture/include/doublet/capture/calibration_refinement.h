#pragma once
// Refinement of the calibration from the take itself: bundle adjustment (Triggs et al. 2000) of cameras and poses over the
// outlines of many frames, with the rigged template as the object that all cameras see.

#include "doublet/capture/outline.h"
#include "doublet/core/context.h"
#include "doublet/core/stage_values.h"
#include "doublet/options/options.h"

#include <numbers>

namespace doublet {

struct CalibrationRefinementOptions {
  int moments = 20;
  int iterations = 10;
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
        option(&O::rims_per_view, "rims_per_view", at_least(10), "", "Number of correspondences per view and direction"),
        option(&O::raster_size, "raster_size", at_least(64), "px", "Longest side of the renderings in which rims are found"),
        option(&O::rotation, "rotation", Range{0, 0.1, Open::Below}, "rad", "Expected error of a camera's direction",
               "The default is half a degree"),
        option(&O::position, "position", above(0), "m", "Expected error of a camera's position, on each axis"),
        option(&O::focal, "focal", above(0), "", "Expected error of a focal length, as a share of it"),
        option(&O::distortion, "distortion", at_least(0), "",
               "Expected error of the first distortion term, if the lens has any; 0 = it is kept fixed"),
        option(&O::late, "late", at_least(0), "frames", "Expected delay of a camera relative to the others; 0 = there is none"),
        option(&O::min_change, "min_change", at_least(0), "m",
               "Cameras are kept if refinement would shift the actor by less than this, in the mean of all"),
    };
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
};

/// A small change of a camera: rotation about its centre (rad, axes of the camera), translation of its centre (m, world),
/// logarithm of the factor of the focal lengths, change of the first distortion term.
using CameraStep = Eigen::Matrix<double, 8, 1>;
Camera stepped(const Camera &camera, const CameraStep &step);
/// d stepped(camera, step).project(point) / d step at step = 0, pixels.
Eigen::Matrix<double, 2, 8> step_jacobian(const Camera &camera, const Eigen::Vector3d &point);

/// One frame in which all cameras saw the actor.
struct CalibrationMoment {
  int row = 0;                                    ///< of the poses
  const std::vector<Outline> *outlines = nullptr; ///< measured, one per camera; an empty one takes no part
  Vertices offset = Vertices(0, 3);               ///< (V, 3) m, rest pose: non-rigid offset (cloth); empty = none
  bool in_scan_pose = false;                      ///< the actor stands where the scan does, to within a centimetre
};

struct CalibrationProblem {
  const RiggedMesh *actor = nullptr;
  CameraRig given; ///< as calibrated: the mean of the prior
  CameraRig rig;   ///< where the optimisation begins
  std::vector<CalibrationMoment> moments;
  MatrixRM poses;              ///< (T, D) of all frames in succession; poses at times between frames are interpolated
  Eigen::VectorXd reliability; ///< (V) in [0, 1]: how far a vertex follows the skeleton; low on loose cloth
  bool timed = true;           ///< delays of cameras are estimated, too
};

/// Result for one camera.
struct RefinedCamera {
  std::string camera;
  bool seen = false;  ///< it shows the actor in some moment; otherwise all below is 0
  double moved = 0;   ///< m, RMS over the actor's outlines: shift of their points relative to the given camera, without the part
                      ///< that a common motion of all cameras explains
  double sure = 0;    ///< m, standard deviation of `moved`
  double turned = 0;  ///< degrees, rotation of the camera
  double shifted = 0; ///< m, translation of its centre
  double focal = 0;   ///< relative change of the focal length
  double late = 0;    ///< frames by which it shows a motion later than the others
  int delay = 0;      ///< whole frames of `late` that were corrected: frame t + delay of its video is frame t of the take
  double late_sure = 0; ///< frames, standard deviation of `late`
};

struct CalibrationEstimate {
  CameraRig rig;
  std::vector<RefinedCamera> cameras;
  double change = 0; ///< m, RMS over the cameras: as RefinedCamera::moved, but relative to CalibrationProblem::rig
  double sure = 0;   ///< m, RMS over the cameras
  double before_px = 0, after_px = 0; ///< mean |residual| of the outlines
};

/// The cameras, delays and poses of the moments that explain the outlines best, with the expected errors of the calibration in
/// `options` as a prior. A camera that sees nothing is kept. The position of the whole rig in the world is fixed by the mean of
/// the given cameras, and by the scan if a moment is in its pose. Throws std::invalid_argument for sizes that do not fit
/// together.
CalibrationEstimate refine_calibration(const CalibrationProblem &problem, const CalibrationRefinementOptions &options,
                                       const Context &context);

} // namespace doublet
