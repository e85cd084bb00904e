#include "node_clip.h"

#include "doublet/core/error.h"
#include "doublet/options/options.h"
#include "motion_bounds.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

namespace doublet {
namespace {

using Eigen::Affine3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double kFewestKeys = 24, kMostKeys = 240; // 1/s at which a clip is sampled, whatever its keys
constexpr double kRounding = 1e-4;                  // s, by which key times, which are floats, may be off
constexpr double kBroadcast = 1.001;                // 30 frames a second are 29.97 where television says so
constexpr double kExact = 1e-4;                     // share of a rate, by which one that is not rounded may be off
constexpr double kUnevenKeys = 0.2;                 // of a gap, by which one may be off
constexpr double kUnchanged = 1e-3;                 // by which a component of a quaternion, or of a place (m), may vary
constexpr double kMovesTheBody = 0.5;               // of the nodes that the liveliest animation turns

class Sampler {
public:
  Sampler(NodeClip clip, const std::string &animation)
      : clip_(std::move(clip)), nodes_(clip_.nodes), animation_(animation.empty() ? liveliest() : number_of(animation)),
        tracks_(clip_.animations[animation_].tracks) {
    put_in_order();
    choose_joints();
    stand_as_bound();
  }

  SourceMotion sampled() const {
    SourceMotion motion;
    motion.source = clip_.source;
    for (const NodeAnimation &one : clip_.animations)
      motion.animations.push_back(one.name);
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
    require_poses(count, nodes_.size(), clip_.source);
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
        fail("expected finite positions of joints, found others at " + options::to_text(time) + " s");
      motion.positions.push_back(std::move(positions));
      motion.rotations.push_back(std::move(rotations));
    }
    return motion;
  }

private:
  [[noreturn]] void fail(const std::string &what) const { throw Error(clip_.source + ": " + what); }

  bool turns(int node) const {
    const auto tracks = tracks_.find(node);
    return tracks != tracks_.end() && tracks->second.count("rotation");
  }

  /// Between keys a cubic spline leaves the unit sphere, far if the turn is wide: the standard has it brought back.
  Quaterniond direction(const Quaterniond &q, const std::string &node) const {
    if (!(q.norm() > 1e-6 && q.norm() < 1e6))
      fail("expected quaternions with a direction between keys, found one of length " + options::to_text(q.norm(), 4) +
           " at node '" + node + "'");
    return q.normalized();
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
      fail("expected a tree of nodes, found a cycle");
  }

  int number_of(const std::string &wanted) const {
    const std::vector<NodeAnimation> &all = clip_.animations;
    const auto named = std::find_if(all.begin(), all.end(), [&](const NodeAnimation &one) { return one.name == wanted; });
    if (named != all.end())
      return static_cast<int>(named - all.begin());
    std::size_t number = 0;
    const auto [end, problem] = std::from_chars(wanted.data(), wanted.data() + wanted.size(), number);
    if (problem == std::errc() && end == wanted.data() + wanted.size() && number >= 1 && number <= all.size())
      return static_cast<int>(number) - 1;
    std::string names;
    for (std::size_t i = 0; i < all.size() && i < 60; ++i)
      names += (i ? ", " : "") + all[i].name;
    fail("expected one of the animations " + names + ", or a number from 1 to " + std::to_string(all.size()) + ", found '" +
         wanted + "'");
  }

  /// The first that moves the body: packs often begin with one that stands still.
  int liveliest() const {
    std::vector<std::size_t> turning;
    for (const NodeAnimation &animation : clip_.animations) {
      turning.push_back(0);
      for (const auto &[node, tracks] : animation.tracks)
        turning.back() += tracks.count("rotation") && tracks.at("rotation").moves();
    }
    const double most = static_cast<double>(*std::max_element(turning.begin(), turning.end()));
    const auto first = std::find_if(turning.begin(), turning.end(),
                                    [&](std::size_t count) { return static_cast<double>(count) >= kMovesTheBody * most; });
    return static_cast<int>(first - turning.begin());
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
    return common >= 0 && tracks_.count(common) > 0;
  }

  std::vector<Group> skins() const {
    std::vector<Group> groups;
    for (const NodeSkin &skin : clip_.skins) {
      std::vector<bool> chosen(nodes_.size(), false);
      for (int node : skin.joints)
        chosen[node] = true;
      if (Group group = closed(chosen); group.top >= 0)
        groups.push_back(std::move(group));
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
      if (!turns(node) && nodes_[node].part.empty())
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
    is_joint_ = body_of(clip_.skins.empty() ? moving() : skins());
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
      fail("expected joints, found no skin and no node that turns");
    const auto largest = std::max_element(size.begin(), size.end(), [](auto a, auto b) { return a.second < b.second; });
    if (largest->second > static_cast<int>(kMostJoints))
      fail("expected at most " + std::to_string(kMostJoints) + " joints, found " + std::to_string(largest->second));
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
      const auto tracks = tracks_.find(*node);
      if (!carries[*node] || tracks == tracks_.end())
        continue;
      for (const auto &[path, track] : tracks->second) {
        first_ = std::min<double>(first_, track.times().front());
        last_ = std::max<double>(last_, track.times().back());
        if (track.times().size() > densest_.size())
          densest_ = track.times();
      }
    }
    if (densest_.empty())
      fail("expected an animation of joints, found none that moves one");
  }

  /// The nearest joint above; -1: none.
  int parent_joint(int node) const { return above_[node]; }

  /// That of the track with the most keys. Their times may be rounded: where all gaps are whole numbers of the usual one, its
  /// mean counts.
  double rate() const {
    if (densest_.size() < 2)
      return kFewestKeys;
    std::vector<double> gaps;
    for (std::size_t k = 1; k < densest_.size(); ++k)
      gaps.push_back(static_cast<double>(densest_[k]) - densest_[k - 1]);
    std::nth_element(gaps.begin(), gaps.begin() + gaps.size() / 2, gaps.end());
    double usual = gaps[gaps.size() / 2], steps = 0;
    for (const double gap : gaps) {
      const double count = std::round(gap / usual);
      steps = count >= 1 && std::abs(gap - count * usual) < kUnevenKeys * usual ? steps + count : std::nan("");
    }
    if (std::isfinite(steps))
      usual = (static_cast<double>(densest_.back()) - densest_.front()) / steps;
    const double broadcast = std::round(kBroadcast / usual);
    if (broadcast >= kFewestKeys && broadcast <= kMostKeys && std::abs(usual * broadcast / kBroadcast - 1) < kExact)
      return broadcast / kBroadcast;
    const double found = std::clamp(1 / usual, kFewestKeys, kMostKeys), whole = std::round(found);
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
    for (const NodeSkin &skin : clip_.skins)
      if (!skin.inverse_bind.empty())
        bound.merge(turns_of_bind_pose(skin.inverse_bind, above_, place, rest));
    bound_ = std::move(bound);
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
    const std::map<std::string, Track> still;
    for (int i : order_) {
      const Node &node = nodes_[i];
      const Vector3d side = node.parent < 0 ? Vector3d::Ones() : sides[node.parent];
      const auto tracks = tracks_.find(i);
      const auto &own_tracks = time && tracks != tracks_.end() ? tracks->second : still;
      const auto none = own_tracks.end();
      const auto translation = own_tracks.find("translation"), rotation = own_tracks.find("rotation"),
                 scale = own_tracks.find("scale");
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

  const NodeClip clip_;
  const std::vector<Node> &nodes_;
  const int animation_;
  const Tracks &tracks_;
  std::vector<int> order_;  ///< of the nodes, parents first
  std::vector<int> joints_; ///< nodes, parents first
  std::vector<bool> is_joint_;
  std::vector<int> above_;             ///< of a node, the nearest joint
  std::map<int, Quaterniond> bound_;   ///< of nodes that stand otherwise in the zero pose, in the world
  double first_ = 1e30, last_ = -1e30; ///< s
  std::vector<float> densest_;         ///< key times
};

} // namespace

Eigen::VectorXd Track::numbers_at(std::size_t key, std::size_t part) const {
  const std::size_t first = (between == Between::Cubic ? 3 * key + part : key) * width;
  return Eigen::Map<const Eigen::VectorXf>(numbers->data() + first, static_cast<Eigen::Index>(width)).cast<double>();
}

Eigen::VectorXd Track::at(double time) const {
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

bool Track::moves() const {
  const Eigen::VectorXd first = key(0);
  for (std::size_t k = 1; k < times().size(); ++k)
    if ((key(k) - first).cwiseAbs().maxCoeff() > kUnchanged)
      return true;
  return false;
}

SourceMotion sampled_motion(NodeClip clip, const std::string &animation) {
  if (clip.animations.empty())
    throw Error(clip.source + ": expected an animation, found none");
  return Sampler(std::move(clip), animation).sampled();
}

} // namespace doublet
