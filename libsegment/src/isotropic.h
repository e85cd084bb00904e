#pragma once
// Isotropic remeshing of an open surface.

#include "doublet/core/mesh.h"

#include <functional>

namespace doublet::detail {

/// Regular triangles with edges of about `length` (m) on the surface of `mesh` (manifold, open or closed): Botsch & Kobbelt 2004
/// (split above 4/3, collapse below 4/5, flip towards valence 6, relax tangentially, project). Boundary vertices stay on the
/// boundary, which is resampled evenly, and smoothed: what is shorter than `noise` (m), or than two edges, goes. Throws Error if
/// the mesh is not manifold.
Mesh remesh_isotropic(const Mesh &mesh, double length, double noise = 0, int iterations = 12);

} // namespace doublet::detail
