#pragma once
// Pinhole camera with OpenCV's conventions: x right, y down, z forward; x_cam = R x_world + t; pixel (0, 0) is the centre of the
// top-left pixel; distortion k1 k2 p1 p2 k3 (Brown 1971, as in OpenCV's calib3d).

#include "doublet/core/types.h"

#include <string>
#include <vector>

namespace doublet {

struct Camera {
  std::string name;
  Eigen::Matrix3d K = Eigen::Matrix3d::Identity();
  Eigen::Matrix<double, 5, 1> distortion = Eigen::Matrix<double, 5, 1>::Zero(); ///< k1 k2 p1 p2 k3
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();                              ///< cam_from_world rotation
  Eigen::Vector3d t = Eigen::Vector3d::Zero();                                  ///< cam_from_world translation, m
  int width = 0, height = 0;                                                    ///< pixels

  Eigen::Vector3d centre() const { return -R.transpose() * t; }
  bool distorted() const { return distortion.squaredNorm() > 0; }
  /// Pixel of a world point; meaningless if depth(point) <= 0.
  Eigen::Vector2d project(const Eigen::Vector3d &point) const;
  /// d project / d point, (2, 3), pixels per metre, distortion included.
  Eigen::Matrix<double, 2, 3> project_jacobian(const Eigen::Vector3d &point) const;
  double depth(const Eigen::Vector3d &point) const { return R.row(2).dot(point) + t.z(); }
  /// Unit direction in the world of the ray through a pixel; undistorts by fixed-point iteration.
  Eigen::Vector3d ray_direction(const Eigen::Vector2d &pixel) const;
  /// The same camera for images resized to the given size (pixel centres remain at integers).
  Camera resized(int new_width, int new_height) const;
};

/// The calibrated cameras of a session.
using CameraRig = std::vector<Camera>;

/// Throws Error naming `source` if K, R or the size are invalid (R not a rotation to 1e-3, focal length <= 0, NaN, size <= 0).
void validate_camera(const Camera &camera, const std::string &source);

} // namespace doublet
