#pragma once

#include "doublet/core/mesh.h"

namespace doublet {

/// A deforming surface: one topology, one set of positions per frame.
struct MeshSequence {
  Faces faces;                  ///< (F, 3)
  std::vector<Vertices> frames; ///< T x (V, 3) metres
  /// The frames brought back to the scan pose by their skeleton (unposed_frames() in stage_values.h), T x (V, 3) metres: what
  /// still moves there, skinning does not explain. Empty = not known.
  std::vector<Vertices> unposed = {};
};

} // namespace doublet
