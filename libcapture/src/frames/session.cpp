#include "doublet/capture/session.h"

#include "calibration/calibration_formats.h"
#include "doublet/core/context.h"
#include "doublet/core/error.h"
#include "doublet/files/files.h"
#include "doublet/options/options.h"
#include "frame_reader.h"
#include "keypoint_file.h"

#include <cctype>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>

namespace doublet {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json; // keeps the order of joints in the file
constexpr int kMostFrames = 100'000'000;
constexpr int kMostKeys = 20'000; // of a file: an ordered object looks for every new key among all

Json read_json(const fs::path &path) {
  const std::string text = read_json_text(path);
  int keys = 0;
  const auto bounded = [&](int, Json::parse_event_t event, const Json &) {
    if (event == Json::parse_event_t::key && ++keys > kMostKeys)
      throw Error(path.string() + ": expected at most " + std::to_string(kMostKeys) + " keys, found more");
    return true;
  };
  try {
    return Json::parse(text, bounded);
  } catch (const nlohmann::json::exception &e) {
    throw Error(path.string() + ": expected JSON, found a syntax error (" + e.what() + ")");
  }
}

/// One value of a JSON object, with the file and the key in every message.
template <class T> T value(const Json &object, const std::string &key, const std::string &where, const std::string &kind) {
  if (!object.is_object() || !object.contains(key))
    throw Error(where + ": expected \"" + key + "\" (" + kind + "), found none");
  try {
    return object.at(key).get<T>();
  } catch (const nlohmann::json::exception &) {
    throw Error(where + ": expected \"" + key + "\" to be " + kind + ", found " + object.at(key).dump().substr(0, 60));
  }
}

/// A whole number that an int can hold: the parser would make one of any number, and of true.
int whole_number(const Json &object, const std::string &key, const std::string &where, const std::string &kind) {
  const double number = value<double>(object, key, where, kind);
  if (number != std::floor(number) || std::abs(number) > std::numeric_limits<int>::max())
    throw Error(where + ": expected \"" + key + "\" to be " + kind + ", found " + object.at(key).dump().substr(0, 60));
  return static_cast<int>(number);
}

std::string text_or(const Json &object, const std::string &key, const std::string &where) {
  return object.contains(key) ? value<std::string>(object, key, where, "a text") : std::string();
}

Eigen::Vector3d point(const Json &object, const std::string &key, const std::string &where) {
  const auto xyz = value<std::vector<double>>(object, key, where, "three numbers");
  if (xyz.size() != 3 || !std::isfinite(xyz[0]) || !std::isfinite(xyz[1]) || !std::isfinite(xyz[2]))
    throw Error(where + ": expected \"" + key + "\" to be three numbers in metres, found " + object.at(key).dump().substr(0, 60));
  return {xyz[0], xyz[1], xyz[2]};
}

/// A file's name in a session, which the system can look for.
fs::path named(const fs::path &folder, const std::string &name, const std::string &what, const fs::path &source) {
  constexpr std::size_t kLongest = 255, kLongestPath = 4095; // bytes, on any disk
  for (const fs::path &part : fs::path(name.substr(0, kLongestPath + 1)))
    if (name.size() > kLongestPath || part.string().size() > kLongest || part.string().find('\0') != std::string::npos)
      throw Error(source.string() + ": expected the name of a " + what + " of at most 255 characters, found " +
                  std::to_string(name.size()));
  return folder / name;
}

fs::path existing(const fs::path &folder, const std::string &name, const std::string &what, const fs::path &source) {
  const fs::path path = named(folder, name, what, source);
  if (!fs::is_regular_file(path))
    throw FileNotFound(path.string() + ": the " + what + " that " + source.string() + " names does not exist");
  return path;
}

/// A video or an image series is there; what is in it is looked at later.
fs::path existing_frames(const fs::path &folder, const std::string &name, const std::string &what, const fs::path &source) {
  const fs::path path = named(folder, name, what, source);
  if (!detail::is_image_pattern(path))
    return existing(folder, name, what, source);
  if (!detail::image_series_exists(path))
    throw FileNotFound(path.string() + ": the " + what + " that " + source.string() + " names has no image numbered 0 or 1");
  return path;
}

/// masks/<camera>_%04d.png or masks/<camera>/%04d.png, for sessions that have masks but no videos.
fs::path masks_by_name(const fs::path &folder, const std::string &camera) {
  for (const fs::path &path : {folder / "masks" / (camera + "_%04d.png"), folder / "masks" / camera / "%04d.png"})
    if (detail::image_series_exists(path))
      return path;
  return {};
}

bool ends_as_image(const std::string &name) {
  std::string end = fs::path(name).extension().string();
  for (char &c : end)
    c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return end == ".png" || end == ".jpg" || end == ".jpeg" || end == ".bmp" || end == ".tif" || end == ".tiff";
}

/// Clean plates: `background` of the camera, or of the session as a pattern with {camera} or a folder of <camera>.png. Any other
/// text there describes the stage.
fs::path read_background(const Json &json, const Json &camera, const std::string &name, const fs::path &folder,
                         const fs::path &source) {
  const std::string what = "clean plate of camera '" + name + "'", key = "{camera}";
  if (camera.contains("background"))
    return existing_frames(
        folder, value<std::string>(camera, "background", source.string() + ": camera '" + name + "'", "a text"), what, source);
  std::string text = text_or(json, "background", source.string());
  if (text.empty())
    return {};
  if (fs::is_directory(named(folder, text, what, source)))
    text += "/" + key + ".png";
  else if (text.find(key) == text.npos && !ends_as_image(text))
    return {};
  for (auto at = text.find(key); at != text.npos; at = text.find(key, at + name.size()))
    text.replace(at, key.size(), name);
  return existing_frames(folder, text, what, source);
}

SessionCamera read_camera(const Json &object, const fs::path &folder, const fs::path &source) {
  SessionCamera camera;
  camera.name = value<std::string>(object, "name", source.string() + ": cameras", "a text");
  named(folder, camera.name + "_0000.png", "camera", source);
  const std::string where = source.string() + ": camera '" + camera.name + "'";
  const std::string video = text_or(object, "video", where), masks = text_or(object, "masks", where);
  if (!video.empty())
    camera.video = existing_frames(folder, video, "video of camera '" + camera.name + "'", source);
  if (!masks.empty())
    camera.masks = existing_frames(folder, masks, "mask series of camera '" + camera.name + "'", source);
  if (camera.video.empty() && camera.masks.empty())
    camera.masks = masks_by_name(folder, camera.name);
  if (object.contains("first_frame"))
    camera.first_frame = whole_number(object, "first_frame", where, "a number of frames");
  if (camera.first_frame < 0 || camera.first_frame > kMostFrames)
    throw Error(where + ": expected \"first_frame\" to be in [0, " + std::to_string(kMostFrames) + "], found " +
                std::to_string(camera.first_frame));
  if (camera.video.empty() && camera.masks.empty())
    throw Error(where + ": expected \"video\" or \"masks\", found neither, nor masks/" + camera.name + "_0000.png");
  return camera;
}

std::vector<SessionCamera> read_cameras(const Json &json, const fs::path &folder, const fs::path &source) {
  const auto list = value<Json>(json, "cameras", source.string(), "a list");
  if (!list.is_array() || list.empty())
    throw Error(source.string() + ": expected \"cameras\" to be a list of at least one camera, found " +
                list.dump().substr(0, 60));
  std::vector<SessionCamera> cameras;
  std::set<std::string> names;
  for (const Json &object : list) {
    cameras.push_back(read_camera(object, folder, source));
    cameras.back().background = read_background(json, object, cameras.back().name, folder, source);
    if (!names.insert(cameras.back().name).second)
      throw Error(source.string() + ": expected camera names to differ, found '" + cameras.back().name + "' twice");
  }
  return cameras;
}

void read_rig(Session &session) {
  std::vector<std::string> names;
  for (const SessionCamera &camera : session.cameras)
    names.push_back(camera.name);
  session.rig.clear();
  session.lenses.clear();
  for (CalibratedCamera &calibrated : detail::read_doublet_calibration(session.calibration, names)) {
    session.cameras[session.rig.size()].late = calibrated.late;
    session.rig.push_back(std::move(calibrated.camera));
    session.lenses.push_back(std::move(calibrated.lens));
  }
}

JointAnnotation read_joint(const std::string &name, const Json &object, const fs::path &source) {
  const std::string where = source.string() + ": joint '" + name + "'";
  JointAnnotation mark;
  mark.name = name;
  mark.position = point(object, "position", where);
  if (object.contains("parent") && !object.at("parent").is_null())
    mark.parent = value<std::string>(object, "parent", where, "the name of a joint, or null for the root");
  if (object.contains("dof") && !object.at("dof").is_null())
    mark.dof = whole_number(object, "dof", where, "0, 1, 2, 3 or 6");
  return mark;
}

void read_joints(const fs::path &path, Session &session) {
  const Json json = read_json(path);
  const auto joints = value<Json>(json, "joints", path.string(), "an object");
  const Json landmarks = json.contains("landmarks") ? json.at("landmarks") : Json::object();
  constexpr std::size_t kMost = 1000; // each is looked for among all
  for (const auto &[name, list] : {std::pair<const char *, const Json &>{"joints", joints}, {"landmarks", landmarks}})
    if (list.size() > kMost)
      throw Error(path.string() + ": expected at most " + std::to_string(kMost) + " " + name + ", found " +
                  std::to_string(list.size()));
  for (const auto &[name, object] : joints.items())
    session.joints.push_back(read_joint(name, object, path));
  std::set<std::string> names;
  for (const JointAnnotation &mark : session.joints)
    names.insert(mark.name);
  for (const JointAnnotation &mark : session.joints)
    if (!mark.parent.empty() && !names.count(mark.parent))
      throw Error(path.string() + ": joint '" + mark.name + "' has the unknown parent '" + mark.parent + "'");
  try {
    make_skeleton(session.joints);
  } catch (const Error &e) {
    throw Error(path.string() + ": " + e.what());
  }
  for (const auto &[name, unused] : landmarks.items())
    session.landmarks[name] = point(landmarks, name, path.string() + ": landmarks");
}

/// Returns the frame rate that the file states; 0 = none.
double check_frames(const fs::path &path, int frame_count, const Camera &camera) try {
  if (path.empty())
    return 0;
  const auto [size, fps] = detail::probe_frames(path, frame_count);
  if (size.width != camera.width || size.height != camera.height)
    throw Error(path.string() + ": expected " + std::to_string(camera.width) + " x " + std::to_string(camera.height) +
                " pixels as the calibration of camera '" + camera.name + "' says, found " + std::to_string(size.width) + " x " +
                std::to_string(size.height));
  return fps;
} catch (const cv::Exception &e) {
  throw Error(path.string() + ": cannot be read (" + e.err + ")");
}

void check_plates(const fs::path &path, const Camera &camera) {
  if (path.empty())
    return;
  for (const Image &plate : detail::read_plates(path))
    if (plate.width != camera.width || plate.height != camera.height)
      throw Error(path.string() + ": expected " + std::to_string(camera.width) + " x " + std::to_string(camera.height) +
                  " pixels as the calibration of camera '" + camera.name + "' says, found " + std::to_string(plate.width) +
                  " x " + std::to_string(plate.height));
}

} // namespace

Session recalibrated(const Session &session, const fs::path &calibration) {
  if (!fs::is_regular_file(calibration))
    throw FileNotFound(calibration.string() + ": expected a calibration, found no such file");
  Session result = session;
  result.calibration = fs::absolute(calibration).lexically_normal();
  read_rig(result);
  for (std::size_t c = 0; c < result.rig.size(); ++c)
    if (const Camera &before = session.rig.at(c), &now = result.rig[c]; now.width != before.width || now.height != before.height)
      throw Error(calibration.string() + ": expected " + std::to_string(before.width) + " x " + std::to_string(before.height) +
                  " pixels of camera '" + now.name + "', found " + std::to_string(now.width) + " x " +
                  std::to_string(now.height));
  return result;
}

Session read_session(const fs::path &folder) {
  detail::quiet_opencv();
  Session session;
  session.folder = fs::absolute(folder).lexically_normal();
  const fs::path source = session.folder / "session.json";
  if (!fs::is_regular_file(source)) {
    const char *found = fs::is_directory(session.folder) ? "no session.json in it"
                        : fs::exists(session.folder)     ? "a file"
                                                         : "no such folder";
    throw FileNotFound(session.folder.string() + ": expected the folder of a session, found " + found +
                       "; `doublet new-session` makes one from videos");
  }
  const Json json = read_json(source);
  const std::string where = source.string();
  session.name = value<std::string>(json, "name", where, "a text");
  session.fps = value<double>(json, "fps", where, "frames per second");
  session.frame_count = whole_number(json, "frame_count", where, "a number of frames");
  if (!(session.fps > 0) || !std::isfinite(session.fps))
    throw Error(where + ": expected \"fps\" to be positive, found " + options::to_text(session.fps));
  if (session.frame_count < 1 || session.frame_count > kMostFrames)
    throw Error(where + ": expected \"frame_count\" to be in [1, " + std::to_string(kMostFrames) + "], found " +
                std::to_string(session.frame_count));
  session.cameras = read_cameras(json, session.folder, source);
  if (const std::string scan = text_or(json, "scan", where); !scan.empty())
    session.scan = existing(session.folder, scan, "scan", source);
  if (json.contains("scan_from_views"))
    session.scan_from_views = value<bool>(json, "scan_from_views", where, "true or false");
  if (const std::string motion = text_or(json, "new_motion", where); !motion.empty())
    session.new_motion = existing(session.folder, motion, "new motion", source);
  session.calibration =
      existing(session.folder, value<std::string>(json, "calibration", where, "a file name"), "calibration", source);
  read_rig(session);
  if (const std::string markers = text_or(json, "markers", where); !markers.empty()) {
    session.markers = existing(session.folder, markers, "file of joints", source);
    read_joints(session.markers, session);
  }
  parallel_for({}, static_cast<int>(session.cameras.size()), [&](int c) { // each waits for programs that decode
    SessionCamera &camera = session.cameras[c];
    const int needed = camera.first_frame + session.frame_count;
    camera.video_fps = check_frames(camera.video, needed, session.rig[c]);
    check_frames(camera.masks, needed, session.rig[c]);
    check_plates(camera.background, session.rig[c]);
  });
  if (const std::string keypoints = text_or(json, "keypoints", where); !keypoints.empty()) {
    session.keypoints = existing(session.folder, keypoints, "file of keypoints", source);
    detail::read_keypoints(session.keypoints, session.cameras, session.frame_count);
  }
  return session;
}

void require_scanned(const Session &session) {
  const std::string missing = session.scan.empty() ? "\"scan\" (a file name)" : "\"markers\" (the file of joints)";
  if (session.scan.empty() || session.markers.empty())
    throw Error((session.folder / "session.json").string() + ": expected " + missing +
                ", found none; `doublet scan` makes scan and joints from the cameras");
}

} // namespace doublet
