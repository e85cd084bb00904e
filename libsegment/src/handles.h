#pragma once
// Handles of a surface: where a reconstruction has joined two folds that touch.

#include "doublet/core/mesh.h"

#include <vector>

namespace doublet::detail {

/// `mesh` (manifold) cut along the shortest loops that do not part it, each of the two edges of a cut closed by a disc, until no
/// such loop is `longest` m long or less (Guskov & Wood, Topological noise removal, GI 2001). A handle cannot be laid out without
/// a knot. What there is of vertices and faces keeps its place in the order; a mesh without handles comes back as it is.
Mesh without_handles(const Mesh &mesh, double longest);

/// `mesh` with a disc over each of these loops of its boundary (boundary_loops()).
Mesh with_closed_loops(Mesh mesh, const std::vector<std::vector<int>> &loops);

/// Of all connected surfaces together: the most loops that do not part them.
int genus(const Mesh &mesh);

} // namespace doublet::detail
