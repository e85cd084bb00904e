#include "doublet/animate/baked_file.h"

#include "doublet/animate/display_surface.h"
#include "doublet/animate/parts/image_file.h"
#include "doublet/core/error.h"
#include "doublet/files/files.h"
#include "doublet/files/npz.h"
#include "doublet/rays/ray_scene.h"
#include "glb_parts.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>

namespace doublet {
namespace {

using Eigen::Quaternionf;
using Eigen::Vector3d;

void require_animation(const Character &character, const AnimationResult &animation) {
  validate_character(character);
  const auto frames = static_cast<Eigen::Index>(animation.surface.size());
  const bool sizes = frames > 0 && animation.dofs.rows() == frames &&
                     static_cast<Eigen::Index>(animation.joints.size()) == frames &&
                     (animation.body.empty() || static_cast<Eigen::Index>(animation.body.size()) == frames) &&
                     (animation.high.empty() || static_cast<Eigen::Index>(animation.high.size()) == frames) && animation.fps > 0;
  if (!sizes || animation.dofs.cols() != character.actor.skeleton.dof_count() ||
      animation.surface[0].rows() != character.actor.mesh.vertices.rows() ||
      (!animation.high.empty() && animation.high[0].rows() != character.high.vertices.rows()))
    throw std::invalid_argument("baked animation: expected frames of this character with poses, joints and a rate, found " +
                                std::to_string(frames) + " frames of another kind");
}

std::vector<double> flatten(const std::vector<Vertices> &frames) {
  std::vector<double> values;
  values.reserve(frames.size() * static_cast<std::size_t>(frames[0].size()));
  for (const Vertices &frame : frames)
    values.insert(values.end(), frame.data(), frame.data() + frame.size());
  return values;
}

std::vector<int> flatten(const Faces &faces) {
  return {faces.data(), faces.data() + faces.size()};
}

std::vector<int> key_frames(int frames, double fps, const BakedGlbOptions &options) {
  int stride = options.keys_per_second > 0 ? std::max(1, static_cast<int>(std::lround(fps / options.keys_per_second))) : 1;
  stride = std::max(stride, (frames + options.max_keys - 2) / std::max(options.max_keys - 1, 1));
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

/// Weights with which every blend of bones can be undone at all poses: where bones turn against each other by almost half a turn,
/// the strongest bone alone.
MatrixRM undoable_weights(const glb::GlbMesh &shown, MatrixRM weights, const std::vector<Transforms> &poses) {
  constexpr double kLeastVolume = 0.05; // what the blend leaves of a unit cube
  for (const Transforms &pose : poses) {
    const std::vector<Eigen::Affine3d> blends = glb::viewer_blends(shown, weights, pose);
    for (std::size_t i = 0; i < blends.size(); ++i)
      if (!(blends[i].linear().determinant() > kLeastVolume)) {
        Eigen::Index strongest = 0;
        weights.row(shown.vertex_from_shown[i]).maxCoeff(&strongest);
        weights.row(shown.vertex_from_shown[i]).setZero();
        weights(shown.vertex_from_shown[i], strongest) = 1;
      }
  }
  return weights;
}

using Floats3 = Eigen::Matrix<float, Eigen::Dynamic, 3, Eigen::RowMajor>;

/// A skinned mesh with a shape a key. Shapes are what the bones have to carry to have the vertices where they are: between keys
/// the mesh goes on following the bones.
struct Shapes {
  glb::GlbMesh shown; ///< at the first key, relative to the bones
  MatrixRM weights;
  std::vector<Floats3> shapes, normals; ///< one a key, relative to the bones
};

/// `positions`, `poses`: at the keys; `faces`: of the vertices before corners were split, so that a normal is the same on both
/// sides of a seam in the texture.
Shapes shapes_of(glb::GlbMesh shown, const Faces &faces, const MatrixRM &weights, const std::vector<const Vertices *> &positions,
                 const std::vector<Transforms> &poses) {
  Shapes result;
  result.weights = undoable_weights(shown, weights, poses);
  result.shown = std::move(shown);
  const std::vector<int> &vertices = result.shown.vertex_from_shown;
  for (std::size_t key = 0; key < positions.size(); ++key) {
    Vertices shape = gather(*positions[key], vertices), normals = gather(vertex_normals(*positions[key], faces), vertices);
    const std::vector<Eigen::Affine3d> blends = glb::viewer_blends(result.shown, result.weights, poses[key]);
    for (Eigen::Index v = 0; v < shape.rows(); ++v) {
      const Eigen::Affine3d back = blends[v].inverse();
      shape.row(v) = (back * Vector3d(shape.row(v))).transpose();
      normals.row(v) = (back.linear() * normals.row(v).transpose()).transpose();
      normals.row(v) =
          normals.row(v).norm() > 1e-6 ? Eigen::RowVector3d(normals.row(v).normalized()) : Eigen::RowVector3d(0, 1, 0);
    }
    if (key == 0) {
      result.shown.mesh.vertices = shape;
      result.shown.normals = normals;
    }
    result.shapes.push_back(shape.cast<float>());
    result.normals.push_back(normals.cast<float>());
  }
  return result;
}

constexpr int kShort = 32767, kByte = 127; ///< 1 in KHR_mesh_quantization

/// m, the largest step from the first shape to another.
double farthest(const Shapes &mesh) {
  float most = 0;
  for (const Floats3 &shape : mesh.shapes)
    most = std::max(most, (shape - mesh.shapes[0]).cwiseAbs().maxCoeff());
  return most;
}

struct NormalStep {
  Eigen::RowVector3f step; ///< each within [-1, 1], as bytes are
  float cosine;            ///< of the angle that is left
};

/// What to add to one normal to have the direction of another; the sum may be shorter than 1.
NormalStep byte_step(const Eigen::RowVector3f &from, const Eigen::RowVector3f &to) {
  constexpr float kNearEnough = 0.996f; // 5 degrees
  NormalStep best{Eigen::RowVector3f::Zero(), -2};
  for (const float length : {1.0f, 0.7f, 0.4f, 0.2f, 0.1f}) {
    const Eigen::RowVector3f step = (length * to - from).cwiseMin(1).cwiseMax(-1);
    const float cosine = (from + step).normalized().dot(to);
    if (cosine > best.cosine)
      best = {step, cosine};
    if (cosine > kNearEnough)
      break;
  }
  return best;
}

/// The mesh's own normals: those of the first key, or where bytes do not reach from there to those of all others, their mean.
Floats3 own_normals(const Shapes &mesh) {
  constexpr float kReached = 0.94f; // 20 degrees
  Floats3 own = mesh.normals[0];
  for (Eigen::Index v = 0; v < own.rows(); ++v) {
    Eigen::RowVector3f sum = Eigen::RowVector3f::Zero();
    bool reached = true;
    for (const Floats3 &normals : mesh.normals) {
      sum += normals.row(v);
      reached = reached && byte_step(mesh.normals[0].row(v), normals.row(v)).cosine > kReached;
    }
    if (!reached && sum.norm() > 0)
      own.row(v) = sum.normalized();
  }
  return own;
}

/// A morph target, relative to the mesh's own places and normals; what it leaves as it is, is not stored. `unit`: m, of the
/// mesh's numbers.
std::map<std::string, int> add_target(glb::Writer &writer, const Floats3 &shape, const Floats3 &normals, const Floats3 &own,
                                      const Floats3 &own_normals, double unit) {
  std::vector<int> rows;
  std::vector<std::int16_t> steps;
  std::vector<std::int8_t> turns;
  for (Eigen::Index v = 0; v < shape.rows(); ++v) {
    const Eigen::RowVector3d step = (shape.row(v).cast<double>() / unit - own.row(v).cast<double>()) * kShort;
    const Eigen::RowVector3d whole = step.array().round().cwiseMin(kShort).cwiseMax(-kShort);
    const Eigen::RowVector3f turn = (byte_step(own_normals.row(v), normals.row(v)).step * kByte).array().round();
    const bool stays = whole.isZero() && turn.cwiseAbs().maxCoeff() < 3; // a degree
    if (stays && !(rows.empty() && v + 1 == shape.rows()))               // sparse arrays have a row at least
      continue;
    rows.push_back(static_cast<int>(v));
    for (int k = 0; k < 3; ++k) {
      steps.push_back(static_cast<std::int16_t>(whole[k]));
      turns.push_back(static_cast<std::int8_t>(turn[k]));
    }
  }
  const glb::Writer::SparseRows at = writer.sparse_rows(rows, static_cast<std::size_t>(shape.rows()));
  const int positions = writer.sparse_vectors(at, steps);
  return {{"POSITION", positions}, {"NORMAL", writer.sparse_vectors(at, turns)}};
}

int add_morphing_mesh(glb::Writer &writer, const std::string &name, Shapes mesh, double unit, int material) {
  const Floats3 normals = own_normals(mesh);
  mesh.shown.mesh.vertices /= unit;
  mesh.shown.normals = normals.cast<double>();
  const Floats3 own = mesh.shown.mesh.vertices.cast<float>();
  const int index = glb::add_mesh(writer, name, mesh.shown, material, &mesh.weights);
  for (std::size_t key = 0; key < mesh.shapes.size(); ++key)
    writer.model.meshes[index].primitives[0].targets.push_back(
        add_target(writer, mesh.shapes[key], mesh.normals[key], own, normals, unit));
  writer.model.meshes[index].weights.assign(mesh.shapes.size(), 0.0);
  writer.model.meshes[index].weights[0] = 1; // as it begins, for viewers that do not play
  return index;
}

/// M_high in its texture.
struct TexturedHigh {
  glb::GlbMesh shown;
  int image = -1;
};

TexturedHigh textured_high(glb::Writer &writer, const Character &c) {
  if (c.texture.empty())
    return {glb::display_mesh(c.high, c.high_valid, {}), -1};
  return {glb::display_mesh(c.high, c.high_valid, c.texcoords), writer.image(c.texture)};
}

std::vector<const Vertices *> at_keys(const std::vector<Vertices> &frames, const std::vector<int> &keys) {
  std::vector<const Vertices *> result;
  for (int key : keys)
    result.push_back(&frames[key]);
  return result;
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

/// One weight a target a key: at key k target k alone.
void add_morph_channels(glb::Writer &writer, tinygltf::Animation &out, const std::vector<int> &nodes,
                        const std::vector<int> &keys, double fps) {
  std::vector<float> weights(keys.size() * keys.size(), 0.0f);
  for (std::size_t k = 0; k < keys.size(); ++k)
    weights[k * keys.size() + k] = 1;
  const int times = add_times(writer, keys, fps), values = writer.floats(weights, TINYGLTF_TYPE_SCALAR, glb::Use::Data);
  for (int node : nodes)
    add_channel(out, node, "weights", times, values);
}

} // namespace

namespace {

/// (T, J, 4) w x y z, in the world from the rest pose; each on the side of its last, so that who blends does not go the long way.
std::vector<double> joint_rotations(const Skeleton &skeleton, const MatrixRM &dofs) {
  std::vector<double> values;
  std::vector<Eigen::Quaterniond> last(skeleton.joints.size(), Eigen::Quaterniond::Identity());
  for (Eigen::Index t = 0; t < dofs.rows(); ++t) {
    const Transforms world_from_rest = forward_kinematics(skeleton, dofs.row(t));
    for (std::size_t j = 0; j < last.size(); ++j) {
      Eigen::Quaterniond turn(world_from_rest[j].linear());
      if (turn.dot(last[j]) < 0)
        turn.coeffs() *= -1;
      last[j] = turn;
      values.insert(values.end(), {turn.w(), turn.x(), turn.y(), turn.z()});
    }
  }
  return values;
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
  npz.set_f4("joint_rotations", {frames, skeleton.joint_count(), 4}, joint_rotations(skeleton, animation.dofs));
  npz.set_text("joint_names", names);
  npz.set_f4("dofs", {frames, animation.dofs.cols()}, {animation.dofs.data(), animation.dofs.data() + animation.dofs.size()});
  npz.set_f8("fps", {}, {animation.fps});
  if (!animation.body.empty()) {
    npz.set_f4("body_vertices", {frames, animation.body[0].rows(), 3}, flatten(animation.body));
    npz.set_i4("body_faces", {character.body.faces.rows(), 3}, flatten(character.body.faces));
    npz.set_b1("body_shown", character.body_shown);
  }
  if (!animation.high.empty()) {
    npz.set_f4("high_vertices", {frames, animation.high[0].rows(), 3}, flatten(animation.high));
    npz.set_i4("high_faces", {character.high.faces.rows(), 3}, flatten(character.high.faces));
    npz.set_b1("high_valid", character.high_valid);
  }
  npz.write(path, kFileFormat);
}

int write_baked_glb(const std::filesystem::path &path, const Character &character, const AnimationResult &animation,
                    const BakedGlbOptions &options) {
  options.validate();
  require_animation(character, animation);
  const int frames = static_cast<int>(animation.surface.size());
  const std::vector<int> keys = key_frames(frames, animation.fps, options);
  std::vector<Transforms> poses;
  for (int key : keys)
    poses.push_back(forward_kinematics(character.actor.skeleton, animation.dofs.row(key)));
  glb::Writer writer;
  glb::add_joint_nodes(writer, character.actor.skeleton);
  const RiggedMesh &actor = character.actor;
  std::vector<std::string> names{"surface"};
  std::vector<Shapes> meshes;
  std::vector<int> materials;
  if (animation.high.empty()) {
    meshes.push_back(shapes_of(glb::display_mesh(actor.mesh, actor.face_valid, {}),
                               valid_faces(actor.mesh.faces, actor.face_valid), actor.weights, at_keys(animation.surface, keys),
                               poses));
    materials.push_back(glb::add_material(writer, "surface", Vector3d::Ones(), -1, true));
  } else {
    TexturedHigh high = textured_high(writer, character);
    const MatrixRM weights = DisplaySurface(character).skin_weights(actor.weights);
    meshes.push_back(shapes_of(std::move(high.shown), valid_faces(character.high.faces, character.high_valid), weights,
                               at_keys(animation.high, keys), poses));
    materials.push_back(glb::add_material(writer, "surface", Vector3d::Constant(0.6), high.image, true));
  }
  glb::GlbMesh body = glb::display_mesh(character.body, character.body_shown, {});
  if (body.mesh.faces.rows() > 0 && !animation.body.empty()) {
    names.emplace_back("body");
    meshes.push_back(shapes_of(std::move(body), valid_faces(character.body.faces, character.body_shown), character.body_weights,
                               at_keys(animation.body, keys), poses));
    materials.push_back(glb::add_material(writer, "body", character.body_colour, -1, false));
  }
  double unit = 1e-3;
  for (const Shapes &mesh : meshes)
    unit = std::max(unit, farthest(mesh));
  const int skin = glb::add_skin(writer, character.actor.skeleton, unit);
  std::vector<int> morphing;
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const std::vector<int> vertices = meshes[i].shown.vertex_from_shown;
    const int mesh = add_morphing_mesh(writer, names[i], std::move(meshes[i]), unit, materials[i]);
    if (i == 0 && animation.high.empty())
      writer.model.meshes[mesh].primitives[0].attributes["COLOR_0"] =
          writer.vectors(gather(surface_colours(character), vertices), glb::Use::Vertices);
    morphing.push_back(glb::add_mesh_node(writer, names[i], mesh, skin));
  }
  writer.model.extensionsUsed = writer.model.extensionsRequired = {"KHR_mesh_quantization"};
  tinygltf::Animation out;
  out.name = "animation";
  add_joint_channels(writer, out, character.actor.skeleton, animation);
  if (keys.size() > 1)
    add_morph_channels(writer, out, morphing, keys, animation.fps);
  writer.model.animations.push_back(out);
  writer.save(path);
  return static_cast<int>(keys.size());
}

} // namespace doublet
