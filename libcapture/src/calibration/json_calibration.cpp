// Cameras in JSON: the list of anipose and AIST++, and that of CMU's Panoptic Studio.

#include "calibration_formats.h"
#include "doublet/core/error.h"
#include "doublet/files/files.h"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace doublet::detail {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

json parse_json(const fs::path &path) {
  const std::string text = read_json_text(path);
  try {
    return json::parse(text);
  } catch (const json::exception &e) {
    throw Error(path.string() + ": expected JSON, found a syntax error (" + e.what() + ")");
  }
}

/// Numbers of a list, or of a list of lists; empty if anything in it is no number.
std::vector<double> json_numbers(const json &list) {
  std::vector<double> result;
  for (const json &element : list)
    for (const json &number : element.is_array() ? element : json::array({element})) {
      if (!number.is_number())
        return {};
      result.push_back(number.get<double>());
    }
  return result;
}

std::vector<double> json_required(const json &camera, const char *key, std::size_t count, std::size_t or_count,
                                  const std::string &where) {
  const std::vector<double> found = camera.contains(key) ? json_numbers(camera.at(key)) : std::vector<double>();
  if (found.size() != count && found.size() != or_count)
    throw Error(where + ": expected \"" + key + "\" to be " + std::to_string(count) +
                (or_count == count ? "" : " or " + std::to_string(or_count)) + " numbers, found " +
                (found.empty() ? "none" : std::to_string(found.size())));
  return found;
}

/// The names of a format's keys.
struct JsonKeys {
  const char *size, *matrix, *rotation, *translation, *distortion;
};

CalibratedCamera json_camera(const json &camera, const JsonKeys &keys, ImageSize size, const std::string &source) {
  CalibratedCamera result;
  result.camera.name = camera.is_object() && camera.contains("name") && camera.at("name").is_string()
                           ? camera.at("name").get<std::string>()
                           : throw Error(source + ": expected cameras with a \"name\", found " + camera.dump().substr(0, 60));
  const std::string where = source + ": camera '" + result.camera.name + "'";
  result.camera.K = matrix_from(json_required(camera, keys.matrix, 9, 9, where));
  result.camera.R = rotation_from(json_required(camera, keys.rotation, 3, 9, where));
  result.camera.t = Eigen::Vector3d(json_required(camera, keys.translation, 3, 3, where).data());
  if (camera.contains(keys.distortion))
    set_distortion(result, json_numbers(camera.at(keys.distortion)), camera.value("fisheye", false),
                   where + ": " + keys.distortion);
  const ImageSize found = camera.contains(keys.size) ? size_from(json_numbers(camera.at(keys.size))) : ImageSize{};
  set_size(result, chosen_size(found, size, where));
  return result;
}

void require_list(const json &list, const fs::path &path) {
  if (!list.is_array() || list.empty() || list.size() > kMostCameras)
    throw Error(path.string() + ": expected a list of 1 to " + std::to_string(kMostCameras) + " cameras, found " +
                (list.is_array() ? std::to_string(list.size()) : list.dump().substr(0, 60)));
}

bool is_hd(const json &camera) {
  return camera.is_object() && camera.value("type", json("")) == "hd";
}

} // namespace

std::vector<CalibratedCamera> read_anipose_calibration(const fs::path &path, ImageSize size) try {
  const json list = parse_json(path);
  require_list(list, path);
  std::vector<CalibratedCamera> cameras;
  for (const json &camera : list)
    cameras.push_back(json_camera(camera, {"size", "matrix", "rotation", "translation", "distortions"}, size, path.string()));
  return cameras;
} catch (const json::exception &e) {
  throw Error(path.string() + ": expected a list of cameras, found an entry that cannot be read (" + e.what() + ")");
}

std::vector<CalibratedCamera> read_panoptic_calibration(const fs::path &path, std::vector<std::string> &left_out) try {
  const json file = parse_json(path);
  const json list = file.is_object() && file.contains("cameras") ? file.at("cameras") : json();
  require_list(list, path);
  const bool mixed = std::any_of(list.begin(), list.end(), is_hd);
  std::size_t others = 0;
  std::vector<CalibratedCamera> cameras;
  for (const json &camera : list)
    if (mixed && !is_hd(camera))
      ++others;
    else
      cameras.push_back(json_camera(camera, {"resolution", "K", "R", "t", "distCoef"}, {}, path.string()));
  if (others > 0)
    left_out.push_back(std::to_string(others) + " cameras that are not of the type \"hd\"");
  return cameras;
} catch (const json::exception &e) {
  throw Error(path.string() + ": expected cameras of the Panoptic Studio, found an entry that cannot be read (" + e.what() + ")");
}

} // namespace doublet::detail
