#include "doublet/core/camera.h"

#include "doublet/core/error.h"
#include "doublet/options/options.h"

#include <cmath>
#include <stdexcept>

namespace doublet {

namespace {

/// Normalised image coordinates -> distorted, Brown 1971 with k1 k2 p1 p2 k3.
Eigen::Vector2d distort(const Eigen::Matrix<double, 5, 1> &k, const Eigen::Vector2d &n) {
  const double x = n.x(), y = n.y(), r2 = x * x + y * y;
  const double radial = 1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  return {x * radial + 2 * k[2] * x * y + k[3] * (r2 + 2 * x * x), y * radial + k[2] * (r2 + 2 * y * y) + 2 * k[3] * x * y};
}

Eigen::Matrix2d distort_jacobian(const Eigen::Matrix<double, 5, 1> &k, const Eigen::Vector2d &n) {
  const double x = n.x(), y = n.y(), r2 = x * x + y * y;
  const double radial = 1 + r2 * (k[0] + r2 * (k[1] + r2 * k[4]));
  const double slope = 2 * (k[0] + r2 * (2 * k[1] + r2 * 3 * k[4])); // d radial / d x = x * slope
  const double cross = x * y * slope + 2 * (k[2] * x + k[3] * y);
  Eigen::Matrix2d J;
  J << radial + x * x * slope + 2 * k[2] * y + 6 * k[3] * x, cross, //
      cross, radial + y * y * slope + 6 * k[2] * y + 2 * k[3] * x;
  return J;
}

} // namespace

Eigen::Vector2d Camera::project(const Eigen::Vector3d &point) const {
  const Eigen::Vector3d c = R * point + t;
  Eigen::Vector2d n = c.head<2>() / c.z();
  if (distorted())
    n = distort(distortion, n);
  return K.topLeftCorner<2, 2>() * n + K.topRightCorner<2, 1>();
}

Eigen::Matrix<double, 2, 3> Camera::project_jacobian(const Eigen::Vector3d &point) const {
  const Eigen::Vector3d c = R * point + t;
  Eigen::Matrix<double, 2, 3> J;
  J << 1, 0, -c.x() / c.z(), 0, 1, -c.y() / c.z();
  J = (J / c.z() * R).eval();
  if (distorted())
    J = (distort_jacobian(distortion, c.head<2>() / c.z()) * J).eval();
  return K.topLeftCorner<2, 2>() * J;
}

Eigen::Vector3d Camera::ray_direction(const Eigen::Vector2d &pixel) const {
  const double yd = (pixel.y() - K(1, 2)) / K(1, 1);
  const Eigen::Vector2d target((pixel.x() - K(0, 2) - K(0, 1) * yd) / K(0, 0), yd);
  Eigen::Vector2d n = target;
  if (distorted()) {
    for (int i = 0; i < 100; ++i) {
      const Eigen::Vector2d error = distort(distortion, n) - target;
      n -= error;
      if (error.squaredNorm() < 1e-24)
        break;
    }
  }
  return (R.transpose() * Eigen::Vector3d(n.x(), n.y(), 1)).normalized();
}

Camera Camera::resized(int new_width, int new_height) const {
  if (new_width <= 0 || new_height <= 0)
    throw std::invalid_argument("Camera::resized: the size must be positive, got " + std::to_string(new_width) + " x " +
                                std::to_string(new_height));
  const double sx = static_cast<double>(new_width) / width, sy = static_cast<double>(new_height) / height;
  Camera out = *this;
  out.K.row(0) *= sx;
  out.K.row(1) *= sy;
  // The image's edge, not the first pixel's centre, stays where it is.
  out.K(0, 2) += 0.5 * sx - 0.5;
  out.K(1, 2) += 0.5 * sy - 0.5;
  out.width = new_width;
  out.height = new_height;
  return out;
}

void validate_camera(const Camera &camera, const std::string &source) {
  const auto fail = [&](const std::string &what) { throw Error(source + ": camera '" + camera.name + "': " + what); };
  if (camera.width <= 0 || camera.height <= 0)
    fail("expected a positive image size, found " + std::to_string(camera.width) + " x " + std::to_string(camera.height));
  if (!camera.K.allFinite() || !camera.distortion.allFinite() || !camera.R.allFinite() || !camera.t.allFinite())
    fail("expected finite numbers in K, distortion, R and t, found NaN or infinity");
  if (camera.K(0, 0) <= 0 || camera.K(1, 1) <= 0)
    fail("expected positive focal lengths in K, found " + options::to_text(camera.K(0, 0)) + " and " +
         options::to_text(camera.K(1, 1)));
  if (camera.K(1, 0) != 0 || camera.K.row(2) != Eigen::RowVector3d(0, 0, 1))
    fail("expected K to be upper triangular with last row 0 0 1");
  const double off = (camera.R * camera.R.transpose() - Eigen::Matrix3d::Identity()).cwiseAbs().maxCoeff();
  if (off > 1e-3 || camera.R.determinant() < 0)
    fail("expected R to be a rotation, found |R R^T - I| = " + options::to_text(off, 4) + " and determinant " +
         options::to_text(camera.R.determinant(), 4));
}

} // namespace doublet
