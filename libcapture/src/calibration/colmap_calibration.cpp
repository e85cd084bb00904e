// COLMAP's cameras and images, text or binary (colmap.github.io/format.html); every count is held against the bytes there are.

#include "calibration_formats.h"
#include "doublet/core/error.h"
#include "doublet/core/parts/number_text.h"
#include "doublet/files/files.h"
#include "doublet/options/options.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <map>
#include <sstream>
#include <string_view>
#include <utility>

namespace doublet::detail {
namespace {

namespace fs = std::filesystem;

/// A model's parameters are its focal lengths, the principal point, and distortion in OpenCV's order, of which the first are
/// given.
struct Model {
  const char *name;
  int id, focal_lengths, terms;
  bool fisheye;
  int parameters() const { return focal_lengths + 2 + terms; }
};
constexpr std::array<Model, 9> kModels{{{"SIMPLE_PINHOLE", 0, 1, 0, false},
                                        {"PINHOLE", 1, 2, 0, false},
                                        {"SIMPLE_RADIAL", 2, 1, 1, false},
                                        {"RADIAL", 3, 1, 2, false},
                                        {"OPENCV", 4, 2, 4, false},
                                        {"OPENCV_FISHEYE", 5, 2, 4, true},
                                        {"FULL_OPENCV", 6, 2, 8, false},
                                        {"SIMPLE_RADIAL_FISHEYE", 8, 1, 1, true},
                                        {"RADIAL_FISHEYE", 9, 1, 2, true}}};

template <class Matches> const Model &find_model(Matches &&matches, const std::string &found, const std::string &where) {
  std::string names;
  for (const Model &model : kModels) {
    if (matches(model))
      return model;
    names += (names.empty() ? "" : ", ") + std::string(model.name);
  }
  throw Error(where + ": expected one of the camera models " + names + ", found " + found);
}

using Intrinsics = std::map<std::int64_t, CalibratedCamera>;

struct Picture {
  std::string name;
  std::int64_t camera = 0;
  Eigen::Vector4d q;
  Eigen::Vector3d t;
};

CalibratedCamera make_intrinsics(const Model &model, double width, double height, const std::vector<double> &p,
                                 const std::string &where) {
  if (!(width > 0 && width < 1e6 && height > 0 && height < 1e6))
    throw Error(where + ": expected an image size of 1 to 1000000 pixels, found another");
  CalibratedCamera result;
  const int f = model.focal_lengths;
  // COLMAP's pixels have their corner, not their centre, at integers.
  result.camera.K << p[0], 0, p[f] - 0.5, 0, p[f - 1], p[f + 1] - 0.5, 0, 0, 1;
  std::vector<double> terms(p.begin() + f + 2, p.end());
  terms.resize(std::max<std::size_t>(terms.size(), 4), 0);
  set_distortion(result, terms, model.fisheye, where);
  set_size(result, {static_cast<int>(width), static_cast<int>(height)});
  return result;
}

// --- text

bool is_content(const std::string &line) {
  const auto begin = line.find_first_not_of(" \t\r");
  return begin != std::string::npos && line[begin] != '#';
}

Intrinsics read_cameras_text(const fs::path &path) {
  Intrinsics cameras;
  std::istringstream text(plain_text(read_text(path), path.string()));
  int number = 0;
  for (std::string line; std::getline(text, line);) {
    const std::string where = path.string() + ": line " + std::to_string(++number);
    if (!is_content(line))
      continue;
    std::istringstream words(line);
    std::int64_t id = 0;
    std::string name;
    double width = 0, height = 0;
    if (!(words >> id >> name >> width >> height))
      throw Error(where + ": expected a camera's number, model, width and height, found something else");
    const Model &model = find_model([&](const Model &m) { return name == m.name; }, "'" + name + "'", where);
    std::vector<double> parameters(model.parameters());
    for (double &parameter : parameters)
      words >> parameter;
    if (!words)
      throw Error(where + ": expected " + std::to_string(model.parameters()) + " parameters of " + model.name + ", found fewer");
    cameras[id] = make_intrinsics(model, width, height, parameters, where);
  }
  return cameras;
}

/// A line of points has three numbers each, or is empty; in models made by hand the next image may stand there instead.
bool is_points(const std::string &line) {
  std::istringstream words(line);
  std::size_t count = 0;
  for (std::string word; words >> word; ++count)
    if (!parse_number(word))
      return false;
  return count % 3 == 0;
}

/// "# Number of images: 4, mean observations ..." as COLMAP writes it; 0 = the file does not say.
std::size_t stated_count(const std::string &line) {
  constexpr std::string_view kSays = "Number of images:";
  const std::size_t at = line.find(kSays);
  return at == std::string::npos ? 0 : std::strtoul(line.c_str() + at + kSays.size(), nullptr, 10);
}

std::vector<Picture> read_images_text(const fs::path &path) {
  std::vector<Picture> pictures;
  std::istringstream text(plain_text(read_text(path), path.string()));
  int number = 0;
  std::size_t stated = 0;
  bool points = false; // may be in this line
  for (std::string line; std::getline(text, line);) {
    ++number;
    if (std::exchange(points, false) && is_points(line))
      continue;
    if (!is_content(line)) {
      stated = std::max(stated, stated_count(line));
      continue;
    }
    std::istringstream words(line);
    Picture picture;
    std::int64_t id = 0;
    words >> id >> picture.q[0] >> picture.q[1] >> picture.q[2] >> picture.q[3] >> picture.t[0] >> picture.t[1] >> picture.t[2] >>
        picture.camera >> std::ws;
    if (!words || !std::getline(words, picture.name))
      throw Error(path.string() + ": line " + std::to_string(number) +
                  ": expected an image's number, quaternion, translation, camera and name, found something else");
    picture.name.erase(picture.name.find_last_not_of(" \t") + 1);
    pictures.push_back(picture);
    points = true;
  }
  if (stated > 0 && stated != pictures.size())
    throw Error(path.string() + ": expected " + std::to_string(stated) + " images as the file says, found " +
                std::to_string(pictures.size()));
  return pictures;
}

// --- binary

class Bytes {
public:
  explicit Bytes(const fs::path &path) : path_(path), data_(read_text(path)) {}

  template <class T> T value() {
    T result;
    std::memcpy(&result, take(sizeof result), sizeof result);
    return result;
  }
  std::string text() {
    const std::size_t end = data_.find('\0', at_);
    if (end == std::string::npos)
      fail();
    const std::string result = data_.substr(at_, end - at_);
    at_ = end + 1;
    return result;
  }
  /// A number of records of at least `size` bytes each.
  std::uint64_t count(std::size_t size) {
    const auto n = value<std::uint64_t>();
    if (n > (data_.size() - at_) / size)
      throw Error(path_.string() + ": expected a complete file, found one that says " + std::to_string(n) + " records and has " +
                  std::to_string(data_.size() - at_) + " bytes left (truncated)");
    return n;
  }
  const char *take(std::size_t size) {
    if (size > data_.size() - at_)
      fail();
    at_ += size;
    return data_.data() + at_ - size;
  }

private:
  [[noreturn]] void fail() const {
    throw Error(path_.string() + ": expected a complete file, found the end after " + std::to_string(data_.size()) +
                " bytes (truncated)");
  }
  fs::path path_;
  std::string data_;
  std::size_t at_ = 0;
};

Intrinsics read_cameras_binary(const fs::path &path) {
  Intrinsics cameras;
  Bytes bytes(path);
  for (std::uint64_t n = bytes.count(24 + 3 * sizeof(double)); n > 0; --n) {
    const std::int64_t id = bytes.value<std::uint32_t>();
    const int model_id = bytes.value<std::int32_t>();
    const std::string where = path.string() + ": camera " + std::to_string(id);
    const Model &model =
        find_model([&](const Model &m) { return model_id == m.id; }, "number " + std::to_string(model_id), where);
    const double width = static_cast<double>(bytes.value<std::uint64_t>()),
                 height = static_cast<double>(bytes.value<std::uint64_t>());
    std::vector<double> parameters(model.parameters());
    for (double &parameter : parameters)
      parameter = bytes.value<double>();
    cameras[id] = make_intrinsics(model, width, height, parameters, where);
  }
  return cameras;
}

std::vector<Picture> read_images_binary(const fs::path &path) {
  std::vector<Picture> pictures;
  Bytes bytes(path);
  for (std::uint64_t n = bytes.count(4 + 7 * sizeof(double) + 4 + 1 + 8); n > 0; --n) {
    Picture picture;
    bytes.value<std::uint32_t>(); // the image's number
    for (double &x : picture.q)
      x = bytes.value<double>();
    for (double &x : picture.t)
      x = bytes.value<double>();
    picture.camera = bytes.value<std::uint32_t>();
    picture.name = bytes.text();
    constexpr std::size_t kPoint = 2 * sizeof(double) + sizeof(std::uint64_t);
    bytes.take(bytes.count(kPoint) * kPoint);
    pictures.push_back(picture);
  }
  return pictures;
}

// --- both

CalibratedCamera posed(const Intrinsics &cameras, const Picture &picture, const std::string &where) {
  const auto found = cameras.find(picture.camera);
  if (found == cameras.end())
    throw Error(where + ": image '" + picture.name + "' is of camera " + std::to_string(picture.camera) +
                ", which the file of cameras does not have");
  if (!(std::abs(picture.q.norm() - 1) < 1e-3))
    throw Error(where + ": image '" + picture.name + "': expected a quaternion of length 1, found " +
                options::to_text(picture.q.norm(), 4));
  CalibratedCamera result = found->second;
  result.camera.R = Eigen::Quaterniond(picture.q[0], picture.q[1], picture.q[2], picture.q[3]).normalized().toRotationMatrix();
  result.camera.t = picture.t;
  return result;
}

} // namespace

std::vector<CalibratedCamera> read_colmap_calibration(const fs::path &folder) {
  const bool binary = fs::exists(folder / "cameras.bin") || fs::exists(folder / "images.bin");
  const fs::path images = folder / (binary ? "images.bin" : "images.txt");
  const Intrinsics cameras = binary ? read_cameras_binary(folder / "cameras.bin") : read_cameras_text(folder / "cameras.txt");
  const std::vector<Picture> pictures = binary ? read_images_binary(images) : read_images_text(images);
  std::vector<std::string> names;
  for (const Picture &picture : pictures)
    names.push_back(picture.name);
  names = camera_names(names);
  std::vector<CalibratedCamera> result;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    result.push_back(posed(cameras, pictures[i], images.string()));
    result.back().camera.name = names[i];
  }
  return result;
}

} // namespace doublet::detail
