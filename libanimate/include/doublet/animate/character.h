#pragma once
// The animatable character: everything that a new animation needs, as one value. File: character.glb (character_file.h).

#include "doublet/core/context.h"
#include "doublet/core/image.h"
#include "doublet/simulate/character_simulator.h"
#include "doublet/simulate/solver_settings.h"

#include <string>

namespace doublet {

/// (N, 2) texture coordinates, glTF's convention: (0, 0) is the top left corner of the image.
using TexCoords = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;

struct Character {
  std::string name = "character";
  RiggedMesh actor; ///< M, skeleton, skin weights
  Segmentation segmentation;
  std::vector<TaperedCapsule> proxies;
  std::vector<pbd::Material> materials; ///< one per cloth region
  SolverSettings solver;

  Mesh body;                                     ///< the body under the clothes, scan pose; may be empty
  std::string body_model;                        ///< name and hash of the statistical model
  MatrixRM body_weights;                         ///< (B, J)
  Mask body_shown;                               ///< (FB) 1 = hidden under cloth in the scan, must be drawn
  Eigen::Vector3d body_colour{0.61, 0.35, 0.25}; ///< linear RGB in [0, 1] of the hidden body

  Mesh high;                     ///< M_high for display, scan pose; may be empty: then M is displayed
  Mask high_valid;               ///< (FH)
  int garment_subdivisions = -1; ///< of the garment in M_high; -1 = M_high is one surface (see DisplayMesh)
  /// If the hidden body is welded to M_high's skin: indices into `body` of the last vertices of that skin (M_high's vertices
  /// before the garment's), which are the body's; body_shown is then 0. Empty = the hidden body is drawn as a separate mesh.
  std::vector<int> high_body;
  TexCoords texcoords;               ///< (3 FH, 2) per corner of M_high; empty = no texture
  std::vector<std::uint8_t> texture; ///< PNG or JPEG file; empty = no texture
};

/// Checks that all parts fit together. Throws Error naming the part.
void validate_character(const Character &character);

/// Assembles a character: checks sizes, computes the body's skin weights and which of its faces must be drawn. If M_high has a
/// garment, these faces are welded to M_high's skin where the two fit together. `high` and `body` may be empty; `high`,
/// `high_valid` and `garment_subdivisions` come from build_display_mesh() (display_surface.h). Throws as validate_character().
Character make_character(const RiggedMesh &actor, const Segmentation &segmentation, const BodyFit &body,
                         const std::vector<TaperedCapsule> &proxies, const std::vector<pbd::Material> &materials,
                         const SolverSettings &solver, const Mesh &high = {}, const Mask &high_valid = {},
                         int garment_subdivisions = -1);

/// (B) 1 = cloth hides this body vertex in the scan pose: the nearest valid surface is cloth, or the surface is not close and the
/// ray along the vertex normal hits cloth.
Mask hidden_by_cloth(const RiggedMesh &actor, const Segmentation &segmentation, const Mesh &body);

/// (FH) 1 = the face of M_high belongs to the hidden body (see Character::high_body), or joins it to the scan. Throws as
/// validate_character().
Mask hidden_faces(const Character &character);

/// (B, J) skin weights of the body. Exposed vertices take those of the actor's surface; those of hidden vertices solve the heat
/// equation of Baran & Popovic 2007 on the body with the exposed ones as boundary values, so that thighs under a skirt follow the
/// thigh bones, not the skirt's weights. With proxies, the nearest proxy is used in place of the nearest bone: the proxies that
/// cloth collides with and the body that is drawn then move together. Throws as require_proxies().
MatrixRM transfer_weights(const RiggedMesh &actor, const Segmentation &segmentation, const Mesh &body,
                          const std::vector<TaperedCapsule> &proxies = {});

} // namespace doublet
