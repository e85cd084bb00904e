// Cameras that Metashape exports as "Agisoft XML": sensors with a lens, cameras with a place in the chunk, and the chunk's own in
// the world. Names and meanings: Metashape's manual, appendix on camera models.

#include "calibration_formats.h"
#include "doublet/core/error.h"
#include "doublet/files/files.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <pugixml.hpp>
#include <regex>
#include <sstream>

namespace doublet::detail {
namespace {

namespace fs = std::filesystem;

/// The numbers of an element's text; empty if anything in it is none.
std::vector<double> xml_numbers(const pugi::xml_node &node) {
  std::istringstream text(node.child_value());
  text.imbue(std::locale::classic());
  std::vector<double> result;
  for (double value; text >> value;)
    result.push_back(value);
  return text.eof() ? result : std::vector<double>();
}

double xml_number(const pugi::xml_node &parent, const char *name, double otherwise, const std::string &where) {
  const pugi::xml_node node = parent.child(name);
  if (!node)
    return otherwise;
  const std::vector<double> found = xml_numbers(node);
  if (found.size() != 1)
    throw Error(where + ": expected a number in <" + name + ">, found '" + std::string(node.child_value()).substr(0, 40) + "'");
  return found[0];
}

CalibratedCamera read_sensor(const pugi::xml_node &sensor, const std::string &where) {
  const pugi::xml_node adjusted = sensor.find_child_by_attribute("calibration", "class", "adjusted");
  const pugi::xml_node node = adjusted ? adjusted : sensor.child("calibration");
  const std::string type = node.attribute("type").value();
  if (type != "frame" && type != "fisheye")
    throw Error(where + ": expected a <calibration> of the type frame or fisheye, found '" + type + "'");
  const pugi::xml_node resolution = node.child("resolution") ? node.child("resolution") : sensor.child("resolution");
  CalibratedCamera result;
  set_size(result, size_from({resolution.attribute("width").as_double(), resolution.attribute("height").as_double()}));
  const auto get = [&](const char *name) { return xml_number(node, name, 0, where); };
  const double f = get("f");
  if (result.camera.width == 0 || !(f > 0))
    throw Error(where + ": expected a <resolution> and a focal length <f>, found none");
  // The principal point is that from the image's centre; pixels have their corner, not their centre, at integers.
  const double cx = 0.5 * result.camera.width + get("cx") - 0.5, cy = 0.5 * result.camera.height + get("cy") - 0.5;
  const double affinity = get("b1"), skew = get("b2"); // before the matrix: Eigen asserts that one that is begun is filled
  result.camera.K << f + affinity, skew, cx, 0, f, cy, 0, 0, 1;
  const bool fisheye = type == "fisheye";
  if (get("p3") != 0 || get("p4") != 0 || (fisheye ? get("p1") != 0 || get("p2") != 0 : get("k4") != 0))
    throw Error(where + ": expected a lens of " + (fisheye ? "k1 to k4" : "k1, k2, k3, p1 and p2") +
                ", found one of more terms; calibrate with these alone");
  // Its p1 belongs to r^2 + 2 x^2, which is OpenCV's second.
  set_distortion(result,
                 fisheye ? std::vector<double>{get("k1"), get("k2"), get("k3"), get("k4")}
                         : std::vector<double>{get("k1"), get("k2"), get("p2"), get("p1"), get("k3")},
                 fisheye, where);
  return result;
}

/// A component of the chunk in the world; scale 1 at the origin if it was not brought to one.
struct Place {
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d t = Eigen::Vector3d::Zero();
  double scale = 1;
};

Place read_place(const pugi::xml_node &owner, const std::string &where) {
  Place place;
  const pugi::xml_node node = owner.child("transform");
  if (!node)
    return place;
  const std::vector<double> R = xml_numbers(node.child("rotation")), t = xml_numbers(node.child("translation"));
  place.scale = xml_number(node, "scale", 1, where);
  if ((node.child("rotation") && R.size() != 9) || (node.child("translation") && t.size() != 3) || !(place.scale > 0))
    throw Error(where + ": expected the chunk's <transform> to be a rotation of 9 numbers, a translation of 3 and a scale, found "
                        "something else");
  if (R.size() == 9)
    place.R = matrix_from(R);
  if (t.size() == 3)
    place.t = Eigen::Vector3d(t.data());
  if (place.t.norm() > 1e5)
    throw Error(where + ": expected cameras in local coordinates, found geographic ones (the chunk is " +
                std::to_string(static_cast<long>(place.t.norm() / 1000)) + " km from the origin)");
  return place;
}

/// By component: cameras that were aligned with each other. Older files have one place, that of the chunk.
std::map<std::string, Place> read_places(const pugi::xml_node &chunk, const std::string &where) {
  std::map<std::string, Place> places{{"", read_place(chunk, where)}};
  for (const pugi::xml_node &component : chunk.child("components").children("component"))
    places[component.attribute("id").value()] = read_place(component.child("transform") ? component : chunk, where);
  return places;
}

/// Those in folders, too.
void add_cameras(const pugi::xml_node &folder, std::vector<pugi::xml_node> &cameras) {
  for (const pugi::xml_node &node : folder.children())
    if (std::strcmp(node.name(), "camera") == 0)
      cameras.push_back(node);
    else if (std::strcmp(node.name(), "group") == 0)
      add_cameras(node, cameras);
}

std::string component_of(const pugi::xml_node &camera) {
  return camera.attribute("component_id").value();
}

/// The component of most of the cameras that have a place.
std::string largest_component(const std::vector<pugi::xml_node> &cameras) {
  std::map<std::string, int> count;
  for (const pugi::xml_node &camera : cameras)
    count[component_of(camera)] += camera.child("transform") ? 1 : 0;
  const auto most =
      std::max_element(count.begin(), count.end(), [](const auto &a, const auto &b) { return a.second < b.second; });
  return most == count.end() ? std::string() : most->first;
}

/// A label is the image's name, often without its ending; a dot may as well stand between a rig and its camera.
std::string name_of_label(const std::string &label) {
  static const std::regex ending("\\.(png|jpe?g|jp2|tiff?|bmp|webp|exr|dng|pgm|ppm|mp4|mov|avi|mkv)$", std::regex::icase);
  return std::regex_replace(label, ending, "");
}

void set_pose(CalibratedCamera &camera, const std::vector<double> &m, const Place &place) {
  Eigen::Matrix3d R;
  R << m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10];
  const Eigen::Vector3d centre = place.scale * (place.R * Eigen::Vector3d(m[3], m[7], m[11])) + place.t;
  camera.camera.R = (place.R * R).transpose();
  camera.camera.t = -camera.camera.R * centre;
}

} // namespace

std::vector<CalibratedCamera> read_metashape_calibration(const fs::path &path, std::vector<std::string> &left_out) {
  const std::string text = read_text(path), source = path.string();
  require_shallow(text, Markup::Xml, source);
  pugi::xml_document document;
  if (const pugi::xml_parse_result parsed = document.load_buffer(text.data(), text.size()); !parsed)
    throw Error(source + ": expected XML, found a syntax error at byte " + std::to_string(parsed.offset) + " (" +
                parsed.description() + ")");
  const pugi::xml_node chunk = document.child("document").child("chunk");
  const std::map<std::string, Place> places = read_places(chunk, source);
  std::map<std::string, CalibratedCamera> sensors;
  for (const pugi::xml_node &sensor : chunk.child("sensors").children("sensor"))
    if (sensor.child("calibration"))
      sensors.emplace(sensor.attribute("id").value(),
                      read_sensor(sensor, source + ": sensor '" + sensor.attribute("id").value() + "'"));
  std::vector<pugi::xml_node> nodes;
  add_cameras(chunk.child("cameras"), nodes);
  const std::string component = largest_component(nodes);
  const Place &place = places.at(places.count(component) ? component : "");
  std::vector<CalibratedCamera> cameras;
  for (const pugi::xml_node &node : nodes) {
    const std::string name = node.attribute("label").value(), where = source + ": camera '" + name + "'";
    const std::vector<double> pose = xml_numbers(node.child("transform"));
    if (!node.child("transform")) {
      left_out.push_back("camera '" + name + "' has no pose (it was not aligned)");
      continue;
    }
    if (component_of(node) != component) {
      left_out.push_back("camera '" + name + "' was not aligned with most of the others (it is of another component)");
      continue;
    }
    const auto sensor = sensors.find(node.attribute("sensor_id").value());
    if (sensor == sensors.end() || pose.size() != 16)
      throw Error(where + ": expected a <transform> of 16 numbers and a sensor with a <calibration>, found something else");
    cameras.push_back(sensor->second);
    cameras.back().camera.name = name_of_label(name);
    set_pose(cameras.back(), pose, place);
  }
  if (cameras.empty())
    throw Error(source + ": expected <document><chunk><cameras> with a <camera> that was aligned, found none");
  return cameras;
}

} // namespace doublet::detail
