// Qualisys' calibration file (.qca.txt, XML). The only file that includes pugixml.

#include "calibration_formats.h"
#include "doublet/core/error.h"
#include "doublet/core/parts/number_text.h"
#include "doublet/files/files.h"

#include <algorithm>
#include <cstring>
#include <optional>
#include <pugixml.hpp>
#include <regex>

namespace doublet::detail {
namespace {

namespace fs = std::filesystem;

constexpr double kSubpixels = 64; // focal lengths and centres are in these units of a pixel

double number(const pugi::xml_node &node, const char *name, const std::string &where) {
  const pugi::xml_attribute attribute = node.attribute(name);
  const std::string text = attribute.value();
  if (text.empty())
    throw Error(where + ": expected " + name + " in <" + node.name() + ">, found none");
  const std::optional<double> value = parse_number(text);
  if (!value)
    throw Error(where + ": expected " + name + " in <" + node.name() + "> to be a number, found '" + text.substr(0, 40) + "'");
  return *value;
}

pugi::xml_node child(const pugi::xml_node &camera, const char *name, const std::string &where) {
  const pugi::xml_node node = camera.child(name);
  if (!node)
    throw Error(where + ": expected <" + name + ">, found none");
  return node;
}

void read_intrinsics(const pugi::xml_node &node, const pugi::xml_node &view, CalibratedCamera &camera, const std::string &where) {
  const auto get = [&](const char *name) { return number(node, name, where); };
  const double left = number(view, "left", where), top = number(view, "top", where);
  const double width = number(view, "right", where) - left + 1, height = number(view, "bottom", where) - top + 1;
  if (!(width >= 1 && width < 1e6 && height >= 1 && height < 1e6))
    throw Error(where + ": expected <fov_video> to span 1 to 1000000 pixels each way, found another size");
  set_size(camera, {static_cast<int>(width), static_cast<int>(height)});
  const double fx = get("focalLengthU") / kSubpixels, cx = get("centerPointU") / kSubpixels - left;
  const double fy = get("focalLengthV") / kSubpixels, cy = get("centerPointV") / kSubpixels - top;
  const double skew = get("skew") / kSubpixels;
  camera.camera.K << fx, skew, cx, 0, fy, cy, 0, 0, 1; // all read: an Eigen that checks itself aborts where a list ends early
  set_distortion(camera,
                 {get("radialDistortion1"), get("radialDistortion2"), get("tangentalDistortion1"), get("tangentalDistortion2"),
                  get("radialDistortion3")},
                 false, where);
}

/// The file has the camera's axes, x right, y up, z backward, row by row, and its place.
void read_pose(const pugi::xml_node &node, Camera &camera, const std::string &where) {
  const auto get = [&](const char *name) { return number(node, name, where); };
  std::vector<double> axes;
  for (const char *name : {"r11", "r12", "r13", "r21", "r22", "r23", "r31", "r32", "r33"})
    axes.push_back(get(name));
  camera.R = Eigen::Vector3d(1, -1, -1).asDiagonal() * matrix_from(axes);
  camera.t = -camera.R * Eigen::Vector3d(get("x"), get("y"), get("z"));
}

/// Those whose model says that they film in colour; marker cameras stand in the same file.
bool films(const pugi::xml_node &camera) {
  static const std::regex video("video|hybrid|[0-9]c\\b", std::regex::icase); // Miqus Video, Miqus Hybrid, Oqus 210c
  return std::regex_search(camera.attribute("model").value(), video);
}

} // namespace

std::vector<CalibratedCamera> read_qualisys_calibration(const fs::path &path, std::vector<std::string> &left_out) {
  const std::string text = read_text(path);
  require_shallow(text, Markup::Xml, path.string());
  pugi::xml_document document;
  const pugi::xml_parse_result parsed = document.load_buffer(text.data(), text.size());
  if (!parsed)
    throw Error(path.string() + ": expected XML, found a syntax error at byte " + std::to_string(parsed.offset) + " (" +
                parsed.description() + ")");
  std::vector<CalibratedCamera> cameras;
  const auto nodes = document.child("calibration").child("cameras").children("camera");
  const bool mixed = std::any_of(nodes.begin(), nodes.end(), films); // else any camera may have been set to video
  for (const pugi::xml_node &node : nodes) {
    if (std::strcmp(node.attribute("active").value(), "0") == 0)
      continue;
    if (mixed && !films(node)) {
      left_out.push_back(std::string("camera '") + node.attribute("serial").value() + "' (" + node.attribute("model").value() +
                         ") sees markers and has no video");
      continue;
    }
    CalibratedCamera &camera = cameras.emplace_back();
    camera.camera.name = node.attribute("serial").value();
    const std::string where = path.string() + ": camera '" + camera.camera.name + "'";
    read_intrinsics(child(node, "intrinsic", where), child(node, "fov_video", where), camera, where);
    read_pose(child(node, "transform", where), camera.camera, where);
  }
  if (cameras.empty())
    throw Error(path.string() + ": expected <calibration><cameras> with an active <camera>, found none");
  return cameras;
}

} // namespace doublet::detail
