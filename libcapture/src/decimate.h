#pragma once
#include "doublet/core/mesh.h"

namespace doublet::detail {

/// Quadric error decimation (Garland & Heckbert 1997, OpenMesh) of a closed manifold to about `triangles` faces: half-edge
/// collapses, so the vertices left are vertices of `mesh`; no collapse turns a face by more than 60 degrees or makes a needle.
/// Stays closed and manifold. Throws Error if the mesh is not manifold.
Mesh decimate(const Mesh &mesh, int triangles);

} // namespace doublet::detail
