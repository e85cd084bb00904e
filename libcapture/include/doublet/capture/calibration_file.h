#pragma once
// Calibrations of other programs (docs/calibration.md): OpenCV, COLMAP, EasyMocap, Pose2Sim, Caliscope,
// anipose, Qualisys, Panoptic Studio, Metashape, Nerfstudio, ActorsHQ.

#include "doublet/core/camera.h"
#include "doublet/core/context.h"
#include "doublet/options/options.h"

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace doublet {

/// A lens that the five terms of Camera::distortion cannot describe. Its images are undistorted when a session reads them, so
/// that all later steps work with a pinhole camera of the same K.
struct Lens {
  bool fisheye = false;       ///< Kannala & Brandt 2006 as OpenCV's cv::fisheye has it; otherwise Brown 1971 and its extensions
  Eigen::VectorXd distortion; ///< fisheye: k1 .. k4; otherwise 8, 12 or 14 terms in OpenCV's order, k1 k2 p1 p2 k3 k4 ...
  bool needs_undistortion() const { return fisheye || distortion.size() > 0; } ///< false: Camera::distortion is sufficient
  template <class... A> [[deprecated("use needs_undistortion")]] decltype(auto) undone(A &&...a) const {
    return needs_undistortion(std::forward<A>(a)...);
  }
};

/// A camera as it was calibrated.
struct CalibratedCamera {
  Camera camera; ///< distortion is zero if the lens needs undistortion
  Lens lens;
  int late = 0; ///< delay in frames: frame t + late of this camera shows the same moment as frame t of the others
  /// Pixel of a world point (m) in the original (distorted) image; meaningless if camera.depth(point) <= 0.
  Eigen::Vector2d project(const Eigen::Vector3d &point) const;
  /// d project / d point, (2, 3), pixels per metre.
  Eigen::Matrix<double, 2, 3> project_jacobian(const Eigen::Vector3d &point) const;
};

/// Found = detected from names and content of the file.
enum class CalibrationFormat {
  Found,
  Doublet,
  OpenCv,
  Colmap,
  EasyMocap,
  Toml,
  Qualisys,
  Anipose,
  Panoptic,
  Metashape,
  OpenCvFisheye,
  Nerfstudio,
  ActorsHq
};
/// In the order of CalibrationFormat.
inline constexpr std::array kCalibrationFormatNames{"found",          "doublet",    "opencv",  "colmap",   "easymocap",
                                                    "toml",           "qualisys",   "anipose", "panoptic", "metashape",
                                                    "opencv_fisheye", "nerfstudio", "actorshq"};
/// Found = the one that the format usually has.
enum class UpAxis { Found, X, MinusX, Y, MinusY, Z, MinusZ };
inline constexpr std::array kUpAxisNames{"found", "x", "-x", "y", "-y", "z", "-z"}; ///< in the order of UpAxis

struct CalibrationOptions {
  CalibrationFormat format = CalibrationFormat::Found;
  std::string units = "found"; ///< text, because it may also be a number
  UpAxis up = UpAxis::Found;
  int image_width = 0, image_height = 0;
  static constexpr auto describe() {
    using namespace options;
    using O = CalibrationOptions;
    return Description{
        "CalibrationOptions",
        option(&O::format, "format", kCalibrationFormatNames,
               "Format of the file or folder; found = detected from its names and content"),
        option(&O::units, "units", "Unit of the file: m, cm, mm, or metres per unit; found = the format's usual one"),
        option(&O::up, "up", kUpAxisNames, "Axis of the file that points up; found = the format's, if cameras are then upright"),
        option(&O::image_width, "image_width", at_least(0), "px",
               "Width of the images, for formats that do not store it; 0 = it is stored"),
        option(&O::image_height, "image_height", at_least(0), "px",
               "Height of the images, for formats that do not store it; 0 = it is stored"),
    };
  }
  void validate() const; ///< throws std::invalid_argument naming option, range and value
};

/// Cameras of a calibration file, or of the folder that a program writes, in metres and with +Y up. Names are converted to
/// letters, digits, _ and -, beginning with a letter, as calibration.yml requires. Throws FileNotFound, or Error naming the file,
/// if anything is missing, damaged or of a camera model that OpenCV does not have, two cameras have the same name, or the cameras
/// are not 0.3 to 30 m apart or, unless `up` is given, not upright (the last two are not checked for calibration.yml). Cameras
/// without a pose, and those that do not film, are left out; the context's log lists them.
std::vector<CalibratedCamera> read_calibration(const std::filesystem::path &path, const CalibrationOptions &options = {},
                                               const Context &context = {});

/// Writes calibration.yml of a session (docs/formats.md) atomically. Throws std::invalid_argument if two cameras have the same
/// name or a name is not allowed in the file, Error naming the file if a camera is invalid.
void write_calibration(const std::filesystem::path &path, const std::vector<CalibratedCamera> &cameras);

} // namespace doublet
