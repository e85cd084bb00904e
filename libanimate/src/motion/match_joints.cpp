#include "match_joints.h"

#include "doublet/animate/retarget.h"
#include "doublet/core/error.h"
#include "joint_names.h"

#include <algorithm>

namespace doublet {
namespace {

class Matcher {
public:
  Matcher(const std::vector<std::string> &names, const std::vector<int> &parents)
      : parents_(parents), by_name_(joints_by_name(names)) {}

  std::map<std::string, int> found;

  void give(const std::string &part, int joint) { found[part] = joint; }
  /// The best-named joint below `above` (a part that was found before; empty = anywhere).
  void below(const std::string &part, const std::string &above) {
    if (found.count(part) || (!above.empty() && !found.count(above)))
      return;
    for (int j : by_name_[part])
      if (above.empty() || is_below(j, found[above])) {
        found[part] = j;
        return;
      }
  }
  void above(const std::string &part, const std::string &below) {
    if (found.count(part) || !found.count(below))
      return;
    for (int j : by_name_[part])
      if (is_below(found[below], j)) {
        found[part] = j;
        return;
      }
  }
  bool is_below(int joint, int ancestor) const {
    for (int j = parents_[joint]; j >= 0; j = parents_[j])
      if (j == ancestor)
        return true;
    return false;
  }
  void fork(const std::string &part, const std::string &a, const std::string &b) {
    if (found.count(part) || !found.count(a) || !found.count(b))
      return;
    for (int j = parents_[found[a]]; j >= 0; j = parents_[j])
      if (is_below(found[b], j)) {
        found[part] = j;
        return;
      }
  }

private:
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
    found[side + "forearm"] = found[wrist];
    found[wrist] = found[hand];
    found.erase(hand);
  }
}

} // namespace

std::map<std::string, int> match_human(const std::vector<std::string> &names, const std::vector<int> &parents,
                                       const std::vector<double> &bone_lengths, const std::map<std::string, std::string> &given,
                                       const std::string &source) {
  Matcher match(names, parents);
  for (const auto &[part, name] : given) {
    const auto it = std::find(names.begin(), names.end(), name);
    if (it == names.end())
      throw Error(source + ": there is no joint '" + name + "' (wanted for '" + part + "'); there are " + list(names));
    match.give(part, static_cast<int>(it - names.begin()));
  }
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
    split_forearm(match, side, parents, bone_lengths);
    step_out(match, side, parents, bone_lengths);
  }
  match.fork("pelvis", "l_hip", "r_hip");
  match.fork("chest", "l_shoulder", "r_shoulder");
  match.above("spine", "chest");
  match.below("neck", "chest");
  match.below("head", "chest");
  match.below("head_top", "head");
  std::vector<std::string> missing;
  for (const std::string part : {"pelvis", "chest", "l_hip", "r_hip", "l_knee", "r_knee", "l_ankle", "r_ankle", "l_shoulder",
                                 "r_shoulder", "l_elbow", "r_elbow", "l_wrist", "r_wrist"})
    if (!match.found.count(part))
      missing.push_back(part);
  if (!missing.empty())
    throw Error(source + ": expected a human skeleton, found no joint for " + list(missing) + " among " + list(names) +
                "; name them with the option joint_names");
  return match.found;
}

std::map<std::string, int> match_joints(const SourceMotion &clip, const std::map<std::string, std::string> &given) {
  std::vector<std::string> names;
  std::vector<int> parents;
  std::vector<double> lengths;
  for (const SourceJoint &joint : clip.joints) {
    names.push_back(joint.name);
    parents.push_back(joint.parent);
    lengths.push_back(joint.offset.norm());
  }
  return match_human(names, parents, lengths, given, clip.source);
}

} // namespace doublet
