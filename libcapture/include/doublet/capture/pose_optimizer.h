#pragma once
// Pose of the skeleton from outlines and feature tracks of all cameras at once (Sect. 4; Gall et al. 2009, local optimisation).

#include "doublet/capture/rims.h"
#include "doublet/core/context.h"
#include "doublet/core/stage_values.h"

#include <memory>

namespace doublet {

/// A surface point that a feature track says should be seen at `pixel` in view `view`.
struct SurfaceTrack {
  int view = 0;
  SurfacePoint surface;
  Eigen::Vector2d pixel;
  double weight = 1; ///< against the other tracks
};

/// What one frame says about the pose. Arrays over views have one entry a camera; a view with an empty outline takes no part.
struct PoseProblem {
  const RiggedMesh *actor = nullptr;
  const CameraRig *rig = nullptr;
  const std::vector<Outline> *outlines = nullptr; ///< measured
  std::vector<SurfaceTrack> tracks;
  Vertices offset;             ///< (V, 3) m, rest pose: non-rigid offset of the surface, carried over from the frame before
  Eigen::VectorXd reliability; ///< (V) in [0, 1]: how well a vertex tells the pose; low on loose cloth
  Eigen::VectorXd predicted;   ///< (D) pose expected from the frames before
  Eigen::VectorXd start;       ///< (D) where to begin
  bool first = false;          ///< nothing is known yet: wider gates, more iterations, no pull to the prediction
};

struct PoseEstimate {
  Eigen::VectorXd dofs;           ///< (D)
  double rim_px = 0, sift_px = 0; ///< mean |residual| of the last iteration's matches, pixels
  double energy = 0;              ///< robust mean of the last iteration, in [0, 1]; comparable between starts
  int iterations = 0;
};

struct PoseOptions {
  int iterations = 8;        ///< renderings with re-matching; a tracked frame moves below 1 mm after 6
  int first_iterations = 24; ///< the same for the first frame
  int raster_size = 512;     ///< px; longest side of the renderings in which rims are found; rims keep sub-pixel residuals
  int rims_per_view = 300;   ///< correspondences per view and direction
  double gate_start = 0.15, gate_end = 0.06; ///< m; rim matches farther away are dropped; from the first to the last iteration
  double scale_start = 0.05,
         scale_end = 0.015; ///< m; Geman-McClure scale of all residuals; shrinks likewise. The end is the size of skinning errors
  double sift_weight = 1.0; ///< of one feature track against one rim correspondence
  double prior_weight = 4.0; ///< of the prediction against one rim correspondence, for a deviation of prior_angle or prior_shift
  double prior_angle = 0.15; ///< rad; expected error of the prediction
  double prior_shift = 0.03; ///< m; the same for the root's translation
  double limit_weight = 400.0; ///< of a joint limit passed by prior_angle against one rim correspondence
  void validate() const;
};

/// The swap point: one frame's correspondences in, a pose out.
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
