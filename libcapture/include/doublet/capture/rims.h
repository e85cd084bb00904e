#pragma once
// Correspondences between a posed surface and measured outlines (Gall et al. 2009; Rosenhahn et al. 2007): surface points on the
// rendered outline (rims), matched to the measured outline in both directions, as point-to-line residuals.

#include "doublet/capture/outline.h"
#include "doublet/core/rasterizer.h"
#include "doublet/options/options.h"

#include <cstdint>

namespace doublet {

/// A surface point: a face and barycentric coordinates of its corners.
struct SurfacePoint {
  int face = -1;
  Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();
  Eigen::Vector3d position(const Vertices &vertices, const Faces &faces) const {
    return (barycentric[0] * vertices.row(faces(face, 0)) + barycentric[1] * vertices.row(faces(face, 1)) +
            barycentric[2] * vertices.row(faces(face, 2)))
        .transpose();
  }
};

/// The rendered outline of a surface in one view; the arrays of `outline` and `surface` go together.
struct Rims {
  Outline outline;                   ///< points in pixels of the full-size camera (its `pixels` are those of the rendering)
  std::vector<SurfacePoint> surface; ///< the surface point seen at the last inside pixel
  std::vector<Eigen::Vector2f>
      seen;                    ///< where it projects to, pixels of the full-size camera; up to a pixel inside outline.points
  double metres_per_pixel = 0; ///< on the surface, mean over the rims
};

/// Renders the surface (its valid faces; face_valid empty = all) at most `raster_size` pixels wide or high and traces it.
Rims find_rims(const Vertices &vertices, const Faces &faces, const Mask &face_valid, const Camera &camera, int raster_size);

/// One scalar constraint in view `view`: normal . (project(surface point) - target) = 0, pixels.
struct RimConstraint {
  int view = 0;
  SurfacePoint surface;
  Eigen::Vector2d target, normal; ///< pixels; unit
  double metres_per_pixel = 0;    ///< turns the pixel residual into metres at the surface
};

struct RimMatchOptions {
  int count = 350;
  double gate = 0.1;
  double min_cosine = 0.5;
  bool both_directions = true;
  static constexpr auto describe() {
    using namespace options;
    using O = RimMatchOptions;
    return Description{
        "RimMatchOptions",
        option(&O::count, "count", at_least(1), "", "Number of correspondences that are sought per view and direction",
               "Enough for a few on a part as wide as a finger"),
        option(&O::gate, "gate", above(0), "m", "Points farther apart than this are not matched"),
        option(&O::min_cosine, "min_cosine", Range{-1, 1}, "", "Smallest cosine between the normals of a match",
               "At 0.5 they may differ by 60 degrees"),
        option(&O::both_directions, "both_directions", "The measured outline is matched to the rendered one, too",
               "So that all of the measured outline must be explained"),
    };
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
};

/// Matches of one view. `unmatched` counts the samples without a match; `index` must be built from `measured`.
struct RimMatches {
  std::vector<RimConstraint> constraints;
  int unmatched = 0;
};
RimMatches match_rims(const Rims &rims, const Outline &measured, const OutlineIndex &index, int view, const Camera &camera,
                      const RimMatchOptions &options);

/// The residual of a constraint in pixels for the surface `vertices`.
double rim_residual(const RimConstraint &constraint, const Vertices &vertices, const Faces &faces, const Camera &camera);

} // namespace doublet
