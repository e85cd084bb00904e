#include "glb_parts.h"

#include "doublet/core/error.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>
#include <tuple>

namespace doublet::glb {
namespace {

/// In float.
std::array<Influence, 4> strongest(const Eigen::VectorXd &weights) {
  std::vector<int> order(weights.size());
  std::iota(order.begin(), order.end(), 0);
  const std::size_t n = std::min<std::size_t>(4, order.size());
  std::partial_sort(order.begin(), order.begin() + n, order.end(),
                    [&](int a, int b) { return weights[a] != weights[b] ? weights[a] > weights[b] : a < b; });
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i)
    sum += std::max(weights[order[i]], 0.0);
  std::array<Influence, 4> result;
  float others = 0;
  for (std::size_t i = n; i-- > 1;) {
    const auto weight = static_cast<float>(std::max(weights[order[i]], 0.0) / sum);
    if (weight > 1e-6f) {
      result[i] = {order[i], weight};
      others += weight;
    }
  }
  result[0] = {order[0], 1.0f - others};
  return result;
}

void add_influences(Writer &writer, tinygltf::Primitive &primitive, const GlbMesh &shown, const MatrixRM &weights) {
  std::vector<std::uint16_t> joints;
  std::vector<float> values;
  for (const auto &vertex : viewer_influences(shown, weights))
    for (const Influence &influence : vertex) {
      joints.push_back(static_cast<std::uint16_t>(influence.joint));
      values.push_back(influence.weight);
    }
  if (weights.cols() <= 255)
    primitive.attributes["JOINTS_0"] =
        writer.bytes(std::vector<std::uint8_t>(joints.begin(), joints.end()), TINYGLTF_TYPE_VEC4, Use::Vertices);
  else
    primitive.attributes["JOINTS_0"] = writer.shorts(joints, TINYGLTF_TYPE_VEC4, Use::Vertices);
  primitive.attributes["WEIGHTS_0"] = writer.floats(values, TINYGLTF_TYPE_VEC4, Use::Vertices);
}

} // namespace

GlbMesh display_mesh(const Mesh &mesh, const std::vector<std::uint8_t> &shown, const TexCoords &corner_texcoords) {
  std::vector<int> faces;
  for (int f = 0; f < mesh.faces.rows(); ++f)
    if (shown.empty() || shown[f])
      faces.push_back(f);
  GlbMesh result;
  result.mesh = submesh(mesh, faces, &result.vertex_from_shown);
  result.normals = vertex_normals(result.mesh.vertices, result.mesh.faces);
  for (Eigen::Index v = 0; v < result.normals.rows(); ++v)
    if (result.normals.row(v).squaredNorm() < 0.5)
      result.normals.row(v) = Eigen::RowVector3d::UnitY();
  if (corner_texcoords.rows() == 0)
    return result;
  const GlbMesh shared = result;
  const auto corners = static_cast<Eigen::Index>(3 * faces.size());
  std::map<std::tuple<int, double, double>, int> placed; // a vertex at a place of the image
  std::vector<int> from;
  std::vector<Eigen::RowVector2d> places;
  for (Eigen::Index c = 0; c < corners; ++c) {
    const int v = shared.mesh.faces(c / 3, c % 3);
    const Eigen::RowVector2d uv = corner_texcoords.row(3 * faces[c / 3] + c % 3);
    const auto [at, is_new] = placed.try_emplace({v, uv.x(), uv.y()}, static_cast<int>(from.size()));
    if (is_new) {
      from.push_back(v);
      places.push_back(uv);
    }
    result.mesh.faces(c / 3, c % 3) = at->second;
  }
  const auto count = static_cast<Eigen::Index>(from.size());
  result.mesh.vertices.resize(count, 3);
  result.normals.resize(count, 3);
  result.texcoords.resize(count, 2);
  result.vertex_from_shown.resize(from.size());
  for (Eigen::Index i = 0; i < count; ++i) {
    result.mesh.vertices.row(i) = shared.mesh.vertices.row(from[i]);
    result.normals.row(i) = shared.normals.row(from[i]);
    result.texcoords.row(i) = places[i];
    result.vertex_from_shown[i] = shared.vertex_from_shown[from[i]];
  }
  return result;
}

GlbMesh surface_mesh(const Mesh &mesh, const std::vector<std::uint8_t> &shown, const TexCoords &corner_texcoords) {
  GlbMesh surface = display_mesh(mesh, shown, corner_texcoords);
  if (surface.mesh.faces.rows() == 0)
    throw Error("character: expected a surface of which something is drawn, found no valid face");
  return surface;
}

void add_joint_nodes(Writer &writer, const Skeleton &skeleton) {
  for (const Joint &joint : skeleton.joints) {
    tinygltf::Node node;
    node.name = joint.name;
    const Eigen::Vector3d from = joint.parent < 0 ? joint.rest : Eigen::Vector3d(joint.rest - skeleton.joints[joint.parent].rest);
    node.translation = {from.x(), from.y(), from.z()};
    const int index = static_cast<int>(writer.model.nodes.size());
    writer.model.nodes.push_back(node);
    if (joint.parent >= 0)
      writer.model.nodes[joint.parent].children.push_back(index);
  }
  tinygltf::Scene scene;
  scene.name = "scene";
  scene.nodes.push_back(0);
  writer.model.scenes.push_back(scene);
  writer.model.defaultScene = 0;
}

int add_skin(Writer &writer, const Skeleton &skeleton, double unit) {
  tinygltf::Skin skin;
  skin.name = "skin";
  std::vector<float> inverse_bind;
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    skin.joints.push_back(j);
    Eigen::Matrix4f bind = Eigen::Matrix4f::Identity();
    bind.topLeftCorner<3, 3>() *= static_cast<float>(unit);
    bind.topRightCorner<3, 1>() = -skeleton.joints[j].rest.cast<float>();
    inverse_bind.insert(inverse_bind.end(), bind.data(), bind.data() + 16); // column-major, as glTF
  }
  skin.skeleton = 0;
  skin.inverseBindMatrices = writer.floats(inverse_bind, TINYGLTF_TYPE_MAT4, Use::Data);
  writer.model.skins.push_back(skin);
  return static_cast<int>(writer.model.skins.size()) - 1;
}

int add_material(Writer &writer, const std::string &name, const Eigen::Vector3d &colour, int texture_image, bool double_sided) {
  tinygltf::Material material;
  material.name = name;
  material.doubleSided = double_sided;
  material.pbrMetallicRoughness.metallicFactor = 0;
  material.pbrMetallicRoughness.roughnessFactor = 0.9;
  if (texture_image >= 0) {
    tinygltf::Sampler sampler;
    sampler.magFilter = TINYGLTF_TEXTURE_FILTER_LINEAR;
    sampler.minFilter = TINYGLTF_TEXTURE_FILTER_LINEAR; // no mipmaps: a painted picture may be of any colour between charts
    sampler.wrapS = sampler.wrapT = TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE;
    writer.model.samplers.push_back(sampler);
    tinygltf::Texture texture;
    texture.source = texture_image;
    texture.sampler = static_cast<int>(writer.model.samplers.size()) - 1;
    writer.model.textures.push_back(texture);
    material.pbrMetallicRoughness.baseColorTexture.index = static_cast<int>(writer.model.textures.size()) - 1;
  } else {
    material.pbrMetallicRoughness.baseColorFactor = {colour.x(), colour.y(), colour.z(), 1.0};
  }
  writer.model.materials.push_back(material);
  return static_cast<int>(writer.model.materials.size()) - 1;
}

int add_mesh(Writer &writer, const std::string &name, const GlbMesh &shown, int material, const MatrixRM *weights) {
  tinygltf::Primitive primitive;
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  primitive.material = material;
  primitive.indices = writer.faces(shown.mesh.faces, Use::Indices);
  primitive.attributes["POSITION"] = writer.vectors(shown.mesh.vertices, Use::Vertices, true);
  primitive.attributes["NORMAL"] = writer.vectors(shown.normals, Use::Vertices);
  if (shown.texcoords.rows() > 0)
    primitive.attributes["TEXCOORD_0"] =
        writer.floats(std::vector<float>(shown.texcoords.data(), shown.texcoords.data() + shown.texcoords.size()),
                      TINYGLTF_TYPE_VEC2, Use::Vertices);
  if (weights)
    add_influences(writer, primitive, shown, *weights);
  tinygltf::Mesh mesh;
  mesh.name = name;
  mesh.primitives.push_back(primitive);
  writer.model.meshes.push_back(mesh);
  return static_cast<int>(writer.model.meshes.size()) - 1;
}

Influences viewer_influences(const GlbMesh &shown, const MatrixRM &weights) {
  Influences influences;
  for (int v : shown.vertex_from_shown)
    influences.push_back(strongest(weights.row(v)));
  return influences;
}

std::vector<Eigen::Affine3d> viewer_blends(const Influences &influences, const Transforms &world_from_rest) {
  std::vector<Eigen::Affine3d> blends;
  blends.reserve(influences.size());
  for (const auto &vertex : influences) {
    Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
    for (const Influence &influence : vertex)
      sum += influence.weight * world_from_rest[influence.joint].matrix();
    blends.emplace_back(sum);
  }
  return blends;
}

int add_mesh_node(Writer &writer, const std::string &name, int mesh, int skin) {
  tinygltf::Node node;
  node.name = name;
  node.mesh = mesh;
  node.skin = skin;
  writer.model.nodes.push_back(node);
  const int index = static_cast<int>(writer.model.nodes.size()) - 1;
  writer.model.scenes[0].nodes.push_back(index);
  return index;
}

} // namespace doublet::glb
