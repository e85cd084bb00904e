#include "image_file.h"

#include "doublet/files/files.h"
#include "jpeg_file.h"
#include "png_file.h"
#include "video_reader.h"

#include <cctype>
#include <memory>
#include <opencv2/imgproc.hpp>
#include <string_view>

namespace doublet::detail {
namespace fs = std::filesystem;
namespace {

cv::Mat decode_by_ffmpeg(const fs::path &path) {
  FrameStream stream(path);
  cv::Mat image;
  if (!stream.next(image))
    throw Error(stream.complaint().empty() ? "there is no picture in it" : "ffmpeg says: " + stream.complaint());
  return image;
}

cv::Mat decode(const std::string &data, const fs::path &path) {
  const auto begins = [&](std::string_view signature) { return std::string_view(data).starts_with(signature); };
  if (begins("\x89PNG\r\n"))
    return decode_png(data);
  if (begins("\xff\xd8\xff"))
    return decode_jpeg(data);
  const std::unique_ptr<std::FILE, int (*)(std::FILE *)> file(std::fopen(path.c_str(), "rb"), std::fclose);
  if (cv::Mat image; file && read_ppm(file.get(), image))
    return image;
  return decode_by_ffmpeg(path);
}

} // namespace

void require_bounded(std::int64_t width, std::int64_t height) {
  constexpr std::int64_t kMost = std::int64_t(1) << 27; // pixels: 16k x 8k
  if (width < 1 || height < 1 || width > kMost / height)
    throw Oversized("expected an image of at most " + std::to_string(kMost) + " pixels, found " + std::to_string(width) + " x " +
                    std::to_string(height));
}

bool read_ppm(std::FILE *file, cv::Mat &image) {
  int width = 0, height = 0, brightest = 0;
  if (std::fscanf(file, "P6 %d %d %d", &width, &height, &brightest) != 3 || brightest != 255 || !std::isspace(std::fgetc(file)))
    return false;
  require_bounded(width, height);
  image.create(height, width, CV_8UC3);
  const std::size_t bytes = image.total() * image.elemSize();
  if (std::fread(image.data, 1, bytes, file) != bytes)
    return false;
  cv::cvtColor(image, image, cv::COLOR_RGB2BGR);
  return true;
}

cv::Mat read_image(const fs::path &path) {
  if (!fs::exists(path))
    throw FileNotFound(path.string() + ": there is no such image");
  try {
    return decode(read_text(path), path);
  } catch (const Oversized &problem) {
    throw Error(path.string() + ": " + problem.what());
  } catch (const Error &problem) {
    throw Error(path.string() + ": expected an image, found a file that cannot be decoded (" + problem.what() + ")");
  }
}

} // namespace doublet::detail
