#include "outline_refinement.h"

#include "mask_cleaning.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace doublet::detail {
namespace {

constexpr double kClear = 2, kBand = 3; // of the expected error: farther away a mask is right as a rule; always

cv::Mat view_of(const Image &mask) {
  return {mask.height, mask.width, CV_8UC1, const_cast<std::uint8_t *>(mask.data.data())};
}

/// (32FC1) px from the outline, above 0 inside: half a pixel in the pixels along it.
cv::Mat distance_inside(const cv::Mat &mask) {
  cv::Mat inner, outer, distance;
  cv::distanceTransform(mask, inner, cv::DIST_L2, 5);
  cv::distanceTransform(~mask, outer, cv::DIST_L2, 5);
  cv::subtract(inner, outer, distance);
  cv::Mat half(mask.size(), CV_32FC1, cv::Scalar(-0.5));
  half.setTo(0.5, ~mask);
  return distance + half;
}

/// Median of the colours that each pixel has where it is clear of the masks, and in which pixels there are enough of them.
Plate plate_behind(const std::vector<Image> &images, const std::vector<cv::Mat> &distances, double clear) {
  constexpr std::size_t kEnough = 3; // frames
  const int width = images[0].width, height = images[0].height;
  cv::Mat colours(height, width, CV_32FC3, cv::Scalar::all(0)), known(height, width, CV_8UC1, cv::Scalar(0));
  std::vector<std::uint8_t> values[3];
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      for (std::vector<std::uint8_t> &channel : values)
        channel.clear();
      for (std::size_t i = 0; i < images.size(); ++i)
        for (int c = 0; distances[i].at<float>(y, x) < -clear && c < 3; ++c)
          values[c].push_back(images[i].at(x, y, c));
      if (values[0].size() < kEnough)
        continue;
      known.at<std::uint8_t>(y, x) = 255;
      for (int c = 0; c < 3; ++c) {
        const auto middle = values[c].begin() + static_cast<long>(values[c].size() / 2);
        std::nth_element(values[c].begin(), middle, values[c].end());
        colours.at<cv::Vec3f>(y, x)[c] = *middle;
      }
    }
  return {colours, {}, known};
}

/// Unknown pixels get the colour of the nearest known one, smoothly: they must show no edge.
void fill_unknown(cv::Mat &colours, const cv::Mat &known) {
  constexpr double kSmooth = 8; // px
  if (cv::countNonZero(known) == 0)
    return;
  cv::Mat distance, nearest, smooth;
  cv::distanceTransform(~known, distance, nearest, cv::DIST_L2, 5, cv::DIST_LABEL_PIXEL);
  std::vector<cv::Vec3f> colour_of_label(1);
  for (int y = 0; y < known.rows; ++y)
    for (int x = 0; x < known.cols; ++x)
      if (known.at<std::uint8_t>(y, x)) {
        const auto label = static_cast<std::size_t>(nearest.at<int>(y, x));
        colour_of_label.resize(std::max(colour_of_label.size(), label + 1));
        colour_of_label[label] = colours.at<cv::Vec3f>(y, x);
      }
  for (int y = 0; y < known.rows; ++y)
    for (int x = 0; x < known.cols; ++x)
      colours.at<cv::Vec3f>(y, x) = colour_of_label[static_cast<std::size_t>(nearest.at<int>(y, x))];
  cv::GaussianBlur(colours, smooth, {}, kSmooth);
  smooth.copyTo(colours, ~known);
}

/// Logarithm of how much likelier the actor is than the background at a distance inside an outline that is off by N(0, 1): of
/// the normal distribution, as Bowling et al., A logistic approximation to the cumulative normal distribution (JIEM 2009).
double log_odds(double distance) {
  return 1.5976 * distance + 0.07056 * distance * distance * distance;
}

} // namespace

OutlineRefiner::OutlineRefiner(double error, const BackgroundOptions &options, const std::vector<Image> &images,
                               const std::vector<Image> &masks)
    : error_(error), options_(options), background_(options) {
  std::vector<cv::Mat> distances;
  for (std::size_t i = 0; i < images.size(); ++i) {
    require_colour(images[i]);
    distances.push_back(distance_inside(view_of(masks[i])));
    const cv::Mat picture = smoothed(colours_of(images[i]));
    actor_.add(picture, distances[i] > kClear * error_);
    room_.add(picture, distances[i] < -kClear * error_);
  }
  actor_.learn();
  room_.learn();
  Plate plate = plate_behind(images, distances, kClear * error_);
  fill_unknown(plate.colours, plate.known);
  plate_ = plate_of(plate.colours, plate.known);
}

Image OutlineRefiner::refine(const Image &image, const Image &mask) const {
  require_colour(image);
  if (image.width != plate_.colours.cols || image.height != plate_.colours.rows || mask.width != image.width ||
      mask.height != image.height)
    throw std::invalid_argument("image, mask: expected " + std::to_string(plate_.colours.cols) + " x " +
                                std::to_string(plate_.colours.rows) + " pixels as those before, found " +
                                std::to_string(image.width) + " x " + std::to_string(image.height) + " and " +
                                std::to_string(mask.width) + " x " + std::to_string(mask.height));
  constexpr float kSure = 100; // log likelihood
  const cv::Mat colours = colours_of(image), picture = smoothed(colours), given = view_of(mask);
  const cv::Mat distance = distance_inside(given);
  const Backdrop backdrop = backdrop_of(picture, plate_);
  cv::Mat evidence = evidence_of(picture, backdrop, actor_, background_);
  for (int y = 0; y < evidence.rows; ++y)
    for (int x = 0; x < evidence.cols; ++x) {
      float &e = evidence.at<float>(y, x);
      const double inside = distance.at<float>(y, x) / error_;
      if (!plate_.known.at<std::uint8_t>(y, x))
        e = actor_.log_density(picture.at<cv::Vec3f>(y, x)) - room_.log_density(picture.at<cv::Vec3f>(y, x));
      e = std::abs(inside) > kBand ? std::copysign(kSure, static_cast<float>(inside)) : e + static_cast<float>(log_odds(inside));
    }
  Image refined(image.width, image.height, 1);
  cv::Mat out = view_of(refined);
  most_likely_mask(evidence, picture, backdrop, options_.smoothness).copyTo(out);
  clean_mask(refined, options_.min_blob_area);
  const cv::Mat found = out.clone();
  halve_mixed_pixels(out, colours, backdrop);
  found.copyTo(out, ~plate_.known);
  given.copyTo(out, cv::abs(distance) > kBand * error_);
  clean_mask(refined, options_.min_blob_area);
  return refined;
}

} // namespace doublet::detail
