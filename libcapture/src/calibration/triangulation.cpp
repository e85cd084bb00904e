#include "doublet/capture/triangulation.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

namespace doublet {
namespace {

constexpr double kAgree = 0.02;   // of the image's larger side, within which cameras agree on a point
constexpr double kTooNear = 1e-3; // m, depth from which on no step is made
constexpr int kSteps = 4;

using Cameras = std::vector<CalibratedCamera>;
using Keypoints = std::vector<Keypoint>;

/// Distance in the image over its larger side; infinite behind the camera.
double image_error(const CalibratedCamera &camera, const Keypoint &seen, const Eigen::Vector3d &point) {
  if (!(camera.camera.depth(point) > 0))
    return std::numeric_limits<double>::infinity();
  return (camera.project(point) - seen.pixel).norm() / std::max(camera.camera.width, camera.camera.height);
}

/// Nearest to the rays, as if there were no distortion.
Eigen::Vector3d nearest_to_rays(const Cameras &cameras, const Keypoints &seen, const std::vector<int> &chosen) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  for (const int i : chosen) {
    const Camera &camera = cameras[i].camera;
    const Eigen::Vector3d ray = camera.R.transpose() * camera.K.inverse() * seen[i].pixel.homogeneous();
    const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - ray * ray.transpose() / ray.squaredNorm();
    normal += across;
    right += across * camera.centre();
  }
  return normal.completeOrthogonalDecomposition().solve(right);
}

/// Least squares of pixels (Gauss-Newton), with distortion.
Eigen::Vector3d least_squares(const Cameras &cameras, const Keypoints &seen, const std::vector<int> &chosen) {
  Eigen::Vector3d point = nearest_to_rays(cameras, seen, chosen);
  const auto is_near = [&](int i) { return !(cameras[i].camera.depth(point) > kTooNear); };
  for (int step = 0; step < kSteps && std::none_of(chosen.begin(), chosen.end(), is_near); ++step) {
    Eigen::MatrixX3d slope(2 * chosen.size(), 3);
    Eigen::VectorXd residual(2 * chosen.size());
    for (std::size_t k = 0; k < chosen.size(); ++k) {
      const CalibratedCamera &camera = cameras[chosen[k]];
      slope.middleRows<2>(2 * k) = camera.project_jacobian(point);
      residual.segment<2>(2 * k) = camera.project(point) - seen[chosen[k]].pixel;
    }
    point -= slope.completeOrthogonalDecomposition().solve(residual);
  }
  return point;
}

} // namespace

std::optional<Eigen::Vector3d> triangulate(const Cameras &cameras, const Keypoints &seen) {
  if (cameras.size() != seen.size())
    throw std::invalid_argument("triangulate: expected a keypoint of each of " + std::to_string(cameras.size()) +
                                " cameras, found " + std::to_string(seen.size()));
  for (std::size_t i = 0; i < cameras.size(); ++i)
    validate_camera(cameras[i].camera, "triangulate: camera " + std::to_string(i));
  std::vector<int> sure;
  for (int i = 0; i < static_cast<int>(seen.size()); ++i)
    if (seen[i].counts())
      sure.push_back(i);
  std::vector<int> best;
  double least = std::numeric_limits<double>::infinity(); // mean error of the best
  for (std::size_t a = 0; a < sure.size(); ++a)
    for (std::size_t b = a + 1; b < sure.size(); ++b) {
      const Eigen::Vector3d point = least_squares(cameras, seen, {sure[a], sure[b]});
      std::vector<int> agreeing;
      double sum = 0;
      bool both = true;
      for (const int i : sure) {
        const double error = image_error(cameras[i], seen[i], point);
        const bool agrees = error < kAgree;
        both = both && (agrees || (i != sure[a] && i != sure[b]));
        if (agrees) {
          agreeing.push_back(i);
          sum += error;
        }
      }
      if (!both || agreeing.size() < best.size())
        continue;
      const double mean = sum / static_cast<double>(agreeing.size());
      if (agreeing.size() == best.size() && mean >= least)
        continue;
      best = std::move(agreeing);
      least = mean;
    }
  if (best.empty())
    return {};
  return least_squares(cameras, seen, best);
}

} // namespace doublet
