#pragma once
// Images as the pinhole camera of the same K would have taken them.

#include "doublet/capture/calibration_file.h"

#include <opencv2/core.hpp>

namespace doublet::detail {

class LensMap {
public:
  LensMap(const Camera &camera, const Lens &lens); ///< throws std::invalid_argument on a lens of no known number of terms
  /// What the lens did not see, beyond the picture's edge, has the edge's colour: a screen goes on there.
  cv::Mat image(const cv::Mat &filmed) const;
  /// What the lens did not see is not the actor.
  cv::Mat mask(const cv::Mat &filmed) const;
  Eigen::Vector2d pixel(const Eigen::Vector2d &filmed) const;

private:
  cv::Matx33d K_;
  Lens lens_;
  cv::Mat x_y_, fraction_; // cv::remap's fixed-point maps
};

} // namespace doublet::detail
