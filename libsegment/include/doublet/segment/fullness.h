#pragma once
// How much wider the cloth is than the scan shows it.

#include "doublet/core/context.h"
#include "doublet/core/mesh_sequence.h"
#include "doublet/core/stage_values.h"

namespace doublet {

struct FullnessOptions {
  bool estimate = true; ///< off: the cloth is as wide as the scan
  /// A width counts that the video shows for the rest of the time: a skirt is spread out in a part of the motion alone, and the
  /// widest frames of all are those of the worst tracking.
  double quantile = 0.75;
  double largest = 1.8;    ///< more is taken for a mistake of the tracking
  double smoothing = 0.03; ///< m, length scale of the diffusion over the surface
  void validate() const;
};

/// (V) at least 1: the *fullness* of the cloth, its width across gravity over that of the scan. Beyond the paper: a garment hangs
/// in folds, and a scan bridges those that it cannot see into, so that a skirt made of it is too narrow to fly. Cloth does not
/// stretch much; what the video shows it spanning, it has. For every vertex and frame the metric of its surroundings (two rings
/// of edges) against the scan's is fitted by least squares. Its component across gravity (-y) counts, over that along gravity,
/// where cloth hangs straight and what it seems to stretch is the noise of the tracking. 1 off the cloth and where the surface
/// lies flat. sequence: the captured surface, posed. Throws std::invalid_argument if sizes disagree or there is no frame.
Eigen::VectorXd estimate_fullness(const Mesh &scan, const std::vector<std::uint8_t> &face_valid, const Clothness &clothness,
                                  const MeshSequence &sequence, const FullnessOptions &options = {}, const Context &context = {});

} // namespace doublet
