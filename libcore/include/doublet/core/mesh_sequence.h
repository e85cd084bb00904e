#pragma once

#include "doublet/core/mesh.h"

namespace doublet {

/// A deforming surface: one topology, one set of positions per frame.
struct MeshSequence {
  Faces faces;                  ///< (F, 3)
  std::vector<Vertices> frames; ///< T x (V, 3) metres
};

} // namespace doublet
