#include "backdrop.h"

#include <algorithm>
#include <cmath>

namespace doublet::detail {
namespace {

using Eigen::ArrayXf;
using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double kShadowCell = 0.03;         // m
constexpr double kShadowBlur = 0.09;         // m
constexpr float kSteepest = 1e-3f;           // sine of the angle under the horizon from which on a ray meets the floor
constexpr float kFade = 12;                  // m, over which the floor goes over into the sky
constexpr float kLine = 0.006f, kGap = 0.5f; // m, half width of the grid's lines, and from one to the next

/// exp(x) for x >= 0, at a fraction of its time: the first terms of exp(x / 16), to the power of 16. Its inverse is off by 0.001
/// at most.
template <class Values> auto growth(const Values &x) {
  return (1 + x * (1.0f / 16) * (1 + x * (0.5f / 16))).square().square().square().square();
}

/// The squared distance to the nearest line of the grid.
template <class Values> auto to_line(const Values &x) {
  constexpr float kNoFraction = 12582912; // 1.5 * 2^23: added, it leaves no bits below 1, so that the sum is rounded
  return (x - kGap * ((x * (1 / kGap) + kNoFraction) - kNoFraction)).square();
}

} // namespace

FloorShadow::FloorShadow(const std::vector<const Vertices *> &meshes, double floor) {
  Vector3d low = Vector3d::Constant(1e30), high = -low;
  for (const Vertices *vertices : meshes)
    if (vertices->rows() > 0) {
      low = low.cwiseMin(Vector3d(vertices->colwise().minCoeff()));
      high = high.cwiseMax(Vector3d(vertices->colwise().maxCoeff()));
    }
  if (low.x() > high.x() || (high - low).maxCoeff() > 50)
    return;
  const double margin = 4 * kShadowBlur;
  x0_ = static_cast<float>(low.x() - margin);
  z0_ = static_cast<float>(low.z() - margin);
  nx_ = static_cast<int>((high.x() - low.x() + 2 * margin) / kShadowCell) + 1;
  nz_ = static_cast<int>((high.z() - low.z() + 2 * margin) / kShadowCell) + 1;
  cells_.assign(static_cast<std::size_t>(nx_) * nz_, 0.0f);
  for (const Vertices *vertices : meshes)
    for (Eigen::Index v = 0; v < vertices->rows(); ++v) {
      const double height = std::max((*vertices)(v, 1) - floor, 0.0);
      const auto dark = static_cast<float>(std::exp(-height / 0.7)); // a contact is dark, a head 1.7 m up hardly
      float &cell = cells_[index((*vertices)(v, 0), (*vertices)(v, 2))];
      cell = std::max(cell, dark);
    }
  for (int pass = 0; pass < 3; ++pass) { // three box filters are near enough to a Gaussian
    blur(1, nx_, nx_, nz_);
    blur(nx_, nz_, 1, nx_);
  }
}

void FloorShadow::darken(const ArrayXf &x, const ArrayXf &z, ArrayXf &brightness) const {
  const float x1 = x0_ + static_cast<float>(nx_ * kShadowCell), z1 = z0_ + static_cast<float>(nz_ * kShadowCell);
  if (x.maxCoeff() < x0_ || x.minCoeff() > x1 || z.maxCoeff() < z0_ || z.minCoeff() > z1)
    return; // all of a row is beside it
  for (Eigen::Index i = 0; i < x.size(); ++i)
    brightness[i] *= 1 - std::min(0.75f, 1.6f * at(x[i], z[i]));
}

float FloorShadow::at(float x, float z) const {
  constexpr auto kCells = static_cast<float>(1 / kShadowCell); // in a metre
  const float i = (x - x0_) * kCells - 0.5f, k = (z - z0_) * kCells - 0.5f;
  if (!(i >= 0) || !(k >= 0) || !(i < static_cast<float>(nx_ - 1)) || !(k < static_cast<float>(nz_ - 1)))
    return 0;
  const int i0 = static_cast<int>(i), k0 = static_cast<int>(k);
  const float a = i - static_cast<float>(i0), b = k - static_cast<float>(k0);
  const float *c = &cells_[static_cast<std::size_t>(k0) * nx_ + i0];
  return (1 - b) * ((1 - a) * c[0] + a * c[1]) + b * ((1 - a) * c[nx_] + a * c[nx_ + 1]);
}

std::size_t FloorShadow::index(double x, double z) const {
  return static_cast<std::size_t>((z - z0_) / kShadowCell) * nx_ + static_cast<std::size_t>((x - x0_) / kShadowCell);
}

/// Box filter along `length` cells `stride` apart, for `lines` lines `next` apart.
void FloorShadow::blur(std::size_t stride, int length, std::size_t next, int lines) {
  const int r = static_cast<int>(kShadowBlur / kShadowCell);
  std::vector<float> line(length);
  for (int l = 0; l < lines; ++l) {
    float *start = cells_.data() + l * next;
    for (int i = 0; i < length; ++i)
      line[i] = start[i * stride];
    for (int i = 0; i < length; ++i) {
      float sum = 0;
      for (int k = std::max(0, i - r); k <= std::min(length - 1, i + r); ++k)
        sum += line[k];
      start[i * stride] = sum / (2 * r + 1);
    }
  }
}

Backdrop::Backdrop(const std::vector<const Vertices *> &meshes, const Camera &camera, const RenderOptions &options)
    : rays_(camera), eye_(camera.centre().cast<float>()),
      drop_(options.floor ? static_cast<float>(options.floor_height - camera.centre().y()) : 0.0f) {
  if (drop_ < 0)
    shadow_ = FloorShadow(meshes, options.floor_height);
}

const ArrayXf &Backdrop::row(float first, float step, float y, int count) {
  brightness_.setOnes(count);
  if (!(drop_ < 0)) // no floor, or seen from below
    return brightness_;
  const ArrayXf pixels = ArrayXf::LinSpaced(count, first, first + step * static_cast<float>(count - 1));
  rays_.along(pixels, y, {&ray_x_, &ray_y_, &ray_z_});
  if (!(ray_y_.minCoeff() < 0)) // above the horizon
    return brightness_;
  inverse_ = (ray_x_.square() + ray_y_.square() + ray_z_.square()).sqrt().inverse(); // of the rays' lengths
  down_ = ray_y_ * -inverse_;                                                        // sine of the angle under the horizon
  away_ = -drop_ / down_.max(kSteepest);                                             // m from the eye to the floor
  inverse_ *= away_;
  x_ = eye_.x() + inverse_ * ray_x_;
  z_ = eye_.z() + inverse_ * ray_z_;
  brightness_ = 0.86f - 0.10f / growth(to_line(x_).min(to_line(z_)) * (1 / (2 * kLine * kLine)));
  shadow_.darken(x_, z_, brightness_);
  // Of the floor there is nothing left far away, nor at the horizon.
  brightness_ = 1 - (1 - brightness_) * down_.max(0).min(kSteepest) * (1 / kSteepest) / growth(away_ * (1 / kFade));
  return brightness_;
}

} // namespace doublet::detail
