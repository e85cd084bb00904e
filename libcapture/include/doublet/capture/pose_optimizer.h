#pragma once
// Pose of the skeleton from outlines and feature tracks of all cameras at once (Sect. 4; Gall et al. 2009, local optimisation).

#include "doublet/capture/rims.h"
#include "doublet/core/context.h"
#include "doublet/core/stage_values.h"
#include "doublet/options/options.h"

#include <algorithm>
#include <memory>

namespace doublet {

/// A surface point that should, according to a feature track, be seen at `pixel` in view `view`.
struct SurfaceTrack {
  int view = 0;
  SurfacePoint surface;
  Eigen::Vector2d pixel;
  double weight = 1; ///< relative to the other tracks
};

/// A point that moves with a joint of the skeleton and its observed position, such as a joint triangulated from keypoints.
struct SeenPoint {
  int joint = 0;        ///< that moves it
  Eigen::Vector3d rest; ///< m, in the rest pose
  Eigen::Vector3d seen; ///< m, observed position in the world
  double tolerance = 0; ///< m, error of the observation: within this distance there is no residual
  /// m, by how much the distance of `place` from `seen` exceeds the tolerance; 0 within.
  double beyond(const Eigen::Vector3d &place) const { return std::max(0.0, (place - seen).norm() - tolerance); }
};

/// Delays of cameras by fractions of a frame.
struct ViewTiming {
  Eigen::VectorXd late; ///< (views) frames by which each shows an earlier moment; empty = none does
  Vertices velocity;    ///< (V, 3) m per frame, of the surface
};

/// Observations and prediction of one frame. Arrays over views have one entry per camera; a view with an empty outline takes no
/// part.
struct PoseProblem {
  const RiggedMesh *actor = nullptr;
  const CameraRig *rig = nullptr;
  const std::vector<Outline> *outlines = nullptr; ///< measured
  std::vector<SurfaceTrack> tracks;
  std::vector<SeenPoint> points;
  Vertices offset;             ///< (V, 3) m, rest pose: non-rigid offset of the surface, predicted from the previous frame
  Eigen::VectorXd reliability; ///< (V) in [0, 1]: how far a vertex follows the skeleton; low on loose cloth
  Eigen::VectorXd predicted;   ///< (D) pose predicted from the previous frames
  Eigen::VectorXd start;       ///< (D) initial pose
  bool first = false;          ///< there is no previous frame: wider gates, more iterations, no pull to the prediction
  ViewTiming timing;           ///< of the cameras
};

struct PoseEstimate {
  Eigen::VectorXd dofs;           ///< (D)
  double rim_px = 0, sift_px = 0; ///< mean |residual| of the last iteration's matches, pixels
  double energy = 0;              ///< robust mean of the last iteration's residuals, in [0, 1]; comparable between initial poses
  int iterations = 0;
};

struct PoseOptions {
  int iterations = 8;
  int first_iterations = 24;
  int raster_size = 512;
  int rims_per_view = 300;
  double gate_start = 0.15, gate_end = 0.06;
  double scale_start = 0.05, scale_end = 0.015;
  double sift_weight = 1.0;
  double keypoint_weight = 100;
  double keypoint_scale = 0.1;
  double prior_weight = 4.0;
  double prior_angle = 0.15;
  double prior_shift = 0.03;
  double limit_weight = 400.0;
  static constexpr auto describe() {
    using namespace options;
    using O = PoseOptions;
    return Description{
        "PoseOptions",
        option(&O::iterations, "iterations", at_least(1), "", "Number of renderings, each with new matches",
               "A tracked frame moves by less than 1 mm after 6"),
        option(&O::first_iterations, "first_iterations", at_least(1), "", "Number of renderings for the first frame"),
        option(&O::raster_size, "raster_size", at_least(64), "px", "Longest side of the renderings in which rims are found",
               "Rims keep sub-pixel residuals"),
        option(&O::rims_per_view, "rims_per_view", at_least(10), "", "Number of correspondences per view and direction"),
        option(&O::gate_start, "gate_start", above(0), "m", "Rim matches farther away are dropped in the first iteration"),
        option(&O::gate_end, "gate_end", above(0), "m", "Rim matches farther away are dropped in the last iteration"),
        option(&O::scale_start, "scale_start", above(0), "m", "Geman-McClure scale of all residuals in the first iteration"),
        option(&O::scale_end, "scale_end", above(0), "m", "Geman-McClure scale of all residuals in the last iteration",
               "The size of skinning errors"),
        option(&O::sift_weight, "sift_weight", at_least(0), "", "Weight of a feature track against one rim match",
               "At 5 a skirt's features, bound to the thigh, hold a leg back"),
        option(&O::keypoint_weight, "keypoint_weight", at_least(0), "",
               "Weight of a joint that is farther from its keypoints than the tolerance, against one rim match"),
        option(&O::keypoint_scale, "keypoint_scale", above(0), "m",
               "Geman-McClure scale of the distance beyond the tolerance, in the last iteration",
               "Detectors sometimes take one limb for another. It is wider in the first iterations, as scale_start is"),
        option(&O::prior_weight, "prior_weight", at_least(0), "",
               "Weight of the prediction against one rim match, at a deviation of prior_angle or prior_shift"),
        option(&O::prior_angle, "prior_angle", above(0), "rad", "Expected error of the predicted angles"),
        option(&O::prior_shift, "prior_shift", above(0), "m", "Expected error of the root's predicted translation"),
        option(&O::limit_weight, "limit_weight", at_least(0), "",
               "Weight of a joint limit that is exceeded by prior_angle, against one rim match"),
    };
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
};

/// The swap point: one frame's correspondences in, a pose out.
/// Threads: one call at a time, frame after frame; it may keep state between calls.
class PoseOptimizer {
public:
  virtual ~PoseOptimizer() = default;
  virtual PoseEstimate optimize(const PoseProblem &problem, const Context &context) = 0;
  static std::unique_ptr<PoseOptimizer> create(const PoseOptions &options = {});
};

/// The posed surface: skinned positions of rest + offset, and each vertex's blended transform. `offset` (V, 3) or empty.
struct PosedSurface {
  Transforms blend;  ///< (V) world_from_rest
  Vertices vertices; ///< (V, 3) m
};
PosedSurface pose_surface(const RiggedMesh &actor, const Eigen::VectorXd &dofs, const Vertices &offset);

/// (V, D) share of each degree of freedom in the motion of each vertex: the sum of its skin weights over the joints that the
/// degree of freedom moves.
MatrixRM dof_influence(const RiggedMesh &actor);

/// Derivative (3, D) of a point of the posed surface with respect to the pose: sum of weights times twists. Exact for linear
/// blend skinning and for rigid points, first-order for dual quaternions. `twists`: dof_twists() of the pose.
Eigen::Matrix3Xd surface_jacobian(const SurfacePoint &point, const Vertices &vertices, const Faces &faces,
                                  const MatrixRM &influence, const std::vector<DofTwist> &twists);

} // namespace doublet
