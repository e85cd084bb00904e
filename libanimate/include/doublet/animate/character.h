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
  /// The last of M_high's skin (its vertices before the garment's) that are the body's, which goes on under the garment, welded
  /// to the scan: the vertex of `body` that each is. Then body_shown is 0. Empty = the hidden body is drawn beside M_high.
  std::vector<int> high_body;
  TexCoords texcoords;               ///< (3 FH, 2) per corner of M_high; empty = no texture
  std::vector<std::uint8_t> texture; ///< PNG or JPEG file; empty = no texture
};

/// Checks that all parts fit together. Throws Error naming the part.
void validate_character(const Character &character);

/// Puts a character together: checks sizes, computes the body's skin weights and which of its faces are needed; where M_high has
/// a garment these become part of it, welded to its skin, if the two fit together.
/// `high`, `body` may be empty; `high`, `high_valid` and `garment_subdivisions` as build_display_mesh() (display_surface.h) makes
/// them.
Character make_character(const RiggedMesh &actor, const Segmentation &segmentation, const BodyFit &body,
                         const std::vector<TaperedCapsule> &proxies, const std::vector<pbd::Material> &materials,
                         const SolverSettings &solver, const Mesh &high = {}, const Mask &high_valid = {},
                         int garment_subdivisions = -1);

/// (B) 1 = this body vertex is hidden by cloth in the scan pose: the nearest valid surface is cloth, or the surface is away and
/// its normal runs into cloth.
Mask hidden_by_cloth(const RiggedMesh &actor, const Segmentation &segmentation, const Mesh &body);

/// (FH) 1 = a face of M_high that is of the hidden body (see Character::high_body), or joins it to the scan. Throws as
/// validate_character().
Mask hidden_faces(const Character &character);

/// (B, J) skin weights for the body. Exposed vertices take those of the actor's surface; hidden ones solve the heat equation of
/// Baran & Popovic 2007 on the body with the exposed ones as boundary, so that thighs under a skirt hang on the thigh bones, not
/// on the skirt's weights. With proxies the nearest of these stands for the nearest bone: what cloth collides with and what is
/// drawn under it then move together. Throws as require_proxies().
MatrixRM transfer_weights(const RiggedMesh &actor, const Segmentation &segmentation, const Mesh &body,
                          const std::vector<TaperedCapsule> &proxies = {});

} // namespace doublet
