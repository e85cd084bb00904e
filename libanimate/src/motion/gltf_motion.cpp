// glTF 2.0, Sect. 3.5 (nodes), 3.7.3 (skins), 3.11 and appendix C (animations).

#include "../display/glb.h"
#include "doublet/animate/motion_file.h"
#include "doublet/core/error.h"
#include "doublet/options/options.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace doublet {
namespace {

using Eigen::Affine3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using nlohmann::json;

constexpr double kFewestKeys = 24, kMostKeys = 240; // 1/s at which a clip is sampled, whatever its keys
constexpr double kMostPoses = 2e7;                  // nodes x frames

enum class Between { Step, Linear, Cubic };

/// A property of a node over time.
struct Track {
  std::vector<float> times;   ///< s, ascending
  std::vector<float> numbers; ///< `width` a key; of a cubic spline three times as many: slope before, value, slope after
  std::size_t width = 0;
  Between between = Between::Linear;

  Eigen::VectorXd numbers_at(std::size_t key, std::size_t part) const {
    const std::size_t first = (between == Between::Cubic ? 3 * key + part : key) * width;
    return Eigen::Map<const Eigen::VectorXf>(numbers.data() + first, static_cast<Eigen::Index>(width)).cast<double>();
  }
  Eigen::VectorXd key(std::size_t k) const { return numbers_at(k, 1); }

  Eigen::VectorXd at(double time) const {
    const auto next = static_cast<std::size_t>(std::upper_bound(times.begin(), times.end(), time) - times.begin());
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
};

struct Node {
  std::string name;
  int parent = -1;
  Vector3d translation = Vector3d::Zero(), scale = Vector3d::Ones();
  Quaterniond rotation = Quaterniond::Identity();
  std::map<std::string, Track> tracks; ///< by "translation", "rotation", "scale"
};

class Clip {
public:
  explicit Clip(const std::filesystem::path &path) : reader_(path), source_(path.string()) {
    read_nodes();
    read_tracks();
    choose_joints();
  }

  SourceMotion sampled() const {
    SourceMotion motion;
    motion.source = source_;
    motion.fps = rate();
    std::vector<Affine3d> place;
    std::vector<Quaterniond> rest, turned;
    world(nullptr, place, rest);
    std::map<int, int> index;
    for (int node : joints_) {
      const int parent = parent_joint(node);
      const Vector3d from = parent < 0 ? Vector3d::Zero() : Vector3d(place[parent].translation());
      motion.joints.push_back({nodes_[node].name, parent < 0 ? -1 : index.at(parent), place[node].translation() - from});
      index.emplace(node, static_cast<int>(index.size()));
    }
    const double count = std::floor((last_ - first_) * motion.fps + 1e-3) + 1;
    if (!(count * static_cast<double>(nodes_.size()) <= kMostPoses))
      reader_.fail("expected a clip of at most " + options::shown(kMostPoses) + " poses of nodes, found " +
                   options::shown(count) + " of " + std::to_string(nodes_.size()));
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
        reader_.fail("expected finite places of joints, found others at " + options::shown(time) + " s");
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
      reader_.fail("expected unit quaternions, found one of length " + options::shown(q.norm(), 4) + " at node '" + node + "'");
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
    node.scale = linear.colwise().norm().transpose();
    const Eigen::Matrix3d turned = linear * node.scale.cwiseMax(1e-30).cwiseInverse().asDiagonal();
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

  void read_tracks() {
    const json animations = reader_.gltf().value("animations", json::array());
    if (animations.empty())
      reader_.fail("expected an animation, found none");
    const json &animation = animations[0];
    for (const json &channel : animation.at("channels")) {
      const json &target = channel.at("target");
      const std::string path = target.at("path").get<std::string>();
      if (!target.contains("node") || path == "weights")
        continue;
      const std::size_t width = path == "rotation" ? 4 : 3;
      nodes_[index_of(target.at("node"), "an animated node")].tracks[path] =
          read_track(animation.at("samplers").at(channel.at("sampler").get<std::size_t>()), width);
    }
  }

  Track read_track(const json &sampler, std::size_t width) const {
    const std::string way = sampler.value("interpolation", "LINEAR");
    Track track{reader_.floats(sampler.at("input").get<int>()), reader_.floats(sampler.at("output").get<int>()), width,
                way == "STEP"          ? Between::Step
                : way == "CUBICSPLINE" ? Between::Cubic
                                       : Between::Linear};
    const std::size_t expected = track.times.size() * width * (track.between == Between::Cubic ? 3 : 1);
    if (track.times.empty() || track.numbers.size() != expected)
      reader_.fail("expected " + std::to_string(expected) + " numbers for " + std::to_string(track.times.size()) +
                   " keys of an animation, found " + std::to_string(track.numbers.size()));
    for (std::size_t k = 0; k < track.times.size(); ++k)
      if (!std::isfinite(track.times[k]) || (k > 0 && track.times[k] <= track.times[k - 1]))
        reader_.fail("expected key times that ascend, found " + options::shown(track.times[k]) + " s at key " +
                     std::to_string(k));
    return track;
  }

  /// The joints of the first skin, or without a skin what turns; of several trees the largest.
  void choose_joints() {
    std::vector<bool> joint(nodes_.size(), false);
    const json skins = reader_.gltf().value("skins", json::array());
    if (!skins.empty())
      for (const json &node : skins[0].at("joints"))
        joint[index_of(node, "a joint")] = true;
    else
      for (std::size_t i = 0; i < nodes_.size(); ++i)
        joint[i] = nodes_[i].tracks.count("rotation") > 0;
    is_joint_ = joint;
    std::map<int, int> size;
    std::vector<int> root(nodes_.size(), -1);
    for (int node : order_)
      if (joint[node]) {
        const int parent = parent_joint(node);
        root[node] = parent < 0 ? node : root[parent];
        ++size[root[node]];
      }
    if (size.empty())
      reader_.fail("expected joints, found no skin and no node that turns");
    const auto largest = std::max_element(size.begin(), size.end(), [](auto a, auto b) { return a.second < b.second; });
    for (int node : order_)
      if (joint[node] && root[node] == largest->first)
        joints_.push_back(node);
    find_span();
  }

  /// When the tracks that carry joints begin and end.
  void find_span() {
    for (int node = 0; node < static_cast<int>(nodes_.size()); ++node)
      for (const auto &[path, track] : nodes_[node].tracks)
        if (carries_joints(node)) {
          first_ = std::min<double>(first_, track.times.front());
          last_ = std::max<double>(last_, track.times.back());
          if (track.times.size() > densest_.size())
            densest_ = track.times;
        }
    if (densest_.empty())
      reader_.fail("expected an animation of joints, found none that moves one");
  }

  bool carries_joints(int node) const {
    return std::any_of(joints_.begin(), joints_.end(), [&](int joint) {
      for (; joint >= 0; joint = nodes_[joint].parent)
        if (joint == node)
          return true;
      return false;
    });
  }

  /// The nearest joint above; -1: none.
  int parent_joint(int node) const {
    do
      node = nodes_[node].parent;
    while (node >= 0 && !is_joint_[node]);
    return node;
  }

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

  /// Of all nodes, at a time, or at rest.
  void world(const double *time, std::vector<Affine3d> &place, std::vector<Quaterniond> &turned) const {
    place.resize(nodes_.size());
    turned.resize(nodes_.size());
    for (int i : order_) {
      const Node &node = nodes_[i];
      const auto at = [&](const char *path) { return time ? node.tracks.find(path) : node.tracks.end(); };
      const auto translation = at("translation"), rotation = at("rotation"), scale = at("scale");
      const auto none = node.tracks.end();
      const Vector3d moved = translation == none ? node.translation : Vector3d(translation->second.at(*time));
      const Vector3d scaled = scale == none ? node.scale : Vector3d(scale->second.at(*time));
      const Quaterniond q =
          rotation == none ? node.rotation : unit(Quaterniond(Eigen::Vector4d(rotation->second.at(*time))), node.name);
      const Affine3d local = Eigen::Translation3d(moved) * q * Eigen::Scaling(scaled);
      place[i] = node.parent < 0 ? local : place[node.parent] * local;
      turned[i] = node.parent < 0 ? q : turned[node.parent] * q;
    }
  }

  glb::Reader reader_;
  std::string source_;
  std::vector<Node> nodes_;
  std::vector<int> order_;  ///< of the nodes, parents first
  std::vector<int> joints_; ///< nodes, parents first
  std::vector<bool> is_joint_;
  double first_ = 1e30, last_ = -1e30; ///< s
  std::vector<float> densest_;
};

} // namespace

SourceMotion read_gltf_motion(const std::filesystem::path &path) try {
  return Clip(path).sampled();
} catch (const json::exception &problem) {
  throw Error(path.string() + ": expected nodes and animations of glTF 2.0, found: " + problem.what());
}

} // namespace doublet
