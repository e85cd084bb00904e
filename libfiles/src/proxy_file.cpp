#include "doublet/core/error.h"
#include "doublet/files/files.h"
#include "doublet/options/options.h"

#include <nlohmann/json.hpp>

#include <cmath>

namespace doublet {

using nlohmann::json;

namespace {

json to_json(const Eigen::Vector3d &p) {
  return {p.x(), p.y(), p.z()};
}

std::string shown(const json &j) {
  return j.dump().substr(0, 60);
}

double number(const json &j, const std::string &what) {
  if (!j.is_number() || !std::isfinite(j.get<double>()))
    throw Error(what + ": expected a number, found " + shown(j));
  return j.get<double>();
}

const json &member(const json &j, const char *key, const std::string &what) {
  if (!j.is_object() || !j.contains(key))
    throw Error(what + ": expected a member '" + key + "', found none");
  return j[key];
}

Eigen::Vector3d point(const json &j, const std::string &what) {
  if (!j.is_array() || j.size() != 3)
    throw Error(what + ": expected three numbers, found " + shown(j));
  return {number(j[0], what), number(j[1], what), number(j[2], what)};
}

TaperedCapsule read_capsule(const json &j, const Skeleton &skeleton, const std::string &what) {
  const json &joint = member(j, "joint", what);
  if (!joint.is_string())
    throw Error(what + ": expected a joint's name, found " + shown(joint));
  TaperedCapsule c;
  try {
    c.joint = skeleton.find(joint.get<std::string>());
  } catch (const Error &error) {
    throw Error(what + ": " + error.what());
  }
  c.p0 = point(member(j, "p0", what), what + ": p0");
  c.p1 = point(member(j, "p1", what), what + ": p1");
  c.r0 = number(member(j, "r0", what), what + ": r0");
  c.r1 = number(member(j, "r1", what), what + ": r1");
  if (c.r0 <= 0 || c.r1 <= 0)
    throw Error(what + ": expected positive radii, found " + options::to_text(c.r0) + " and " + options::to_text(c.r1));
  return c;
}

} // namespace

void write_proxies(const Path &path, const std::vector<TaperedCapsule> &capsules, const Skeleton &skeleton) {
  require_proxies(capsules, skeleton, "write_proxies");
  json list = json::array();
  for (const TaperedCapsule &c : capsules)
    list.push_back(
        {{"joint", skeleton.joints[c.joint].name}, {"p0", to_json(c.p0)}, {"p1", to_json(c.p1)}, {"r0", c.r0}, {"r1", c.r1}});
  write_text(path, json{{"format", kFileFormat}, {"capsules", list}}.dump(1) + "\n");
}

std::vector<TaperedCapsule> read_proxies(const Path &path, const Skeleton &skeleton) {
  const json file = json::parse(read_json_text(path), nullptr, false);
  if (file.is_discarded())
    throw Error(path.string() + ": expected JSON, found something else or a truncated file");
  if (file.is_object() && file.contains("format"))
    require_format(file["format"].is_number_integer() ? file["format"].get<int>() : 0, kFileFormat, path.string());
  const json &list = member(file, "capsules", path.string());
  if (!list.is_array())
    throw Error(path.string() + ": expected a list of capsules, found " + shown(list));
  std::vector<TaperedCapsule> capsules;
  for (std::size_t i = 0; i < list.size(); ++i)
    capsules.push_back(read_capsule(list[i], skeleton, path.string() + ": capsule " + std::to_string(i)));
  return capsules;
}

} // namespace doublet
