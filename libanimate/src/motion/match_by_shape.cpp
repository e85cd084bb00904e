#include "match_by_shape.h"

#include "joint_names.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace doublet {
namespace {

using Eigen::Vector3d;

/// What a limb is like, in lengths of its two long bones together: where it begins behind the fork, and what is behind its end.
struct Proportions {
  double offset, offset_spread, first_bone, rest, rest_spread;
};
constexpr Proportions kLeg{0.12, 0.10, 0.50, 0.25, 0.15}, kArm{0.35, 0.20, 0.53, 0.35, 0.25};
constexpr double kFirstBoneSpread = 0.05;
constexpr double kMirrored = 0.05; // share by which the bones of both sides may differ
constexpr int kLeastLikely = 12;   // sum of squared deviations, in spreads

struct Limb {
  std::vector<int> chain;     ///< joints, without those that begin where the one before does
  std::vector<double> behind; ///< of each, how far it is from the fork along the bones
};

struct Pair {
  int fork = -1;
  Limb sides[2];
  double length() const { return sides[0].behind.back(); }
};

/// Joints of a limb: the one it hangs on, and where its bones begin and end, as indices of its chain.
struct Parts {
  std::size_t first, middle, end;
  double unlikely;
};

class Shape {
public:
  explicit Shape(const SourceMotion &clip) : clip_(clip), children_(clip.joints.size()), reach_(clip.joints.size(), 0) {
    for (std::size_t j = clip.joints.size(); j-- > 1;) {
      const int parent = clip.joints[j].parent;
      children_[parent].push_back(static_cast<int>(j));
      reach_[parent] = std::max(reach_[parent], reach_[j] + length(static_cast<int>(j)));
    }
    for (std::vector<int> &list : children_)
      std::reverse(list.begin(), list.end());
  }

  bool is_below(int joint, int ancestor) const {
    while (joint > ancestor)
      joint = clip_.joints[joint].parent;
    return joint == ancestor;
  }

  /// Pairs of limbs that hang on one joint, the longest first.
  std::vector<Pair> pairs() const {
    std::vector<Pair> result;
    for (std::size_t fork = 0; fork < children_.size(); ++fork)
      for (std::size_t a = 0; a < children_[fork].size() && children_[fork].size() < 32; ++a)
        for (std::size_t b = a + 1; b < children_[fork].size(); ++b) {
          Pair pair{static_cast<int>(fork), {limb(children_[fork][a]), limb(children_[fork][b])}};
          if (mirrored(pair))
            result.push_back(std::move(pair));
        }
    std::stable_sort(result.begin(), result.end(), [](const Pair &a, const Pair &b) { return a.length() > b.length(); });
    return result;
  }

  /// From `joint` towards its farthest end.
  Limb limb(int joint) const {
    Limb result;
    double behind = 0;
    for (int j = joint; j >= 0; j = farthest(j)) {
      behind += length(j);
      if (j == joint || behind > result.behind.back() + 1e-6 * (reach_[joint] + behind)) {
        result.chain.push_back(j);
        result.behind.push_back(behind);
      }
    }
    return result;
  }

  double length(int joint) const { return clip_.joints[joint].offset.norm(); }
  const std::vector<int> &children(int joint) const { return children_[joint]; }
  double reach(int joint) const { return reach_[joint] + length(joint); }

private:
  int farthest(int joint) const {
    int best = -1;
    for (int child : children_[joint])
      if (best < 0 || reach(child) > reach(best))
        best = child;
    return best;
  }

  static bool mirrored(const Pair &pair) {
    const Limb &a = pair.sides[0], &b = pair.sides[1];
    constexpr std::size_t kJoints = 3; // hip, knee, ankle
    if (a.chain.size() < kJoints || b.chain.size() < kJoints)
      return false;
    for (std::size_t k = 0; k < kJoints; ++k)
      if (!(std::abs(a.behind[k] - b.behind[k]) <= kMirrored * std::max(a.behind.back(), b.behind.back())))
        return false;
    return std::abs(a.behind.back() - b.behind.back()) <= 2 * kMirrored * std::max(a.behind.back(), b.behind.back());
  }

  const SourceMotion &clip_;
  std::vector<std::vector<int>> children_;
  std::vector<double> reach_;
};

double squared(double value, double expected, double spread) {
  return (value - expected) * (value - expected) / (spread * spread);
}

std::optional<Parts> parts_of(const Limb &limb, const Proportions &usual) {
  std::optional<Parts> best;
  const std::size_t count = std::min<std::size_t>(limb.chain.size(), 16);
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = i + 1; j < count; ++j)
      for (std::size_t k = j + 1; k < count; ++k) {
        const double both = limb.behind[k] - limb.behind[i];
        const double unlikely = squared(limb.behind[i] / both, usual.offset, usual.offset_spread) +
                                squared((limb.behind[j] - limb.behind[i]) / both, usual.first_bone, kFirstBoneSpread) +
                                squared((limb.behind.back() - limb.behind[k]) / both, usual.rest, usual.rest_spread);
        if (unlikely < (best ? best->unlikely : kLeastLikely))
          best = Parts{i, j, k, unlikely};
      }
  return best;
}

/// Above 0 if side 0 is the left one; near 0 if that cannot be told.
double leftness(const SourceMotion &clip, const Pair &legs, const Parts &leg, const Pair &arms, const Parts &arm) {
  const auto both = [](const Pair &pair, std::size_t part, const Vertices &at) {
    return Vector3d(0.5 * (at.row(pair.sides[0].chain[part]) + at.row(pair.sides[1].chain[part])));
  };
  double sum = 0;
  const std::size_t step = std::max<std::size_t>(clip.positions.size() / 32, 1);
  for (std::size_t t = 0; t < clip.positions.size(); t += step) {
    const Vertices &at = clip.positions[t];
    const Vector3d up = both(arms, arm.first, at) - both(legs, leg.first, at);
    const Vector3d across = at.row(legs.sides[0].chain[leg.first]) - at.row(legs.sides[1].chain[leg.first]);
    Vector3d ahead = Vector3d::Zero();
    for (const Limb &side : legs.sides)
      ahead += leg.end + 1 < side.chain.size() ? Vector3d(at.row(side.chain[leg.end + 1]) - at.row(side.chain[leg.end])) // feet
                                               : Vector3d(at.row(side.chain[leg.middle]) - 0.5 * at.row(side.chain[leg.first]) -
                                                          0.5 * at.row(side.chain[leg.end])); // knees
    const Vector3d left = up.cross(ahead);
    if (left.norm() > 1e-9 && across.norm() > 1e-9)
      sum += left.normalized().dot(across.normalized());
  }
  return sum / std::max(1.0, std::ceil(static_cast<double>(clip.positions.size()) / static_cast<double>(step)));
}

/// 0 or 1: the side that is left; nothing if it cannot be told.
std::optional<int> left_side(const SourceMotion &clip, const Pair &legs, const Parts &leg, const Pair &arms, const Parts &arm) {
  const char one = side_of(clip.joints[legs.sides[0].chain[leg.middle]].name),
             other = side_of(clip.joints[legs.sides[1].chain[leg.middle]].name);
  if (one && other && one != other)
    return one == 'l' ? 0 : 1;
  const double left = leftness(clip, legs, leg, arms, arm);
  if (std::abs(left) < 0.5)
    return std::nullopt;
  return left > 0 ? 0 : 1;
}

/// The limb of `arms` that is on the same side as `left` of `legs`: names, else the one that is nearer to it.
int same_side(const SourceMotion &clip, const Pair &legs, const Parts &leg, int left, const Pair &arms) {
  const char one = side_of(clip.joints[arms.sides[0].chain[1]].name), other = side_of(clip.joints[arms.sides[1].chain[1]].name);
  if (one && other && one != other)
    return one == 'l' ? 0 : 1;
  double nearer = 0;
  for (const Vertices &at : clip.positions) {
    // Of the hips: CMU's rigs begin both legs in the pelvis.
    const Vector3d across = at.row(legs.sides[left].chain[leg.first]) - at.row(legs.sides[1 - left].chain[leg.first]);
    nearer += across.dot(Vector3d(at.row(arms.sides[0].chain[1]) - at.row(arms.sides[1].chain[1])));
  }
  return nearer > 0 ? 0 : 1;
}

void take_limb(const Limb &limb, const Parts &parts, const std::string &side, bool leg, std::map<std::string, int> &out) {
  const auto set = [&](const char *part, std::size_t k) { out[side + part] = limb.chain[k]; };
  set(leg ? "hip" : "shoulder", parts.first);
  set(leg ? "knee" : "elbow", parts.middle);
  set(leg ? "ankle" : "wrist", parts.end);
  if (parts.end + 1 < limb.chain.size())
    set(leg ? "toe" : "hand", parts.end + 1);
  if (!leg && parts.first > 0)
    set("clavicle", parts.first - 1);
}

/// Spine, neck and head: what is between the forks, and the longest branch above that is no arm.
void take_trunk(const SourceMotion &clip, const Shape &shape, const Pair &legs, const Pair &arms,
                std::map<std::string, int> &out) {
  out["pelvis"] = legs.fork;
  out["chest"] = arms.fork;
  for (int j = clip.joints[arms.fork].parent; j > legs.fork && shape.is_below(arms.fork, legs.fork); j = clip.joints[j].parent)
    out["spine"] = j;
  int neck = -1;
  for (int child : shape.children(arms.fork))
    if (child != arms.sides[0].chain[0] && child != arms.sides[1].chain[0] && child != legs.sides[0].chain[0] &&
        child != legs.sides[1].chain[0] && (neck < 0 || shape.reach(child) > shape.reach(neck)))
      neck = child;
  if (neck < 0)
    return;
  const Limb up = shape.limb(neck);
  out["neck"] = neck;
  if (up.chain.size() > 1)
    out["head"] = up.chain[1];
}

} // namespace

std::map<std::string, int> match_by_shape(const SourceMotion &clip) {
  constexpr std::size_t kMost = 2000; // joints; no body has more
  if (clip.joints.empty() || clip.joints.size() > kMost)
    return {};
  const Shape shape(clip);
  const std::vector<Pair> pairs = shape.pairs();
  const auto inside = [&](const Pair &inner, const Pair &outer) {
    return shape.is_below(inner.fork, outer.sides[0].chain[0]) || shape.is_below(inner.fork, outer.sides[1].chain[0]);
  };
  const auto shares = [](const Pair &a, const Pair &b) {
    for (const Limb &one : a.sides)
      for (const Limb &other : b.sides)
        if (one.chain[0] == other.chain[0])
          return true;
    return false;
  };
  if (pairs.empty())
    return {};
  const Pair *legs = &pairs[0], *arms = nullptr;
  for (std::size_t i = 1; i < pairs.size() && !arms; ++i)
    if (!inside(pairs[i], *legs) && !inside(*legs, pairs[i]) && !shares(pairs[i], *legs))
      arms = &pairs[i];
  if (!arms)
    return {};
  if (legs->fork != arms->fork && shape.is_below(legs->fork, arms->fork))
    std::swap(legs, arms);
  const auto leg = parts_of(legs->sides[0], kLeg), arm = parts_of(arms->sides[0], kArm);
  if (!leg || !arm || leg->end >= legs->sides[1].chain.size() || arm->end >= arms->sides[1].chain.size())
    return {};
  const auto left_leg = left_side(clip, *legs, *leg, *arms, *arm);
  if (!left_leg)
    return {};
  const int left_arm = same_side(clip, *legs, *leg, *left_leg, *arms);
  std::map<std::string, int> result;
  for (const int side : {0, 1}) {
    take_limb(legs->sides[side], *leg, side == *left_leg ? "l_" : "r_", true, result);
    take_limb(arms->sides[side], *arm, side == left_arm ? "l_" : "r_", false, result);
  }
  take_trunk(clip, shape, *legs, *arms, result);
  return result;
}

} // namespace doublet
