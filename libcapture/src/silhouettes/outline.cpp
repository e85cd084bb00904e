#include "doublet/capture/outline.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>

namespace doublet {
namespace {

constexpr int kCell = 8;          // pixels; about one cell a nearest query at convergence
constexpr int kShortestLoop = 12; // pixels

double signed_area(const std::vector<cv::Point> &loop) {
  double twice = 0;
  for (size_t i = 0; i < loop.size(); ++i) {
    const cv::Point &a = loop[i], &b = loop[(i + 1) % loop.size()];
    twice += static_cast<double>(a.x) * b.y - static_cast<double>(b.x) * a.y;
  }
  return twice / 2;
}

constexpr int kAround = 3; // pixels of a loop that its smoothing looks at before and behind one

/// A loop, which begins and ends with kAround pixels of its other end.
std::vector<Eigen::Vector2f> closed(const std::vector<cv::Point> &loop) {
  const int n = static_cast<int>(loop.size());
  std::vector<Eigen::Vector2f> points;
  points.reserve(loop.size() + 2 * kAround);
  for (int k = n - kAround; k < 2 * n + kAround; ++k) {
    const cv::Point &p = loop[k % n];
    points.emplace_back(static_cast<float>(p.x), static_cast<float>(p.y));
  }
  return points;
}

Eigen::Vector2f mean_of(const std::vector<Eigen::Vector2f> &closed_loop, int centre, int half) {
  Eigen::Vector2f sum = Eigen::Vector2f::Zero();
  for (int k = centre - half; k <= centre + half; ++k)
    sum += closed_loop[k + kAround];
  return sum / static_cast<float>(2 * half + 1);
}

void append_loop(const std::vector<cv::Point> &loop, bool hole, int width, int height, int margin, Outline &outline) {
  const float side = (signed_area(loop) > 0) == !hole ? 1.f : -1.f; // +1: the right-hand normal (t_y, -t_x) points outward
  const std::vector<Eigen::Vector2f> points = closed(loop);
  for (int i = 0; i < static_cast<int>(loop.size()); ++i) {
    const cv::Point &pixel = loop[i];
    if (pixel.x < margin || pixel.y < margin || pixel.x >= width - margin || pixel.y >= height - margin)
      continue;
    const Eigen::Vector2f tangent = mean_of(points, i + 2, 1) - mean_of(points, i - 2, 1);
    if (tangent.squaredNorm() < 1e-6f) // the tip of a one-pixel spike has no direction
      continue;
    const Eigen::Vector2f normal = side * Eigen::Vector2f(tangent.y(), -tangent.x()).normalized();
    // Inside pixels' centres lie 0 to max(|nx|, |ny|) pixels inside the true edge, half of that on average.
    const float shift = 0.5f * std::max(std::abs(normal.x()), std::abs(normal.y()));
    outline.points.push_back(mean_of(points, i, 2) + shift * normal);
    outline.normals.push_back(normal);
    outline.pixels.emplace_back(pixel.x, pixel.y);
  }
}

} // namespace

Outline trace_outline(const Image &mask, int margin) {
  return trace_outline(mask, 0, 0, mask.width, mask.height, margin);
}

Outline trace_outline(const Image &part, int x, int y, int width, int height, int margin) {
  Outline outline;
  if (margin < 0 || (!part.empty() && part.channels != 1))
    throw std::invalid_argument("trace_outline: expected a mask of 1 channel and a margin of at least 0, found " +
                                std::to_string(part.channels) + " and " + std::to_string(margin));
  if (x < 0 || y < 0 || x + part.width > width || y + part.height > height)
    throw std::invalid_argument("trace_outline: expected a part of a mask of " + std::to_string(width) + " x " +
                                std::to_string(height) + ", found " + std::to_string(part.width) + " x " +
                                std::to_string(part.height) + " at (" + std::to_string(x) + ", " + std::to_string(y) + ")");
  if (part.empty())
    return outline;
  const cv::Mat view(part.height, part.width, CV_8UC1, const_cast<std::uint8_t *>(part.data.data()));
  std::vector<std::vector<cv::Point>> loops;
  std::vector<cv::Vec4i> hierarchy;
  cv::findContours(view, loops, hierarchy, cv::RETR_CCOMP, cv::CHAIN_APPROX_NONE, cv::Point(x, y));
  for (size_t l = 0; l < loops.size(); ++l)
    if (static_cast<int>(loops[l].size()) >= kShortestLoop)
      append_loop(loops[l], hierarchy[l][3] >= 0, width, height, margin, outline);
  return outline;
}

Image fill_outline(const std::vector<Eigen::Vector2f> &points, int width, int height) {
  constexpr float kGap = 6; // pixels; farther apart than smoothed neighbours ever are: a new loop begins
  constexpr int kShift = 4; // cv::fillPoly takes fixed point
  std::vector<std::vector<cv::Point>> loops;
  for (size_t i = 0; i < points.size(); ++i) {
    if (i == 0 || (points[i] - points[i - 1]).norm() > kGap)
      loops.emplace_back();
    loops.back().emplace_back(static_cast<int>(std::lround(points[i].x() * (1 << kShift))),
                              static_cast<int>(std::lround(points[i].y() * (1 << kShift))));
  }
  Image mask(width, height, 1);
  cv::Mat view(height, width, CV_8UC1, mask.data.data());
  if (!loops.empty())
    cv::fillPoly(view, loops, cv::Scalar(255), cv::LINE_8, kShift);
  return mask;
}

OutlineIndex::OutlineIndex(const Outline &outline, int width, int height)
    : columns_(width / kCell + 1), rows_(height / kCell + 1), first_(columns_ * rows_ + 1, 0) {
  const auto cell = [&](const Eigen::Vector2f &p) {
    const int x = std::clamp(static_cast<int>(p.x()) / kCell, 0, columns_ - 1);
    const int y = std::clamp(static_cast<int>(p.y()) / kCell, 0, rows_ - 1);
    return y * columns_ + x;
  };
  for (const Eigen::Vector2f &p : outline.points)
    ++first_[cell(p) + 1];
  for (size_t c = 1; c < first_.size(); ++c)
    first_[c] += first_[c - 1];
  entries_.resize(outline.points.size());
  std::vector<int> next(first_.begin(), first_.end() - 1);
  for (size_t i = 0; i < outline.points.size(); ++i)
    entries_[next[cell(outline.points[i])]++] = {outline.points[i], outline.normals[i], static_cast<int>(i)};
}

int OutlineIndex::nearest(const Eigen::Vector2f &point, const Eigen::Vector2f &normal, float radius, float min_cosine) const {
  if (!(std::abs(point.x()) < 1e6f && std::abs(point.y()) < 1e6f)) // NaN, or projected from behind the camera
    return -1;
  const int cx = static_cast<int>(std::floor(point.x() / kCell)), cy = static_cast<int>(std::floor(point.y() / kCell));
  int best = -1;
  float best_squared = radius * radius;
  const auto look = [&](int y, int from, int to) {
    const int *row = first_.data() + y * columns_;
    for (int e = row[std::clamp(from, 0, columns_)]; e < row[std::clamp(to + 1, 0, columns_)]; ++e) {
      const float squared = (entries_[e].point - point).squaredNorm();
      if (squared < best_squared && entries_[e].normal.dot(normal) >= min_cosine) {
        best_squared = squared;
        best = entries_[e].index;
      }
    }
  };
  // Square rings of cells outward; ring r holds nothing closer than (r - 1) cells.
  for (int ring = 0; static_cast<float>((ring - 1) * kCell) * std::abs((ring - 1) * kCell) <= best_squared; ++ring)
    for (int y = std::max(cy - ring, 0); y <= std::min(cy + ring, rows_ - 1); ++y)
      if (y == cy - ring || y == cy + ring) {
        look(y, cx - ring, cx + ring);
      } else {
        look(y, cx - ring, cx - ring);
        look(y, cx + ring, cx + ring);
      }
  return best;
}

} // namespace doublet
