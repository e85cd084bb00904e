#pragma once
// Surface refinement (Sect. 4; Gall et al. 2009 Sect. 5; Laplacian deformation as in Botsch & Sorkine 2008): the posed surface is
// bent so that its outline meets the measured one and its texture features lie where they were seen.

#include "doublet/capture/pose_optimizer.h"

namespace doublet {

/// One frame. Arrays over views have one entry a camera; a view with an empty outline takes no part.
struct SurfaceProblem {
  const RiggedMesh *actor = nullptr;
  const CameraRig *rig = nullptr;
  const std::vector<Outline> *outlines = nullptr; ///< measured
  std::vector<SurfaceTrack> tracks;
  Vertices base;               ///< (V, 3) m; the surface expected: posed, with the non-rigid offset carried from the frame before
  Vertices skinned;            ///< (V, 3) m; posed without any offset
  Eigen::VectorXd reliability; ///< (V) in [0, 1]: 1 = moves with the skeleton, 0 = loose cloth
};

struct SurfaceEstimate {
  Vertices vertices;              ///< (V, 3) m
  double rim_px = 0, sift_px = 0; ///< mean |residual| of the last matches, pixels
};

struct SurfaceOptions {
  int iterations = 3;                          ///< renderings with re-matching
  int raster_size = 1024;                      ///< px; longest side of the renderings in which rims are found
  int rims_per_view = 500;                     ///< correspondences per view and direction
  double gate_start = 0.10, gate_end = 0.04;   ///< m; as in PoseOptions; a hem moves up to 0.1 m between frames
  double scale_start = 0.04, scale_end = 0.02; ///< m; Geman-McClure scale
  double sift_weight = 2.0; ///< of one feature track against one rim match; more lets skin slide where tracks are off
  double bending = 1.0;     ///< weight of |Laplacian of the displacement|^2 a vertex; keeps the shape between constraints
  double stretching = 0.02; ///< weight of |difference of neighbours' displacement|^2; small, ties down what nothing else does
  double memory = 1.0;      ///< share of the offset from the skinned surface that bends and stretches back; 0 lets folds pile up
  double anchor_cloth = 0.01; ///< pull of a loose vertex to its expected position, against one rim correspondence
  double anchor_rigid = 0.5;  ///< the same for a vertex that moves with the skeleton, to its skinned position
  double loose = 0.02;        ///< m; a vertex this far from its skinned position is held there with a quarter of anchor_rigid
  void validate() const;
};

/// Is the face's longest edge more than twice what it was at rest? Cloth and skin do not stretch so far: such a face has lost its
/// place, and what is seen there belongs to something else.
bool overstretched(const Vertices &vertices, const Mesh &rest, int face);

/// The swap point: expected surface and correspondences in, refined surface out. May keep factorisations from call to call.
class SurfaceRefiner {
public:
  virtual ~SurfaceRefiner() = default;
  virtual SurfaceEstimate refine(const SurfaceProblem &problem, const Context &context) = 0;
  static std::unique_ptr<SurfaceRefiner> create(const SurfaceOptions &options = {});
};

} // namespace doublet
