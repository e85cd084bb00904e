#include "doublet/capture/calibration_file.h"

#include "calibration_formats.h"
#include "doublet/core/error.h"
#include "doublet/core/parts/alignment.h"
#include "doublet/core/parts/number_text.h"
#include "doublet/files/files.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/calib3d.hpp>
#include <optional>
#include <set>

namespace doublet {
namespace {

namespace fs = std::filesystem;
using detail::ImageSize;

constexpr double kNearestCameras = 0.3, kFarthestCameras = 30; // m between the two cameras that are farthest apart
constexpr double kUpright = 0.5; // cosine of the mean picture's lean; cameras look down, not at the ceiling

/// What a format has where its file says nothing.
struct Convention {
  const char *units, *up;
  bool declared; // says so in its definition
};
const std::map<std::string, Convention> kConventions = {
    {"doublet", {"m", "y", true}},         {"opencv", {"m", "y", false}},     {"colmap", {"m", "y", false}},
    {"easymocap", {"m", "z", false}},      {"toml", {"m", "z", false}},       {"qualisys", {"mm", "z", false}},
    {"anipose", {"m", "y", false}},        {"panoptic", {"cm", "-y", false}}, {"metashape", {"m", "z", false}},
    {"opencv_fisheye", {"m", "y", false}}, {"nerfstudio", {"m", "z", false}}, {"actorshq", {"m", "y", false}}};

const std::map<std::string, double> kUnits = {{"m", 1}, {"cm", 0.01}, {"mm", 0.001}};

/// Metres of one unit; 0 if the text is none.
double metres(const std::string &units) {
  if (const auto known = kUnits.find(units); known != kUnits.end())
    return known->second;
  const std::optional<double> factor = parse_number(units);
  return factor && *factor > 0 && std::isfinite(*factor) ? *factor : 0;
}

// --- which format

constexpr const char *kTransforms = "transforms.json"; // as most programs of radiance fields call it

std::string folder_format(const fs::path &folder) {
  for (const char *name : {"cameras.bin", "cameras.txt", "images.bin", "images.txt"})
    if (fs::exists(folder / name))
      return "colmap";
  for (const char *name : {"intri.yml", "extri.yml"})
    if (fs::exists(folder / name))
      return "easymocap";
  if (fs::exists(folder / kTransforms))
    return "nerfstudio";
  if (!detail::opencv_files(folder).empty())
    return "opencv";
  for (const char *inside : {"0", "sparse/0", "sparse"})
    if (fs::exists(folder / inside / "cameras.bin") || fs::exists(folder / inside / "cameras.txt"))
      throw Error(folder.string() + ": expected a folder with a calibration, found a model of COLMAP in a folder inside: say " +
                  (folder / inside).string());
  throw Error(
      folder.string() +
      ": expected cameras.txt or .bin (COLMAP), intri.yml (EasyMocap), transforms.json (Nerfstudio) or OpenCV files, found "
      "none of them");
}

std::string file_format(const fs::path &path) {
  const std::string name = path.filename().string();
  if (name == "intri.yml" || name == "extri.yml")
    return "easymocap";
  if (name == "cameras.bin" || name == "cameras.txt" || name == "images.bin" || name == "images.txt")
    return "colmap";
  if (name == kTransforms)
    return "nerfstudio";
  if (path.extension() == ".toml")
    return "toml";
  if (path.extension() == ".csv")
    return "actorshq";
  const std::string text = plain_text(read_text(path), path.string());
  const std::size_t begin = std::min(text.find_first_not_of(" \t\n"), text.size());
  if (text.compare(begin, 1, "[") == 0)
    return "anipose";
  if (text.compare(begin, 1, "{") == 0 && text.find("\"distCoef\"") != std::string::npos)
    return "panoptic";
  if (text.compare(begin, 1, "{") == 0 && text.find("\"transform_matrix\"") != std::string::npos)
    return "nerfstudio";
  if (text.find("<sensors") != std::string::npos && text.find("<document") != std::string::npos)
    return "metashape";
  if (text.find("<calibration") != std::string::npos)
    return "qualisys";
  if (text.starts_with("%YAML") || text.starts_with("{") || text.find("<opencv_storage") != std::string::npos)
    return detail::opencv_dialect(path);
  throw Error(path.string() +
              ": expected a calibration of OpenCV, COLMAP, EasyMocap, Pose2Sim, Caliscope, anipose, Qualisys, Panoptic "
              "Studio, Metashape, Nerfstudio or ActorsHQ, found a file that looks like none of them (format, --format: says "
              "which it is)");
}

std::string format_of(const fs::path &path, const CalibrationOptions &options) {
  if (!fs::exists(path))
    throw FileNotFound(path.string() + ": the calibration does not exist");
  if (options.format != CalibrationFormat::Found)
    return kCalibrationFormatNames[static_cast<std::size_t>(options.format)];
  return fs::is_directory(path) ? folder_format(path) : file_format(path);
}

std::vector<CalibratedCamera> read_as(const std::string &format, const fs::path &path, ImageSize size,
                                      std::vector<std::string> &left_out) {
  const bool folder = fs::is_directory(path);
  const fs::path inside = folder ? path : path.parent_path();
  if (format == "colmap")
    return detail::read_colmap_calibration(inside);
  if (format == "easymocap")
    return detail::read_easymocap_calibration(inside, size);
  if (format == "opencv" || format == "opencv_fisheye")
    return detail::read_opencv_calibration(path, size, format == "opencv_fisheye");
  if (format == "nerfstudio")
    return detail::read_nerfstudio_calibration(folder ? path / kTransforms : path, size);
  if (folder)
    throw Error(path.string() + ": expected a file, as the format " + format + " is one, found a folder");
  if (format == "toml")
    return detail::read_toml_calibration(path, size, left_out);
  if (format == "anipose")
    return detail::read_anipose_calibration(path, size);
  if (format == "panoptic")
    return detail::read_panoptic_calibration(path, left_out);
  if (format == "metashape")
    return detail::read_metashape_calibration(path, left_out);
  if (format == "actorshq")
    return detail::read_actorshq_calibration(path);
  return format == "qualisys" ? detail::read_qualisys_calibration(path, left_out) : detail::read_doublet_calibration(path);
}

/// What a sentence about all cameras names.
std::string source_of(const std::string &format, const fs::path &path) {
  const fs::path inside = fs::is_directory(path) ? path : path.parent_path();
  if (format == "easymocap")
    return (inside / "intri.yml").string() + " and extri.yml";
  if (format != "colmap")
    return path.string();
  const std::string end = fs::exists(inside / "cameras.bin") ? ".bin" : ".txt";
  return (inside / "cameras").string() + end + " and images" + end;
}

// --- names

bool stands_in_a_file(const std::string &name) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  return !name.empty() && letter(name[0]) && std::all_of(name.begin(), name.end(), [&](char c) {
    return letter(c) || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
}

/// The name with what cannot stand in a key of cv::FileStorage replaced: "01.front" -> "cam01_front".
std::string key_name(std::string name) {
  if (stands_in_a_file(name))
    return name;
  for (char &c : name)
    if (!stands_in_a_file(std::string("a") + c))
      c = '_';
  return stands_in_a_file(name) ? name : "cam" + name;
}

/// The first name that two cameras have; empty if none.
std::string repeated_name(const std::vector<CalibratedCamera> &cameras) {
  std::set<std::string> names;
  for (const CalibratedCamera &camera : cameras)
    if (!names.insert(camera.camera.name).second)
      return camera.camera.name;
  return {};
}

// --- units and axes

const std::map<std::string, Eigen::Vector3d> kAxes = {{"x", {1, 0, 0}},   {"-x", {-1, 0, 0}}, {"y", {0, 1, 0}},
                                                      {"-y", {0, -1, 0}}, {"z", {0, 0, 1}},   {"-z", {0, 0, -1}}};

/// The rotation by the smallest angle that turns the file's up axis to +Y; by half a turn about X for -y.
Eigen::Matrix3d world_from_file(const std::string &up) {
  if (up == "-y")
    return Eigen::Vector3d(1, -1, -1).asDiagonal();
  return shortest_turn(kAxes.at(up), Eigen::Vector3d::UnitY()).array().round();
}

void to_world(Camera &camera, double unit, const std::string &up) {
  camera.R = (camera.R * world_from_file(up).transpose()).eval();
  camera.t *= unit;
}

double widest(const std::vector<CalibratedCamera> &cameras) {
  double distance = 0;
  for (const CalibratedCamera &a : cameras)
    for (const CalibratedCamera &b : cameras)
      distance = std::max(distance, (a.camera.centre() - b.camera.centre()).norm());
  return distance;
}

void require_plausible_distance(const std::vector<CalibratedCamera> &cameras, double unit, const std::string &where) {
  const double distance = widest(cameras);
  if (cameras.size() < 2 || (distance >= kNearestCameras && distance <= kFarthestCameras))
    return;
  std::string fitting;
  for (const auto &[name, other] : kUnits)
    if (const double converted = distance / unit * other; converted >= kNearestCameras && converted <= kFarthestCameras)
      fitting += (fitting.empty() ? "; " : ", ") + name + " would make it " + options::to_text(converted, 4) + " m";
  throw Error(where + ": expected the two cameras farthest apart to be 0.3 to 30 m from each other, found " +
              options::to_text(distance, 4) + " m: say which units the file has (--units m, cm, mm, or metres per unit" +
              fitting + ")");
}

/// Where the pictures' upper edges point, on average, in the world; near zero if cameras look straight down.
Eigen::Vector3d mean_up(const std::vector<CalibratedCamera> &cameras) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const CalibratedCamera &camera : cameras)
    sum -= camera.camera.R.row(1).transpose();
  return sum / static_cast<double>(std::max<std::size_t>(cameras.size(), 1));
}

void require_upright(const std::vector<CalibratedCamera> &cameras, const std::string &up, const std::string &where) {
  const Eigen::Vector3d mean = mean_up(cameras);
  if (mean.norm() < 0.3 || mean.y() > kUpright * mean.norm())
    return;
  const Eigen::Vector3d in_file = world_from_file(up).transpose() * mean;
  const auto nearest = std::max_element(
      kAxes.begin(), kAxes.end(), [&](const auto &a, const auto &b) { return a.second.dot(in_file) < b.second.dot(in_file); });
  throw Error(where + ": expected the file's " + up + " axis to point up, found that the pictures' upper edges point along " +
              nearest->first + ": say which axis points up (--up=" + nearest->first + ", or --up=" + up +
              " if the cameras do lie on their sides)");
}

void require_size(const Camera &camera, ImageSize given, const std::string &where) {
  const auto differs = [](int expected, int found) { return expected != 0 && expected != found; };
  if (differs(given.width, camera.width) || differs(given.height, camera.height))
    throw Error(where + ": camera '" + camera.name + "': expected images of " + std::to_string(given.width) + " x " +
                std::to_string(given.height) + " pixels as image_width and image_height say, found " +
                std::to_string(camera.width) + " x " + std::to_string(camera.height));
}

} // namespace

namespace {

struct Projected {
  Eigen::Vector2d pixel;
  Eigen::Matrix<double, 2, 3> by_point; ///< d pixel / d point of the camera's frame
};

/// `p` in the camera's frame, through a lens that is undone elsewhere.
Projected project_through(const Lens &lens, const Eigen::Matrix3d &camera_K, const Eigen::Vector3d &p) {
  detail::require_lens(lens);
  const std::vector<cv::Point3d> points{{p.x(), p.y(), p.z()}};
  const cv::Matx33d K(camera_K(0, 0), 0, camera_K(0, 2), 0, camera_K(1, 1), camera_K(1, 2), 0, 0, 1);
  const std::vector<double> terms(lens.distortion.begin(), lens.distortion.end());
  std::vector<cv::Point2d> pixels;
  cv::Mat jacobian;
  if (lens.fisheye)
    cv::fisheye::projectPoints(points, pixels, cv::Vec3d::all(0), cv::Vec3d::all(0), K, terms, 0, jacobian);
  else
    cv::projectPoints(points, cv::Vec3d::all(0), cv::Vec3d::all(0), K, terms, pixels, jacobian);
  const int translation = lens.fisheye ? 11 : 3; // its first column; without a rotation a point moves as the camera's frame does
  Projected result{{pixels[0].x, pixels[0].y}, {}};
  for (int row = 0; row < 2; ++row)
    for (int column = 0; column < 3; ++column)
      result.by_point(row, column) = jacobian.at<double>(row, translation + column);
  return result;
}

} // namespace

Eigen::Vector2d CalibratedCamera::project(const Eigen::Vector3d &point) const {
  return lens.needs_undistortion() ? project_through(lens, camera.K, camera.R * point + camera.t).pixel : camera.project(point);
}

Eigen::Matrix<double, 2, 3> CalibratedCamera::project_jacobian(const Eigen::Vector3d &point) const {
  return lens.needs_undistortion() ? project_through(lens, camera.K, camera.R * point + camera.t).by_point * camera.R
                                   : camera.project_jacobian(point);
}

void CalibrationOptions::validate() const {
  options::check(*this);
  if (units != "found" && metres(units) == 0)
    throw std::invalid_argument(
        "CalibrationOptions: units: expected 'found', 'm', 'cm', 'mm' or a positive number of metres, found '" + units + "'");
}

std::vector<CalibratedCamera> read_calibration(const fs::path &path, const CalibrationOptions &options, const Context &context) {
  options.validate();
  const std::string format = format_of(path, options), where = source_of(format, path);
  const Convention &convention = kConventions.at(format);
  const ImageSize size{options.image_width, options.image_height};
  std::vector<std::string> left_out;
  std::vector<CalibratedCamera> cameras = read_as(format, path, size, left_out);
  if (cameras.empty())
    throw Error(where + ": expected at least one camera, found none");
  const double unit = metres(options.units == "found" ? convention.units : options.units);
  const std::string up = options.up == UpAxis::Found ? convention.up : kUpAxisNames[static_cast<std::size_t>(options.up)];
  for (CalibratedCamera &camera : cameras) {
    camera.camera.name = key_name(camera.camera.name);
    to_world(camera.camera, unit, up);
    detail::validate_calibrated(camera, where);
    require_size(camera.camera, size, where);
  }
  if (const std::string name = repeated_name(cameras); !name.empty())
    throw Error(where + ": expected the names of cameras to differ, found '" + name + "' twice");
  if (!convention.declared || options.units != "found")
    require_plausible_distance(cameras, unit, where);
  if (!convention.declared && options.up == UpAxis::Found)
    require_upright(cameras, up, where);
  for (const std::string &sentence : left_out)
    context.log_line(where + ": " + sentence + ": left out");
  return cameras;
}

namespace detail {

void set_distortion(CalibratedCamera &camera, const std::vector<double> &terms, bool fisheye, const std::string &where) {
  const std::size_t count = terms.size();
  if (fisheye ? count != 4 : count != 4 && count != 5 && count != 8 && count != 12 && count != 14)
    throw Error(where + ": expected " + (fisheye ? "4 numbers of a fisheye lens" : "4, 5, 8, 12 or 14 numbers of distortion") +
                ", found " + (terms.empty() ? std::string("none") : std::to_string(count)));
  const std::size_t held = 5; // by Camera::distortion
  if (!fisheye && std::all_of(terms.begin() + std::min(held, count), terms.end(), [](double k) { return k == 0; })) {
    std::copy_n(terms.begin(), std::min(held, count), camera.camera.distortion.begin());
    return;
  }
  camera.lens.fisheye = fisheye;
  camera.lens.distortion = Eigen::Map<const Eigen::VectorXd>(terms.data(), static_cast<Eigen::Index>(count));
}

Eigen::Matrix3d matrix_from(const std::vector<double> &numbers) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(numbers.data());
}

Eigen::Matrix3d rotation_from(const std::vector<double> &numbers) {
  if (numbers.size() == 9)
    return matrix_from(numbers);
  const Eigen::Vector3d vector(numbers.data());
  const double angle = vector.norm();
  return angle == 0 ? Eigen::Matrix3d::Identity() : Eigen::AngleAxisd(angle, vector / angle).toRotationMatrix();
}

ImageSize size_from(const std::vector<double> &numbers) {
  const auto sane = [](double pixels) { return pixels >= 1 && pixels < 1e6; };
  if (numbers.size() != 2 || !sane(numbers[0]) || !sane(numbers[1]))
    return {};
  return {static_cast<int>(numbers[0]), static_cast<int>(numbers[1])};
}

ImageSize chosen_size(ImageSize found, ImageSize given, const std::string &where) {
  if (found.width > 0 && found.height > 0)
    return found;
  if (given.width == 0 || given.height == 0)
    throw Error(where + ": expected a size of the images, found none: say it (--image-size WxH)");
  return given;
}

void set_size(CalibratedCamera &camera, ImageSize size) {
  camera.camera.width = size.width;
  camera.camera.height = size.height;
}

std::vector<std::string> camera_names(const std::vector<std::string> &images) {
  std::vector<std::string> stems, folders, paths;
  for (const std::string &image : images) {
    stems.push_back(fs::path(image).stem().string());
    folders.push_back(fs::path(image).parent_path().filename().string());
    paths.push_back(fs::path(image).parent_path().string());
  }
  for (const std::vector<std::string> *names : {&stems, &folders, &paths})
    if (const std::set<std::string> different(names->begin(), names->end());
        different.size() == names->size() && !different.count(""))
      return *names;
  return stems;
}

void require_lens(const Lens &lens) {
  const auto count = lens.distortion.size();
  if (lens.fisheye ? count != 4 : lens.needs_undistortion() && count != 8 && count != 12 && count != 14)
    throw std::invalid_argument("lens: expected 8, 12 or 14 numbers of distortion, or the 4 of a fisheye, found " +
                                std::to_string(count));
}

void validate_calibrated(const CalibratedCamera &camera, const std::string &source) {
  validate_camera(camera.camera, source);
  const std::string where = source + ": camera '" + camera.camera.name + "'";
  if (!camera.lens.distortion.allFinite())
    throw Error(where + ": expected finite numbers in distortion, found NaN or infinity");
  require_lens(camera.lens);
  if (camera.lens.needs_undistortion() && camera.camera.K(0, 1) != 0)
    throw Error(where + ": expected no skew in K beside a lens of more than five terms, found " +
                options::to_text(camera.camera.K(0, 1), 4));
  if (camera.lens.needs_undistortion() && camera.camera.distorted())
    throw Error(where + ": expected the distortion in the lens or in the camera, found both");
  if (camera.late < -kMostLate || camera.late > kMostLate)
    throw Error(where + ": expected it to be late by at most " + std::to_string(kMostLate) + " frames, found " +
                std::to_string(camera.late));
}

} // namespace detail

namespace {

void write_matrix(cv::FileStorage &storage, const std::string &key, int rows, int cols, std::vector<double> values) {
  storage << key << cv::Mat(rows, cols, CV_64F, values.data());
}

void write_camera(cv::FileStorage &storage, const CalibratedCamera &calibrated) {
  const Camera &camera = calibrated.camera;
  const std::string &name = camera.name;
  const auto row_by_row = [](const auto &m) {
    const Eigen::Matrix<double, 3, 3, Eigen::RowMajor> rows = m;
    return std::vector<double>(rows.data(), rows.data() + 9);
  };
  const auto flat = [](const auto &v) { return std::vector<double>(v.begin(), v.end()); };
  const std::vector<double> terms =
      calibrated.lens.needs_undistortion() ? flat(calibrated.lens.distortion) : flat(camera.distortion);
  write_matrix(storage, name + "_K", 3, 3, row_by_row(camera.K));
  write_matrix(storage, name + "_distortion", 1, static_cast<int>(terms.size()), terms);
  if (calibrated.lens.fisheye)
    storage << name + "_lens"
            << "fisheye";
  write_matrix(storage, name + "_R", 3, 3, row_by_row(camera.R));
  write_matrix(storage, name + "_t", 3, 1, flat(camera.t));
  if (calibrated.late != 0)
    storage << name + "_late" << calibrated.late;
  storage << name + "_image_width" << camera.width << name + "_image_height" << camera.height;
}

} // namespace

void write_calibration(const fs::path &path, const std::vector<CalibratedCamera> &cameras) {
  if (cameras.empty())
    throw std::invalid_argument("cameras: expected at least one, found none");
  if (const std::string name = repeated_name(cameras); !name.empty())
    throw std::invalid_argument("cameras: expected names that differ, found '" + name + "' twice");
  for (const CalibratedCamera &camera : cameras) {
    if (!stands_in_a_file(camera.camera.name))
      throw std::invalid_argument("cameras: expected names of letters, digits, _ and -, beginning with a letter, found '" +
                                  camera.camera.name + "'");
    detail::validate_calibrated(camera, path.string());
  }
  cv::FileStorage storage(".yml", cv::FileStorage::WRITE | cv::FileStorage::MEMORY);
  storage << "camera_count" << static_cast<int>(cameras.size());
  for (const CalibratedCamera &camera : cameras)
    write_camera(storage, camera);
  write_text(path, storage.releaseAndGetString());
}

} // namespace doublet
