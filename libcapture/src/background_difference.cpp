#include "doublet/capture/silhouette_extractor.h"
#include "mask_cleaning.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace doublet {

namespace {

/// B G R as floats, smoothed a little: noise halves, edges stay within a pixel.
cv::Mat smoothed(const Image &image) {
  cv::Mat result;
  cv::Mat(image.height, image.width, CV_8UC3, const_cast<std::uint8_t *>(image.data.data())).convertTo(result, CV_32FC3);
  cv::GaussianBlur(result, result, {}, 0.7);
  return result;
}

Image median_image(const std::vector<const Image *> &images) {
  Image result = *images[0];
  std::vector<std::uint8_t> values(images.size());
  for (std::size_t i = 0; i < result.data.size(); ++i) {
    for (std::size_t k = 0; k < images.size(); ++k)
      values[k] = images[k]->data[i];
    std::nth_element(values.begin(), values.begin() + values.size() / 2, values.end());
    result.data[i] = values[values.size() / 2];
  }
  return result;
}

/// Standard deviation of the noise, channel by channel: most pixels of an image show the background, so the median of the
/// differences is theirs.
cv::Vec3f noise(const cv::Mat &image, const cv::Mat &background) {
  constexpr float kFloor = 1.2F; // grey levels; rounding and the codec, where the picture is clean
  std::array<std::vector<float>, 3> differences;
  for (int y = 0; y < image.rows; y += 4)
    for (int x = 0; x < image.cols; x += 4)
      for (int c = 0; c < 3; ++c)
        differences[c].push_back(std::abs(image.at<cv::Vec3f>(y, x)[c] - background.at<cv::Vec3f>(y, x)[c]));
  cv::Vec3f result;
  for (int c = 0; c < 3; ++c) {
    auto middle = differences[c].begin() + differences[c].size() / 2;
    std::nth_element(differences[c].begin(), middle, differences[c].end());
    result[c] = std::max(kFloor, 1.4826F * *middle);
  }
  return result;
}

class BackgroundDifference : public SilhouetteExtractor {
public:
  explicit BackgroundDifference(const BackgroundOptions &options) : options_(options) { options.validate(); }

  void train(int camera, const std::vector<Image> &images) override {
    if (camera < 0)
      throw std::invalid_argument("camera: expected at least 0, found " + std::to_string(camera));
    std::vector<const Image *> plates;
    for (const Image &image : images)
      if (!image.empty()) {
        require_colour(image);
        if (image.width != images[0].width || image.height != images[0].height)
          throw std::invalid_argument("images: expected images of one size for camera " + std::to_string(camera));
        plates.push_back(&image);
      }
    if (plates.empty())
      throw std::invalid_argument("images: expected at least one image of camera " + std::to_string(camera) + ", found none");
    backgrounds_[camera] = smoothed(median_image(plates));
  }

  Image extract(int camera, const Image &image) const override {
    const auto found = backgrounds_.find(camera);
    if (found == backgrounds_.end())
      throw std::invalid_argument("camera: expected one that was trained, found " + std::to_string(camera));
    require_colour(image);
    const cv::Mat &background = found->second;
    if (background.cols != image.width || background.rows != image.height)
      throw std::invalid_argument("image: expected " + std::to_string(background.cols) + " x " + std::to_string(background.rows) +
                                  " pixels as the background has, found " + std::to_string(image.width) + " x " +
                                  std::to_string(image.height));
    Image mask(image.width, image.height, 1);
    compare(smoothed(image), background, mask);
    clean_mask(mask, options_.min_blob_area);
    return mask;
  }

private:
  void compare(const cv::Mat &image, const cv::Mat &background, Image &mask) const {
    const cv::Vec3f deviation = noise(image, background);
    const auto limit = static_cast<float>(options_.tolerance * options_.tolerance);
    const auto low = static_cast<float>(options_.shadow), high = static_cast<float>(options_.highlight);
    for (int y = 0; y < image.rows; ++y)
      for (int x = 0; x < image.cols; ++x) {
        float ib = 0, bb = 1e-6F, distance = 0;
        cv::Vec3f i = image.at<cv::Vec3f>(y, x), b = background.at<cv::Vec3f>(y, x);
        for (int c = 0; c < 3; ++c) {
          i[c] /= deviation[c];
          b[c] /= deviation[c];
          ib += i[c] * b[c];
          bb += b[c] * b[c];
        }
        const float brightness = std::clamp(ib / bb, low, high);
        for (int c = 0; c < 3; ++c)
          distance += (i[c] - brightness * b[c]) * (i[c] - brightness * b[c]);
        mask.at(x, y) = distance > limit ? 255 : 0;
      }
  }

  BackgroundOptions options_;
  std::map<int, cv::Mat> backgrounds_; // smoothed
};

} // namespace

std::unique_ptr<SilhouetteExtractor> SilhouetteExtractor::create(const BackgroundOptions &options) {
  return std::make_unique<BackgroundDifference>(options);
}

} // namespace doublet
