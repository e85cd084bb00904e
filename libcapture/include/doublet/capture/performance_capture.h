#pragma once
// Video -> reference performance (Sect. 4; Gall et al. 2009): pose by rims and SIFT in Gauss-Newton over all cameras, Laplacian
// refinement.

#include "doublet/capture/calibration_refinement.h"
#include "doublet/capture/feature_tracker.h"
#include "doublet/capture/limb_search.h"
#include "doublet/capture/pose_optimizer.h"
#include "doublet/capture/session.h"
#include "doublet/capture/silhouette_extractor.h"
#include "doublet/capture/surface_refiner.h"
#include "doublet/core/context.h"
#include "doublet/core/stage_values.h"
#include "doublet/files/files.h"
#include "doublet/options/options.h"

#include <functional>
#include <memory>

namespace doublet {

struct CaptureOptions {
  int first_frame = 0, frame_count = -1, start_frame = -1;
  std::vector<std::string> cameras;
  bool use_sift = true;
  FeatureTrackerOptions features;
  PoseOptions pose;
  LimbSearchOptions limbs;
  SurfaceOptions surface;
  bool refine_cameras = true;
  CalibrationRefinementOptions calibration;
  bool find_lost_limbs = true;
  double extra_twist_range = 0.8;
  bool second_pass = true;
  bool use_feature_map = true;
  double map_search_radius = 0.05;
  double keypoint_tolerance = 0.06;
  double velocity_damping = 0.8;
  double acceleration = 0.3;
  double offset_decay = 0.95;
  double cloth_deviation_scale = 0.01;
  int smooth_window = 5, smooth_order = 2;
  /// Every frame is appended when it has been tracked. A capture that was interrupted in any way resumes after the last complete
  /// frame, with the same bits. A checkpoint of other options, another actor, rig or images, or another version is ignored, which
  /// is logged. Custom parts (CaptureParts) are not identified: remove the file when they change. The file is not removed at the
  /// end; the caller does that.
  Path checkpoint;
  static constexpr auto describe() {
    using namespace options;
    using O = CaptureOptions;
    return Description{
        "CaptureOptions",
        option(&O::first_frame, "first_frame", at_least(0), "", "First video frame"),
        option(&O::frame_count, "frame_count", at_least(-1), "", "Number of frames; -1 = to the end"),
        option(&O::start_frame, "start_frame", at_least(-1), "",
               "Video frame from which tracking goes both ways; -1 = the first, or the one most like the scan",
               "The first if it is in the scan's pose, otherwise the frame that is closest to it"),
        option(&O::cameras, "cameras", "Names of the cameras to use; none = all"),
        option(&O::use_sift, "use_sift", "Texture features are detected and matched; off = silhouettes alone"),
        option(&O::features, "features", "Options of the feature tracker"),
        option(&O::pose, "pose", "Options of the pose optimiser"),
        option(&O::limbs, "limbs", "Options of the search for lost limbs"),
        option(&O::surface, "surface", "Options of the surface refiner"),
        option(&O::refine_cameras, "refine_cameras",
               "Calibration and delays are corrected where the take shows that they are clearly wrong"),
        option(&O::calibration, "calibration", "Options of the refinement of the cameras"),
        option(&O::find_lost_limbs, "find_lost_limbs", "Limbs that the local optimisation has lost are searched for globally"),
        option(&O::extra_twist_range, "extra_twist_range", at_least(0), "rad",
               "Allowed twist of a limb's last joint about the bone before it, each way; 0 = none",
               "A foot turns in and out, which the session's hinge does not allow; without it the whole leg turns"),
        option(&O::second_pass, "second_pass", "The take is tracked again once it is known which vertices are loose cloth"),
        option(&O::use_feature_map, "use_feature_map", "Features of the first frame are found again in every frame",
               "Tracks from frame to frame alone drift"),
        option(&O::map_search_radius, "map_search_radius", above(0), "",
               "Distance within which a mapped feature is sought, as a share of the silhouette's height"),
        option(&O::keypoint_tolerance, "keypoint_tolerance", at_least(0), "m",
               "Distance of a joint from its keypoints that is ignored; larger where keypoints are unsteady",
               "Detectors are off by 2 to 3 cm on what they see, by twice that under clothes"),
        option(
            &O::velocity_damping, "velocity_damping", Range{0, 1}, "",
            "Share of the last velocity in the prediction; 0 = stay, 1 = go on at the same speed",
            "With 0.8 and an acceleration of 0.3 two motions are predicted to 0.98 and 0.49 degrees, RMS; 1.18 and 0.58 without"),
        option(&O::acceleration, "acceleration", Range{0, 1}, "", "Share of the last change of velocity in the prediction"),
        option(&O::offset_decay, "offset_decay", Range{0, 1}, "",
               "Share of the non-rigid offset that is predicted for the next frame"),
        option(&O::cloth_deviation_scale, "cloth_deviation_scale", above(0), "m",
               "A vertex that usually lies this far from its skinned position has half the weight in the pose"),
        option(&O::smooth_window, "smooth_window", at_least(1), "",
               "Frames of the Savitzky-Golay filter of pose and offsets, an odd number; 1 = off"),
        option(&O::smooth_order, "smooth_order", at_least(0), "", "Order of the Savitzky-Golay filter"),
        not_serialised(&O::checkpoint, "checkpoint", "File from which an interrupted capture resumes; empty = none"),
    };
  }
  void validate() const; ///< throws std::invalid_argument naming option, range and value
};

/// A limb whose error was above LimbSearchOptions::lost_error after the local optimisation.
struct LostLimb {
  int frame = 0;          ///< video frame number
  std::string limb;       ///< name of its first joint
  double before = 0;      ///< m; error after the local optimisation
  double after = 0;       ///< m; error of the pose that was kept
  bool recovered = false; ///< after <= LimbSearchOptions::lost_error
};

/// Number of frames in which the bone that a joint moves was
struct JointVisibility {
  std::string joint; ///< one with degrees of freedom
  int seen = 0;      ///< covered by enough visible surface that moves with the skeleton,
  int inferred = 0;  ///< hidden by a garment or by other limbs: it follows from the joints before and after it,
  int lost = 0;      ///< in a limb that was lost and not found again.
};

struct CaptureSummary {
  std::vector<double> rim_px, sift_px;        ///< (T) mean residual per frame, pixels
  std::vector<double> keypoint_distance;      ///< (T) m, mean distance of joints from their keypoints; NaN where there are none
  std::vector<double> silhouette_iou;         ///< (T) mean over cameras, of the refined surface against the measured masks
  std::vector<int> views;                     ///< (T) cameras that took part
  double jitter_before = 0, jitter_after = 0; ///< rad; mean |second difference| of the joint angles before and after smoothing
  std::vector<LostLimb> lost_limbs;           ///< in the order of frames
  int start_frame = 0;                        ///< video frame number: tracking went from it to the last, then to the first
  std::vector<JointVisibility> joints;        ///< in the order of the skeleton
  /// Result for each camera of the rig, from the last refinement; empty if refinement was off.
  std::vector<RefinedCamera> cameras;
  bool cameras_refined = false; ///< poses and observations are of the refined cameras, otherwise of the given ones
  /// Times of the whole run, including those before a resume: images to outlines, features and their matches; features lifted to
  /// the surface and matched with the map; poses; the check of limbs and the search for lost ones; surfaces.
  double measure_seconds = 0, map_seconds = 0, pose_seconds = 0, limb_seconds = 0, surface_seconds = 0;
  double seconds_per_frame = 0;
};

struct CaptureResult {
  ReferencePerformance performance;
  Observations observations; ///< its cameras are the refined ones
  CaptureSummary summary;
};

/// The session with the cameras that the capture used: the refined ones if there are any, with their delays corrected.
Session filmed(Session session, const CaptureResult &captured);

/// The parts of a capture, each a swap point. Null = created from the options.
struct CaptureParts {
  std::shared_ptr<FeatureTracker> features;
  std::shared_ptr<PoseOptimizer> pose;
  std::shared_ptr<LimbSearch> limbs;
  std::shared_ptr<SurfaceRefiner> surface;
};

/// The swap point: (rigged mesh, rig, frames, context) -> reference performance and the 2D observations it used.
/// Threads: one call at a time, since its parts may keep state. `frames` is read from several threads, each camera from one at a
/// time; the extractor is called from several at once.
class PerformanceCapture {
public:
  virtual ~PerformanceCapture() = default;
  /// `extractor` must be trained; it may be null if every frame has a ready mask. Throws Error if an image does not have its
  /// camera's size, or has neither mask nor extractor; std::invalid_argument if frames, rig and options do not fit together;
  /// Cancelled after the user asked to stop.
  virtual CaptureResult capture(const RiggedMesh &actor, const CameraRig &rig, FrameSource &frames,
                                const SilhouetteExtractor *extractor, const Context &context) = 0;
  static std::unique_ptr<PerformanceCapture> create(const CaptureOptions &options = {});
  static std::unique_ptr<PerformanceCapture> create(const CaptureOptions &options, const CaptureParts &parts);
};

// Deprecated names.
using JointSight [[deprecated("use JointVisibility")]] = JointVisibility;

} // namespace doublet
