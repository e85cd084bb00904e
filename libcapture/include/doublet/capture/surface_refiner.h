#pragma once
// Surface refinement (Sect. 4; Gall et al. 2009 Sect. 5; Laplacian deformation as in Botsch & Sorkine 2008): the posed surface is
// deformed so that its outline meets the measured one and its texture features lie where they were seen.

#include "doublet/capture/pose_optimizer.h"
#include "doublet/options/options.h"

namespace doublet {

/// One frame. Arrays over views have one entry per camera; a view with an empty outline takes no part.
struct SurfaceProblem {
  const RiggedMesh *actor = nullptr;
  const CameraRig *rig = nullptr;
  const std::vector<Outline> *outlines = nullptr; ///< measured
  std::vector<SurfaceTrack> tracks;
  Vertices base;               ///< (V, 3) m; the predicted surface: posed, with the non-rigid offset of the previous frame
  Vertices skinned;            ///< (V, 3) m; posed without any offset
  Eigen::VectorXd reliability; ///< (V) in [0, 1]: 1 = moves with the skeleton, 0 = loose cloth
  ViewTiming timing;           ///< of its cameras
};

struct SurfaceEstimate {
  Vertices vertices;              ///< (V, 3) m
  double rim_px = 0, sift_px = 0; ///< mean |residual| of the last matches, pixels
};

struct SurfaceOptions {
  int iterations = 3;
  int raster_size = 1024;
  int rims_per_view = 500;
  double gate_start = 0.10, gate_end = 0.04;
  double scale_start = 0.04, scale_end = 0.02;
  double sift_weight = 2.0;
  double bending = 1.0;
  double stretching = 0.02;
  double offset_prior_share = 1.0;
  double anchor_cloth = 0.01;
  double anchor_rigid = 0.5;
  double anchor_falloff = 0.02;
  static constexpr auto describe() {
    using namespace options;
    using O = SurfaceOptions;
    return Description{
        "SurfaceOptions",
        option(&O::iterations, "iterations", at_least(0), "", "Number of renderings, each with new matches"),
        option(&O::raster_size, "raster_size", at_least(64), "px", "Longest side of the renderings in which rims are found"),
        option(&O::rims_per_view, "rims_per_view", at_least(10), "", "Number of correspondences per view and direction"),
        option(&O::gate_start, "gate_start", above(0), "m", "Rim matches farther away are dropped in the first iteration",
               "A hem moves up to 0.1 m between frames"),
        option(&O::gate_end, "gate_end", above(0), "m", "Rim matches farther away are dropped in the last iteration"),
        option(&O::scale_start, "scale_start", above(0), "m", "Geman-McClure scale of the residuals in the first iteration"),
        option(&O::scale_end, "scale_end", above(0), "m", "Geman-McClure scale of the residuals in the last iteration"),
        option(&O::sift_weight, "sift_weight", at_least(0), "", "Weight of a feature track against one rim match",
               "At 10 skin slides towards tracks that are off by a pixel"),
        option(&O::bending, "bending", above(0), "", "Weight of |Laplacian of the displacement|^2 per vertex",
               "Keeps the shape between constraints"),
        option(&O::stretching, "stretching", above(0), "", "Weight of |difference of neighbours' displacement|^2",
               "Small; determines what no other term does"),
        option(&O::offset_prior_share, "offset_prior_share", Range{0, 1}, "",
               "Share of the offset from the skinned surface that bending and stretching act on",
               "With 0 folds accumulate from frame to frame"),
        option(&O::anchor_cloth, "anchor_cloth", above(0), "",
               "Weight of a cloth vertex's expected position, against one rim match"),
        option(&O::anchor_rigid, "anchor_rigid", above(0), "",
               "Weight of a rigid vertex's skinned position, against one rim match"),
        option(&O::anchor_falloff, "anchor_falloff", above(0), "m",
               "At this distance from its skinned position a vertex has a quarter of anchor_rigid"),
    };
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
};

/// True if the longest edge of the face is more than twice as long as at rest. Cloth and skin do not stretch so far: such a face
/// is misplaced, and what is seen there belongs to something else.
bool is_overstretched(const Vertices &vertices, const Mesh &rest, int face);

/// The swap point: expected surface and correspondences in, refined surface out.
/// Threads: one call at a time, frame after frame; factorisations may be kept from one to the next.
class SurfaceRefiner {
public:
  virtual ~SurfaceRefiner() = default;
  virtual SurfaceEstimate refine(const SurfaceProblem &problem, const Context &context) = 0;
  static std::unique_ptr<SurfaceRefiner> create(const SurfaceOptions &options = {});
};

} // namespace doublet
