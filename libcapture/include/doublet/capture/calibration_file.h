#pragma once
// Calibrations from the programs that make them (docs/calibration.md): OpenCV, COLMAP, EasyMocap, Pose2Sim, Caliscope,
// anipose, Qualisys, Panoptic Studio, Metashape.

#include "doublet/core/camera.h"
#include "doublet/core/context.h"
#include "doublet/options/options.h"

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

namespace doublet {

/// A lens that the five terms of Camera::distortion cannot describe. Images taken through it are undistorted when a session reads
/// them, so that everything behind the reader sees the pinhole camera of the same K.
struct Lens {
  bool fisheye = false;       ///< Kannala & Brandt 2006 as OpenCV's cv::fisheye has it; otherwise Brown 1971 and its extensions
  Eigen::VectorXd distortion; ///< fisheye: k1 .. k4; otherwise 8, 12 or 14 terms in OpenCV's order, k1 k2 p1 p2 k3 k4 ...
  bool needs_undistortion() const { return fisheye || distortion.size() > 0; } ///< false: Camera::distortion says all there is
  template <class... A> [[deprecated("use needs_undistortion")]] decltype(auto) undone(A &&...a) const {
    return needs_undistortion(std::forward<A>(a)...);
  }
};

/// A camera as it was calibrated.
struct CalibratedCamera {
  Camera camera; ///< distortion is zero where the lens is undone
  Lens lens;
  int late = 0; ///< frames: what the camera films in frame t + late the others film in frame t
  /// Pixel of a world point (m) in the image as it was filmed; meaningless if camera.depth(point) <= 0.
  Eigen::Vector2d project(const Eigen::Vector3d &point) const;
  /// d project / d point, (2, 3), pixels per metre.
  Eigen::Matrix<double, 2, 3> project_jacobian(const Eigen::Vector3d &point) const;
};

/// Found = by names and content of the file.
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
  OpenCvFisheye
};
/// In the order of CalibrationFormat.
inline constexpr std::array kCalibrationFormatNames{"found",    "doublet", "opencv",   "colmap",    "easymocap",     "toml",
                                                    "qualisys", "anipose", "panoptic", "metashape", "opencv_fisheye"};
/// Found = the one that the format usually has.
enum class UpAxis { Found, X, MinusX, Y, MinusY, Z, MinusZ };
inline constexpr std::array kUpAxisNames{"found", "x", "-x", "y", "-y", "z", "-z"}; ///< in the order of UpAxis

struct CalibrationOptions {
  CalibrationFormat format = CalibrationFormat::Found;
  std::string units = "found"; ///< a text, as it may be a number, too
  UpAxis up = UpAxis::Found;
  int image_width = 0, image_height = 0;
  static constexpr auto describe() {
    using namespace options;
    using O = CalibrationOptions;
    return Description{
        "CalibrationOptions",
        option(&O::format, "format", kCalibrationFormatNames, "Format of the file or folder; found = by its names and content"),
        option(&O::units, "units", "Unit of the file: m, cm, mm, or metres a unit; found = what the format usually has"),
        option(&O::up, "up", kUpAxisNames, "Axis of the file that points up; found = the format's, if cameras stand upright"),
        option(&O::image_width, "image_width", at_least(0), "px",
               "Width of the images, where the format does not have it; 0 = it has"),
        option(&O::image_height, "image_height", at_least(0), "px",
               "Height of the images, where the format does not have it; 0 = it has"),
    };
  }
  void validate() const; ///< throws std::invalid_argument naming option, range and value
};

/// Cameras of a calibration file, or of the folder that a program writes, in metres and with +Y up. Names become what
/// calibration.yml can hold: letters, digits, _ and -, beginning with a letter. Throws FileNotFound, or Error naming the file, if
/// anything is missing, damaged or of a camera model that OpenCV does not have, two cameras have one name, or (but for
/// calibration.yml, which is taken at its word) the cameras are not 0.3 to 30 m apart or, unless `up` is given, not upright.
/// Cameras without a pose, and those that do not film, are left out; the context's log says which.
std::vector<CalibratedCamera> read_calibration(const std::filesystem::path &path, const CalibrationOptions &options = {},
                                               const Context &context = {});

/// calibration.yml of a session (docs/formats.md), complete or not at all. Throws std::invalid_argument if two cameras have one
/// name or a name cannot stand in the file, Error naming the file if a camera makes no sense.
void write_calibration(const std::filesystem::path &path, const std::vector<CalibratedCamera> &cameras);

} // namespace doublet
