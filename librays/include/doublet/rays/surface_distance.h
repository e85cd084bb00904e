#pragma once
// Distances of points from a surface, and visibility of vertices in cameras: used by the evaluation (docs/formats.md).

#include "doublet/core/camera.h"
#include "doublet/core/context.h"
#include "doublet/core/mesh.h"

#include <cstdint>
#include <vector>

namespace doublet {

/// (N) unsigned distances, m, of `points` (N, 3) to the faces of `surface` with face_valid[f] != 0 (empty = all). In parallel;
/// the result does not depend on the number of threads. Throws Error if the surface is not usable, std::invalid_argument on a
/// point that is not finite.
Eigen::VectorXd distances_to_surface(const Vertices &points, const Mesh &surface, const Mask &face_valid = {},
                                     const Context &context = {});

/// (V) 1 for vertices that at least one camera sees: inside its image and no more than `tolerance` (m along the optical axis)
/// behind the farthest surface in the four surrounding pixels. So a vertex that is hidden by less than a pixel at an outline
/// counts as seen.
Mask visible_vertices(const Vertices &vertices, const Faces &faces, const CameraRig &cameras, double tolerance);

} // namespace doublet
