#pragma once
// A scan from the cameras themselves, where there is no scanner: the visual hull of the silhouettes of one frame (Laurentini
// 1994), moved inwards where neighbouring cameras agree on a surface inside it.

#include "doublet/capture/silhouette_extractor.h"
#include "doublet/core/camera.h"
#include "doublet/core/mesh.h"
#include "doublet/options/options.h"

#include <numbers>
#include <vector>

namespace doublet {

struct ViewScanOptions {
  double cell = 0.006;
  int poisson_depth = 9;
  int max_missing_views = 0;
  double search_depth = 0.08;
  double patch = 0.035;
  double smoothness = 0.3;
  double grazing_angle = 80 * std::numbers::pi / 180;
  static constexpr int kMaxMissingViews = 7;
  static constexpr auto describe() {
    using namespace options;
    using O = ViewScanOptions;
    return Description{
        "ViewScanOptions",
        option(&O::cell, "cell", Range{0.001, 0.05}, "m", "Size of a cell of the grid that the visual hull is sampled on"),
        option(&O::poisson_depth, "poisson_depth", Range{5, 11}, "", "Octree depth of the surface through the samples"),
        option(&O::max_missing_views, "max_missing_views", Range{0, kMaxMissingViews}, "cameras",
               "Number of cameras whose silhouettes may miss a point that all others contain",
               "Holes in silhouettes then cut less, and the hull gets thicker"),
        option(&O::search_depth, "search_depth", Range{0, 0.3}, "m",
               "Depth inside the hull within which the surface is sought; 0 = the hull itself"),
        option(&O::patch, "patch", Range{0.01, 0.3}, "m", "Side of the square of surface that two cameras compare"),
        option(&O::smoothness, "smoothness", above(0), "", "Correlation that a depth step of 1 cm between neighbours must gain"),
        option(&O::grazing_angle, "grazing_angle", Range{0.17, std::numbers::pi / 2}, "rad",
               "Surface that faces down is left out if no camera sees it at a smaller angle to its normal",
               "Under a hem. The default is 80 degrees"),
    };
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
};

/// rig, views: one entry per camera, all of one frame; a view without a mask is not used, one without an image only for the hull.
/// Returns the largest component of the surface, in metres, +Y up, with holes where it faces down and no camera sees it (under a
/// hem, soles). Throws std::invalid_argument on sizes that differ; Error if fewer than 3 cameras show the actor, or if the
/// silhouettes have no point in common, naming the camera without which they would.
Mesh scan_from_views(const CameraRig &rig, const std::vector<CameraView> &views, const ViewScanOptions &options = {},
                     const Context &context = {});

/// The same with a body (closed, usable; m) that was fitted to a first scan, as by detect_joints(): the surface lies no farther
/// from it than the outlines do nearby. With few cameras the hull has corners, and is filled where an arm hides the trunk from a
/// camera.
Mesh scan_from_views(const CameraRig &rig, const std::vector<CameraView> &views, const Mesh &body,
                     const ViewScanOptions &options = {}, const Context &context = {});

} // namespace doublet
