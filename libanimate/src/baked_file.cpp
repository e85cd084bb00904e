#include "doublet/animate/baked_file.h"

#include "doublet/animate/image_file.h"
#include "doublet/core/error.h"
#include "doublet/core/npz.h"
#include "doublet/core/ray_scene.h"
#include "glb_parts.h"

#include <algorithm>
#include <cmath>

namespace doublet {
namespace {

using Eigen::Quaternionf;
using Eigen::Vector3d;

void require_animation(const Character &character, const AnimationResult &animation) {
  validate_character(character);
  const auto frames = static_cast<Eigen::Index>(animation.surface.size());
  const bool sizes = frames > 0 && animation.dofs.rows() == frames &&
                     static_cast<Eigen::Index>(animation.joints.size()) == frames &&
                     (animation.body.empty() || static_cast<Eigen::Index>(animation.body.size()) == frames) && animation.fps > 0;
  if (!sizes || animation.dofs.cols() != character.actor.skeleton.dof_count() ||
      animation.surface[0].rows() != character.actor.mesh.vertices.rows())
    throw std::invalid_argument("baked animation: expected frames of this character with poses, joints and a rate, found " +
                                std::to_string(frames) + " frames of another kind");
}

std::vector<double> flatten(const std::vector<Vertices> &frames) {
  std::vector<double> values;
  for (const Vertices &frame : frames)
    values.insert(values.end(), frame.data(), frame.data() + frame.size());
  return values;
}

std::vector<int> flatten(const Faces &faces) {
  return {faces.data(), faces.data() + faces.size()};
}

std::vector<int> key_frames(int frames, double fps, const BakedGlbOptions &options) {
  int stride = std::max(1, static_cast<int>(std::lround(fps / options.keys_per_second)));
  stride = std::max(stride, (frames + options.most_keys - 2) / std::max(options.most_keys - 1, 1));
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
  std::vector<std::uint8_t> skip;
  for (std::uint8_t valid : c.high_valid)
    skip.push_back(valid ? 0 : 1);
  const RayScene scene(c.high, skip);
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

/// The surface at key 0, and what the others differ from it.
int add_morphing_surface(glb::Writer &writer, const Character &c, const AnimationResult &animation,
                         const std::vector<int> &keys) {
  glb::DisplayMesh shown = glb::display_mesh(c.actor.mesh, c.actor.face_valid, {});
  const auto at_key = [&](int frame) { return gather(animation.surface[frame], shown.vertex_from_shown); };
  const auto normals_of = [&](const Vertices &vertices) {
    Vertices normals = vertex_normals(vertices, shown.mesh.faces);
    for (Eigen::Index v = 0; v < normals.rows(); ++v)
      if (normals.row(v).squaredNorm() < 0.5)
        normals.row(v) = Eigen::RowVector3d::UnitY();
    return normals;
  };
  const Vertices first = at_key(keys[0]), first_normals = normals_of(first);
  shown.mesh.vertices = first;
  shown.normals = first_normals;
  const int material = glb::add_material(writer, "surface", Vector3d::Ones(), -1, true);
  const int index = glb::add_mesh(writer, "surface", shown, material, nullptr);
  tinygltf::Mesh &mesh = writer.model.meshes[index];
  mesh.primitives[0].attributes["COLOR_0"] =
      writer.vectors(gather(surface_colours(c), shown.vertex_from_shown), glb::Use::Vertices);
  for (std::size_t k = 1; k < keys.size(); ++k) {
    const Vertices vertices = at_key(keys[k]);
    std::map<std::string, int> target;
    target["POSITION"] = writer.vectors(vertices - first, glb::Use::Vertices, true);
    target["NORMAL"] = writer.vectors(normals_of(vertices) - first_normals, glb::Use::Vertices);
    mesh.primitives[0].targets.push_back(target);
  }
  mesh.weights.assign(keys.size() - 1, 0.0);
  return glb::add_mesh_node(writer, "surface", index, -1);
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

/// One weight a target a key: at key k target k - 1 alone.
void add_morph_channel(glb::Writer &writer, tinygltf::Animation &out, int node, const std::vector<int> &keys, double fps) {
  const std::size_t targets = keys.size() - 1;
  std::vector<float> weights(keys.size() * targets, 0.0f);
  for (std::size_t k = 1; k < keys.size(); ++k)
    weights[k * targets + k - 1] = 1;
  add_channel(out, node, "weights", add_times(writer, keys, fps), writer.floats(weights, TINYGLTF_TYPE_SCALAR, glb::Use::Data));
}

} // namespace

void write_baked_npz(const std::filesystem::path &path, const Character &character, const AnimationResult &animation) {
  require_animation(character, animation);
  const auto frames = static_cast<std::int64_t>(animation.surface.size());
  const Skeleton &skeleton = character.actor.skeleton;
  std::vector<std::string> names;
  for (const Joint &joint : skeleton.joints)
    names.push_back(joint.name);
  Npz npz;
  npz.set_f4("vertices", {frames, animation.surface[0].rows(), 3}, flatten(animation.surface));
  npz.set_i4("faces", {character.actor.mesh.faces.rows(), 3}, flatten(character.actor.mesh.faces));
  npz.set_b1("face_valid", character.actor.face_valid);
  npz.set_f4("joints", {frames, skeleton.joint_count(), 3}, flatten(animation.joints));
  npz.set_text("joint_names", names);
  npz.set_f4("dofs", {frames, animation.dofs.cols()}, {animation.dofs.data(), animation.dofs.data() + animation.dofs.size()});
  npz.set_f8("fps", {}, {animation.fps});
  if (!animation.body.empty()) {
    npz.set_f4("body_vertices", {frames, animation.body[0].rows(), 3}, flatten(animation.body));
    npz.set_i4("body_faces", {character.body.faces.rows(), 3}, flatten(character.body.faces));
    npz.set_b1("body_shown", character.body_shown);
  }
  npz.write(path);
}

void BakedGlbOptions::validate() const {
  if (!(keys_per_second > 0) || keys_per_second > 1000)
    throw std::invalid_argument("BakedGlbOptions.keys_per_second must be in (0, 1000], found " + std::to_string(keys_per_second));
  if (most_keys < 2 || most_keys > 5000)
    throw std::invalid_argument("BakedGlbOptions.most_keys must be in [2, 5000], found " + std::to_string(most_keys));
}

void write_baked_glb(const std::filesystem::path &path, const Character &character, const AnimationResult &animation,
                     const BakedGlbOptions &options) {
  options.validate();
  require_animation(character, animation);
  const int frames = static_cast<int>(animation.surface.size());
  const std::vector<int> keys = key_frames(frames, animation.fps, options);
  glb::Writer writer;
  glb::add_joint_nodes(writer, character.actor.skeleton);
  const int surface = add_morphing_surface(writer, character, animation, keys);
  const glb::DisplayMesh body = glb::display_mesh(character.body, character.body_shown, {});
  if (body.mesh.faces.rows() > 0) {
    const int skin = glb::add_skin(writer, character.actor.skeleton);
    const int material = glb::add_material(writer, "body", character.body_colour, -1, false);
    glb::add_mesh_node(writer, "body", glb::add_mesh(writer, "body", body, material, &character.body_weights), skin);
  }
  tinygltf::Animation out;
  out.name = "animation";
  add_joint_channels(writer, out, character.actor.skeleton, animation);
  if (keys.size() > 1)
    add_morph_channel(writer, out, surface, keys, animation.fps);
  writer.model.animations.push_back(out);
  writer.save(path);
}

} // namespace doublet
