#pragma once
// Pose of the skeleton from outlines and feature tracks of all cameras at once (Sect. 4; Gall et al. 2009, local optimisation).

#include "doublet/capture/rims.h"
#include "doublet/core/context.h"
#include "doublet/core/stage_values.h"
#include "doublet/options/options.h"

#include <algorithm>
#include <memory>

namespace doublet {

/// A surface point that a feature track says should be seen at `pixel` in view `view`.
struct SurfaceTrack {
  int view = 0;
  SurfacePoint surface;
  Eigen::Vector2d pixel;
  double weight = 1; ///< against the other tracks
};

/// A point that moves with a joint of the skeleton, and where it was seen, such as a joint that keypoints show.
struct SeenPoint {
  int joint = 0;        ///< that moves it
  Eigen::Vector3d rest; ///< m, in the rest pose
  Eigen::Vector3d seen; ///< m, in the world
  double tolerance = 0; ///< m; as far from there it may be: the error of whoever saw it
  /// m: how far beyond that it is, 0 within.
  double beyond(const Eigen::Vector3d &place) const { return std::max(0.0, (place - seen).norm() - tolerance); }
};

/// Cameras that film between the frames of the others.
struct ViewTiming {
  Eigen::VectorXd late; ///< (views) frames by which each shows an earlier moment; empty = none does
  Vertices velocity;    ///< (V, 3) m a frame, of the surface
};

/// What one frame says about the pose. Arrays over views have one entry a camera; a view with an empty outline takes no part.
struct PoseProblem {
  const RiggedMesh *actor = nullptr;
  const CameraRig *rig = nullptr;
  const std::vector<Outline> *outlines = nullptr; ///< measured
  std::vector<SurfaceTrack> tracks;
  std::vector<SeenPoint> points;
  Vertices offset;             ///< (V, 3) m, rest pose: non-rigid offset of the surface, carried over from the frame before
  Eigen::VectorXd reliability; ///< (V) in [0, 1]: how well a vertex tells the pose; low on loose cloth
  Eigen::VectorXd predicted;   ///< (D) pose expected from the frames before
  Eigen::VectorXd start;       ///< (D) where to begin
  bool first = false;          ///< nothing is known yet: wider gates, more iterations, no pull to the prediction
  ViewTiming timing;           ///< of its cameras
};

struct PoseEstimate {
  Eigen::VectorXd dofs;           ///< (D)
  double rim_px = 0, sift_px = 0; ///< mean |residual| of the last iteration's matches, pixels
  double energy = 0;              ///< robust mean of the last iteration, in [0, 1]; comparable between starts
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
        option(&O::rims_per_view, "rims_per_view", at_least(10), "", "Number of correspondences a view and direction"),
        option(&O::gate_start, "gate_start", above(0), "m", "Rim matches farther away are dropped in the first iteration"),
        option(&O::gate_end, "gate_end", above(0), "m", "Rim matches farther away are dropped in the last iteration"),
        option(&O::scale_start, "scale_start", above(0), "m", "Geman-McClure scale of all residuals in the first iteration"),
        option(&O::scale_end, "scale_end", above(0), "m", "Geman-McClure scale of all residuals in the last iteration",
               "The size of skinning errors"),
        option(&O::sift_weight, "sift_weight", at_least(0), "", "Weight of a feature track against one rim match",
               "At 5 a skirt's features, bound to the thigh, hold a leg back"),
        option(&O::keypoint_weight, "keypoint_weight", at_least(0), "",
               "Weight of a joint that is beyond the tolerance of where keypoints show it, against one rim match"),
        option(&O::keypoint_scale, "keypoint_scale", above(0), "m",
               "Geman-McClure scale of how far it is beyond, in the last iteration",
               "Programs that find joints are now and then wrong by a limb. It is wider in the first ones, as scale_start is"),
        option(&O::prior_weight, "prior_weight", at_least(0), "",
               "Weight of the prediction against one rim match, at a deviation of prior_angle or prior_shift"),
        option(&O::prior_angle, "prior_angle", above(0), "rad", "Expected error of the predicted angles"),
        option(&O::prior_shift, "prior_shift", above(0), "m", "Expected error of the root's predicted translation"),
        option(&O::limit_weight, "limit_weight", at_least(0), "",
               "Weight of a joint limit that is passed by prior_angle, against one rim match"),
    };
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
};

/// The swap point: one frame's correspondences in, a pose out.
/// Threads: one call at a time, frame after frame; it may keep what it likes from one to the next.
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

/// (V, D): the share of each degree of freedom in each vertex's motion, sum of the weights of the joints that it moves.
MatrixRM dof_influence(const RiggedMesh &actor);

/// Derivative (3, D) of a surface point on the posed surface by the pose: sum of weights times twists. Exact for linear blending
/// and for rigid points, first-order for dual quaternions. `twists` of the pose.
Eigen::Matrix3Xd surface_jacobian(const SurfacePoint &point, const Vertices &vertices, const Faces &faces,
                                  const MatrixRM &influence, const std::vector<DofTwist> &twists);

} // namespace doublet
