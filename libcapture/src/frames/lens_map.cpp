#include "lens_map.h"

#include "calibration/calibration_formats.h"

#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

namespace doublet::detail {

LensMap::LensMap(const Camera &camera, const Lens &lens)
    : K_(camera.K(0, 0), 0, camera.K(0, 2), 0, camera.K(1, 1), camera.K(1, 2), 0, 0, 1), lens_(lens) {
  require_lens(lens);
  const std::vector<double> terms(lens.distortion.begin(), lens.distortion.end());
  const cv::Size size(camera.width, camera.height);
  if (lens.fisheye)
    cv::fisheye::initUndistortRectifyMap(K_, terms, cv::Matx33d::eye(), K_, size, CV_16SC2, x_y_, fraction_);
  else
    cv::initUndistortRectifyMap(K_, terms, cv::noArray(), K_, size, CV_16SC2, x_y_, fraction_);
}

cv::Mat LensMap::image(const cv::Mat &filmed) const {
  cv::Mat result;
  cv::remap(filmed, result, x_y_, fraction_, cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return result;
}

Eigen::Vector2d LensMap::pixel(const Eigen::Vector2d &filmed) const {
  const std::vector<double> terms(lens_.distortion.begin(), lens_.distortion.end());
  const std::vector<cv::Point2d> seen{{filmed.x(), filmed.y()}};
  std::vector<cv::Point2d> undone;
  if (lens_.fisheye)
    cv::fisheye::undistortPoints(seen, undone, K_, terms, cv::noArray(), K_);
  else // five steps, as by default, leave pixels where a lens bends much
    cv::undistortPoints(seen, undone, K_, terms, cv::noArray(), K_, cv::TermCriteria(cv::TermCriteria::COUNT, 100, 0));
  return {undone[0].x, undone[0].y};
}

cv::Mat LensMap::mask(const cv::Mat &filmed) const {
  cv::Mat result;
  cv::remap(filmed, result, x_y_, fraction_, cv::INTER_LINEAR, cv::BORDER_CONSTANT, cv::Scalar::all(0));
  return result;
}

} // namespace doublet::detail
