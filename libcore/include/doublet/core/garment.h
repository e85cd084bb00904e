#pragma once
// A garment with a mesh of its own, and the actor who wears it.

#include "doublet/core/stage_values.h"

#include <utility>

namespace doublet {

/// All cloth of a character as a mesh with regular triangles on the actor's surface. File: garment.npz.
struct Garment {
  Mesh mesh;                    ///< (G, 3) m in the scan pose, (H, 3); one or more components per region, bounded by simple loops
  Eigen::VectorXi region;       ///< (G) cloth region of each vertex
  Eigen::VectorXd clothness;    ///< (G) 0 = attached to the skeleton, 1 = free, between = the band of the attachment
  Vertices rest;                ///< (G, 3) m, the shape that defines lengths and masses: spread out, not hanging in folds
  std::vector<Vertices> widths; ///< [K] (G, 3) m, rest shapes to choose from, the widest first; empty = only `rest`
  Eigen::VectorXi actor_face;   ///< (G) position of each vertex on the actor: face ...
  Vertices barycentric;         ///< (G, 3) ... and barycentric coordinates
  Mask replaced_faces;          ///< (F) faces of the actor that the garment replaces
  /// (V) in [0, 1], for the actor's cloth: 1 = carried by the body and moves like skin, 0 = hangs free; empty = all free.
  Eigen::VectorXd attachment = {};
  int region_count = 0;
};

/// Throws Error naming `what`, expectation and finding if the arrays do not fit each other or the actor.
void validate_garment(const Garment &garment, const RiggedMesh &actor, const std::string &what);

/// (G, C) values of the actor's vertices (V, C), interpolated at the garment's vertices.
MatrixRM interpolate_to_garment(const Garment &garment, const Faces &actor_faces, const MatrixRM &values);

/// The garment in one width, without others to choose from. `chosen` (R): for each region a position among Garment::widths, 0 =
/// the first, 0.5 = halfway between first and second. Without widths to choose from, or with an empty `chosen`, its `rest` is
/// used. Throws std::invalid_argument for another number of regions, or a position beyond the first or the last width.
Garment choose_widths(const Garment &garment, const std::vector<double> &chosen = {});

/// [K] the garment in each of its widths; without widths to choose from, the garment itself.
std::vector<Garment> width_variants(const Garment &garment);

/// [garments][count] positions among the widths at which several meshes of one garment, made from several takes, have the same
/// rest area: from the widest that all have to the narrowest. Throws std::invalid_argument if one has no widths to choose from,
/// or their ranges of areas do not overlap.
std::vector<std::vector<double>> common_widths(const std::vector<Garment> &garments, int count);

/// The actor in the garment: vertices [0, V) are the actor's, [V, V + G) the garment's, with skin weights interpolated from the
/// actor's; the actor's faces that the garment replaces are invalid. Can be used wherever an actor and a segmentation are
/// expected. If the garment has no vertices, the cloth is that of the actor's own mesh, without the part that is carried by the
/// body (Garment::attachment).
struct DressedActor {
  RiggedMesh actor;          ///< V + G vertices, F + H faces
  Segmentation segmentation; ///< (V + G), cloth on the garment alone
};
DressedActor dress(const RiggedMesh &actor, const Segmentation &segmentation, const Garment &garment);
/// The captured surface on the dressed actor's mesh.
ReferencePerformance dress(const ReferencePerformance &performance, const RiggedMesh &actor, const Garment &garment);

// Deprecated names.
template <class... A> [[deprecated("use interpolate_to_garment")]] decltype(auto) at_garment(A &&...a) {
  return interpolate_to_garment(std::forward<A>(a)...);
}
template <class... A> [[deprecated("use choose_widths")]] decltype(auto) worn(A &&...a) {
  return choose_widths(std::forward<A>(a)...);
}
template <class... A> [[deprecated("use width_variants")]] decltype(auto) offered(A &&...a) {
  return width_variants(std::forward<A>(a)...);
}

} // namespace doublet
