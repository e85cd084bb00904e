#include "mask_cleaning.h"

#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>

namespace doublet {
namespace {

/// Turns connected regions of `value` with fewer than `smallest` pixels into the other value. Diagonal neighbours belong together
/// in the actor, not in the background.
void drop_small_regions(cv::Mat &mask, std::uint8_t value, int smallest) {
  cv::Mat labels, stats, centroids;
  const cv::Mat regions = value == 255 ? mask : cv::Mat(255 - mask);
  const int count = cv::connectedComponentsWithStats(regions, labels, stats, centroids, value == 255 ? 8 : 4, CV_32S);
  const std::uint8_t other = 255 - value;
  for (int label = 1; label < count; ++label) {
    if (stats.at<int>(label, cv::CC_STAT_AREA) >= smallest)
      continue;
    const cv::Rect box(stats.at<int>(label, cv::CC_STAT_LEFT), stats.at<int>(label, cv::CC_STAT_TOP),
                       stats.at<int>(label, cv::CC_STAT_WIDTH), stats.at<int>(label, cv::CC_STAT_HEIGHT));
    cv::Mat part = mask(box);
    part.setTo(other, labels(box) == label);
  }
}

} // namespace

void clean_mask(Image &mask, int min_blob_area) {
  const int smallest = static_cast<int>(min_blob_area * (double(mask.width) * mask.height) / (1004.0 * 1004.0) + 0.5);
  cv::Mat view(mask.height, mask.width, CV_8UC1, mask.data.data());
  drop_small_regions(view, 255, smallest);
  if (const cv::Rect box = cv::boundingRect(view); !box.empty()) {
    // A hole never touches the rim of the actor's box widened by a pixel, so the box is enough.
    const cv::Rect wide = cv::Rect(box.x - 1, box.y - 1, box.width + 2, box.height + 2) & cv::Rect(0, 0, view.cols, view.rows);
    cv::Mat part = view(wide);
    drop_small_regions(part, 0, smallest);
  }
}

void require_colour(const Image &image) {
  if (image.empty() || image.channels != 3)
    throw std::invalid_argument("image: expected a colour image (3 channels), found " + std::to_string(image.channels) +
                                " channel(s) and " + std::to_string(image.data.size()) + " bytes");
}

} // namespace doublet
