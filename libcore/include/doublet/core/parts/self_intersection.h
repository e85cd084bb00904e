#pragma once
// Intersections of a surface with itself and with segments.

#include "doublet/core/context.h"
#include "doublet/core/mesh.h"

#include <cstdint>
#include <vector>

namespace doublet {

/// (F) 1 for the faces that pass through another face of the mesh: an edge of one crosses the inside of the other, and they share
/// no corner of that edge. Faces that merely touch, or lie in one plane, do not count. In parallel; the result does not depend on
/// the number of threads. Throws Error if the mesh is not usable.
Mask self_intersecting_faces(const Mesh &mesh, const Context &context = {});

/// True if the segment from p to q (m) passes through the inside of a face. Tests every face.
bool crosses_surface(const Eigen::Vector3d &p, const Eigen::Vector3d &q, const Mesh &mesh);

/// Number of the given edges of the mesh that pass through the inside of a face without either end as a corner. Tests every face.
int crossing_edges(const Mesh &mesh, const std::vector<Eigen::Vector2i> &edges);

} // namespace doublet
