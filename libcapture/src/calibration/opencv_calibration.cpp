// calibration.yml, OpenCV's files of one camera, and EasyMocap's two, all of them cv::FileStorage.

#include "calibration_formats.h"
#include "doublet/core/error.h"
#include "doublet/files/files.h"
#include "opencv_storage.h"

#include <algorithm>
#include <cstdlib>
#include <initializer_list>

namespace doublet::detail {
namespace {

namespace fs = std::filesystem;
using Keys = std::initializer_list<const char *>;

std::vector<double> matrix(const cv::FileStorage &storage, const std::string &key, std::size_t count, const std::string &where) {
  const std::vector<double> numbers = numbers_of(storage[key]);
  if (numbers.size() != count)
    throw Error(where + ": expected " + key + " to be a matrix of " + std::to_string(count) + " numbers, found " +
                (numbers.empty() ? std::string("none") : std::to_string(numbers.size())));
  return numbers;
}

int pixels(const cv::FileStorage &storage, const std::string &key, const std::string &where) {
  if (!storage[key].isInt() || static_cast<int>(storage[key]) <= 0)
    throw Error(where + ": expected " + key + " to be a number of pixels, found none");
  return static_cast<int>(storage[key]);
}

void require_few(std::size_t count, const std::string &where) {
  if (count > kMostCameras)
    throw Error(where + ": expected at most " + std::to_string(kMostCameras) + " cameras, found " + std::to_string(count));
}

// --- calibration.yml

/// What stands before `end` in the keys that end so.
std::vector<std::string> names_before(const cv::FileStorage &storage, const std::string &end, const std::string &where) {
  std::vector<std::string> names;
  for (const cv::FileNode &node : storage.root())
    if (const std::string key = node.name(); key.size() > end.size() && key.ends_with(end))
      names.push_back(key.substr(0, key.size() - end.size()));
  require_few(names.size(), where);
  return names;
}

std::string joined(const std::vector<std::string> &names) {
  std::string text;
  for (const std::string &name : names)
    text += (text.empty() ? "" : ", ") + name;
  return text.empty() ? "no camera" : text;
}

bool fisheye_lens(const cv::FileStorage &storage, const std::string &key, const std::string &where) {
  const cv::FileNode lens = storage[key];
  if (lens.empty())
    return false;
  if (!lens.isString() || static_cast<std::string>(lens) != "fisheye")
    throw Error(where + ": expected " + key + ", if it is there, to be \"fisheye\", found another value");
  return true;
}

int frames_late(const cv::FileStorage &storage, const std::string &key, const std::string &where) {
  const cv::FileNode late = storage[key];
  if (late.empty())
    return 0;
  if (!late.isInt() || std::abs(static_cast<double>(late)) > kMostLate)
    throw Error(where + ": expected " + key + ", if it is there, to be a number of frames, found another value");
  return static_cast<int>(late);
}

CalibratedCamera doublet_camera(const cv::FileStorage &storage, const std::string &name, const fs::path &source) {
  const std::string where = source.string();
  if (storage[name + "_K"].empty())
    throw Error(where + ": expected a calibration of camera '" + name + "' (key " + name + "_K), found " +
                joined(names_before(storage, "_K", where)));
  CalibratedCamera result;
  Camera &camera = result.camera;
  camera.name = name;
  camera.K = matrix_from(matrix(storage, name + "_K", 9, where));
  camera.R = matrix_from(matrix(storage, name + "_R", 9, where));
  camera.t = Eigen::Vector3d(matrix(storage, name + "_t", 3, where).data());
  set_distortion(result, numbers_of(storage[name + "_distortion"]), fisheye_lens(storage, name + "_lens", where),
                 where + ": " + name + "_distortion");
  set_size(result, {pixels(storage, name + "_image_width", where), pixels(storage, name + "_image_height", where)});
  result.late = frames_late(storage, name + "_late", where);
  validate_calibrated(result, where);
  return result;
}

// --- one camera a file

constexpr Keys kMatrixKeys = {"camera_matrix", "Camera_Matrix", "cameraMatrix", "intrinsic_matrix", "intrinsics", "K", "M"};

/// `map`: a file's, or that of a camera in it.
cv::FileNode first_of(const cv::FileNode &map, Keys keys) {
  if (map.isMap())
    for (const char *key : keys)
      if (const cv::FileNode node = map[key]; !node.empty())
        return node;
  return {};
}

std::vector<double> required(const cv::FileNode &map, Keys keys, std::initializer_list<std::size_t> counts,
                             const std::string &where) {
  const std::vector<double> numbers = numbers_of(first_of(map, keys));
  if (std::find(counts.begin(), counts.end(), numbers.size()) != counts.end())
    return numbers;
  std::string expected;
  for (const std::size_t count : counts)
    expected += (expected.empty() ? "" : " or ") + std::to_string(count);
  throw Error(where + ": expected " + *keys.begin() + " to be " + expected + " numbers, found " +
              (numbers.empty() ? std::string("none") : std::to_string(numbers.size())));
}

/// The size in keys of its own or in one list; 0 if there is none.
ImageSize size_in(const cv::FileNode &map, Keys widths, Keys heights, Keys both) {
  const cv::FileNode width = first_of(map, widths), height = first_of(map, heights);
  const auto is_number = [](const cv::FileNode &node) { return node.isInt() || node.isReal(); };
  if (is_number(width) && is_number(height)) // Python's numbers of pixels are often floats
    return size_from({static_cast<double>(width), static_cast<double>(height)});
  return size_from(numbers_of(first_of(map, both)));
}

/// 1 or true, which in YAML is a word to OpenCV.
bool is_set(const cv::FileNode &flag, const std::string &where) {
  if (flag.isInt())
    return static_cast<int>(flag) != 0;
  const std::string word = flag.isString() ? static_cast<std::string>(flag) : std::string();
  if (word == "true" || word == "True")
    return true;
  if (!flag.empty() && word != "false" && word != "False")
    throw Error(where + ": expected " + flag.name() + " to be 1 or 0, true or false, found '" + word + "'");
  return false;
}

bool says_fisheye(const cv::FileNode &map, const std::string &where) {
  const cv::FileNode model = first_of(map, {"distortion_model", "camera_model", "model"});
  if (is_set(first_of(map, {"fisheye_model", "fisheye"}), where))
    return true;
  const std::string name = model.isString() ? static_cast<std::string>(model) : std::string("pinhole");
  if (name == "fisheye" || name == "equidistant")
    return true;
  if (name != "pinhole" && name != "plumb_bob" && name != "rational_polynomial" && name != "brown")
    throw Error(where +
                ": expected the camera model pinhole, plumb_bob, rational_polynomial, brown, fisheye or equidistant, found '" +
                name + "'");
  return false;
}

/// `otherwise`: its name, if the map has none.
CalibratedCamera one_camera(const cv::FileNode &map, const std::string &otherwise, ImageSize size, bool fisheye,
                            const std::string &where) {
  CalibratedCamera result;
  const cv::FileNode name = first_of(map, {"camera_name", "name"});
  result.camera.name = name.isString() ? static_cast<std::string>(name) : otherwise;
  result.camera.K = matrix_from(required(map, kMatrixKeys, {9}, where));
  result.camera.R =
      rotation_from(required(map, {"R", "Rot", "rotation", "rotation_matrix", "rvec", "Rvec", "rotation_vector"}, {9, 3}, where));
  result.camera.t =
      Eigen::Vector3d(required(map, {"T", "t", "tvec", "Tvec", "translation", "translation_vector"}, {3}, where).data());
  const cv::FileNode terms = first_of(
      map, {"distortion_coefficients", "Distortion_Coefficients", "dist_coeffs", "distCoeffs", "distortion", "dist", "D"});
  if (!terms.empty()) // without any, the lens has none
    set_distortion(result, numbers_of(terms), says_fisheye(map, where) || fisheye, where + ": " + terms.name());
  const ImageSize found = size_in(map, {"image_width", "image_Width", "width"}, {"image_height", "image_Height", "height"},
                                  {"image_size", "imageSize", "size"});
  set_size(result, chosen_size(found, size, where));
  return result;
}

/// A file's only camera, or several, each a map of its own: by their names, or listed, in the file or its "cameras".
std::vector<CalibratedCamera> cameras_in(const cv::FileNode &file, const fs::path &path, ImageSize size, bool fisheye) {
  const std::string where = path.string();
  if (!first_of(file, kMatrixKeys).empty())
    return {one_camera(file, path.stem().string(), size, fisheye, where)};
  const cv::FileNode inner = first_of(file, {"cameras"});
  std::vector<CalibratedCamera> cameras;
  std::vector<std::string> found;
  for (const cv::FileNode &node : inner.empty() ? file : inner) {
    found.push_back(node.isNamed() ? node.name() : std::to_string(found.size())); // an entry of a list has none
    if (first_of(node, kMatrixKeys).empty())
      continue;
    require_few(cameras.size() + 1, where);
    cameras.push_back(one_camera(node, found.back(), size, fisheye, where + ": camera '" + found.back() + "'"));
  }
  if (found.size() > 8) // say more than enough
    found.resize(8);
  if (cameras.empty())
    throw Error(where + ": expected camera_matrix, R and T of a camera, or of several by their names, found " + joined(found));
  return cameras;
}

// --- EasyMocap

std::string text_in(const cv::FileNode &node) {
  // A name like 01 is a number to a parser of YAML; EasyMocap writes them in quotes.
  return node.isString() ? static_cast<std::string>(node) : std::string();
}

std::vector<std::string> listed_names(const cv::FileStorage &storage, const std::string &where) {
  std::vector<std::string> names;
  const cv::FileNode list = storage["names"];
  if (list.isSeq())
    for (const cv::FileNode &node : list)
      names.push_back(text_in(node));
  if (names.empty() || std::find(names.begin(), names.end(), "") != names.end())
    throw Error(where + ": expected names to be a list of the cameras' names in quotes, found none");
  require_few(names.size(), where);
  return names;
}

void read_intrinsics(const cv::FileStorage &storage, CalibratedCamera &camera, ImageSize size, const std::string &where) {
  const std::string &name = camera.camera.name;
  camera.camera.K = matrix_from(matrix(storage, "K_" + name, 9, where));
  const std::string key = storage["dist_" + name].empty() ? "D_" + name : "dist_" + name;
  set_distortion(camera, numbers_of(storage[key]), false, where + ": " + key);
  const std::string width = "W_" + name, height = "H_" + name;
  set_size(camera,
           chosen_size(size_in(storage.root(), {width.c_str()}, {height.c_str()}, {}), size, where + ": camera '" + name + "'"));
}

void read_extrinsics(const cv::FileStorage &storage, CalibratedCamera &camera, const std::string &where) {
  const std::string name = camera.camera.name, rotation = "Rot_" + name, vector = "R_" + name;
  camera.camera.R = rotation_from(required(storage.root(), {rotation.c_str(), vector.c_str()}, {9, 3}, where));
  camera.camera.t = Eigen::Vector3d(matrix(storage, "T_" + name, 3, where).data());
}

} // namespace

std::vector<CalibratedCamera> read_doublet_calibration(const fs::path &path, const std::vector<std::string> &names) {
  return read_storage(path, [&](const cv::FileStorage &storage) {
    const std::vector<std::string> chosen = names.empty() ? names_before(storage, "_K", path.string()) : names;
    if (chosen.empty())
      throw Error(path.string() + ": expected keys <camera>_K, found none");
    std::vector<CalibratedCamera> cameras;
    for (const std::string &name : chosen)
      cameras.push_back(doublet_camera(storage, name, path));
    return cameras;
  });
}

std::vector<fs::path> opencv_files(const fs::path &folder) {
  std::vector<fs::path> files;
  for (const auto &entry : fs::directory_iterator(folder))
    if (const std::string end = entry.path().extension().string(), name = entry.path().filename().string();
        name[0] != '.' && // macOS keeps ._cam0.yml beside cam0.yml
        entry.is_regular_file() && (end == ".yml" || end == ".yaml" || end == ".xml" || end == ".json"))
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

std::vector<CalibratedCamera> read_opencv_calibration(const fs::path &path, ImageSize size, bool fisheye) {
  const std::vector<fs::path> files = fs::is_directory(path) ? opencv_files(path) : std::vector<fs::path>{path};
  if (files.empty())
    throw Error(path.string() + ": expected a .yml, .yaml, .xml or .json file for each camera, found none");
  std::vector<CalibratedCamera> cameras;
  for (const fs::path &file : files) {
    const std::vector<CalibratedCamera> found =
        read_storage(file, [&](const cv::FileStorage &storage) { return cameras_in(storage.root(), file, size, fisheye); });
    cameras.insert(cameras.end(), found.begin(), found.end());
  }
  return cameras;
}

std::vector<CalibratedCamera> read_easymocap_calibration(const fs::path &folder, ImageSize size) {
  const fs::path intrinsics = folder / "intri.yml", extrinsics = folder / "extri.yml";
  std::vector<CalibratedCamera> cameras = read_storage(intrinsics, [&](const cv::FileStorage &storage) {
    std::vector<CalibratedCamera> found;
    for (const std::string &name : listed_names(storage, intrinsics.string())) {
      found.emplace_back().camera.name = name;
      read_intrinsics(storage, found.back(), size, intrinsics.string());
    }
    return found;
  });
  return read_storage(extrinsics, [&](const cv::FileStorage &storage) {
    for (CalibratedCamera &camera : cameras)
      read_extrinsics(storage, camera, extrinsics.string());
    return cameras;
  });
}

std::string opencv_dialect(const fs::path &path) {
  return read_storage(path, [&](const cv::FileStorage &storage) -> std::string {
    if (!storage["names"].empty())
      return "easymocap";
    return names_before(storage, "_K", path.string()).empty() ? "opencv" : "doublet";
  });
}

} // namespace doublet::detail
