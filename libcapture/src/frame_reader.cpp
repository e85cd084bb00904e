#include "frame_reader.h"

#include "doublet/core/error.h"
#include "lens_map.h"

#include <array>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <mutex>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/videoio.hpp>
#include <optional>
#include <regex>
#include <string_view>

namespace doublet::detail {
namespace fs = std::filesystem;

void quiet_opencv() {
  static std::once_flag once;
  std::call_once(once, [] {
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    setenv("OPENCV_FFMPEG_LOGLEVEL", "-8", 0); // AV_LOG_QUIET; read by OpenCV when it opens its first video
  });
}

namespace {

struct NumberField {
  std::string before, after;
  std::size_t digits;
};

std::optional<NumberField> number_field(const fs::path &path) {
  static const std::regex pattern("^([^%]*)%(?:0([1-9]))?d([^%]*)$");
  const std::string text = path.string();
  std::smatch match;
  if (!std::regex_match(text, match, pattern))
    return std::nullopt;
  return NumberField{match[1], match[3], match[2].matched ? std::stoul(match[2]) : 1};
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

/// Throws for a PNG that says it is larger than any frame: a few kilobytes can hold 32000 x 32000 pixels of nothing.
void require_frame_size(const std::string &file) {
  constexpr double kMostPixels = 1 << 27; // 16k x 8k
  constexpr std::string_view kPng("\x89PNG\r\n\x1a\n");
  std::array<unsigned char, 24> head{};
  std::ifstream in(file, std::ios::binary);
  if (!in.read(reinterpret_cast<char *>(head.data()), head.size()) || std::memcmp(head.data(), kPng.data(), kPng.size()) != 0)
    return;
  const auto number = [&](std::size_t at) {
    return 16777216.0 * head[at] + 65536.0 * head[at + 1] + 256.0 * head[at + 2] + head[at + 3];
  };
  if (number(16) * number(20) > kMostPixels)
    throw Error(file + ": expected an image of at most " + std::to_string(1 << 27) + " pixels, found " +
                std::to_string(static_cast<long>(number(16))) + " x " + std::to_string(static_cast<long>(number(20))));
}

class ImageSeries : public FrameReader {
public:
  ImageSeries(const fs::path &path, const NumberField &field) : field_(field), first_(first_number(path, field)) {}

  std::string file(int frame) const { return numbered(field_, first_ + frame); }

  const cv::Mat &read(int frame) override {
    if (frame == current_)
      return image_;
    current_ = frame;
    image_ = cv::Mat();
    const std::string name = file(frame);
    if (!fs::exists(name))
      return image_; // the camera dropped out
    require_frame_size(name);
    image_ = cv::imread(name, cv::IMREAD_COLOR);
    if (image_.empty())
      throw Error(name + ": expected an image, found a file that OpenCV cannot decode");
    return image_;
  }

private:
  NumberField field_;
  int first_;
  int current_ = -1;
  cv::Mat image_;
};

class Video : public FrameReader {
public:
  explicit Video(const fs::path &path) : path_(path) {
    if (!fs::exists(path))
      throw FileNotFound(path.string() + ": the video does not exist");
    rewind();
  }

  /// What the container says; may be wrong.
  int stated_frames() const { return static_cast<int>(capture_.get(cv::CAP_PROP_FRAME_COUNT)); }

  double stated_fps() const {
    const double fps = capture_.get(cv::CAP_PROP_FPS);
    return fps > 0 && std::isfinite(fps) ? fps : 0;
  }

  const cv::Mat &read(int frame) override {
    if (frame == next_ - 1)
      return image_;
    if (frame < next_ || frame > next_ + kSkim)
      seek(frame);
    for (; next_ < frame; ++next_)
      if (!capture_.grab())
        fail(next_);
    if (!capture_.read(image_) || image_.empty())
      fail(frame);
    ++next_;
    return image_;
  }

private:
  static constexpr int kSkim = 32; // frames; up to here decoding on is not slower than jumping to a key frame

  void rewind() {
    if (!capture_.open(path_.string(), cv::CAP_FFMPEG))
      throw Error(path_.string() +
                  ": expected a complete video file, found one that cannot be opened (truncated, or not a video)");
    next_ = 0;
  }

  void seek(int frame) {
    capture_.set(cv::CAP_PROP_POS_FRAMES, frame);
    next_ = static_cast<int>(capture_.get(cv::CAP_PROP_POS_FRAMES));
    if (next_ > frame || next_ < 0)
      rewind(); // this container's time stamps do not allow a jump: decode from the start
  }

  [[noreturn]] void fail(int frame) {
    next_ = std::numeric_limits<int>::min() + 1; // forces a fresh seek should the caller go on
    throw Error(path_.string() + ": frame " + std::to_string(frame) + " cannot be decoded (the video states " +
                std::to_string(stated_frames()) + " frames; it may be truncated)");
  }

  fs::path path_;
  cv::VideoCapture capture_;
  cv::Mat image_;
  int next_ = 0; // frame that capture_ delivers next
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
  return std::make_unique<Video>(path);
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
    require_frame_size(file.string());
    const cv::Mat image = cv::imread(file.string(), cv::IMREAD_COLOR);
    if (image.empty())
      throw Error(file.string() + ": expected an image, found a file that OpenCV cannot decode");
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
  const auto *video = dynamic_cast<const Video *>(reader.get());
  if (video && video->stated_frames() < frame_count)
    throw Error(path.string() + ": expected " + std::to_string(frame_count) + " frames as session.json says, found " +
                std::to_string(video->stated_frames()));
  const cv::Size size = reader->read(0).size();
  const cv::Mat &last = reader->read(frame_count - 1);
  if (last.empty())
    throw FileNotFound(path.string() + ": expected " + std::to_string(frame_count) +
                       " images as session.json says, found none for the last frame");
  if (last.size() != size)
    throw Error(path.string() + ": the last image is " + std::to_string(last.cols) + " x " + std::to_string(last.rows) +
                ", the first is " + std::to_string(size.width) + " x " + std::to_string(size.height));
  return {size, video ? video->stated_fps() : 0};
}

} // namespace doublet::detail
