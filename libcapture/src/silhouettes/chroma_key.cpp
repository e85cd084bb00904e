#include "doublet/capture/silhouette_extractor.h"
#include "doublet/core/error.h"
#include "doublet/core/parts/key_colour.h"
#include "doublet/core/types.h"
#include "mask_cleaning.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <map>
#include <numeric>
#include <stdexcept>

namespace doublet {

namespace {

using Form = Eigen::Vector3d; // of (B, G, R)

/// keyness < threshold, rewritten as along . bgr - |across . bgr| < constant in 32-bit integers: no division, no table,
/// vectorises.
struct KeyTest {
  std::array<int, 3> along{}, across{};
  int constant = 0;

  KeyTest() = default;
  KeyTest(const KeyColour &key, double threshold) {
    constexpr double kFixed = 1 << 14; // 3 * 255 * 2^14 * |coefficient| < 2^31
    const double slope = threshold / key.scale;
    const Form luma = KeyColour::luma_form();
    for (int i = 0; i < 3; ++i) {
      along[i] = static_cast<int>(std::lround(kFixed * (key.along[i] - slope * luma[i])));
      across[i] = static_cast<int>(std::lround(kFixed * key.across[i]));
    }
    constant = static_cast<int>(std::lround(kFixed * slope * key.luma));
  }

  void apply(const std::uint8_t *bgr, int count, std::uint8_t *mask) const {
    for (int i = 0; i < count; ++i) {
      const int b = bgr[3 * i], g = bgr[3 * i + 1], r = bgr[3 * i + 2];
      const int p = along[0] * b + along[1] * g + along[2] * r, q = across[0] * b + across[1] * g + across[2] * r;
      mask[i] = p - std::abs(q) < constant ? 255 : 0;
    }
  }
};

Form pixel(const Image &image, int x, int y) {
  return {double(image.at(x, y, 0)), double(image.at(x, y, 1)), double(image.at(x, y, 2))};
}

/// Pixels of a frame around the image, a twentieth of its width: mostly screen, whatever the actor does.
std::vector<Form> border_pixels(const std::vector<Image> &images) {
  std::vector<Form> pixels;
  for (const Image &image : images) {
    const int mx = std::max(1, image.width / 20), my = std::max(1, image.height / 20);
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        if (x < mx || x >= image.width - mx || y < my || y >= image.height - my)
          pixels.push_back(pixel(image, x, y));
        else
          x = image.width - mx - 1; // skip the inside of the row
  }
  return pixels;
}

/// Midway between the means of the two classes it separates (Ridler & Calvard 1978): a pixel half covered by the actor lies on
/// it, however few pixels the actor has. Starts at 0.5 and stays there on an empty stage: most pixels of an actor show less than
/// a quarter of the key's hue, those of a shadow do not.
double class_threshold(const KeyColour &key, const std::vector<Image> &images) {
  constexpr int kBins = 256;
  std::array<double, kBins> histogram{};
  for (const Image &image : images)
    for (int y = 0; y < image.height; y += 2)
      for (int x = 0; x < image.width; x += 2)
        ++histogram[static_cast<int>(std::clamp(key.keyness(pixel(image, x, y)), 0.0, 1.0) * (kBins - 1) + 0.5)];
  const auto below = [&](double value) {
    return std::accumulate(histogram.begin(), histogram.begin() + static_cast<int>(value * kBins), 0.0);
  };
  double threshold = 0.5;
  if (below(0.25) <= 0.5 * below(0.5))
    return threshold;
  for (int iteration = 0; iteration < 50; ++iteration) {
    double count[2] = {0, 0}, sum[2] = {0, 0};
    for (int b = 0; b < kBins; ++b) {
      const double value = b / (kBins - 1.0);
      count[value >= threshold] += histogram[b];
      sum[value >= threshold] += histogram[b] * value;
    }
    if (count[0] == 0 || count[1] == 0)
      break;
    const double next = 0.5 * (sum[0] / count[0] + sum[1] / count[1]);
    if (std::abs(next - threshold) < 1e-4)
      break;
    threshold = next;
  }
  return threshold;
}

class ChromaKey : public SilhouetteExtractor {
public:
  explicit ChromaKey(const ChromaKeyOptions &options) : options_(options) { options.validate(); }

  void train(int camera, const std::vector<Image> &images) override {
    if (camera < 0)
      throw std::invalid_argument("camera: expected at least 0, found " + std::to_string(camera));
    std::vector<Image> usable;
    for (const Image &image : images)
      if (!image.empty()) {
        require_colour(image);
        usable.push_back(image);
      }
    if (usable.empty())
      throw std::invalid_argument("images: expected at least one image of camera " + std::to_string(camera) + ", found none");
    const SharedHue hue = shared_hue(border_pixels(usable));
    if (hue.share < options_.min_key_share)
      throw Error("camera " + std::to_string(camera) + ": no key colour: expected one saturated hue on at least " +
                  percent(options_.min_key_share) + " of the image border, found " + percent(hue.share) +
                  "; give the session ready masks instead (\"masks\" in session.json)");
    const KeyColour key = key_colour(hue.pixels);
    tests_[camera] = KeyTest(key, class_threshold(key, usable));
  }

  Image extract(int camera, const Image &image) const override {
    const auto test = tests_.find(camera);
    if (test == tests_.end())
      throw std::invalid_argument("camera: expected one that was trained, found " + std::to_string(camera));
    require_colour(image);
    Image mask(image.width, image.height, 1);
    test->second.apply(image.data.data(), image.width * image.height, mask.data.data());
    clean_mask(mask, options_.min_blob_area);
    return mask;
  }

private:
  static std::string percent(double share) { return std::to_string(static_cast<int>(std::lround(100 * share))) + " %"; }

  ChromaKeyOptions options_;
  std::map<int, KeyTest> tests_;
};

} // namespace

std::unique_ptr<SilhouetteExtractor> SilhouetteExtractor::create(const ChromaKeyOptions &options) {
  return std::make_unique<ChromaKey>(options);
}

} // namespace doublet
