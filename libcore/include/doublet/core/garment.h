#pragma once
// A garment with a mesh of its own, and the actor who wears it.

#include "doublet/core/stage_values.h"

#include <utility>

namespace doublet {

/// All cloth of a character as a regular mesh on the actor's surface. File: garment.npz.
struct Garment {
  Mesh mesh;                    ///< (G, 3) m in the scan pose, (H, 3); one component or more a region, bounded by clean loops
  Eigen::VectorXi region;       ///< (G) cloth region of each vertex
  Eigen::VectorXd clothness;    ///< (G) 0 = hangs on the skeleton, 1 = free, between = the attachment's band
  Vertices rest;                ///< (G, 3) m, the shape that lengths and masses come from: spread out, not hanging in folds
  std::vector<Vertices> widths; ///< [K] (G, 3) m, rest shapes to choose from, the widest first; empty = `rest` alone
  Eigen::VectorXi actor_face;   ///< (G) the place of each vertex on the actor: face ...
  Vertices barycentric;         ///< (G, 3) ... and weights of its corners
  Mask replaced_faces;          ///< (F) faces of the actor that the garment stands for
  /// (V) in [0, 1] of the actor's cloth: 1 = carried by the body, which it follows as skin does, 0 = hangs free; empty = all
  /// free.
  Eigen::VectorXd attachment = {};
  int region_count = 0;
};

/// Throws Error naming `what`, expectation and finding if the arrays do not fit together or to the actor.
void validate_garment(const Garment &garment, const RiggedMesh &actor, const std::string &what);

/// (G, C) values of the actor's vertices (V, C) at the places of the garment's.
MatrixRM interpolate_to_garment(const Garment &garment, const Faces &actor_faces, const MatrixRM &values);

/// The garment in the widths (R) that are `chosen`, a position among those it offers for each region: 0 = the first, 0.5 =
/// halfway to the second; the only one it still offers. Without widths to choose from, or with an empty choice, the garment in
/// its `rest`. Throws std::invalid_argument for another number of regions, or a position that is not between the first and the
/// last.
Garment choose_widths(const Garment &garment, const std::vector<double> &chosen = {});

/// [K] the garment in each of the widths that it offers; one that offers none alone.
std::vector<Garment> width_variants(const Garment &garment);

/// [garments][count] positions at which several meshes of one garment, made from several takes, have the same area at rest: from
/// the widest that all offer to the narrowest. Throws std::invalid_argument if one offers no choice, or they have no area in
/// common.
std::vector<std::vector<double>> common_widths(const std::vector<Garment> &garments, int count);

/// The actor in the garment: vertices [0, V) are the actor's, [V, V + G) the garment's, which have the skin weights of their
/// place; those of the actor's faces that it covers count as invalid. Everything that
/// takes an actor and a segmentation takes these. With a garment without vertices the cloth is the loose part of the actor's own
/// mesh, but for what is carried by the body (Garment::attachment): that is no cloth any more.
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
