#pragma once
// How much wider the cloth is than the scan shows it.

#include "doublet/core/context.h"
#include "doublet/core/mesh_sequence.h"
#include "doublet/core/stage_values.h"
#include "doublet/options/options.h"

namespace doublet {

struct FullnessOptions {
  bool estimate = true;
  double quantile = 0.75;
  double largest = 1.8;
  double smoothing = 0.03;
  static constexpr auto describe() {
    using namespace options;
    using O = FullnessOptions;
    return Description{
        "FullnessOptions",
        option(&O::estimate, "estimate", "off: the cloth is as wide as the scan, as in the paper"),
        option(&O::quantile, "quantile", Range{0, 1}, "",
               "over time, of the width that counts: a skirt is spread in a part of the motion only, and widest where tracking "
               "is worst"),
        option(&O::largest, "largest", at_least(1), "", "more is taken for a mistake of the tracking"),
        option(&O::smoothing, "smoothing", at_least(0), "m",
               "length scale of the diffusion over the surface; about an edge of the template"),
    };
  }
  void validate() const { options::check(*this); } ///< throws std::invalid_argument naming option, range and value
};

/// (V) at least 1: the *fullness* of the cloth, its width across gravity over that of the scan. Beyond the paper: a garment hangs
/// in folds, and a scan bridges those that it cannot see into, so that a skirt made of it is too narrow to fly. Cloth does not
/// stretch much; what the video shows it spanning, it has. For every vertex and frame the metric of its surroundings (two rings
/// of edges) against the scan's is fitted by least squares. Its component across gravity (-y) counts, over that along gravity,
/// where cloth hangs straight and what it seems to stretch is the noise of the tracking. 1 off the cloth and where the surface
/// lies flat. sequence: the captured surface, posed. Throws std::invalid_argument if sizes disagree or there is no frame.
Eigen::VectorXd estimate_fullness(const Mesh &scan, const Mask &face_valid, const Segmentation &segmentation,
                                  const MeshSequence &sequence, const FullnessOptions &options = {}, const Context &context = {});

} // namespace doublet
