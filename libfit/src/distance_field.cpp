#include "doublet/fit/parts/distance_field.h"

#include "doublet/options/options.h"

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

/// (height, width) the row of the closest seed in the node's column, the upper of two as close, -1 if there is none.
std::vector<int> nearest_rows(int width, int height, const std::vector<std::uint8_t> &seed) {
  std::vector<int> row_of(seed.size());
  std::vector<int> last(width, -1);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t node = static_cast<std::size_t>(y) * width + x;
      row_of[node] = last[x] = seed[node] ? y : last[x];
    }
  last.assign(width, -1);
  for (int y = height - 1; y >= 0; --y)
    for (int x = 0; x < width; ++x) {
      const std::size_t node = static_cast<std::size_t>(y) * width + x;
      last[x] = seed[node] ? y : last[x];
      const bool nearer = row_of[node] < 0 || (last[x] >= 0 && last[x] - y < y - row_of[node]);
      row_of[node] = nearer ? last[x] : row_of[node];
    }
  return row_of;
}

/// From nearest_rows() of a row y to the closest seed of each of its nodes.
class RowTransform {
public:
  explicit RowTransform(int width) : width_(width), envelope_(width), f_(width), site_(width) {}
  void transform(const int *rows, int y, int *nearest) {
    for (int x = 0; x < width_; ++x)
      f_[x] = rows[x] < 0 ? kInfinity : static_cast<double>(rows[x] - y) * (rows[x] - y);
    envelope_.transform(f_, width_, site_);
    for (int x = 0; x < width_; ++x)
      nearest[x] = site_[x] < 0 ? -1 : rows[site_[x]] * width_ + site_[x];
  }

private:
  int width_;
  Envelope envelope_;
  std::vector<double> f_;
  std::vector<int> site_;
};

} // namespace

std::vector<int> nearest_seed(int width, int height, const std::vector<std::uint8_t> &seed) {
  require(width > 0 && height > 0 && seed.size() == static_cast<std::size_t>(width) * height,
          "nearest_seed: seed: expected width * height values, found " + std::to_string(seed.size()));
  const std::vector<int> rows = nearest_rows(width, height, seed);
  std::vector<int> nearest(seed.size());
  RowTransform row(width);
  for (int y = 0; y < height; ++y)
    row.transform(&rows[static_cast<std::size_t>(y) * width], y, &nearest[static_cast<std::size_t>(y) * width]);
  return nearest;
}

DistanceField::DistanceField(const std::vector<Eigen::Vector2f> &points, const Box &box, int cell, float cap)
    : cell_(cell), cap_(cap) {
  require(cell >= 1 && cap > 0, "DistanceField: cell and cap: expected positive numbers, found " + options::to_text(cell) +
                                    " and " + options::to_text(cap));
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
  const std::vector<int> rows = nearest_rows(wide, high, seed);
  std::vector<int> nearest(wide); // of the rows that are kept alone
  RowTransform row(wide);
  values_.resize(static_cast<std::size_t>(width_) * height_);
  for (int y = 0; y < height_; ++y) {
    const int fine_y = y * cell + margin;
    row.transform(&rows[static_cast<std::size_t>(fine_y) * wide], fine_y, nearest.data());
    for (int x = 0; x < width_; ++x) {
      const int node = nearest[x * cell + margin];
      float distance = cap;
      if (node >= 0) {
        const Eigen::Vector2f here(x0_ + static_cast<float>(x * cell), y0_ + static_cast<float>(y * cell));
        distance = std::min(cap, (points[point_at[node]] - here).norm());
      }
      values_[static_cast<std::size_t>(y) * width_ + x] = static_cast<std::uint16_t>(std::lround(distance / cap * 65535.f));
    }
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
