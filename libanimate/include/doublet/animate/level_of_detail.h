#pragma once
// A display surface in fewer triangles.

#include "doublet/core/textured_faces.h"

namespace doublet {

struct Character;

/// The valid faces of M_high, with the texture coordinates that it has. Throws Error as validate_character().
TexturedFaces drawn_faces(const Character &character);

/// Reduces `drawn` to about `triangles` faces by half-edge collapses in the order of the quadric error (Garland & Heckbert 1997,
/// OpenMesh). The remaining vertices are vertices (V, 3) m of the surface, so that weights and animations still fit. Boundaries
/// and seams of the texture lose vertices only where they are straight; no face flips. More triangles may remain if no further
/// collapse is possible. Faces that make the surface non-manifold, or have a vertex twice, are kept. Throws std::invalid_argument
/// on indices or texture coordinates that do not fit, or fewer than 4 triangles.
TexturedFaces reduce_faces(const Vertices &vertices, const TexturedFaces &drawn, int triangles);

} // namespace doublet
