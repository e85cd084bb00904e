#pragma once
// One camera's frames on disk: a video file or a numbered series of images. The only file besides chroma_key and the tracker that
// opens images.

#include "doublet/core/image.h"

#include <filesystem>
#include <memory>
#include <opencv2/core.hpp>
#include <vector>

namespace doublet::detail {

/// Keeps OpenCV from writing to stderr; what went wrong is told by our own exceptions.
void quiet_opencv();

Image to_image(const cv::Mat &mat);

class FrameReader {
public:
  virtual ~FrameReader() = default;
  /// BGR, or an empty Mat if there is no image for that frame. Sequential reading is cheap. The Mat is valid until the next call.
  virtual const cv::Mat &read(int frame) = 0;
  /// Opens `path`. Throws FileNotFound or Error naming it.
  static std::unique_ptr<FrameReader> open(const std::filesystem::path &path);
};

/// "%d" or "%04d" in the file name: a series of images, one per frame, whose first number is 0 or 1.
bool is_image_pattern(const std::filesystem::path &path);
/// True if a series has an image numbered 0 or 1.
bool image_series_exists(const std::filesystem::path &pattern);
class LensMap;
/// Images of the empty stage: one file, or all of a series, with the lens undone if one is given. Throws as FrameReader does.
std::vector<Image> read_plates(const std::filesystem::path &path, const LensMap *lens = nullptr);
/// Checks that frames 0 .. frame_count-1 can be read (the last one is decoded, which finds truncated files within a second) and
/// returns what they are like. Throws FileNotFound or Error naming the file.
struct ProbedFrames {
  cv::Size size;
  double fps = 0; ///< of a video, measured; 0 = unknown
};
ProbedFrames probe_frames(const std::filesystem::path &path, int frame_count);

} // namespace doublet::detail
