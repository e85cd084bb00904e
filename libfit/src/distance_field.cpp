#include "doublet/fit/distance_field.h"

#include "optimizer_checks.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace doublet {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Lower envelope of the parabolas (x - i)^2 + f[i]; site[x] = the i whose parabola is lowest at x, -1 if all f are infinite.
class Envelope {
public:
  explicit Envelope(int size) : apex_(size), from_(size + 1) {}

  void transform(const std::vector<double> &f, int size, std::vector<int> &site) {
    int count = 0;
    for (int i = 0; i < size; ++i) {
      if (f[i] == kInfinity)
        continue;
      double start = -kInfinity;
      while (count > 0 && (start = crossing(f, apex_[count - 1], i)) <= from_[count - 1])
        --count;
      if (count == 0)
        start = -kInfinity;
      apex_[count] = i;
      from_[count++] = start;
    }
    for (int x = 0, k = 0; x < size; ++x) {
      while (k + 1 < count && from_[k + 1] < x)
        ++k;
      site[x] = count > 0 ? apex_[k] : -1;
    }
  }

private:
  static double crossing(const std::vector<double> &f, int a, int b) {
    return ((f[b] + static_cast<double>(b) * b) - (f[a] + static_cast<double>(a) * a)) / (2.0 * (b - a));
  }
  std::vector<int> apex_;
  std::vector<double> from_;
};

} // namespace

std::vector<int> nearest_seed(int width, int height, const std::vector<std::uint8_t> &seed) {
  require(width > 0 && height > 0 && seed.size() == static_cast<std::size_t>(width) * height,
          "nearest_seed: seed: expected width * height values, found " + std::to_string(seed.size()));
  const int longest = std::max(width, height);
  Envelope envelope(longest);
  std::vector<double> f(longest);
  std::vector<int> site(longest);
  std::vector<int> row_of(seed.size()); // per node the row of the closest seed in its column
  for (int x = 0; x < width; ++x) {
    for (int y = 0; y < height; ++y)
      f[y] = seed[static_cast<std::size_t>(y) * width + x] ? 0.0 : kInfinity;
    envelope.transform(f, height, site);
    for (int y = 0; y < height; ++y)
      row_of[static_cast<std::size_t>(y) * width + x] = site[y];
  }
  std::vector<int> nearest(seed.size());
  for (int y = 0; y < height; ++y) {
    const int *rows = &row_of[static_cast<std::size_t>(y) * width];
    for (int x = 0; x < width; ++x)
      f[x] = rows[x] < 0 ? kInfinity : static_cast<double>(rows[x] - y) * (rows[x] - y);
    envelope.transform(f, width, site);
    for (int x = 0; x < width; ++x)
      nearest[static_cast<std::size_t>(y) * width + x] = site[x] < 0 ? -1 : rows[site[x]] * width + site[x];
  }
  return nearest;
}

DistanceField::DistanceField(const std::vector<Eigen::Vector2f> &points, const Box &box, int cell, float cap)
    : cell_(cell), cap_(cap) {
  require(cell >= 1 && cap > 0, "DistanceField: cell and cap: expected positive numbers, found " + std::to_string(cell) +
                                    " and " + std::to_string(cap));
  require(box.x1 >= box.x0 && box.y1 >= box.y0, "DistanceField: box: expected x0 <= x1 and y0 <= y1");
  width_ = static_cast<int>(std::ceil((box.x1 - box.x0) / static_cast<float>(cell))) + 1;
  height_ = static_cast<int>(std::ceil((box.y1 - box.y0) / static_cast<float>(cell))) + 1;
  x0_ = box.x0;
  y0_ = box.y0;
  // The transform runs pixel by pixel, so that every contour point has a node of its own, and over more than what is kept, so
  // that contour just outside the box counts.
  const int margin = static_cast<int>(std::ceil(cap)) + 1;
  const int wide = (width_ - 1) * cell + 1 + 2 * margin, high = (height_ - 1) * cell + 1 + 2 * margin;
  std::vector<std::uint8_t> seed(static_cast<std::size_t>(wide) * high, 0);
  std::vector<int> point_at(seed.size(), -1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float x = std::round(points[i].x() - x0_) + static_cast<float>(margin);
    const float y = std::round(points[i].y() - y0_) + static_cast<float>(margin);
    if (!(x >= 0 && y >= 0 && x < static_cast<float>(wide) && y < static_cast<float>(high)))
      continue;
    const std::size_t node = static_cast<std::size_t>(y) * wide + static_cast<std::size_t>(x);
    seed[node] = 1;
    point_at[node] = static_cast<int>(i);
  }
  const std::vector<int> nearest = nearest_seed(wide, high, seed);
  values_.resize(static_cast<std::size_t>(width_) * height_);
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x) {
      const int node = nearest[static_cast<std::size_t>(y * cell + margin) * wide + x * cell + margin];
      float distance = cap;
      if (node >= 0) {
        const Eigen::Vector2f here(x0_ + static_cast<float>(x * cell), y0_ + static_cast<float>(y * cell));
        distance = std::min(cap, (points[point_at[node]] - here).norm());
      }
      values_[static_cast<std::size_t>(y) * width_ + x] = static_cast<std::uint16_t>(std::lround(distance / cap * 65535.f));
    }
}

float DistanceField::distance(float x, float y) const {
  const float gx = (x - x0_) / cell_, gy = (y - y0_) / cell_;
  const float cx = std::clamp(gx, 0.f, static_cast<float>(width_ - 1)), cy = std::clamp(gy, 0.f, static_cast<float>(height_ - 1));
  const int ix = std::min(static_cast<int>(cx), std::max(0, width_ - 2)),
            iy = std::min(static_cast<int>(cy), std::max(0, height_ - 2));
  const float fx = cx - ix, fy = cy - iy;
  const std::uint16_t *row = &values_[static_cast<std::size_t>(iy) * width_ + ix];
  const int right = width_ > 1 ? 1 : 0, down = height_ > 1 ? width_ : 0;
  const float top = row[0] + fx * (row[right] - row[0]), bottom = row[down] + fx * (row[down + right] - row[down]);
  const float inside = (top + fy * (bottom - top)) * (cap_ / 65535.f);
  if (gx == cx && gy == cy)
    return std::min(cap_, inside);
  return std::min(cap_, inside + std::hypot(gx - cx, gy - cy) * cell_);
}

} // namespace doublet
