#pragma once
// A display surface in fewer triangles.

#include "doublet/core/textured_faces.h"

namespace doublet {

struct Character;

/// The valid faces of M_high, with the texture coordinates that it has. Throws Error as validate_character().
TexturedFaces drawn_faces(const Character &character);

/// About `triangles` of `drawn`, by half-edge collapses in the order of the quadric error (Garland & Heckbert 1997, OpenMesh):
/// the vertices that are left are vertices (V, 3) m of the surface, so that weights and animations fit. Open rims, and seams of
/// the texture, are only thinned along themselves, by what is straight; no face turns over. It may stop at more triangles, where
/// none can go. Faces that make the surface non-manifold, or have a vertex twice, stay. Throws std::invalid_argument on indices
/// or texture coordinates that do not fit, or fewer than 4 triangles.
TexturedFaces reduce_faces(const Vertices &vertices, const TexturedFaces &drawn, int triangles);

} // namespace doublet
