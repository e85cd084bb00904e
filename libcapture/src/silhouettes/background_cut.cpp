// The actor against a still background that a plate shows (actor_cut.h).

#include "actor_cut.h"
#include "doublet/capture/silhouette_extractor.h"
#include "mask_cleaning.h"

#include <algorithm>
#include <map>
#include <stdexcept>

namespace doublet {

namespace {

using detail::Backdrop;
using detail::backdrop_of;
using detail::BackgroundColours;
using detail::ColourHistogram;
using detail::colours_of;
using detail::evidence_of;
using detail::halve_mixed_pixels;
using detail::most_likely_mask;
using detail::Plate;
using detail::smoothed;

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
        plates.push_back(&image);
        if (image.width != plates[0]->width || image.height != plates[0]->height)
          throw std::invalid_argument("images: expected images of one size for camera " + std::to_string(camera));
      }
    if (plates.empty())
      throw std::invalid_argument("images: expected at least one image of camera " + std::to_string(camera) + ", found none");
    cameras_[camera] = {detail::plate_of(colours_of(median_image(plates))), {}};
  }

  /// First what no background would show, then what is found with these colours.
  void learn_actor(int camera, const std::vector<Image> &images) override {
    constexpr double kPlain = 10; // log likelihood
    View view = view_of(camera);
    for (const bool first : {true, false}) {
      ColourHistogram colours;
      for (const Image &image : images) {
        if (image.empty())
          continue;
        require_alike(camera, view, image);
        const cv::Mat picture = smoothed(colours_of(image));
        const Backdrop backdrop = backdrop_of(picture, view.plate);
        const cv::Mat evidence = evidence_of(picture, backdrop, view.actor, background_);
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
    const Backdrop backdrop = backdrop_of(picture, view.plate);
    cv::Mat found = label(evidence_of(picture, backdrop, view.actor, background_), picture, backdrop);
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
    Plate plate;
    ColourHistogram actor;
  };

  const View &view_of(int camera) const {
    const auto found = cameras_.find(camera);
    if (found == cameras_.end())
      throw std::invalid_argument("camera: expected one that was trained, found " + std::to_string(camera));
    return found->second;
  }

  static void require_alike(int camera, const View &view, const Image &image) {
    require_colour(image);
    if (view.plate.colours.cols != image.width || view.plate.colours.rows != image.height)
      throw std::invalid_argument("image: expected " + std::to_string(view.plate.colours.cols) + " x " +
                                  std::to_string(view.plate.colours.rows) + " pixels as the background of camera " +
                                  std::to_string(camera) + " has, found " + std::to_string(image.width) + " x " +
                                  std::to_string(image.height));
  }

  cv::Mat label(const cv::Mat &evidence, const cv::Mat &picture, const Backdrop &backdrop) const {
    return most_likely_mask(evidence, picture, backdrop, options_.smoothness);
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
