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
  /// (F k, 3) B G R, 0 to 255, of any k points spread over every face, face by face; NaN where no camera sees it. What surface
  /// looks like (sample_colours() in texture_baker.h makes them). Empty = not known.
  Vertices colours = Vertices(0, 3);
};

} // namespace doublet
