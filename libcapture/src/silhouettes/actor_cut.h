#pragma once
// The actor against a still background: how likely each colour is on one and on the other, and the labelling that is most likely
// as a whole. After Boykov and Jolly, Interactive graph cuts (ICCV 2001); Sun et al., Background cut (ECCV 2006).

#include "doublet/capture/silhouette_extractor.h"

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

namespace doublet::detail {

constexpr float kLogColours = 16.6355F; // log 256^3: a density of 1 over all colours

cv::Mat colours_of(const Image &image); ///< 32FC3

/// Smoothed a little: noise halves, edges stay within a pixel.
cv::Mat smoothed(const cv::Mat &colours);

/// An empty stage.
struct Plate {
  cv::Mat colours, contrast; ///< 32FC3, smoothed; largest difference to a neighbour
  cv::Mat known;             ///< 8UC1, 0 = nobody has seen what is there; empty = all is known
};
Plate plate_of(const cv::Mat &colours, const cv::Mat &known = {});

/// What the background looks like in one image: its colours under the light of that moment, and how far each varies.
struct Backdrop {
  cv::Mat colours, deviation; ///< 32FC3
  float noise;                ///< grey levels, mean over the channels
};

/// Light and noise are those of most pixels, which show the background.
Backdrop backdrop_of(const cv::Mat &image, const Plate &plate);

/// How likely each colour is on what was seen of something: a smoothed histogram.
class ColourHistogram {
public:
  /// Sum over the pixels that a mask (8UC1) has.
  void add(const cv::Mat &image, const cv::Mat &mask) {
    for (int y = 0; y < image.rows; ++y)
      for (int x = 0; x < image.cols; ++x)
        if (mask.at<std::uint8_t>(y, x)) {
          count_[bin(image.at<cv::Vec3f>(y, x))] += 1;
          total_ += 1;
        }
  }

  /// Of what was added. With little to go by every colour is as likely.
  void learn() {
    constexpr double kEnough = 500, kUnseen = 0.05; // px; share of colours that were not seen
    log_density_.clear();
    if (total_ < kEnough)
      return;
    smooth();
    log_density_.resize(count_.size());
    const double bins = static_cast<double>(count_.size());
    for (std::size_t i = 0; i < count_.size(); ++i)
      log_density_[i] = static_cast<float>(std::log((1 - kUnseen) * count_[i] / total_ * bins + kUnseen)) - kLogColours;
  }

  /// Natural logarithm; of a density over colours of 256^3 levels.
  float log_density(const cv::Vec3f &bgr) const { return log_density_.empty() ? -kLogColours : log_density_[bin(bgr)]; }

private:
  static constexpr int kBins = 16; // a channel

  static std::size_t bin(const cv::Vec3f &bgr) {
    std::size_t index = 0;
    for (int c = 0; c < 3; ++c)
      index = index * kBins + static_cast<std::size_t>(std::clamp(static_cast<int>(bgr[c]) * kBins / 256, 0, kBins - 1));
    return index;
  }

  /// A quarter of each bin goes to its neighbours, channel by channel.
  void smooth() {
    for (const int stride : {1, kBins, kBins * kBins}) {
      const std::vector<double> before = count_;
      for (int i = 0; i < static_cast<int>(count_.size()); ++i) {
        const int place = i / stride % kBins;
        count_[i] = 0.75 * before[i];
        count_[i] += 0.125 * before[place > 0 ? i - stride : i];
        count_[i] += 0.125 * before[place + 1 < kBins ? i + stride : i];
      }
    }
  }

  std::vector<double> count_ = std::vector<double>(kBins * kBins * kBins, 0);
  double total_ = 0;
  std::vector<float> log_density_; // empty = all alike
};

/// Log density of a colour on the background: mostly the backdrop up to its deviation, now and then in a shadow or a light on it
/// (Horprasert, Harwood & Davis, A statistical approach for real-time robust background subtraction, ICCV Frame-Rate 1999),
/// rarely anything.
class BackgroundColours {
public:
  explicit BackgroundColours(const BackgroundOptions &options)
      : low_(static_cast<float>(options.shadow)), high_(static_cast<float>(options.highlight)) {}

  float log_density(const cv::Vec3f &image, const cv::Vec3f &plate, const cv::Vec3f &deviation) const {
    constexpr float kShaded = 0.02F, kAnything = 0.001F, kLogTwoPi = 1.83788F;
    float plain = 0, ib = 0, bb = 1e-6F;
    cv::Vec3f i, b;
    for (int c = 0; c < 3; ++c) {
      i[c] = image[c] / deviation[c];
      b[c] = plate[c] / deviation[c];
      plain += (i[c] - b[c]) * (i[c] - b[c]);
      ib += i[c] * b[c];
      bb += b[c] * b[c];
    }
    const float volume = 1 / (deviation[0] * deviation[1] * deviation[2]);
    float density = (1 - kShaded - kAnything) * volume * std::exp(-0.5F * plain - 1.5F * kLogTwoPi);
    if (high_ > low_) {
      const float brightness = std::clamp(ib / bb, low_, high_);
      float across = 0;
      for (int c = 0; c < 3; ++c)
        across += (i[c] - brightness * b[c]) * (i[c] - brightness * b[c]);
      density += kShaded * volume / ((high_ - low_) * std::sqrt(bb)) * std::exp(-0.5F * across - kLogTwoPi);
    }
    return std::log(density + kAnything * std::exp(-kLogColours));
  }

private:
  float low_, high_; // brightness against the plate
};

/// (32FC1) log likelihood of each pixel's colour on the actor over that on the background.
cv::Mat evidence_of(const cv::Mat &image, const Backdrop &backdrop, const ColourHistogram &actor,
                    const BackgroundColours &background);

/// The most likely labelling (8UC1, 255 = actor). `smoothness`: log likelihood that an edge between two pixels of the same colour
/// costs.
cv::Mat most_likely_mask(const cv::Mat &evidence, const cv::Mat &image, const Backdrop &backdrop, double smoothness);

/// Pixels along the outline show both: one is the actor's if it is nearer to his colour beside it than to the background's. Where
/// these look alike nothing changes. `image` is not smoothed.
void halve_mixed_pixels(cv::Mat &mask, const cv::Mat &image, const Backdrop &backdrop);

} // namespace doublet::detail
