#pragma once
// A scan out of the cameras themselves, where there is no scanner: what the silhouettes of one frame leave (the visual hull,
// Laurentini 1994), pressed in where neighbouring cameras agree on a surface inside it.

#include "doublet/capture/silhouette_extractor.h"
#include "doublet/core/camera.h"
#include "doublet/core/mesh.h"
#include "doublet/options/options.h"

#include <vector>

namespace doublet {

struct ViewScanOptions {
  double cell = 0.006;
  int poisson_depth = 9;
  int outvoted = 0;
  double search_depth = 0.08;
  double patch = 0.035;
  double smoothness = 0.3;
  double grazing_angle = 80;
  static constexpr int kMostOutvoted = 7;
  static constexpr auto describe() {
    using namespace options;
    using O = ViewScanOptions;
    return Description{
        "ViewScanOptions",
        option(&O::cell, "cell", Range{0.001, 0.05}, "m", "of the grid that the visual hull is sampled on"),
        option(&O::poisson_depth, "poisson_depth", Range{5, 11}, "", "octree depth of the surface through the samples"),
        option(&O::outvoted, "outvoted", Range{0, kMostOutvoted}, "cameras",
               "that may miss a point which all others see: silhouettes with holes cut less, the hull gets thicker"),
        option(&O::search_depth, "search_depth", Range{0, 0.3}, "m",
               "how far inside the hull the surface is looked for; 0 = the hull itself"),
        option(&O::patch, "patch", Range{0.01, 0.3}, "m", "side of the square of surface that two cameras compare"),
        option(&O::smoothness, "smoothness", above(0), "",
               "correlation that a step of a centimetre between neighbours must gain"),
        option(&O::grazing_angle, "grazing_angle", Range{10, 90}, "degrees",
               "surface that faces down and that every camera sees flatter than this, or not at all, is left out: under a hem"),
    };
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
};

/// rig, views: one each a camera, the views of one frame; a view without a mask takes no part, one without an image only in the
/// hull. Returns the largest piece of the surface, in metres, +Y up, with holes where it faces down and no camera sees it (under
/// a hem, soles). Throws std::invalid_argument on sizes that differ; Error if fewer than 3 cameras show the actor, or the
/// silhouettes have no point in common, naming the camera without which they have.
Mesh scan_from_views(const CameraRig &rig, const std::vector<CameraView> &views, const ViewScanOptions &options = {},
                     const Context &context = {});

} // namespace doublet
