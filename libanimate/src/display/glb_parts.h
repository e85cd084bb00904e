#pragma once
// Parts of a scene that both character.glb and baked animations have: joint nodes, skinned meshes, materials.

#include "doublet/animate/character.h"
#include "glb.h"

#include <array>

namespace doublet::glb {

/// What is drawn of a mesh: its valid faces, corners split where texture coordinates need it.
struct GlbMesh {
  Mesh mesh;
  Vertices normals;
  TexCoords texcoords;                ///< per vertex, or empty
  std::vector<int> vertex_from_shown; ///< index into the original vertices
};
GlbMesh display_mesh(const Mesh &mesh, const std::vector<std::uint8_t> &shown, const TexCoords &corner_texcoords);
/// The same of a surface, of which something must be drawn: else Error.
GlbMesh surface_mesh(const Mesh &mesh, const std::vector<std::uint8_t> &shown, const TexCoords &corner_texcoords);

/// Nodes of the skeleton in the rest pose; node i is joint i.
void add_joint_nodes(Writer &writer, const Skeleton &skeleton);
/// A skin over those nodes, of meshes whose numbers are in `unit` m; returns its index.
int add_skin(Writer &writer, const Skeleton &skeleton, double unit = 1);
/// A rough, non-metallic surface; `texture_image` < 0 = none.
int add_material(Writer &writer, const std::string &name, const Eigen::Vector3d &colour, int texture_image, bool double_sided);
/// A mesh with POSITION, NORMAL, TEXCOORD_0 and, if weights are given (original vertices, J), JOINTS_0 and WEIGHTS_0.
int add_mesh(Writer &writer, const std::string &name, const GlbMesh &shown, int material, const MatrixRM *weights);

struct Influence {
  int joint = 0;
  float weight = 0;
};
using Influences = std::vector<std::array<Influence, 4>>; ///< [shown vertices]
/// With what a viewer skins what add_mesh() writes: the four largest weights, normalised; unused slots name joint 0, as glTF
/// asks.
Influences viewer_influences(const GlbMesh &shown, const MatrixRM &weights);
/// [shown vertices] the blends of the bones (linear).
std::vector<Eigen::Affine3d> viewer_blends(const Influences &influences, const Transforms &world_from_rest);
/// A node of the scene that shows the mesh, skinned if skin >= 0.
int add_mesh_node(Writer &writer, const std::string &name, int mesh, int skin);

} // namespace doublet::glb
