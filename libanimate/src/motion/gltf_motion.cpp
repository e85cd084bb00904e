// glTF 2.0, Sect. 3.5 (nodes), 3.7.3 (skins), 3.11 and appendix C (animations).

#include "../display/glb.h"
#include "doublet/animate/motion_file.h"
#include "doublet/core/error.h"
#include "doublet/options/options.h"
#include "node_clip.h"

#include <cmath>

namespace doublet {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;
using nlohmann::json;

constexpr double kMostKeysInFile = 5e7; // several tracks may name the same keys

/// Parts of a human as VRM names them (0.x and 1.0), and as we do.
const std::map<std::string, std::string> &vrm_parts() {
  static const std::map<std::string, std::string> parts = [] {
    std::map<std::string, std::string> result{{"hips", "pelvis"}, {"spine", "spine"}, {"neck", "neck"}, {"head", "head"}};
    for (const std::string side : {"left", "right"})
      for (const auto &[theirs, ours] : std::map<std::string, std::string>{{"Shoulder", "clavicle"},
                                                                           {"UpperArm", "shoulder"},
                                                                           {"LowerArm", "elbow"},
                                                                           {"Hand", "wrist"},
                                                                           {"MiddleProximal", "hand"},
                                                                           {"UpperLeg", "hip"},
                                                                           {"LowerLeg", "knee"},
                                                                           {"Foot", "ankle"},
                                                                           {"Toes", "toe"}})
        result[side + theirs] = side.substr(0, 1) + "_" + ours;
    return result;
  }();
  return parts;
}

class ClipReader {
public:
  explicit ClipReader(const std::filesystem::path &path) : reader_(path) { clip_.source = path.string(); }

  NodeClip clip() {
    read_nodes();
    read_parts();
    read_skins();
    for (const json &animation : reader_.gltf().value("animations", json::array()))
      clip_.animations.push_back({animation.value("name", std::to_string(clip_.animations.size() + 1)), tracks_of(animation)});
    return std::move(clip_);
  }

private:
  int index_of(const json &number, const char *what) const {
    if (!number.is_number_integer() || number < 0 || number >= clip_.nodes.size())
      reader_.fail(std::string("expected ") + what + " to be one of " + std::to_string(clip_.nodes.size()) + " nodes, found " +
                   number.dump().substr(0, 60));
    return number.get<int>();
  }

  Vector3d vector(const json &node, const char *key, const Vector3d &otherwise) const {
    if (!node.contains(key))
      return otherwise;
    return {node.at(key).at(0).get<double>(), node.at(key).at(1).get<double>(), node.at(key).at(2).get<double>()};
  }

  Quaterniond unit(const Quaterniond &q, const std::string &node) const {
    if (!(std::abs(q.norm() - 1) < 0.1))
      reader_.fail("expected unit quaternions, found one of length " + options::to_text(q.norm(), 4) + " at node '" + node + "'");
    return q.normalized();
  }

  void read_nodes() {
    const json list = reader_.gltf().value("nodes", json::array());
    clip_.nodes.resize(list.size());
    for (std::size_t i = 0; i < list.size(); ++i) {
      const json &from = list[i];
      Node &node = clip_.nodes[i];
      node.name = from.value("name", "node_" + std::to_string(i));
      node.translation = vector(from, "translation", node.translation);
      node.scale = vector(from, "scale", node.scale);
      if (from.contains("rotation")) {
        const json &q = from.at("rotation");
        node.rotation =
            unit({q.at(3).get<double>(), q.at(0).get<double>(), q.at(1).get<double>(), q.at(2).get<double>()}, node.name);
      }
      node.bone = !from.contains("mesh") && !from.contains("camera") && !from.contains("extensions");
      if (from.contains("matrix"))
        set_matrix(from.at("matrix"), node);
      for (const json &child : from.value("children", json::array())) {
        const int c = index_of(child, "a child");
        if (clip_.nodes[c].parent >= 0)
          reader_.fail("expected one parent for node " + std::to_string(c) + ", found two");
        clip_.nodes[c].parent = static_cast<int>(i);
      }
    }
  }

  static void set_matrix(const json &m, Node &node) { // column by column
    Eigen::Matrix3d linear;
    for (int c = 0; c < 3; ++c)
      for (int r = 0; r < 3; ++r)
        linear(r, c) = m.at(4 * c + r).get<double>();
    node.translation = {m.at(12).get<double>(), m.at(13).get<double>(), m.at(14).get<double>()};
    const double side = linear.determinant() < 0 ? -1 : 1; // mirrored
    node.scale = side * linear.colwise().norm().transpose();
    const Eigen::Matrix3d turned = linear * (side * node.scale.cwiseAbs().cwiseMax(1e-30)).cwiseInverse().asDiagonal();
    node.rotation = Quaterniond(turned).normalized();
  }

  /// Of VRM: "humanBones" is a list of bones with their nodes in 0.x, an object by bones in 1.0 and in animations.
  void read_parts() {
    const json extensions = reader_.gltf().value("extensions", json::object());
    for (const char *name : {"VRM", "VRMC_vrm", "VRMC_vrm_animation"}) {
      const json bones = extensions.value(name, json::object()).value("humanoid", json::object()).value("humanBones", json());
      std::map<std::string, json> nodes;
      for (const auto &[key, bone] : bones.items())
        if (bone.is_object() && bone.contains("node"))
          nodes[bones.is_array() ? bone.value("bone", "") : key] = bone.at("node");
      for (const auto &[theirs, ours] : vrm_parts())
        if (nodes.count(theirs))
          clip_.nodes[index_of(nodes[theirs], "a bone of VRM")].part = ours;
      for (const char *chest : {"upperChest", "chest"}) // the upper one may be missing
        if (nodes.count(chest)) {
          clip_.nodes[index_of(nodes[chest], "a bone of VRM")].part = "chest";
          break;
        }
    }
  }

  void read_skins() {
    for (const json &skin : reader_.gltf().value("skins", json::array())) {
      NodeSkin read;
      for (const json &joint : skin.at("joints"))
        read.joints.push_back(index_of(joint, "a joint"));
      if (skin.contains("inverseBindMatrices"))
        read.inverse_bind = bind_pose(read.joints, *floats(skin.at("inverseBindMatrices").get<int>()));
      clip_.skins.push_back(std::move(read));
      if (clip_.skins.size() > kMostSkins)
        reader_.fail("expected at most " + std::to_string(kMostSkins) + " skins, found more");
    }
  }

  BindPose bind_pose(const std::vector<int> &joints, const std::vector<float> &numbers) const {
    if (numbers.size() < 16 * joints.size())
      reader_.fail("expected inverse bind matrices of all joints of a skin, found fewer");
    BindPose bind;
    for (std::size_t j = 0; j < joints.size(); ++j)
      bind[joints[j]].matrix() = Eigen::Map<const Eigen::Matrix4f>(numbers.data() + 16 * j).cast<double>();
    return bind;
  }

  Tracks tracks_of(const json &animation) {
    Tracks result;
    for (const json &channel : animation.at("channels")) {
      const json &target = channel.at("target");
      const std::string path = target.at("path").get<std::string>();
      if (!target.contains("node") || (path != "rotation" && path != "translation" && path != "scale"))
        continue;
      const int node = index_of(target.at("node"), "an animated node");
      result[node][path] = read_track(animation.at("samplers").at(channel.at("sampler").get<std::size_t>()),
                                      path == "rotation" ? 4 : 3, clip_.nodes[node].name);
    }
    return result;
  }

  /// An accessor's numbers, once, however many tracks have them. Accessors that overlap could be more than any memory holds.
  Track::Floats floats(int accessor) {
    Track::Floats &found = floats_[accessor];
    if (!found) {
      found = std::make_shared<const std::vector<float>>(reader_.numbers(accessor));
      floats_read_ += found->size();
      if (floats_read_ > reader_.size())
        reader_.fail("expected accessors that do not overlap, found more numbers in them than the file has bytes");
    }
    return found;
  }

  Track read_track(const json &sampler, std::size_t width, const std::string &node) {
    const std::string way = sampler.value("interpolation", "LINEAR");
    Track track{floats(sampler.at("input").get<int>()), floats(sampler.at("output").get<int>()), width,
                way == "STEP"          ? Track::Between::Step
                : way == "CUBICSPLINE" ? Track::Between::Cubic
                                       : Track::Between::Linear};
    const std::vector<float> &times = track.times();
    keys_ += static_cast<double>(times.size());
    if (keys_ > kMostKeysInFile)
      reader_.fail("expected at most " + options::to_text(kMostKeysInFile) + " keys of all animations, found more");
    const std::size_t expected = times.size() * width * (track.between == Track::Between::Cubic ? 3 : 1);
    if (times.empty() || track.numbers->size() != expected)
      reader_.fail("expected " + std::to_string(expected) + " numbers for " + std::to_string(times.size()) +
                   " keys of an animation, found " + std::to_string(track.numbers->size()));
    for (std::size_t k = 0; k < times.size(); ++k) {
      if (!std::isfinite(times[k]) || (k > 0 && times[k] <= times[k - 1]))
        reader_.fail("expected key times that ascend, found " + options::to_text(times[k]) + " s at key " + std::to_string(k));
      if (width == 4)
        unit(Quaterniond(Eigen::Vector4d(track.key(k))), node);
    }
    return track;
  }

  glb::Reader reader_;
  NodeClip clip_;
  std::map<int, Track::Floats> floats_; ///< by accessor
  std::size_t floats_read_ = 0;
  double keys_ = 0; ///< of all tracks
};

} // namespace

SourceMotion read_gltf_motion(const std::filesystem::path &path, const std::string &animation) try {
  return sampled_motion(ClipReader(path).clip(), animation);
} catch (const json::exception &problem) {
  throw Error(path.string() + ": expected nodes and animations of glTF 2.0, found: " + problem.what());
}

} // namespace doublet
