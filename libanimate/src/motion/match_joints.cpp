#include "match_joints.h"

#include "doublet/animate/retarget.h"
#include "doublet/core/error.h"
#include "joint_names.h"
#include "match_by_shape.h"

#include <algorithm>

namespace doublet {
namespace {

class Matcher {
public:
  Matcher(const std::vector<std::string> &names, const std::vector<int> &parents)
      : parents_(parents), by_name_(joints_by_name(names)) {}

  std::map<std::string, int> found;
  std::map<std::string, std::string> reasons; ///< of what was found

  void set(const std::string &part, int joint, const std::string &reason) {
    found[part] = joint;
    reasons[part] = reason;
  }
  void forget(const std::string &part) {
    found.erase(part);
    reasons.erase(part);
  }
  /// No joint plays this part, whatever its name.
  void leave_out(const std::string &part) { by_name_[part].clear(); }
  std::vector<std::string> parts() const {
    std::vector<std::string> names{"l_forearm", "r_forearm"};
    for (const auto &[part, joints] : by_name_)
      names.push_back(part);
    std::sort(names.begin(), names.end());
    return names;
  }
  /// The best-named joint below `above` (a part that was found before; empty = anywhere).
  void below(const std::string &part, const std::string &above) {
    if (found.count(part) || (!above.empty() && !found.count(above)))
      return;
    for (int j : by_name_[part])
      if (above.empty() || is_below(j, found[above])) {
        set(part, j, "by its name");
        return;
      }
  }
  void above(const std::string &part, const std::string &below) {
    if (found.count(part) || !found.count(below))
      return;
    for (int j : by_name_[part])
      if (is_below(found[below], j) && !plays_another(j)) {
        set(part, j, "by its name");
        return;
      }
  }
  bool is_below(int joint, int ancestor) const {
    for (int j = parents_[joint]; j >= 0; j = parents_[j])
      if (j == ancestor)
        return true;
    return false;
  }
  void fork(const std::string &part, const std::string &a, const std::string &b, const std::string &reason) {
    if (found.count(part) || !found.count(a) || !found.count(b))
      return;
    for (int j = parents_[found[a]]; j >= 0; j = parents_[j])
      if (is_below(found[b], j)) {
        set(part, j, reason);
        return;
      }
  }
  /// 3ds Max hangs the arms on the neck, which turns with the head: the chest is what carries it.
  void lower_chest() {
    const std::vector<int> &necks = by_name_["neck"];
    const auto chest = found.find("chest"), pelvis = found.find("pelvis");
    if (chest == found.end() || pelvis == found.end())
      return;
    int joint = chest->second;
    while (std::find(necks.begin(), necks.end(), joint) != necks.end() && is_below(joint, pelvis->second) &&
           parents_[joint] != pelvis->second)
      joint = parents_[joint];
    if (joint != chest->second)
      set("chest", joint, "by its place: it carries the neck, on which the arms hang");
  }

private:
  bool plays_another(int joint) const {
    return std::any_of(found.begin(), found.end(), [&](const auto &part) { return part.second == joint; });
  }

  const std::vector<int> &parents_;
  std::map<std::string, std::vector<int>> by_name_;
};

double length_between(int from, int to, const std::vector<int> &parents, const std::vector<double> &lengths) {
  double sum = 0;
  for (int j = to; j >= 0 && j != from; j = parents[j])
    sum += lengths[j];
  return sum;
}

std::string list(const std::vector<std::string> &names) {
  std::string text;
  for (std::size_t i = 0; i < names.size() && i < 60; ++i)
    text += (i ? ", " : "") + names[i];
  return text + (names.size() > 60 ? ", ..." : "");
}

/// A hand that starts where the wrist does gives no direction: its first joint farther out does.
void step_out(Matcher &match, const std::string &side, const std::vector<int> &parents, const std::vector<double> &lengths) {
  const auto wrist = match.found.find(side + "wrist"), hand = match.found.find(side + "hand");
  if (lengths.empty() || wrist == match.found.end() || hand == match.found.end())
    return;
  for (int j = hand->second; j < static_cast<int>(parents.size()); ++j)
    if ((j == hand->second || match.is_below(j, hand->second)) && length_between(wrist->second, j, parents, lengths) > 0) {
      match.reasons[side + "hand"] = "by its name, or the first below that is away from the wrist";
      hand->second = j;
      return;
    }
}

/// CMU's rigs split the forearm: 'wrist' starts in its middle and turns with it, the hand starts at the wrist.
void split_forearm(Matcher &match, const std::string &side, const std::vector<int> &parents, const std::vector<double> &lengths) {
  auto &found = match.found;
  const std::string wrist = side + "wrist", hand = side + "hand", elbow = side + "elbow", shoulder = side + "shoulder";
  if (lengths.empty() || !found.count(wrist) || !found.count(hand) || !found.count(elbow) || found[wrist] == found[hand] ||
      !match.is_below(found[hand], found[wrist]))
    return;
  const double upper = length_between(found[shoulder], found[elbow], parents, lengths);
  const double lower = length_between(found[elbow], found[wrist], parents, lengths);
  if (lower < 0.75 * upper) {
    match.set(side + "forearm", found[wrist], "by its place: named a wrist, it begins in the middle of the forearm");
    match.set(wrist, found[hand], "by its place: named a hand, it begins where the forearm ends");
    match.forget(hand);
  }
}

/// Retargeting needs these.
const std::vector<std::string> &needed_parts() {
  static const std::vector<std::string> parts{"pelvis",  "chest",      "l_hip",      "r_hip",   "l_knee",  "r_knee",  "l_ankle",
                                              "r_ankle", "l_shoulder", "r_shoulder", "l_elbow", "r_elbow", "l_wrist", "r_wrist"};
  return parts;
}

void take_given(Matcher &match, const std::vector<std::string> &names, const std::map<std::string, std::string> &given,
                const std::string &source) {
  const std::vector<std::string> parts = match.parts();
  for (const auto &[part, name] : given) {
    if (std::find(parts.begin(), parts.end(), part) == parts.end())
      throw Error(source + ": expected one of our joints, " + list(parts) + ", found '" + part + "' (to be played by '" + name +
                  "')");
    if (name.empty()) {
      match.leave_out(part);
      continue;
    }
    const auto it = std::find(names.begin(), names.end(), name);
    if (it == names.end())
      throw Error(source + ": there is no joint '" + name + "' (wanted for '" + part + "'); there are " + list(names));
    match.set(part, static_cast<int>(it - names.begin()), "given");
  }
}

/// Trunks may be of one piece, and a hand may end where it begins; else no joint plays two parts.
bool may_be_one(const std::string &a, const std::string &b) {
  const auto sided = [](const std::string &part) { return part.substr(0, 2) == "l_" || part.substr(0, 2) == "r_"; };
  const auto ends = [](const std::string &part) {
    return part.substr(1) == "_forearm" || part.substr(1) == "_wrist" || part.substr(1) == "_hand";
  };
  return sided(a) == sided(b) && (!sided(a) || (a[0] == b[0] && ends(a) && ends(b)));
}

/// A map of bones may give one joint twice, or one that another part has by its name.
void refuse_twice(const Matcher &match, const std::vector<std::string> &names, const std::map<std::string, std::string> &given,
                  const std::string &source) {
  for (const auto &[part, name] : given)
    for (const auto &[other, joint] : match.found)
      if (!name.empty() && other != part && joint == match.found.at(part) && !may_be_one(part, other))
        throw Error(source + ": expected another joint for " + part + " and " + other + ", found '" + names[joint] +
                    "' for both; \"\" says that no joint plays a part");
}

/// Everything that can be found by names.
Matcher matched(const std::vector<std::string> &names, const std::vector<int> &parents, const std::vector<double> &bone_lengths,
                const std::map<std::string, std::string> &given, const std::string &source,
                const std::map<std::string, int> &stated = {}) {
  Matcher match(names, parents);
  take_given(match, names, given, source);
  for (const auto &[part, joint] : stated)
    if (!given.count(part))
      match.set(part, joint, "as the file says");
  for (const std::string side : {"l_", "r_"}) {
    match.below(side + "hip", "");
    match.below(side + "knee", side + "hip");
    match.below(side + "ankle", side + "knee");
    match.below(side + "toe", side + "ankle");
    match.below(side + "shoulder", "");
    match.below(side + "elbow", side + "shoulder");
    match.below(side + "wrist", side + "elbow");
    match.below(side + "hand", side + "wrist");
    match.above(side + "clavicle", side + "shoulder");
    if (!given.count(side + "wrist") && !given.count(side + "hand") && !stated.count(side + "wrist"))
      split_forearm(match, side, parents, bone_lengths);
    if (!given.count(side + "hand"))
      step_out(match, side, parents, bone_lengths);
  }
  match.fork("pelvis", "l_hip", "r_hip", "by its place: where the legs meet");
  match.fork("chest", "l_shoulder", "r_shoulder", "by its place: where the arms meet");
  if (!given.count("chest") && !stated.count("chest"))
    match.lower_chest();
  match.above("spine", "chest");
  match.below("neck", "chest");
  match.below("head", "chest");
  match.below("head_top", "head");
  refuse_twice(match, names, given, source);
  return match;
}

struct Bones {
  std::vector<std::string> names;
  std::vector<int> parents;
  std::vector<double> lengths;
  std::map<std::string, int> stated;
  explicit Bones(const SourceMotion &clip) {
    for (const SourceJoint &joint : clip.joints) {
      if (!joint.part.empty())
        stated.emplace(joint.part, static_cast<int>(names.size()));
      names.push_back(joint.name);
      parents.push_back(joint.parent);
      lengths.push_back(joint.offset.norm());
    }
  }
};

std::vector<std::string> missing_parts(const Matcher &match) {
  std::vector<std::string> missing;
  for (const std::string &part : needed_parts())
    if (!match.found.count(part))
      missing.push_back(part);
  return missing;
}

/// By names, and if these do not give a human, by shape.
Matcher matched(const SourceMotion &clip, const std::map<std::string, std::string> &given) {
  const Bones bones(clip);
  Matcher match = matched(bones.names, bones.parents, bones.lengths, given, clip.source, bones.stated);
  if (missing_parts(match).empty())
    return match;
  const std::map<std::string, int> shape = match_by_shape(clip);
  if (shape.empty())
    return match;
  Matcher by_shape(bones.names, bones.parents);
  take_given(by_shape, bones.names, given, clip.source);
  for (const auto &[part, joint] : shape)
    if (!given.count(part))
      by_shape.set(part, joint, "by its place and length: its name is of no known convention");
  refuse_twice(by_shape, bones.names, given, clip.source);
  return missing_parts(by_shape).size() < missing_parts(match).size() ? by_shape : match;
}

[[noreturn]] void refuse_missing(const std::vector<std::string> &missing, const std::vector<std::string> &names,
                                 const std::string &source) {
  throw Error(source + ": expected a human skeleton, found no joint for " + list(missing) + " among " + list(names) +
              "; name them with the option joint_names");
}

} // namespace

std::map<std::string, int> match_human(const std::vector<std::string> &names, const std::vector<int> &parents,
                                       const std::vector<double> &bone_lengths, const std::map<std::string, std::string> &given,
                                       const std::string &source) {
  const Matcher match = matched(names, parents, bone_lengths, given, source);
  if (const auto missing = missing_parts(match); !missing.empty())
    refuse_missing(missing, names, source);
  return match.found;
}

std::map<std::string, int> match_joints(const SourceMotion &clip, const std::map<std::string, std::string> &given) {
  const Matcher match = matched(clip, given);
  if (const auto missing = missing_parts(match); !missing.empty())
    refuse_missing(missing, Bones(clip).names, clip.source);
  return match.found;
}

std::vector<JointMatch> explain_match(const SourceMotion &clip, const std::map<std::string, std::string> &given) {
  const Matcher match = matched(clip, given);
  std::vector<JointMatch> result;
  for (const std::string &part : match.parts()) {
    const std::vector<std::string> &needed = needed_parts();
    const bool is_needed = std::find(needed.begin(), needed.end(), part) != needed.end();
    const auto found = match.found.find(part);
    if (found == match.found.end())
      result.push_back({part, -1, is_needed ? "needed, and not found" : "not found"});
    else
      result.push_back({part, found->second, match.reasons.at(part)});
  }
  return result;
}

} // namespace doublet
