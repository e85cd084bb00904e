#include "frame_reader.h"

#include "doublet/core/error.h"
#include "image_file.h"
#include "lens_map.h"
#include "video_reader.h"

#include <cstring>
#include <mutex>
#include <opencv2/core/utils/logger.hpp>
#include <optional>
#include <regex>

namespace doublet::detail {
namespace fs = std::filesystem;

void quiet_opencv() {
  static std::once_flag once;
  std::call_once(once, [] { cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT); });
}

namespace {

struct NumberField {
  std::string before, after;
  std::size_t digits;
};

/// Of a file's name: a folder may be called what it likes.
std::optional<NumberField> number_field(const fs::path &path) {
  static const std::regex pattern("^([^%]*)%(?:0([1-9]))?d([^%]*)$");
  const std::string name = path.filename().string();
  std::smatch match;
  if (!std::regex_match(name, match, pattern))
    return std::nullopt;
  return NumberField{(path.parent_path() / match[1].str()).string(), match[3], match[2].matched ? std::stoul(match[2]) : 1};
}

std::string numbered(const NumberField &field, int number) {
  std::string digits = std::to_string(number);
  digits.insert(0, field.digits > digits.size() ? field.digits - digits.size() : 0, '0');
  return field.before + digits + field.after;
}

int first_number(const fs::path &path, const NumberField &field) {
  for (int number : {0, 1})
    if (fs::exists(numbered(field, number)))
      return number;
  throw FileNotFound(path.string() + ": expected images numbered from 0 or 1, found neither " + numbered(field, 0) + " nor " +
                     numbered(field, 1));
}

class ImageSeries : public FrameReader {
public:
  ImageSeries(const fs::path &path, const NumberField &field) : field_(field), first_(first_number(path, field)) {}

  std::string file(int frame) const { return numbered(field_, first_ + frame); }

  const cv::Mat &read(int frame) override {
    if (frame == current_)
      return image_;
    const std::string name = file(frame);
    image_ = fs::exists(name) ? read_image(name) : cv::Mat(); // without: the camera dropped out
    current_ = frame;
    return image_;
  }

private:
  NumberField field_;
  int first_;
  int current_ = -1;
  cv::Mat image_;
};

} // namespace

bool is_image_pattern(const fs::path &path) {
  return number_field(path).has_value();
}

bool image_series_exists(const fs::path &pattern) {
  const auto field = number_field(pattern);
  return field && (fs::exists(numbered(*field, 0)) || fs::exists(numbered(*field, 1)));
}

std::unique_ptr<FrameReader> FrameReader::open(const fs::path &path) {
  quiet_opencv();
  if (const auto field = number_field(path))
    return std::make_unique<ImageSeries>(path, *field);
  if (fs::is_directory(path))
    throw Error(path.string() + ": expected a video file or a pattern such as " + (path / "%04d.png").string() +
                ", found a folder");
  return std::make_unique<VideoReader>(path);
}

Image to_image(const cv::Mat &mat) {
  Image image(mat.cols, mat.rows, mat.channels());
  const std::size_t row_bytes = static_cast<std::size_t>(mat.cols) * mat.channels();
  for (int y = 0; y < mat.rows; ++y)
    std::memcpy(image.data.data() + y * row_bytes, mat.ptr(y), row_bytes);
  return image;
}

std::vector<Image> read_plates(const fs::path &path, const LensMap *lens) {
  quiet_opencv();
  std::vector<Image> plates;
  const auto read = [&](const fs::path &file) {
    const cv::Mat image = read_image(file);
    plates.push_back(to_image(lens ? lens->image(image) : image));
  };
  if (const auto field = number_field(path))
    for (int n = first_number(path, *field); fs::exists(numbered(*field, n)); ++n)
      read(numbered(*field, n));
  else
    read(path);
  return plates;
}

ProbedFrames probe_frames(const fs::path &path, int frame_count) {
  const auto reader = FrameReader::open(path);
  if (dynamic_cast<VideoReader *>(reader.get()))
    return probe_video(path, frame_count);
  const cv::Size size = reader->read(0).size();
  const cv::Mat &last = reader->read(frame_count - 1);
  if (last.empty())
    throw FileNotFound(path.string() + ": expected " + std::to_string(frame_count) +
                       " images as session.json says, found none for the last frame");
  if (last.size() != size)
    throw Error(path.string() + ": the last image is " + std::to_string(last.cols) + " x " + std::to_string(last.rows) +
                ", the first is " + std::to_string(size.width) + " x " + std::to_string(size.height));
  return {size, 0};
}

} // namespace doublet::detail
