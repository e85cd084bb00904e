// glTF 2.0, Sect. 3.5 (nodes), 3.7.3 (skins), 3.11 and appendix C (animations).

#include "../display/glb.h"
#include "bind_pose.h"
#include "doublet/animate/motion_file.h"
#include "doublet/core/error.h"
#include "doublet/options/options.h"
#include "motion_bounds.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <memory>
#include <set>

namespace doublet {
namespace {

using Eigen::Affine3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using nlohmann::json;

constexpr double kFewestKeys = 24, kMostKeys = 240; // 1/s at which a clip is sampled, whatever its keys
constexpr std::size_t kMostSkins = 1000;
constexpr double kMostKeysInFile = 5e7; // several tracks may name the same keys
constexpr double kRounding = 1e-4;      // s, by which key times, which are floats, may be off
constexpr double kUnchanged = 1e-3;     // by which a component of a quaternion, or of a place (m), may vary
constexpr double kMovesTheBody = 0.5;   // of the nodes that the liveliest animation turns

enum class Between { Step, Linear, Cubic };

/// A property of a node over time.
struct Track {
  using Floats = std::shared_ptr<const std::vector<float>>; ///< that several tracks may have in common
  Floats times_of,
      numbers; ///< s, ascending; `width` a key; of a cubic spline three times as many: slope before, value, slope after
  std::size_t width = 0;
  Between between = Between::Linear;

  const std::vector<float> &times() const { return *times_of; }
  Eigen::VectorXd numbers_at(std::size_t key, std::size_t part) const {
    const std::size_t first = (between == Between::Cubic ? 3 * key + part : key) * width;
    return Eigen::Map<const Eigen::VectorXf>(numbers->data() + first, static_cast<Eigen::Index>(width)).cast<double>();
  }
  Eigen::VectorXd key(std::size_t k) const { return numbers_at(k, 1); }

  Eigen::VectorXd at(double time) const {
    const std::vector<float> &times = *times_of;
    const double from = between == Between::Step ? time + kRounding : time;
    const auto next = static_cast<std::size_t>(std::upper_bound(times.begin(), times.end(), from) - times.begin());
    if (next == 0 || next == times.size() || between == Between::Step)
      return key(next == 0 ? 0 : next - 1);
    const double gap = static_cast<double>(times[next]) - times[next - 1], s = (time - times[next - 1]) / gap;
    const Eigen::VectorXd a = key(next - 1), b = key(next);
    if (between == Between::Cubic) {
      const double s2 = s * s, s3 = s2 * s;
      return (2 * s3 - 3 * s2 + 1) * a + gap * (s3 - 2 * s2 + s) * numbers_at(next - 1, 2) + (3 * s2 - 2 * s3) * b +
             gap * (s3 - s2) * numbers_at(next, 0);
    }
    if (width == 4)
      return Quaterniond(Eigen::Vector4d(a)).slerp(s, Quaterniond(Eigen::Vector4d(b))).coeffs();
    return (1 - s) * a + s * b;
  }
  bool moves() const {
    const Eigen::VectorXd first = key(0);
    for (std::size_t k = 1; k < times().size(); ++k)
      if ((key(k) - first).cwiseAbs().maxCoeff() > kUnchanged)
        return true;
    return false;
  }
};

struct Node {
  std::string name;
  int parent = -1;
  Vector3d translation = Vector3d::Zero(), scale = Vector3d::Ones();
  Quaterniond rotation = Quaterniond::Identity();
  bool bone = true;                    ///< draws nothing
  std::string part;                    ///< of a human, where the file says so
  std::map<std::string, Track> tracks; ///< by "translation", "rotation", "scale"
};

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

class Clip {
public:
  Clip(const std::filesystem::path &path, const std::string &animation) : reader_(path), source_(path.string()) {
    read_nodes();
    read_parts();
    read_tracks(animation);
    choose_joints();
    stand_as_bound();
  }

  SourceMotion sampled() const {
    SourceMotion motion;
    motion.source = source_;
    motion.animations = animations_;
    motion.animation = animation_;
    motion.fps = rate();
    motion.up = Vector3d::UnitY();
    std::vector<Affine3d> place;
    std::vector<Quaterniond> rest, turned;
    world(nullptr, place, rest);
    std::map<int, int> index;
    for (int node : joints_) {
      const int parent = parent_joint(node);
      const Vector3d from = parent < 0 ? Vector3d::Zero() : Vector3d(place[parent].translation());
      motion.joints.push_back(
          {nodes_[node].name, parent < 0 ? -1 : index.at(parent), place[node].translation() - from, nodes_[node].part});
      index.emplace(node, static_cast<int>(index.size()));
    }
    const double count = std::floor((last_ - first_) * motion.fps + 1e-3) + 1;
    require_poses(count, nodes_.size(), source_);
    for (int t = 0; t < static_cast<int>(count); ++t) {
      const double time = std::min(last_, first_ + t / motion.fps);
      world(&time, place, turned);
      Vertices positions(joints_.size(), 3);
      std::vector<Quaterniond> rotations;
      for (std::size_t j = 0; j < joints_.size(); ++j) {
        positions.row(static_cast<Eigen::Index>(j)) = place[joints_[j]].translation();
        rotations.push_back((turned[joints_[j]] * rest[joints_[j]].conjugate()).normalized());
      }
      if (!positions.allFinite())
        reader_.fail("expected finite places of joints, found others at " + options::to_text(time) + " s");
      motion.positions.push_back(std::move(positions));
      motion.rotations.push_back(std::move(rotations));
    }
    return motion;
  }

private:
  int index_of(const json &number, const char *what) const {
    if (!number.is_number_integer() || number < 0 || number >= nodes_.size())
      reader_.fail(std::string("expected ") + what + " to be one of " + std::to_string(nodes_.size()) + " nodes, found " +
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

  /// Between keys a cubic spline leaves the unit sphere, far if the turn is wide: the standard has it brought back.
  Quaterniond direction(const Quaterniond &q, const std::string &node) const {
    if (!(q.norm() > 1e-6 && q.norm() < 1e6))
      reader_.fail("expected quaternions with a direction between keys, found one of length " + options::to_text(q.norm(), 4) +
                   " at node '" + node + "'");
    return q.normalized();
  }

  void read_nodes() {
    const json list = reader_.gltf().value("nodes", json::array());
    nodes_.resize(list.size());
    for (std::size_t i = 0; i < list.size(); ++i) {
      const json &from = list[i];
      Node &node = nodes_[i];
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
        if (nodes_[c].parent >= 0)
          reader_.fail("expected one parent for node " + std::to_string(c) + ", found two");
        nodes_[c].parent = static_cast<int>(i);
      }
    }
    put_in_order();
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

  void put_in_order() { // not by recursion: a chain may be as long as the file
    std::vector<std::vector<int>> children(nodes_.size());
    std::vector<int> open;
    for (int i = static_cast<int>(nodes_.size()) - 1; i >= 0; --i)
      (nodes_[i].parent < 0 ? open : children[nodes_[i].parent]).push_back(i);
    while (!open.empty()) {
      const int node = open.back();
      open.pop_back();
      order_.push_back(node);
      open.insert(open.end(), children[node].begin(), children[node].end());
    }
    if (order_.size() != nodes_.size())
      reader_.fail("expected nodes that hang on roots, found a circle");
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
          nodes_[index_of(nodes[theirs], "a bone of VRM")].part = ours;
      for (const char *chest : {"upperChest", "chest"}) // the upper one may be missing
        if (nodes.count(chest)) {
          nodes_[index_of(nodes[chest], "a bone of VRM")].part = "chest";
          break;
        }
    }
  }

  using Tracks = std::map<int, std::map<std::string, Track>>; ///< by node

  void read_tracks(const std::string &wanted) {
    const json list = reader_.gltf().value("animations", json::array());
    if (list.empty())
      reader_.fail("expected an animation, found none");
    for (std::size_t i = 0; i < list.size(); ++i)
      animations_.push_back(list[i].value("name", std::to_string(i + 1)));
    animation_ = wanted.empty() ? liveliest(list) : number_of(wanted);
    for (auto &[node, tracks] : tracks_of(list[animation_]))
      nodes_[node].tracks = std::move(tracks);
  }

  int number_of(const std::string &wanted) const {
    if (const auto named = std::find(animations_.begin(), animations_.end(), wanted); named != animations_.end())
      return static_cast<int>(named - animations_.begin());
    std::size_t number = 0;
    const auto [end, problem] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), number);
    if (problem == std::errc() && end == wanted.data() + wanted.size() && number >= 1 && number <= animations_.size())
      return static_cast<int>(number) - 1;
    std::string names;
    for (std::size_t i = 0; i < animations_.size() && i < 60; ++i)
      names += (i ? ", " : "") + animations_[i];
    reader_.fail("expected one of the animations " + names + ", or a number from 1 to " + std::to_string(animations_.size()) +
                 ", found '" + wanted + "'");
  }

  /// The first that moves the body: packs often begin with one that stands still.
  int liveliest(const json &list) {
    std::vector<std::size_t> turning;
    for (const json &animation : list) {
      if (list.size() == 1)
        return 0;
      std::size_t count = 0;
      for (const auto &[node, tracks] : tracks_of(animation))
        count += tracks.count("rotation") && tracks.at("rotation").moves();
      turning.push_back(count);
    }
    const double most = static_cast<double>(*std::max_element(turning.begin(), turning.end()));
    const auto first = std::find_if(turning.begin(), turning.end(),
                                    [&](std::size_t count) { return static_cast<double>(count) >= kMovesTheBody * most; });
    return static_cast<int>(first - turning.begin());
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
                                      path == "rotation" ? 4 : 3, nodes_[node].name);
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
                way == "STEP"          ? Between::Step
                : way == "CUBICSPLINE" ? Between::Cubic
                                       : Between::Linear};
    const std::vector<float> &times = track.times();
    keys_ += static_cast<double>(times.size());
    if (keys_ > kMostKeysInFile)
      reader_.fail("expected at most " + options::to_text(kMostKeysInFile) + " keys of all animations, found more");
    const std::size_t expected = times.size() * width * (track.between == Between::Cubic ? 3 : 1);
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

  // --- joints

  /// A skin's joints, and those between them, up to where they come together.
  struct Group {
    std::set<int> nodes;
    int top = -1;
  };

  /// Of several trees that one with the most of `chosen`.
  Group closed(const std::vector<bool> &chosen) const {
    std::vector<int> below(nodes_.size(), 0);
    int root = -1;
    for (auto node = order_.rbegin(); node != order_.rend(); ++node) {
      below[*node] += chosen[*node];
      if (nodes_[*node].parent >= 0)
        below[nodes_[*node].parent] += below[*node];
      else if (root < 0 || below[*node] >= below[root])
        root = *node;
    }
    Group group;
    if (root < 0 || below[root] == 0)
      return group;
    std::vector<bool> inside(nodes_.size(), false);
    for (int node : order_) { // a node holds all until one of its children does not, or it is one itself
      const int parent = nodes_[node].parent;
      const bool holds_all = below[node] == below[root] && (parent < 0 ? node == root : group.top == parent);
      if (holds_all && !(parent >= 0 && chosen[parent]))
        group.top = node;
    }
    for (int node : order_) {
      const int parent = nodes_[node].parent;
      inside[node] = below[node] > 0 && (node == group.top || (parent >= 0 && inside[parent]));
      if (inside[node])
        group.nodes.insert(node);
    }
    return group;
  }

  bool is_above(int ancestor, int node) const {
    while (node >= 0 && node != ancestor)
      node = nodes_[node].parent;
    return node >= 0;
  }

  /// Do both belong to one body: one hangs on the other, or what carries both moves?
  bool belong_together(const Group &a, const Group &b) const {
    if (is_above(a.top, b.top) || is_above(b.top, a.top))
      return true;
    std::set<int> above;
    for (int node = a.top; node >= 0; node = nodes_[node].parent)
      above.insert(node);
    int common = b.top;
    while (common >= 0 && !above.count(common))
      common = nodes_[common].parent;
    return common >= 0 && !nodes_[common].tracks.empty();
  }

  std::vector<Group> skins() const {
    std::vector<Group> groups;
    for (const json &skin : reader_.gltf().value("skins", json::array())) {
      std::vector<bool> chosen(nodes_.size(), false);
      for (const json &node : skin.at("joints"))
        chosen[index_of(node, "a joint")] = true;
      if (Group group = closed(chosen); group.top >= 0)
        groups.push_back(std::move(group));
      if (groups.size() > kMostSkins)
        reader_.fail("expected at most " + std::to_string(kMostSkins) + " skins, found more");
    }
    return groups;
  }

  /// Of a file without a skin: nodes that turn, or are said to be a human's, each with those that hang on it.
  std::vector<Group> moving() const {
    std::vector<Group> groups;
    std::vector<int> group_of(nodes_.size(), -1);
    for (int node : order_) {
      int &group = group_of[node];
      group = nodes_[node].parent < 0 ? -1 : group_of[nodes_[node].parent];
      if (!nodes_[node].tracks.count("rotation") && nodes_[node].part.empty())
        continue;
      if (group < 0) {
        group = static_cast<int>(groups.size());
        groups.push_back({{}, node});
      }
      groups[group].nodes.insert(node);
    }
    return groups;
  }

  /// The largest group and all that belong to its body. A file has one skin a mesh: for the eyes, a shirt, the lower half.
  std::vector<bool> body_of(std::vector<Group> groups) const {
    std::stable_sort(groups.begin(), groups.end(),
                     [](const Group &a, const Group &b) { return a.nodes.size() > b.nodes.size(); });
    groups.resize(std::min(groups.size(), kMostSkins));
    std::vector<bool> chosen(nodes_.size(), false);
    Group body = groups.empty() ? Group{} : groups[0];
    for (std::size_t before = 0; body.nodes.size() > before;) {
      before = body.nodes.size();
      for (const Group &group : groups)
        if (belong_together(body, group)) {
          for (int node : group.nodes)
            chosen[node] = true;
          body = closed(chosen);
        }
    }
    for (int node : body.nodes)
      chosen[node] = true;
    return chosen;
  }

  /// The body's joints and what hangs on them and draws nothing: ends, and bones that carry no vertex, or do not turn.
  void choose_joints() {
    is_joint_ = body_of(reader_.gltf().value("skins", json::array()).empty() ? moving() : skins());
    for (int node : order_)
      is_joint_[node] = is_joint_[node] || (nodes_[node].parent >= 0 && is_joint_[nodes_[node].parent] && nodes_[node].bone);
    above_.assign(nodes_.size(), -1);
    std::map<int, int> size;
    std::vector<int> root(nodes_.size(), -1);
    for (int node : order_) {
      const int parent = nodes_[node].parent;
      above_[node] = parent < 0 ? -1 : is_joint_[parent] ? parent : above_[parent];
      if (!is_joint_[node])
        continue;
      root[node] = above_[node] < 0 ? node : root[above_[node]];
      ++size[root[node]];
    }
    if (size.empty())
      reader_.fail("expected joints, found no skin and no node that turns");
    const auto largest = std::max_element(size.begin(), size.end(), [](auto a, auto b) { return a.second < b.second; });
    if (largest->second > static_cast<int>(kMostJoints))
      reader_.fail("expected at most " + std::to_string(kMostJoints) + " joints, found " + std::to_string(largest->second));
    for (int node : order_)
      if (is_joint_[node] && root[node] == largest->first)
        joints_.push_back(node);
    find_span();
  }

  /// When the tracks that carry joints begin and end.
  void find_span() {
    std::vector<bool> carries(nodes_.size(), false);
    for (int joint : joints_)
      carries[joint] = true;
    for (auto node = order_.rbegin(); node != order_.rend(); ++node) {
      if (carries[*node] && nodes_[*node].parent >= 0)
        carries[nodes_[*node].parent] = true;
      for (const auto &[path, track] : nodes_[*node].tracks)
        if (carries[*node]) {
          first_ = std::min<double>(first_, track.times().front());
          last_ = std::max<double>(last_, track.times().back());
          if (track.times().size() > densest_.size())
            densest_ = track.times();
        }
    }
    if (densest_.empty())
      reader_.fail("expected an animation of joints, found none that moves one");
  }

  /// The nearest joint above; -1: none.
  int parent_joint(int node) const { return above_[node]; }

  /// That of the track with the most keys.
  double rate() const {
    if (densest_.size() < 2)
      return kFewestKeys;
    std::vector<double> gaps;
    for (std::size_t k = 1; k < densest_.size(); ++k)
      gaps.push_back(static_cast<double>(densest_[k]) - densest_[k - 1]);
    std::nth_element(gaps.begin(), gaps.begin() + gaps.size() / 2, gaps.end());
    const double found = std::clamp(1 / gaps[gaps.size() / 2], kFewestKeys, kMostKeys), whole = std::round(found);
    return std::abs(found - whole) < 0.01 * found ? whole : found; // key times are floats
  }

  // --- the zero pose

  /// Nodes stand as they did in some frame where an exporter has left them so. Then the pose in which a skin's mesh was bound to
  /// its joints is the zero pose.
  void stand_as_bound() {
    std::vector<Affine3d> place;
    std::vector<Quaterniond> rest;
    world(nullptr, place, rest);
    std::map<int, Quaterniond> bound;
    for (const json &skin : reader_.gltf().value("skins", json::array()))
      if (skin.contains("inverseBindMatrices"))
        bound.merge(turns_of_bind_pose(bind_pose(skin), above_, place, rest));
    bound_ = std::move(bound);
  }

  BindPose bind_pose(const json &skin) {
    const std::vector<float> &numbers = *floats(skin.at("inverseBindMatrices").get<int>());
    BindPose bind;
    std::size_t first = 0;
    for (const json &joint : skin.at("joints")) {
      const int node = index_of(joint, "a joint");
      if (first + 16 > numbers.size())
        reader_.fail("expected inverse bind matrices of all joints of a skin, found fewer");
      bind[node].matrix() = Eigen::Map<const Eigen::Matrix4f>(numbers.data() + first).cast<double>();
      first += 16;
    }
    return bind;
  }

  /// What hangs on mirrored axes turns the other way.
  static Quaterniond mirrored(Quaterniond q, const Vector3d &sides) {
    q.vec() = sides.prod() * sides.cwiseProduct(q.vec());
    return q;
  }

  /// Of all nodes, at a time, or in the zero pose.
  void world(const double *time, std::vector<Affine3d> &place, std::vector<Quaterniond> &turned) const {
    place.resize(nodes_.size());
    turned.resize(nodes_.size());
    std::vector<Vector3d> sides(nodes_.size()); // of its axes: -1 = mirrored
    for (int i : order_) {
      const Node &node = nodes_[i];
      const Vector3d side = node.parent < 0 ? Vector3d::Ones() : sides[node.parent];
      const auto at = [&](const char *path) { return time ? node.tracks.find(path) : node.tracks.end(); };
      const auto translation = at("translation"), rotation = at("rotation"), scale = at("scale");
      const auto none = node.tracks.end();
      const Vector3d moved = translation == none ? node.translation : Vector3d(translation->second.at(*time));
      const Vector3d scaled = scale == none ? node.scale : Vector3d(scale->second.at(*time));
      const Quaterniond above = node.parent < 0 ? Quaterniond::Identity() : turned[node.parent];
      const auto bound = time ? bound_.end() : bound_.find(i);
      const Quaterniond q =
          rotation == none ? node.rotation : direction(Quaterniond(Eigen::Vector4d(rotation->second.at(*time))), node.name);
      turned[i] = bound == bound_.end() ? above * mirrored(q, side) : bound->second;
      const Quaterniond own = bound == bound_.end() ? q : mirrored(above.conjugate() * bound->second, side);
      const Affine3d local = Eigen::Translation3d(moved) * own * Eigen::Scaling(scaled);
      place[i] = node.parent < 0 ? local : place[node.parent] * local;
      sides[i] = side.cwiseProduct(scaled.unaryExpr([](double x) { return x < 0 ? -1.0 : 1.0; }));
    }
  }

  glb::Reader reader_;
  std::string source_;
  std::vector<Node> nodes_;
  std::vector<int> order_;  ///< of the nodes, parents first
  std::vector<int> joints_; ///< nodes, parents first
  std::vector<bool> is_joint_;
  std::vector<int> above_;           ///< of a node, the nearest joint
  std::map<int, Quaterniond> bound_; ///< of nodes that stand otherwise in the zero pose, in the world
  std::vector<std::string> animations_;
  int animation_ = 0;
  std::map<int, Track::Floats> floats_; ///< by accessor
  std::size_t floats_read_ = 0;
  double keys_ = 0;                    ///< of all tracks
  double first_ = 1e30, last_ = -1e30; ///< s
  std::vector<float> densest_;
};

} // namespace

SourceMotion read_gltf_motion(const std::filesystem::path &path, const std::string &animation) try {
  return Clip(path, animation).sampled();
} catch (const json::exception &problem) {
  throw Error(path.string() + ": expected nodes and animations of glTF 2.0, found: " + problem.what());
}

} // namespace doublet
