#include "joint_names.h"

#include <algorithm>
#include <cctype>
#include <iterator>
#include <set>

namespace doublet {
namespace {

struct Part {
  const char *name;                  ///< standard name without side
  std::vector<std::string> synonyms; ///< lower case, letters and digits only, best first
};

const std::vector<Part> &limb_parts() {
  static const std::vector<Part> parts{
      {"hip", {"upleg", "thigh", "upperleg", "thighbend", "uleg", "femur", "hip", "legupper", "leg"}},
      {"knee", {"calf", "lowerleg", "tibia", "shin", "shank", "knee", "lowleg", "loleg", "lleg", "leglower", "shinbend", "leg"}},
      {"ankle", {"ankle", "foot"}},
      {"toe", {"toebase", "toes", "toe", "ball", "toe0", "foot"}}, // SMPL and Kinect have the foot below the ankle
      {"clavicle", {"clavicle", "collar", "collarbone", "clav", "scapula", "shoulder"}},
      {"shoulder", {"upperarm", "uparm", "uarm", "humerus", "armupper", "shldr", "shldrbend", "arm", "shoulder"}},
      {"elbow", {"forearm", "lowerarm", "farm", "forearmbend", "radius", "elbow", "lowarm", "loarm", "armlower"}},
      {"wrist", {"wrist", "hand"}},
      {"hand",
       {"hand", "middle1", "mid1", "handmiddle1", "fingers", "middle01", "fmiddle01", "middlefinger1", "middleproximal",
        "handend"}},
  };
  return parts;
}

const std::vector<Part> &centre_parts() {
  static const std::vector<Part> parts{
      {"pelvis", {"pelvis", "hips", "hip", "root"}},
      {"spine", {"spine", "waist", "torso", "lowerback", "spine0", "spine01", "abdomen", "abdomenlower", "ab", "spine1"}},
      {"chest", {"chest", "upperchest", "spine2", "spine02", "upperback", "thorax", "chestupper", "spine03", "spine3"}},
      {"neck", {"neck", "neck1", "neck01", "necktwist01", "lowerneck", "necklower", "spine004"}},
      {"head", {"head", "spine006"}}, // Rigify has a neck and a head by numbers
      {"head_top", {"headtop", "headtopend", "headend", "headnub", "headsite"}},
  };
  return parts;
}

using Tokens = std::vector<std::string>;

/// Words of a name, lower case: at separators, between letters and digits, and where a capital begins one.
Tokens tokens_of(const std::string &name) {
  Tokens result;
  const auto kind = [](unsigned char c) { return std::isdigit(c) ? 2 : std::isupper(c) ? 1 : std::islower(c) ? 0 : -1; };
  int before = -1;
  for (std::size_t i = std::min(name.find_last_of(":|/") + 1, name.size()); i < name.size(); ++i) {
    const int now = kind(static_cast<unsigned char>(name[i])), next = i + 1 < name.size() ? kind(name[i + 1]) : -1;
    const bool begins = before < 0 || (now == 2) != (before == 2) || (now == 1 && (before == 0 || (before == 1 && next == 0)));
    if (now >= 0 && begins)
      result.emplace_back();
    if (now >= 0)
      result.back() += static_cast<char>(std::tolower(static_cast<unsigned char>(name[i])));
    before = now;
  }
  return result;
}

bool is_number(const std::string &token) {
  return std::isdigit(static_cast<unsigned char>(token[0]));
}

/// How many words nearly all names begin with: that of the character or of the rig.
std::size_t common_words(const std::vector<Tokens> &names) {
  constexpr double kNearlyAll = 0.9;
  constexpr std::size_t kFew = 5; // names, which may all be of one limb
  if (names.size() <= kFew)
    return 0;
  std::map<std::string, std::size_t> count;
  for (const Tokens &name : names)
    if (name.size() > 1)
      ++count[name[0]];
  const auto most = std::max_element(count.begin(), count.end(), [](auto &a, auto &b) { return a.second < b.second; });
  return most != count.end() && static_cast<double>(most->second) > kNearlyAll * static_cast<double>(names.size()) ? 1 : 0;
}

/// Without what says nothing about the joint: the rig's prefixes and suffixes.
std::string plain(Tokens tokens, std::size_t common) {
  static const std::set<std::string> before{"j",   "bip", "m",  "c",    "jnt", "bind", "sk",    "def", "org",   "mch",
                                            "rig", "rl",  "cc", "base", "b",   "bone", "joint", "jt",  "valve", "biped"},
      after{"jnt", "joint", "jt", "bone", "bind", "skin", "c", "m"};
  if (tokens.size() > common)
    tokens.erase(tokens.begin(), tokens.begin() + static_cast<std::ptrdiff_t>(common));
  bool cut = common > 0;
  while (tokens.size() > 1 && (before.count(tokens[0]) || (cut && is_number(tokens[0])))) {
    tokens.erase(tokens.begin());
    cut = true;
  }
  while (tokens.size() > 1 && after.count(tokens.back()))
    tokens.pop_back();
  std::string result;
  for (const std::string &token : tokens)
    result += token;
  for (const std::string prefix : {"ccbase", "mixamorig", "bip01", "bip001", "character1", "rlbone", "def", "b0"})
    if (result.rfind(prefix, 0) == 0 && result.size() > prefix.size())
      return result.substr(prefix.size());
  return result;
}

std::string without_digits(const std::string &name) {
  std::string result;
  std::copy_if(name.begin(), name.end(), std::back_inserter(result), [](unsigned char c) { return !std::isdigit(c); });
  return result;
}

std::vector<int> indices(const std::vector<std::string> &names, const std::vector<std::string> &wanted) {
  std::vector<int> found;
  for (const std::string &name : wanted)
    for (std::size_t i = 0; i < names.size(); ++i)
      if (names[i] == name && std::find(found.begin(), found.end(), static_cast<int>(i)) == found.end())
        found.push_back(static_cast<int>(i));
  return found;
}

} // namespace

std::map<std::string, std::vector<int>> joints_by_name(const std::vector<std::string> &names) {
  std::vector<Tokens> tokens;
  for (const std::string &name : names)
    tokens.push_back(tokens_of(name));
  const std::size_t common = common_words(tokens);
  std::vector<std::string> simple, numberless;
  for (const Tokens &name : tokens) {
    simple.push_back(plain(name, common));
    numberless.push_back(without_digits(simple.back()));
  }
  std::map<std::string, std::vector<int>> result;
  const auto find = [&](const std::string &part, const std::vector<std::string> &wanted) {
    result[part] = indices(simple, wanted);
    for (int i : indices(numberless, wanted)) // upperleg01.L
      if (std::find(result[part].begin(), result[part].end(), i) == result[part].end())
        result[part].push_back(i);
  };
  for (const Part &part : centre_parts())
    find(part.name, part.synonyms);
  for (const std::string side : {"left", "right"})
    for (const Part &part : limb_parts()) {
      const std::string letter = side.substr(0, 1);
      std::vector<std::string> wanted;
      for (const std::string &synonym : part.synonyms)
        for (const std::string &name : {side + synonym, letter + synonym, synonym + side, synonym + letter,
                                        side.substr(0, 2) + synonym, letter + (letter == "l" ? "f" : "t") + synonym})
          wanted.push_back(name);
      find(letter + "_" + part.name, wanted);
    }
  return result;
}

char side_of(const std::string &name) {
  for (const std::string &token : tokens_of(name)) {
    if (token == "left" || token == "l" || token == "lf" || token == "lft")
      return 'l';
    if (token == "right" || token == "r" || token == "rt" || token == "rgt")
      return 'r';
  }
  return 0;
}

} // namespace doublet
