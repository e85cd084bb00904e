#include "actor_cut.h"

#include "doublet/core/parts/labelling.h"

#include <opencv2/imgproc.hpp>

namespace doublet::detail {
namespace {

/// Largest difference to a neighbour, channel by channel: what blur, codec and a camera that trembles make of a pixel there.
cv::Mat contrast_of(const cv::Mat &colours) {
  cv::Mat low, high;
  const cv::Mat cross = cv::getStructuringElement(cv::MORPH_CROSS, {3, 3});
  cv::erode(colours, low, cross);
  cv::dilate(colours, high, cross);
  const cv::Mat above = high - colours, below = colours - low;
  return cv::max(above, below);
}

float median_of(std::vector<float> &values) {
  const auto middle = values.begin() + static_cast<long>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// The most likely labelling. Pixels whose evidence is plain and agrees with all around are not asked.
class PixelLabelling {
public:
  /// `evidence` (32FC1): log likelihood of the actor over that of the background.
  PixelLabelling(const cv::Mat &evidence, const cv::Mat &image, const Backdrop &backdrop, double smoothness)
      : evidence_(evidence), image_(image), backdrop_(backdrop), smoothness_(smoothness), label_(evidence.size(), CV_8UC1),
        node_(evidence.size(), CV_32SC1) {}

  /// 8UC1, 255 = actor.
  cv::Mat solve() {
    guess();
    choose_nodes();
    scale_ = mean_contrast();
    for (int y = 0; y < label_.rows; ++y)
      for (int x = 0; x < label_.cols; ++x) {
        if (x + 1 < label_.cols)
          connect({x, y}, {x + 1, y});
        if (y + 1 < label_.rows)
          connect({x, y}, {x, y + 1});
      }
    const std::vector<char> found = lowest_labelling(energy_);
    for (std::size_t n = 0; n < pixels_.size(); ++n)
      label_.at<std::uint8_t>(pixels_[n]) = found[n] ? 255 : 0;
    return label_;
  }

private:
  void guess() {
    constexpr int kAround = 9; // px
    constexpr double kPlain = 8;
    cv::Mat mean = cv::max(cv::min(evidence_, kPlain), -kPlain);
    cv::blur(mean, mean, {kAround, kAround});
    label_ = mean > 0;
  }

  void choose_nodes() {
    constexpr float kDoubt = 3;
    constexpr int kBand = 9; // px wide, around the guess's outline
    cv::Mat low, high;
    const cv::Mat square = cv::getStructuringElement(cv::MORPH_RECT, {kBand, kBand});
    cv::erode(label_, low, square);
    cv::dilate(label_, high, square);
    std::vector<double> gain;
    for (int y = 0; y < label_.rows; ++y)
      for (int x = 0; x < label_.cols; ++x) {
        const float e = evidence_.at<float>(y, x);
        const bool band = low.at<std::uint8_t>(y, x) != high.at<std::uint8_t>(y, x),
                   against = (e > 0) != (label_.at<std::uint8_t>(y, x) > 0);
        node_.at<int>(y, x) = band || against || std::abs(e) < kDoubt ? static_cast<int>(pixels_.size()) : -1;
        if (node_.at<int>(y, x) >= 0) {
          pixels_.emplace_back(x, y);
          gain.push_back(e);
        }
      }
    energy_.gain = Eigen::Map<Eigen::VectorXd>(gain.data(), static_cast<Eigen::Index>(gain.size()));
  }

  /// Squared, in deviations: that of the image less that of the background, so that edges of the background are none.
  float contrast(const cv::Point &a, const cv::Point &b) const {
    const cv::Vec3f step = (image_.at<cv::Vec3f>(a) - image_.at<cv::Vec3f>(b)) -
                           (backdrop_.colours.at<cv::Vec3f>(a) - backdrop_.colours.at<cv::Vec3f>(b));
    return step.dot(step) / (backdrop_.noise * backdrop_.noise);
  }

  float mean_contrast() const {
    double sum = 0, count = 0;
    for (int y = 0; y + 1 < label_.rows; y += 3)
      for (int x = 0; x < label_.cols; x += 3) {
        sum += contrast({x, y}, {x, y + 1});
        count += 1;
      }
    return static_cast<float>(std::max(3.0, sum / std::max(1.0, count)));
  }

  void connect(const cv::Point &a, const cv::Point &b) {
    constexpr float kLeast = 0.1F; // of the smoothness, across any contrast
    const int n = node_.at<int>(a), m = node_.at<int>(b);
    if (n < 0 && m < 0)
      return;
    const double cost = smoothness_ * (std::exp(-contrast(a, b) / (2 * scale_)) + kLeast);
    if (n >= 0 && m >= 0) {
      energy_.edges.emplace_back(n, m);
      energy_.cost.push_back(cost);
    } else {
      const bool actor = label_.at<std::uint8_t>(n < 0 ? a : b) > 0; // of the one that is not asked
      energy_.gain[std::max(n, m)] += actor ? cost : -cost;
    }
  }

  const cv::Mat &evidence_, &image_;
  const Backdrop &backdrop_;
  double smoothness_;
  float scale_ = 1;
  cv::Mat label_, node_; // the latter -1 where the label is plain
  std::vector<cv::Point> pixels_;
  LabellingEnergy energy_;
};

} // namespace

cv::Mat colours_of(const Image &image) {
  cv::Mat result;
  cv::Mat(image.height, image.width, CV_8UC3, const_cast<std::uint8_t *>(image.data.data())).convertTo(result, CV_32FC3);
  return result;
}

cv::Mat smoothed(const cv::Mat &colours) {
  cv::Mat result;
  cv::GaussianBlur(colours, result, {}, 0.7);
  return result;
}

Plate plate_of(const cv::Mat &colours, const cv::Mat &known) {
  const cv::Mat plate = smoothed(colours);
  return {plate, contrast_of(plate), known};
}

Backdrop backdrop_of(const cv::Mat &image, const Plate &plate) {
  constexpr float kFloor = 1.2F;    // grey levels; rounding and the codec, where the picture is clean
  constexpr float kTremble = 0.25F; // px
  cv::Vec3f light, noise;
  for (int c = 0; c < 3; ++c) {
    std::vector<float> ratios, differences;
    for (int y = 0; y < image.rows; y += 4)
      for (int x = 0; x < image.cols; x += 4)
        ratios.push_back(image.at<cv::Vec3f>(y, x)[c] / std::max(1.0F, plate.colours.at<cv::Vec3f>(y, x)[c]));
    light[c] = median_of(ratios);
    for (int y = 0; y < image.rows; y += 4)
      for (int x = 0; x < image.cols; x += 4)
        differences.push_back(std::abs(image.at<cv::Vec3f>(y, x)[c] - light[c] * plate.colours.at<cv::Vec3f>(y, x)[c]));
    noise[c] = std::max(kFloor, 1.4826F * median_of(differences));
  }
  Backdrop backdrop{cv::Mat(image.size(), CV_32FC3), cv::Mat(image.size(), CV_32FC3), (noise[0] + noise[1] + noise[2]) / 3};
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x)
      for (int c = 0; c < 3; ++c) {
        backdrop.colours.at<cv::Vec3f>(y, x)[c] = light[c] * plate.colours.at<cv::Vec3f>(y, x)[c];
        backdrop.deviation.at<cv::Vec3f>(y, x)[c] = std::hypot(noise[c], kTremble * plate.contrast.at<cv::Vec3f>(y, x)[c]);
      }
  return backdrop;
}

cv::Mat evidence_of(const cv::Mat &image, const Backdrop &backdrop, const ColourHistogram &actor,
                    const BackgroundColours &background) {
  cv::Mat evidence(image.size(), CV_32FC1);
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x) {
      const cv::Vec3f &colour = image.at<cv::Vec3f>(y, x);
      evidence.at<float>(y, x) = actor.log_density(colour) - background.log_density(colour, backdrop.colours.at<cv::Vec3f>(y, x),
                                                                                    backdrop.deviation.at<cv::Vec3f>(y, x));
    }
  return evidence;
}

cv::Mat most_likely_mask(const cv::Mat &evidence, const cv::Mat &image, const Backdrop &backdrop, double smoothness) {
  return PixelLabelling(evidence, image, backdrop, smoothness).solve();
}

void halve_mixed_pixels(cv::Mat &mask, const cv::Mat &image, const Backdrop &backdrop) {
  constexpr float kInside = 2.5F, kInner = 3, kOuter = 1.5F; // px from the outline: of one colour; the band
  constexpr double kNear = 2;                                // px; standard deviation of "beside"
  constexpr float kUnlike = 6;                               // deviations
  const cv::Rect box = cv::boundingRect(mask);
  if (box.empty())
    return;
  const cv::Rect part = cv::Rect(box.x - 2, box.y - 2, box.width + 4, box.height + 4) & cv::Rect({}, mask.size());
  cv::Mat labels = mask(part), inner, outer, core, share, colour;
  cv::distanceTransform(labels, inner, cv::DIST_L2, 5);
  cv::distanceTransform(~labels, outer, cv::DIST_L2, 5);
  cv::Mat(inner > kInside).convertTo(core, CV_32F, 1 / 255.0);
  cv::GaussianBlur(core, share, {}, kNear);
  image(part).copyTo(colour, inner > kInside);
  cv::GaussianBlur(colour, colour, {}, kNear);
  for (int y = 0; y < part.height; ++y)
    for (int x = 0; x < part.width; ++x) {
      const float in = inner.at<float>(y, x), out = outer.at<float>(y, x), weight = share.at<float>(y, x);
      if (in > kInner || out > kOuter || weight < 0.02F)
        continue;
      const cv::Point there = cv::Point(x, y) + part.tl();
      const cv::Vec3f &back = backdrop.colours.at<cv::Vec3f>(there), &deviation = backdrop.deviation.at<cv::Vec3f>(there);
      float along = 0, apart = 0;
      for (int c = 0; c < 3; ++c) {
        const float actor = (colour.at<cv::Vec3f>(y, x)[c] / weight - back[c]) / deviation[c];
        along += actor * (image.at<cv::Vec3f>(there)[c] - back[c]) / deviation[c];
        apart += actor * actor;
      }
      if (apart > kUnlike * kUnlike)
        labels.at<std::uint8_t>(y, x) = 2 * along > apart ? 255 : 0;
    }
}

} // namespace doublet::detail
