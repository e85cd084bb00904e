#pragma once
// The order in which Gauss-Seidel visits the constraints. Neighbouring constraints share vertices and wait for each other's
// results; an order that leaves a vertex alone for a while lets the processor overlap them (2-3x). Results depend on the order,
// so it is part of the model.

#include <vector>

namespace doublet::pbd {

inline constexpr int kStretchGap = 12; ///< stretches before a vertex is touched again, where the mesh allows
inline constexpr int kBendGap = 6;     ///< the same for bends

/// Order of constraints: levels ascending (rings outward from the attachment, so that one sweep carries it far), within that the
/// first constraint whose vertices were all left alone for `gap` constraints; where there is none, the one that comes closest.
/// vertices: `arity` indices a constraint; levels: one a constraint. Returns a permutation of the constraints. Deterministic.
std::vector<int> spread_order(const std::vector<int> &vertices, int arity, const std::vector<int> &levels, int vertex_count,
                              int gap);

} // namespace doublet::pbd
