#include "baked_animation.h"
#include "morph_targets.h"

#include "doublet/animate/baked_file.h"
#include "doublet/animate/display_surface.h"
#include "doublet/animate/parts/image_file.h"
#include "doublet/core/parts/quantile.h"
#include "doublet/rays/ray_scene.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>

namespace doublet {
namespace {

using Eigen::Quaternionf;
using Eigen::Vector3d;

/// `max_keys`: 2 or more; 0 = any number
std::vector<int> key_frames(int frames, double fps, double keys_per_second, int max_keys) {
  int stride = keys_per_second > 0 ? std::max(1, static_cast<int>(std::lround(fps / keys_per_second))) : 1;
  if (max_keys > 0)
    stride = std::max(stride, (frames + max_keys - 3) / (max_keys - 1)); // (frames - 1) / (max_keys - 1), rounded up
  std::vector<int> keys;
  for (int t = 0; t < frames; t += stride)
    keys.push_back(t);
  if (keys.back() != frames - 1)
    keys.push_back(frames - 1);
  return keys;
}

/// (V, 3) linear R G B of M's vertices: the texture at the closest point of M_high.
Vertices surface_colours(const Character &c) {
  Vertices colours = Vertices::Constant(c.actor.mesh.vertices.rows(), 3, 0.6);
  if (c.texture.empty())
    return colours;
  const Image image = decode_image(c.texture);
  const RayScene scene(c.high, c.high_valid);
  for (Eigen::Index v = 0; v < colours.rows(); ++v) {
    const ClosestPoint at = scene.closest(c.actor.mesh.vertices.row(v));
    Eigen::RowVector2d uv = Eigen::RowVector2d::Zero();
    for (int k = 0; k < 3; ++k)
      uv += at.barycentric[k] * c.texcoords.row(3 * at.face + k);
    const int x = std::clamp(static_cast<int>(uv.x() * image.width), 0, image.width - 1);
    const int y = std::clamp(static_cast<int>(uv.y() * image.height), 0, image.height - 1);
    for (int k = 0; k < 3; ++k)
      colours(v, k) = std::pow(image.at(x, y, 2 - k) / 255.0, 2.2); // COLOR_0 is linear, the image sRGB
  }
  return colours;
}

Vertices gather(const Vertices &all, const std::vector<int> &rows) {
  Vertices part(rows.size(), 3);
  for (std::size_t i = 0; i < rows.size(); ++i)
    part.row(i) = all.row(rows[i]);
  return part;
}

/// A mesh of the file, as it is while the file is made.
struct Baked {
  BoundMesh mesh;
  int material;
  MorphTargets targets;
};

/// The surface, and the body where it is drawn apart; with the material of each.
std::vector<Baked> bound_meshes(glb::Writer &writer, const Character &character, const AnimationResult &animation,
                                const TexturedFaces &drawn, const std::vector<Transforms> &poses) {
  std::vector<Baked> meshes;
  const RiggedMesh &actor = character.actor;
  if (animation.high.empty()) {
    meshes.push_back({bind_mesh("surface", glb::surface_mesh(actor.mesh, actor.face_valid, {}),
                                valid_faces(actor.mesh.faces, actor.face_valid), actor.weights, animation.surface, poses),
                      glb::add_material(writer, "surface", Vector3d::Ones(), -1, true),
                      {}});
  } else {
    const TexturedFaces shown = faces_to_draw(character, animation, drawn);
    const int image = character.texture.empty() ? -1 : writer.image(character.texture);
    const TexCoords places = image < 0 ? TexCoords() : TexCoords(shown.texcoords);
    meshes.push_back({bind_mesh("surface", glb::surface_mesh({character.high.vertices, shown.faces}, {}, places),
                                valid_faces(character.high.faces, character.high_valid), // normals are those of all its triangles
                                DisplaySurface(character).skin_weights(actor.weights), animation.high, poses),
                      glb::add_material(writer, "surface", Vector3d::Constant(0.6), image, true),
                      {}});
  }
  glb::GlbMesh body = glb::display_mesh(character.body, character.body_shown, {});
  if (body.mesh.faces.rows() > 0 && !animation.body.empty())
    meshes.push_back({bind_mesh("body", std::move(body), valid_faces(character.body.faces, character.body_shown),
                                character.body_weights, animation.body, poses),
                      glb::add_material(writer, "body", character.body_colour, -1, false),
                      {}});
  return meshes;
}

/// Vertices that any of `count` targets moves or turns; sparse arrays have a row at least.
std::vector<int> moved_rows(const MorphTargets &targets, Eigen::Index first, Eigen::Index count) {
  std::vector<int> rows;
  for (Eigen::Index v = 0; v < targets.own.rows(); ++v)
    if (!targets.steps.block(first, 3 * v, count, 3).isZero(0) || !targets.turns.block(first, 3 * v, count, 3).isZero(0))
      rows.push_back(static_cast<int>(v));
  if (rows.empty())
    rows.push_back(0);
  return rows;
}

/// Three whole numbers a row.
template <class T> std::vector<T> numbers_at(const FloatRows &values, Eigen::Index target, const std::vector<int> &rows) {
  std::vector<T> numbers;
  for (int row : rows)
    for (int k = 0; k < 3; ++k)
      numbers.push_back(static_cast<T>(values(target, 3 * row + k)));
  return numbers;
}

/// Rows of sparse arrays, and where the file has them.
struct ListedRows {
  std::vector<int> rows;
  glb::Writer::SparseRows listed;
};

/// Sparse, with the vertices that it moves; if those are most, with `shared`, whose list is in the file once (an array that is
/// not sparse would have its vectors padded to whole words). Small steps are bytes.
std::map<std::string, int> add_target(glb::Writer &writer, const MorphTargets &targets, Eigen::Index target,
                                      const ListedRows &shared) {
  constexpr double kMost = 0.8; // then the list of rows, 2 bytes each, is more than the rows that it saves, 6 to 9
  std::vector<int> rows = moved_rows(targets, target, 1);
  const bool most = static_cast<double>(rows.size()) > kMost * static_cast<double>(shared.rows.size());
  const glb::Writer::SparseRows listed =
      most ? shared.listed : writer.sparse_rows(rows, static_cast<std::size_t>(targets.own.rows()));
  if (most)
    rows = shared.rows;
  const bool small = targets.steps.row(target).cwiseAbs().maxCoeff() <= 127;
  const int positions = small ? writer.sparse_vectors(listed, numbers_at<std::int8_t>(targets.steps, target, rows), false)
                              : writer.sparse_vectors(listed, numbers_at<std::int16_t>(targets.steps, target, rows));
  const int normals = writer.sparse_vectors(listed, numbers_at<std::int8_t>(targets.turns, target, rows), true);
  return {{"POSITION", positions}, {"NORMAL", normals}};
}

int add_morphing_mesh(glb::Writer &writer, const BoundMesh &mesh, const MorphTargets &targets, int material) {
  glb::GlbMesh shown = mesh.shown;
  shown.mesh.vertices = targets.own.cast<double>() / targets.step;
  shown.normals = targets.own_normals.cast<double>();
  const int index = glb::add_mesh(writer, mesh.name, shown, material, &mesh.weights);
  ListedRows shared{moved_rows(targets, 0, targets.steps.rows()), {}};
  if (targets.steps.rows() > 0)
    shared.listed = writer.sparse_rows(shared.rows, static_cast<std::size_t>(targets.own.rows()));
  for (Eigen::Index target = 0; target < targets.steps.rows(); ++target)
    writer.model.meshes[index].primitives[0].targets.push_back(add_target(writer, targets, target, shared));
  for (Eigen::Index target = 0; target < targets.steps.rows(); ++target)
    writer.model.meshes[index].weights.push_back(targets.weights(0, target)); // as it begins, for viewers that do not play
  return index;
}

void add_channel(tinygltf::Animation &animation, int node, const std::string &path, int input, int output) {
  tinygltf::AnimationSampler sampler;
  sampler.input = input;
  sampler.output = output;
  sampler.interpolation = "LINEAR";
  tinygltf::AnimationChannel channel;
  channel.sampler = static_cast<int>(animation.samplers.size());
  channel.target_node = node;
  channel.target_path = path;
  animation.samplers.push_back(sampler);
  animation.channels.push_back(channel);
}

int add_times(glb::Writer &writer, const std::vector<int> &frames, double fps) {
  std::vector<float> times;
  for (int t : frames)
    times.push_back(static_cast<float>(t / fps));
  return writer.floats(times, TINYGLTF_TYPE_SCALAR, glb::Use::Data, true);
}

void add_joint_channels(glb::Writer &writer, tinygltf::Animation &out, const Skeleton &skeleton,
                        const AnimationResult &animation) {
  const int frames = static_cast<int>(animation.surface.size());
  std::vector<int> all(frames);
  for (int t = 0; t < frames; ++t)
    all[t] = t;
  const int times = add_times(writer, all, animation.fps);
  std::vector<std::vector<float>> turns(skeleton.joint_count());
  std::vector<float> root;
  std::vector<Quaternionf> last(skeleton.joint_count(), Quaternionf::Identity());
  for (int t = 0; t < frames; ++t) {
    const Transforms world = forward_kinematics(skeleton, animation.dofs.row(t));
    const Vector3d at = world[0] * skeleton.joints[0].rest;
    for (int k = 0; k < 3; ++k)
      root.push_back(static_cast<float>(at[k]));
    for (int j = 0; j < skeleton.joint_count(); ++j) {
      const int p = skeleton.joints[j].parent;
      const Eigen::Matrix3d local =
          p < 0 ? Eigen::Matrix3d(world[j].linear()) : Eigen::Matrix3d(world[p].linear().transpose() * world[j].linear());
      Quaternionf q(local.cast<float>());
      q.normalize();
      if (q.dot(last[j]) < 0)
        q.coeffs() *= -1; // linear interpolation goes the short way
      last[j] = q;
      turns[j].insert(turns[j].end(), {q.x(), q.y(), q.z(), q.w()});
    }
  }
  add_channel(out, 0, "translation", times, writer.floats(root, TINYGLTF_TYPE_VEC3, glb::Use::Data));
  for (int j = 0; j < skeleton.joint_count(); ++j)
    if (skeleton.joints[j].kind != JointKind::Fixed)
      add_channel(out, j, "rotation", times, writer.floats(turns[j], TINYGLTF_TYPE_VEC4, glb::Use::Data));
}

void add_morph_channel(glb::Writer &writer, tinygltf::Animation &out, int node, int times, const Eigen::MatrixXf &weights) {
  const FloatRows by_key = weights;
  const std::vector<float> values(by_key.data(), by_key.data() + by_key.size());
  add_channel(out, node, "weights", times, writer.floats(values, TINYGLTF_TYPE_SCALAR, glb::Use::Data));
}

BakedMeshSummary summary_of(const BoundMesh &mesh, const MorphTargets &targets, const std::vector<double> &errors) {
  BakedMeshSummary summary;
  summary.name = mesh.name;
  summary.vertices = static_cast<int>(mesh.influences.size());
  summary.shapes = static_cast<int>(targets.steps.rows());
  double squares = 0;
  for (double error : errors)
    squares += error * error;
  summary.rms_error = std::sqrt(squares / static_cast<double>(errors.size()));
  summary.error_95 = quantile(errors, 0.95);
  summary.max_error = *std::max_element(errors.begin(), errors.end());
  return summary;
}

tinygltf::Value as_extras(const BakedMeshSummary &summary) {
  return tinygltf::Value(tinygltf::Value::Object{{"shapes", tinygltf::Value(summary.shapes)},
                                                 {"rms_error", tinygltf::Value(summary.rms_error)},
                                                 {"error_95", tinygltf::Value(summary.error_95)},
                                                 {"max_error", tinygltf::Value(summary.max_error)}});
}

/// Hangs the joints on a node of their own. Blender takes the inverse of what scales a mesh for the place of a root that has no
/// such node, kilometres away, where floats are coarse.
void put_under_armature(glb::Writer &writer) {
  tinygltf::Node armature;
  armature.name = "armature";
  armature.children = {0};
  writer.model.nodes.push_back(armature);
  writer.model.scenes[0].nodes[0] = static_cast<int>(writer.model.nodes.size()) - 1;
  for (tinygltf::Skin &skin : writer.model.skins)
    skin.skeleton = -1;
}

/// The file's name, so that several clips in one program can be told apart; any bytes are a name of a file, glTF's are UTF-8.
std::string animation_name(const std::filesystem::path &path) {
  using nlohmann::json;
  const std::string valid = json(path.stem().string()).dump(-1, ' ', false, json::error_handler_t::replace);
  return json::parse(valid).get<std::string>();
}

/// Adds the mesh with a skin of its own, for its numbers are in its steps; the weights if there are several keys.
BakedMeshSummary add_baked(glb::Writer &writer, tinygltf::Animation &out, const Skeleton &skeleton, const Baked &baked,
                           const std::vector<int> &keys, int times, const Context &context) {
  const int index = add_morphing_mesh(writer, baked.mesh, baked.targets, baked.material);
  const BakedMeshSummary summary = summary_of(baked.mesh, baked.targets, errors(baked.mesh, baked.targets, keys, context));
  writer.model.meshes[index].extras = as_extras(summary);
  const int skin = glb::add_skin(writer, skeleton, baked.targets.step);
  const int node = glb::add_mesh_node(writer, baked.mesh.name, index, skin);
  if (times >= 0 && summary.shapes > 0)
    add_morph_channel(writer, out, node, times, baked.targets.weights);
  return summary;
}

} // namespace

BakedGlbSummary write_baked_glb(const std::filesystem::path &path, const Character &character, const AnimationResult &animation,
                                const BakedGlbOptions &options, const TexturedFaces &drawn, const Context &context) {
  options.validate();
  require_animation(character, animation);
  const Skeleton &skeleton = character.actor.skeleton;
  const bool exact = options.max_error == 0;
  const int frames = static_cast<int>(animation.surface.size());
  const std::vector<int> keys = key_frames(frames, animation.fps, options.keys_per_second, exact ? options.max_keys : 0);
  std::vector<Transforms> poses;
  for (int t = 0; t < frames; ++t)
    poses.push_back(forward_kinematics(skeleton, animation.dofs.row(t)));
  glb::Writer writer;
  glb::add_joint_nodes(writer, skeleton);
  tinygltf::Animation out;
  out.name = animation_name(path);
  add_joint_channels(writer, out, skeleton, animation);
  const int times = keys.size() > 1 ? add_times(writer, keys, animation.fps) : -1;
  BakedGlbSummary summary{static_cast<int>(keys.size()), {}};
  std::vector<Baked> meshes = bound_meshes(writer, character, animation, drawn, poses);
  for (Baked &baked : meshes) {
    baked.targets = exact ? key_shapes(baked.mesh, keys, context)
                          : principal_shapes(baked.mesh, keys, options.max_error, options.max_keys, context);
    summary.meshes.push_back(add_baked(writer, out, skeleton, baked, keys, times, context));
    baked.targets = {}; // a long clip's are large
  }
  if (animation.high.empty())
    writer.model.meshes[0].primitives[0].attributes["COLOR_0"] =
        writer.vectors(gather(surface_colours(character), meshes[0].mesh.shown.vertex_from_shown), glb::Use::Vertices);
  put_under_armature(writer);
  writer.model.extensionsUsed = writer.model.extensionsRequired = {"KHR_mesh_quantization"};
  writer.model.animations.push_back(out);
  writer.save(path);
  return summary;
}

} // namespace doublet
