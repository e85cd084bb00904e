// The actor against a still background: how likely each colour is on one and on the other, and the labelling that is most likely
// as a whole. After Boykov and Jolly, Interactive graph cuts (ICCV 2001); Sun et al., Background cut (ECCV 2006).

#include "doublet/capture/silhouette_extractor.h"
#include "doublet/core/parts/labelling.h"
#include "mask_cleaning.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace doublet {

namespace {

constexpr float kLogColours = 16.6355F; // log 256^3: a density of 1 over all colours

cv::Mat colours_of(const Image &image) {
  cv::Mat result;
  cv::Mat(image.height, image.width, CV_8UC3, const_cast<std::uint8_t *>(image.data.data())).convertTo(result, CV_32FC3);
  return result;
}

/// Smoothed a little: noise halves, edges stay within a pixel.
cv::Mat smoothed(const cv::Mat &colours) {
  cv::Mat result;
  cv::GaussianBlur(colours, result, {}, 0.7);
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

/// What the background looks like in one image: its colours under the light of that moment, and how far each varies.
struct Backdrop {
  cv::Mat colours, deviation; // 32FC3
  float noise;                // grey levels, mean over the channels
};

/// Light and noise are those of most pixels, which show the background.
Backdrop backdrop_of(const cv::Mat &image, const cv::Mat &plate, const cv::Mat &contrast) {
  constexpr float kFloor = 1.2F;    // grey levels; rounding and the codec, where the picture is clean
  constexpr float kTremble = 0.25F; // px
  cv::Vec3f light, noise;
  for (int c = 0; c < 3; ++c) {
    std::vector<float> ratios, differences;
    for (int y = 0; y < image.rows; y += 4)
      for (int x = 0; x < image.cols; x += 4)
        ratios.push_back(image.at<cv::Vec3f>(y, x)[c] / std::max(1.0F, plate.at<cv::Vec3f>(y, x)[c]));
    light[c] = median_of(ratios);
    for (int y = 0; y < image.rows; y += 4)
      for (int x = 0; x < image.cols; x += 4)
        differences.push_back(std::abs(image.at<cv::Vec3f>(y, x)[c] - light[c] * plate.at<cv::Vec3f>(y, x)[c]));
    noise[c] = std::max(kFloor, 1.4826F * median_of(differences));
  }
  Backdrop backdrop{cv::Mat(image.size(), CV_32FC3), cv::Mat(image.size(), CV_32FC3), (noise[0] + noise[1] + noise[2]) / 3};
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x)
      for (int c = 0; c < 3; ++c) {
        backdrop.colours.at<cv::Vec3f>(y, x)[c] = light[c] * plate.at<cv::Vec3f>(y, x)[c];
        backdrop.deviation.at<cv::Vec3f>(y, x)[c] = std::hypot(noise[c], kTremble * contrast.at<cv::Vec3f>(y, x)[c]);
      }
  return backdrop;
}

/// How likely each colour is on the actor: a smoothed histogram.
class ActorColours {
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

/// Pixels along the outline show both: one is the actor's if it is nearer to his colour beside it than to the background's. Where
/// these look alike nothing changes.
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

class BackgroundCut : public SilhouetteExtractor {
public:
  explicit BackgroundCut(const BackgroundOptions &options) : options_(options), background_(options) { options.validate(); }

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
    const cv::Mat plate = smoothed(colours_of(median_image(plates)));
    cameras_[camera] = {plate, contrast_of(plate), {}};
  }

  /// First what no background would show, then what is found with these colours.
  void learn_actor(int camera, const std::vector<Image> &images) override {
    constexpr double kPlain = 10; // log likelihood
    View view = view_of(camera);
    for (const bool first : {true, false}) {
      ActorColours colours;
      for (const Image &image : images) {
        if (image.empty())
          continue;
        require_alike(camera, view, image);
        const cv::Mat picture = smoothed(colours_of(image));
        const Backdrop backdrop = backdrop_of(picture, view.plate, view.contrast);
        const cv::Mat evidence = evidence_of(picture, backdrop, view.actor);
        colours.add(picture, first ? cv::Mat(evidence > kPlain) : label(evidence, picture, backdrop));
      }
      colours.learn();
      view.actor = colours;
    }
    cameras_[camera] = view;
  }

  Image extract(int camera, const Image &image) const override {
    const View &view = view_of(camera);
    require_alike(camera, view, image);
    const cv::Mat colours = colours_of(image), picture = smoothed(colours);
    const Backdrop backdrop = backdrop_of(picture, view.plate, view.contrast);
    cv::Mat found = label(evidence_of(picture, backdrop, view.actor), picture, backdrop);
    Image mask(image.width, image.height, 1);
    cv::Mat out(image.height, image.width, CV_8UC1, mask.data.data());
    found.copyTo(out);
    clean_mask(mask, options_.min_blob_area);
    halve_mixed_pixels(out, colours, backdrop);
    clean_mask(mask, options_.min_blob_area);
    return mask;
  }

private:
  struct View {
    cv::Mat plate, contrast; // 32FC3, smoothed
    ActorColours actor;
  };

  const View &view_of(int camera) const {
    const auto found = cameras_.find(camera);
    if (found == cameras_.end())
      throw std::invalid_argument("camera: expected one that was trained, found " + std::to_string(camera));
    return found->second;
  }

  static void require_alike(int camera, const View &view, const Image &image) {
    require_colour(image);
    if (view.plate.cols != image.width || view.plate.rows != image.height)
      throw std::invalid_argument("image: expected " + std::to_string(view.plate.cols) + " x " + std::to_string(view.plate.rows) +
                                  " pixels as the background of camera " + std::to_string(camera) + " has, found " +
                                  std::to_string(image.width) + " x " + std::to_string(image.height));
  }

  cv::Mat evidence_of(const cv::Mat &picture, const Backdrop &backdrop, const ActorColours &actor) const {
    cv::Mat evidence(picture.size(), CV_32FC1);
    for (int y = 0; y < picture.rows; ++y)
      for (int x = 0; x < picture.cols; ++x) {
        const cv::Vec3f &colour = picture.at<cv::Vec3f>(y, x);
        evidence.at<float>(y, x) =
            actor.log_density(colour) -
            background_.log_density(colour, backdrop.colours.at<cv::Vec3f>(y, x), backdrop.deviation.at<cv::Vec3f>(y, x));
      }
    return evidence;
  }

  cv::Mat label(const cv::Mat &evidence, const cv::Mat &picture, const Backdrop &backdrop) const {
    return PixelLabelling(evidence, picture, backdrop, options_.smoothness).solve();
  }

  BackgroundOptions options_;
  BackgroundColours background_;
  std::map<int, View> cameras_;
};

} // namespace

std::unique_ptr<SilhouetteExtractor> SilhouetteExtractor::create(const BackgroundOptions &options) {
  return std::make_unique<BackgroundCut>(options);
}

} // namespace doublet
