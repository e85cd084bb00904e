#pragma once
// One reader a format: cameras in the units, axes and names of the file. They throw FileNotFound or Error naming the file.

#include "doublet/capture/calibration_file.h"

#include <filesystem>
#include <string>
#include <vector>

namespace doublet::detail {

constexpr std::size_t kMostCameras = 1000; ///< of a file: every one is looked for by its keys
constexpr int kMostLate = 100'000;         ///< frames, either way

struct ImageSize {
  int width = 0, height = 0;
};

/// calibration.yml: those named, or all if none are.
std::vector<CalibratedCamera> read_doublet_calibration(const std::filesystem::path &path,
                                                       const std::vector<std::string> &names = {});
/// A file a camera, of OpenCV's FileStorage: one file, or all of a folder. `size` stands in for one that the file lacks.
/// `fisheye`: its distortion is that of cv::fisheye, whether or not the file says so.
std::vector<CalibratedCamera> read_opencv_calibration(const std::filesystem::path &path, ImageSize size, bool fisheye = false);
/// intri.yml and extri.yml of a folder.
std::vector<CalibratedCamera> read_easymocap_calibration(const std::filesystem::path &folder, ImageSize size);
/// cameras and images of a folder, .bin or .txt.
std::vector<CalibratedCamera> read_colmap_calibration(const std::filesystem::path &folder);
// Of some files there are cameras that are of no use here; `left_out` gets a sentence on each.

/// A table a camera, as anipose, Pose2Sim and Caliscope write it.
std::vector<CalibratedCamera> read_toml_calibration(const std::filesystem::path &path, ImageSize size,
                                                    std::vector<std::string> &left_out);
std::vector<CalibratedCamera> read_qualisys_calibration(const std::filesystem::path &path, std::vector<std::string> &left_out);
/// A list of cameras in JSON, as anipose's and AIST++ have it.
std::vector<CalibratedCamera> read_anipose_calibration(const std::filesystem::path &path, ImageSize size);
/// JSON of CMU's Panoptic Studio; of its kinds of cameras the HD ones, if there are any.
std::vector<CalibratedCamera> read_panoptic_calibration(const std::filesystem::path &path, std::vector<std::string> &left_out);
/// transforms.json of Nerfstudio, Instant NGP and other radiance fields.
std::vector<CalibratedCamera> read_nerfstudio_calibration(const std::filesystem::path &path, ImageSize size);
/// calibration.csv of ActorsHQ.
std::vector<CalibratedCamera> read_actorshq_calibration(const std::filesystem::path &path);
/// XML that Metashape exports ("Agisoft XML").
std::vector<CalibratedCamera> read_metashape_calibration(const std::filesystem::path &path, std::vector<std::string> &left_out);

/// "doublet", "easymocap" or "opencv", by the keys of an OpenCV file.
std::string opencv_dialect(const std::filesystem::path &path);
/// .yml, .yaml, .xml, .json of a folder, sorted.
std::vector<std::filesystem::path> opencv_files(const std::filesystem::path &folder);

// What the readers share. `where` begins the sentences: the file, and the camera.

/// Puts the terms where they belong: Camera::distortion if it can hold them, the lens otherwise.
void set_distortion(CalibratedCamera &camera, const std::vector<double> &terms, bool fisheye, const std::string &where);
/// From 9 numbers, row by row.
Eigen::Matrix3d matrix_from(const std::vector<double> &numbers);
/// From 9 numbers, row by row, or the 3 of a rotation vector.
Eigen::Matrix3d rotation_from(const std::vector<double> &numbers);
/// From two numbers of pixels; 0 x 0 if they are none.
ImageSize size_from(const std::vector<double> &numbers);
/// The size of the file, or the one given if the file has none. Throws Error if there is neither.
ImageSize chosen_size(ImageSize found, ImageSize given, const std::string &where);
void set_size(CalibratedCamera &camera, ImageSize size);
/// Of cameras whose images are cam0.png, cam1.png, or cam0/0001.png, cam1/0001.png.
std::vector<std::string> camera_names(const std::vector<std::string> &images);
/// Throws std::invalid_argument if there is no lens of so many numbers of distortion.
void require_lens(const Lens &lens);
/// Throws Error if the numbers, or their combination, make no sense.
void validate_calibrated(const CalibratedCamera &camera, const std::string &source);

} // namespace doublet::detail
