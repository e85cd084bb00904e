#pragma once
#include "doublet/core/mesh.h"

#include <cstdint>
#include <vector>

namespace doublet::detail {

/// A surface whose faces carry a label; where two labels meet is a rim.
struct LabelledMesh {
  Mesh mesh;
  std::vector<std::uint8_t> labels; ///< (F)
};

/// Quadric error decimation (Garland & Heckbert 1997, OpenMesh) of a closed manifold to about `triangles` faces: half-edge
/// collapses, so the vertices left are vertices of `surface`; no collapse turns a face by more than 60 degrees or makes a needle,
/// and rims are only thinned along themselves, so that regions of one label stay joined, or apart, as they were. Stays closed and
/// manifold. Throws Error if the mesh is not manifold.
LabelledMesh decimate(const LabelledMesh &surface, int triangles);

/// Collapses edges shorter than `length` (m) of a closed manifold where that turns no face over and makes no needle: the slivers
/// that contouring a Poisson field leaves. `old_vertex[i]` is the vertex of `surface` that i was.
Mesh collapse_short_edges(const Mesh &surface, double length, std::vector<int> &old_vertex);

} // namespace doublet::detail
