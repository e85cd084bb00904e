// FBX, of which ufbx knows what Autodesk never wrote down: its nodes, skins and animations, sampled.

#include "doublet/animate/motion_file.h"
#include "doublet/core/error.h"
#include "doublet/files/files.h"
#include "motion_bounds.h"
#include "node_clip.h"

#include <algorithm>
#include <array>
#include <cmath>

// Of this file alone: no symbol of ufbx is seen outside, and what nothing calls is left out.
#define ufbx_abi static
#define UFBX_MINIMAL
#include <ufbx.c>

namespace doublet {
namespace {

constexpr double kSlowest = 24, kFastest = 240; // 1/s at which a clip is sampled, whatever the file says
constexpr double kFilm = 23.9;                  // 1/s; from here on a rate is one of film, 24 or 24 / 1.001
// Bytes to which a packed file may grow: arrays say how long they are before anything of them is read.
constexpr std::size_t kLeastMemory = std::size_t(64) << 20, kMostMemory = std::size_t(2) << 30, kMostUnpacked = 200;
constexpr double kUnchanged = 1e-6;

Eigen::Vector3d vector_of(const ufbx_vec3 &v) {
  return {v.x, v.y, v.z};
}

Eigen::Affine3d affine_of(const ufbx_matrix &m) {
  Eigen::Affine3d result;
  for (int c = 0; c < 4; ++c)
    result.matrix().col(c).head<3>() = vector_of(m.cols[c]);
  result.makeAffine();
  return result;
}

std::string text_of(const ufbx_string &text) {
  return {text.data, text.length};
}

Node node_of(const ufbx_node &from) {
  Node node;
  node.name = text_of(from.name);
  node.parent = from.parent ? static_cast<int>(from.parent->typed_id) : -1;
  node.translation = vector_of(from.local_transform.translation);
  node.scale = vector_of(from.local_transform.scale);
  const ufbx_quat &q = from.local_transform.rotation;
  node.rotation = Eigen::Quaterniond(q.w, q.x, q.y, q.z).normalized();
  node.bone = !from.mesh && !from.camera && !from.light;
  return node;
}

/// The pose that a file without a mesh says its bones were bound in, if it does.
BindPose written_pose(const ufbx_scene &scene) {
  BindPose inverse;
  for (const ufbx_pose *pose : scene.poses)
    if (pose->is_bind_pose)
      for (const ufbx_bone_pose &bone : pose->bone_poses)
        if (bone.bone_node->bone)
          inverse[static_cast<int>(bone.bone_node->typed_id)] = affine_of(bone.bone_to_world).inverse();
  return inverse;
}

/// One a deformer, with the pose that it was bound in; of a file without, what it calls bones.
std::vector<NodeSkin> skins_of(const ufbx_scene &scene, const std::string &source) {
  if (scene.skin_deformers.count > kMostSkins)
    throw Error(source + ": expected at most " + std::to_string(kMostSkins) + " skins, found " +
                std::to_string(scene.skin_deformers.count));
  std::vector<NodeSkin> skins;
  for (const ufbx_skin_deformer *deformer : scene.skin_deformers) {
    NodeSkin skin;
    for (const ufbx_skin_cluster *cluster : deformer->clusters)
      if (cluster->bone_node) {
        skin.joints.push_back(static_cast<int>(cluster->bone_node->typed_id));
        skin.inverse_bind[skin.joints.back()] = affine_of(cluster->geometry_to_bone);
      }
    if (!skin.joints.empty())
      skins.push_back(std::move(skin));
  }
  if (!skins.empty())
    return skins;
  NodeSkin bones{{}, written_pose(scene)};
  for (const ufbx_node *node : scene.nodes)
    if (node->bone)
      bones.joints.push_back(static_cast<int>(node->typed_id));
  return bones.joints.empty() ? skins : std::vector{bones};
}

/// Place, turn and size as glTF names them, in the order of an ufbx_transform's numbers.
struct Channel {
  const char *name;
  std::size_t width;
};
constexpr std::array<Channel, 3> kChannels{{{"translation", 3}, {"rotation", 4}, {"scale", 3}}};
constexpr std::size_t kNumbers = sizeof(ufbx_transform) / sizeof(ufbx_real);

std::array<float, kNumbers> numbers_of(const ufbx_transform &at) {
  const ufbx_vec3 &p = at.translation, &s = at.scale;
  const ufbx_quat &q = at.rotation;
  std::array<float, kNumbers> result;
  const std::array<double, kNumbers> all{p.x, p.y, p.z, q.x, q.y, q.z, q.w, s.x, s.y, s.z};
  std::transform(all.begin(), all.end(), result.begin(), [](double x) { return static_cast<float>(x); });
  return result;
}

struct Span {
  double begin, end; ///< s
  double frames(double fps) const { return std::floor((end - begin) * fps + 1e-3) + 1; }
};

/// When it plays; where that is not said, from its first key to its last.
Span span_of(const ufbx_anim_stack &stack) {
  if (stack.time_end > stack.time_begin)
    return {stack.time_begin, stack.time_end};
  Span keys{1e30, -1e30};
  for (const ufbx_anim_layer *layer : stack.layers)
    for (const ufbx_anim_value *value : layer->anim_values)
      for (const ufbx_anim_curve *curve : value->curves)
        if (curve && curve->keyframes.count > 0)
          keys = {std::min(keys.begin, curve->min_time), std::max(keys.end, curve->max_time)};
  return keys.begin < keys.end ? keys : Span{0, 0};
}

NodeAnimation animation_of(const ufbx_scene &scene, const ufbx_anim_stack &stack, double fps) {
  NodeAnimation animation{text_of(stack.name), {}};
  const Span span = span_of(stack);
  std::vector<float> times;
  for (double frame = 0; frame < span.frames(fps); ++frame)
    times.push_back(static_cast<float>(frame / fps));
  const auto shared = std::make_shared<const std::vector<float>>(std::move(times));
  for (const ufbx_node *node : scene.nodes) {
    const auto still = numbers_of(node->local_transform);
    std::array<std::vector<float>, kChannels.size()> keys;
    std::array<bool, kChannels.size()> moved{};
    for (std::size_t k = 0; k < shared->size(); ++k) {
      const auto at = numbers_of(ufbx_evaluate_transform(stack.anim, node, span.begin + static_cast<double>(k) / fps));
      for (std::size_t c = 0, first = 0; c < kChannels.size(); first += kChannels[c++].width)
        for (std::size_t i = first; i < first + kChannels[c].width; ++i) {
          keys[c].push_back(at[i]);
          moved[c] = moved[c] || std::abs(at[i] - still[i]) > kUnchanged;
        }
    }
    for (std::size_t c = 0; c < kChannels.size(); ++c)
      if (moved[c] || (node->bone && kChannels[c].width == 4)) // a bone that rests is animated, too
        animation.tracks[static_cast<int>(node->typed_id)][kChannels[c].name] = {
            shared, std::make_shared<const std::vector<float>>(std::move(keys[c])), kChannels[c].width, Track::Between::Linear};
  }
  return animation;
}

/// Of a joint that does not turn: how it is oriented. The file has that apart from what its animations turn.
Eigen::Quaterniond unturned(const ufbx_node &node) {
  const auto turn = [&](const char *name) {
    const ufbx_quat q = ufbx_euler_to_quat(ufbx_find_vec3(&node.props, name, ufbx_vec3{}), UFBX_ROTATION_ORDER_XYZ);
    return Eigen::Quaterniond(q.w, q.x, q.y, q.z);
  };
  return (turn("PreRotation") * turn("PostRotation").conjugate()).normalized();
}

/// Programs leave nodes as they stand in the frame that is shown, which is no zero pose. Where that is the first of an animation
/// and joints have orientations, not turned from these they stand as the skeleton was made.
void stand_unturned(const ufbx_scene &scene, NodeClip &clip) {
  constexpr double kSame = 0.01; // rad
  const auto as_first = [&](const NodeAnimation &animation) {
    return std::all_of(animation.tracks.begin(), animation.tracks.end(), [&](const auto &tracks) {
      const auto turns = tracks.second.find("rotation");
      return turns == tracks.second.end() ||
             clip.nodes[tracks.first].rotation.angularDistance(Eigen::Quaterniond(Eigen::Vector4d(turns->second.key(0)))) < kSame;
    });
  };
  const auto oriented = [](const ufbx_node *node) {
    return node->bone && unturned(*node).angularDistance(Eigen::Quaterniond::Identity()) > kSame;
  };
  if (std::none_of(clip.animations.begin(), clip.animations.end(), as_first) ||
      std::none_of(scene.nodes.begin(), scene.nodes.end(), oriented))
    return;
  for (const ufbx_node *node : scene.nodes)
    if (node->bone)
      clip.nodes[node->typed_id].rotation = unturned(*node);
}

NodeClip clip_of(const ufbx_scene &scene, const std::string &source) {
  const double stated = scene.settings.frames_per_second, fps = stated > kFilm ? std::min(stated, kFastest) : kSlowest;
  double frames = 0;
  for (const ufbx_anim_stack *stack : scene.anim_stacks)
    frames += span_of(*stack).frames(fps);
  require_poses(frames, scene.nodes.count, source);
  NodeClip clip{source, {}, skins_of(scene, source), {}};
  for (const ufbx_node *node : scene.nodes)
    clip.nodes.push_back(node_of(*node));
  for (const ufbx_anim_stack *stack : scene.anim_stacks)
    clip.animations.push_back(animation_of(scene, *stack, fps));
  if (clip.skins.empty() || clip.skins[0].inverse_bind.empty())
    stand_unturned(scene, clip);
  return clip;
}

} // namespace

SourceMotion read_fbx_motion(const std::filesystem::path &path, const std::string &animation) {
  const std::string content = read_text(path);
  ufbx_load_opts options{};
  const std::size_t memory = std::min(kMostMemory, kLeastMemory + kMostUnpacked * content.size());
  options.temp_allocator.memory_limit = options.result_allocator.memory_limit = memory;
  options.ignore_geometry = true;
  options.file_format = UFBX_FILE_FORMAT_FBX;
  options.target_axes = ufbx_axes_right_handed_y_up;
  options.target_unit_meters = 1;
  ufbx_error error;
  const std::unique_ptr<ufbx_scene, void (*)(ufbx_scene *)> scene(
      ufbx_load_memory(content.data(), content.size(), &options, &error), &ufbx_free_scene);
  if (!scene)
    throw Error(path.string() + ": expected an FBX file, found one that cannot be read: " + text_of(error.description));
  return sampled_motion(clip_of(*scene, path.string()), animation);
}

} // namespace doublet
