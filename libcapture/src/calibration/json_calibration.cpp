// Cameras in JSON: the list of anipose and AIST++, that of CMU's Panoptic Studio, and transforms.json of radiance fields.

#include "calibration_formats.h"
#include "doublet/core/error.h"
#include "doublet/files/files.h"

#include <algorithm>
#include <array>
#include <cmath>
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

// --- transforms.json: what is alike for all frames may stand ahead of them

double number_in(const json &frame, const json &file, const char *key, double otherwise) {
  const json &from = frame.contains(key) ? frame : file;
  return from.value(key, otherwise);
}

Eigen::Matrix3d frame_matrix(const json &frame, const json &file, ImageSize size, const std::string &where) {
  const auto focal_length = [&](const char *key, const char *angle, double pixels, double otherwise) {
    const double opening = number_in(frame, file, angle, 0);
    return number_in(frame, file, key, opening > 0 ? pixels / (2 * std::tan(opening / 2)) : otherwise);
  };
  const double fx = focal_length("fl_x", "camera_angle_x", size.width, 0),
               fy = focal_length("fl_y", "camera_angle_y", size.height, fx);
  if (!(fx > 0))
    throw Error(where + ": expected \"fl_x\" or \"camera_angle_x\", found neither");
  // Pixels have their corner, not their centre, at integers.
  const double cx = number_in(frame, file, "cx", size.width / 2.0) - 0.5,
               cy = number_in(frame, file, "cy", size.height / 2.0) - 0.5;
  Eigen::Matrix3d K;
  K << fx, 0, cx, 0, fy, cy, 0, 0, 1;
  return K;
}

void set_frame_lens(CalibratedCamera &camera, const json &frame, const json &file, const std::string &where) {
  const std::string model = frame.value("camera_model", file.value("camera_model", "OPENCV"));
  constexpr std::array kLensModels{"OPENCV", "OPENCV_FISHEYE", "PINHOLE", "SIMPLE_PINHOLE", "RADIAL", "SIMPLE_RADIAL"};
  if (std::none_of(kLensModels.begin(), kLensModels.end(), [&](const char *known) { return model == known; }))
    throw Error(where + ": expected a \"camera_model\" of a perspective or fisheye lens, found " + model);
  const bool fisheye = model == "OPENCV_FISHEYE" || frame.value("is_fisheye", file.value("is_fisheye", false));
  const auto terms = [&](std::initializer_list<const char *> keys) {
    std::vector<double> found;
    for (const char *key : keys)
      found.push_back(number_in(frame, file, key, 0));
    return found;
  };
  if (!fisheye && number_in(frame, file, "k4", 0) != 0)
    throw Error(where + ": expected no \"k4\" of a lens that is no fisheye, found one");
  set_distortion(camera, fisheye ? terms({"k1", "k2", "k3", "k4"}) : terms({"k1", "k2", "p1", "p2", "k3"}), fisheye, where);
}

/// The pose of a frame maps its camera, which looks along -Z with +Y up, to the world.
void set_frame_pose(Camera &camera, const json &frame, const std::string &where) {
  const std::vector<double> pose = json_required(frame, "transform_matrix", 12, 16, where);
  const Eigen::Matrix<double, 3, 4> to_world = Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(pose.data());
  camera.R = Eigen::Vector3d(1, -1, -1).asDiagonal() * to_world.leftCols<3>().transpose();
  camera.t = -camera.R * to_world.col(3);
}

CalibratedCamera frame_camera(const json &frame, const json &file, ImageSize given, const std::string &where) {
  CalibratedCamera result;
  const ImageSize size = chosen_size(size_from({number_in(frame, file, "w", 0), number_in(frame, file, "h", 0)}), given, where);
  set_size(result, size);
  result.camera.K = frame_matrix(frame, file, size, where);
  set_frame_lens(result, frame, file, where);
  set_frame_pose(result.camera, frame, where);
  return result;
}

} // namespace

std::vector<CalibratedCamera> read_nerfstudio_calibration(const fs::path &path, ImageSize size) try {
  const json file = parse_json(path);
  const json frames = file.is_object() && file.contains("frames") ? file.at("frames") : json();
  require_list(frames, path);
  if (file.value("from_na", false))
    throw Error(path.string() + ": expected cameras that look along -Z, found \"from_na\", with which they do not");
  std::vector<std::string> images;
  std::vector<CalibratedCamera> cameras;
  for (const json &frame : frames) {
    images.push_back(frame.at("file_path"));
    cameras.push_back(frame_camera(frame, file, size, path.string() + ": '" + images.back() + "'"));
  }
  const std::vector<std::string> names = camera_names(images);
  for (std::size_t i = 0; i < cameras.size(); ++i)
    cameras[i].camera.name = frames[i].value("camera_name", names[i]);
  return cameras;
} catch (const json::exception &e) {
  throw Error(path.string() + ": expected frames with their cameras, found an entry that cannot be read (" + e.what() + ")");
}

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
