#pragma once
#include "doublet/core/mesh.h"

namespace doublet::detail {

/// Drops what makes a surface non-manifold (the faces at edges with more than two faces, repeated faces; vertices where two fans
/// touch are split), keeps the component with the largest area and closes the small openings left. `old_vertex[i]` is the vertex
/// that i was, -1 for the new ones that close an opening. Throws Error if the result is not closed.
Mesh closed_surface(const Mesh &mesh, std::vector<int> &old_vertex);

} // namespace doublet::detail
