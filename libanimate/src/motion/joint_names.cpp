#include "joint_names.h"

#include <algorithm>
#include <cctype>

namespace doublet {
namespace {

struct Part {
  const char *name;                  ///< standard name without side
  std::vector<std::string> synonyms; ///< lower case, letters and digits only, best first
};

const std::vector<Part> &limb_parts() {
  static const std::vector<Part> parts{
      {"hip", {"upleg", "thigh", "upperleg", "femur", "hip", "legupper"}},
      {"knee", {"calf", "lowerleg", "tibia", "shin", "knee", "lowleg", "leglower", "leg"}},
      {"ankle", {"foot", "ankle"}},
      {"toe", {"toebase", "toes", "toe", "ball", "toe0"}},
      {"clavicle", {"clavicle", "collar", "collarbone", "shoulder"}},
      {"shoulder", {"upperarm", "uparm", "humerus", "armupper", "arm", "shoulder"}},
      {"elbow", {"forearm", "lowerarm", "radius", "elbow", "lowarm", "armlower"}},
      {"wrist", {"wrist", "hand"}},
      {"hand", {"hand", "middle1", "mid1", "handmiddle1", "fingers", "middle01", "handend"}},
  };
  return parts;
}

const std::vector<Part> &centre_parts() {
  static const std::vector<Part> parts{
      {"pelvis", {"pelvis", "hips", "hip", "root"}},
      {"spine", {"spine", "waist", "lowerback", "spine0", "spine01", "abdomen", "spine1"}},
      {"chest", {"chest", "spine2", "spine02", "upperback", "thorax", "spine03", "spine3"}},
      {"neck", {"neck", "neck1", "neck01", "necktwist01", "lowerneck"}},
      {"head", {"head"}},
      {"head_top", {"headtop", "headtopend", "headend", "headnub", "headsite"}},
  };
  return parts;
}

/// Lower case, namespace and the rigs' prefixes cut off, separators dropped.
std::string plain(const std::string &name) {
  std::string text = name.substr(name.rfind(':') == std::string::npos ? 0 : name.rfind(':') + 1);
  std::string result;
  for (unsigned char c : text)
    if (std::isalnum(c))
      result += static_cast<char>(std::tolower(c));
  for (const std::string prefix : {"ccbase", "mixamorig", "bip01", "bip001", "character1", "rlbone", "def", "b0"})
    if (result.rfind(prefix, 0) == 0 && result.size() > prefix.size())
      return result.substr(prefix.size());
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
  std::vector<std::string> simple;
  for (const std::string &name : names)
    simple.push_back(plain(name));
  std::map<std::string, std::vector<int>> result;
  for (const Part &part : centre_parts())
    result[part.name] = indices(simple, part.synonyms);
  for (const std::string side : {"left", "right"})
    for (const Part &part : limb_parts()) {
      const std::string letter = side.substr(0, 1);
      std::vector<std::string> wanted;
      for (const std::string &synonym : part.synonyms)
        for (const std::string &name : {side + synonym, letter + synonym, synonym + side, synonym + letter})
          wanted.push_back(name);
      result[letter + "_" + part.name] = indices(simple, wanted);
    }
  return result;
}

} // namespace doublet
