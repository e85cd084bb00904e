#include "doublet/capture/feature_tracker.h"

#include "doublet/core/error.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <opencv2/features2d.hpp>
#include <opencv2/imgproc.hpp>
#include <stdexcept>
#include <string>
#include <tuple>

namespace doublet {
namespace {

cv::Mat as_mat(const Image &image) {
  return cv::Mat(image.height, image.width, image.channels == 3 ? CV_8UC3 : CV_8UC1,
                 const_cast<std::uint8_t *>(image.data.data()));
}

/// Indices of keypoints, strongest first, ties by place (OpenCV's own order depends on its threads), one a place: a second
/// orientation at the same place would be its own second-best match.
std::vector<int> chosen_keypoints(const std::vector<cv::KeyPoint> &keypoints, int budget) {
  std::vector<int> order(keypoints.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int i, int j) {
    const cv::KeyPoint &a = keypoints[i], &b = keypoints[j];
    return std::tie(b.response, a.pt.y, a.pt.x, a.size, a.angle) < std::tie(a.response, b.pt.y, b.pt.x, b.size, b.angle);
  });
  const auto same_place = [&](int i, int j) { return keypoints[i].pt == keypoints[j].pt; };
  order.erase(std::unique(order.begin(), order.end(), same_place), order.end());
  order.resize(std::min<size_t>(order.size(), budget));
  return order;
}

/// A feature within reach of another one: which, and the squared distance of their descriptors.
struct Candidate {
  int index;
  double distance;
};

/// [features] the closest candidate of each, if it is clearly closer than any at another place; -1 otherwise. `points`: of the
/// candidates.
std::vector<int> best_matches(const std::vector<std::vector<Candidate>> &candidates, const std::vector<Eigen::Vector2f> &points,
                              double ratio) {
  constexpr float kSamePlace = 3; // pixels; one corner seen in two ways is no rival of itself
  std::vector<int> best(candidates.size(), -1);
  for (size_t i = 0; i < candidates.size(); ++i) {
    const auto closest = std::min_element(candidates[i].begin(), candidates[i].end(),
                                          [](const Candidate &a, const Candidate &b) { return a.distance < b.distance; });
    if (closest == candidates[i].end())
      continue;
    double rival = 1e30;
    for (const Candidate &other : candidates[i])
      if ((points[other.index] - points[closest->index]).norm() > kSamePlace)
        rival = std::min(rival, other.distance);
    if (closest->distance <= ratio * ratio * rival)
      best[i] = closest->index;
  }
  return best;
}

/// Squared distances of the rows of two matrices. Those of SIFT are whole numbers of one byte: sums of their squares are exact in
/// integers, and the same as in doubles.
class RowDistances {
public:
  RowDistances(const MatrixRM &previous, const MatrixRM &current) : previous_(previous), current_(current) {
    if (!to_bytes(previous, previous_bytes_) || !to_bytes(current, current_bytes_))
      previous_bytes_.clear();
  }
  double operator()(int i, int j) const {
    const Eigen::Index size = previous_.cols();
    if (previous_bytes_.empty())
      return (previous_.row(i) - current_.row(j)).squaredNorm();
    return squared_distance(previous_bytes_.data() + i * size, current_bytes_.data() + j * size, static_cast<int>(size));
  }

private:
  static bool to_bytes(const MatrixRM &rows, std::vector<std::int16_t> &bytes) {
    constexpr Eigen::Index kLongest = 32768; // so many squares of a byte fit into an int
    if (rows.cols() > kLongest)
      return false;
    bytes.resize(rows.size());
    bool all = true;
    for (Eigen::Index i = 0; i < rows.size(); ++i) {
      const double value = rows.data()[i];
      bytes[i] = static_cast<std::int16_t>(std::min(std::max(0.0, value), 255.0));
      all &= bytes[i] == value;
    }
    return all;
  }
  static int squared_distance(const std::int16_t *a, const std::int16_t *b, int size) {
    int sum = 0;
    for (int k = 0; k < size; ++k) {
      const auto difference = static_cast<std::int16_t>(a[k] - b[k]);
      sum += difference * difference;
    }
    return sum;
  }

  const MatrixRM &previous_, &current_;
  std::vector<std::int16_t> previous_bytes_, current_bytes_; // empty: other numbers
};

class SiftTracker : public FeatureTracker {
public:
  explicit SiftTracker(const FeatureTrackerOptions &options) : options_(options) {}

  Features detect(const Image &image, const Image &mask) const override {
    if (image.width != mask.width || image.height != mask.height)
      throw std::invalid_argument("FeatureTracker::detect: image and mask must be of one size");
    const cv::Mat inside = as_mat(mask);
    const cv::Rect box = cv::boundingRect(inside);
    if (box.width < 16 || box.height < 16)
      return {};
    cv::Mat grey, eroded;
    if (image.channels == 3)
      cv::cvtColor(as_mat(image)(box), grey, cv::COLOR_BGR2GRAY);
    else
      as_mat(image)(box).copyTo(grey);
    const int radius = std::max(1, options_.erode * image.height / 1004);
    grey.setTo(cv::mean(grey, inside(box)), inside(box) == 0); // what stands behind the actor is of no use
    cv::erode(inside(box), eroded, cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * radius + 1, 2 * radius + 1}));
    return describe(grey, eroded, box.tl());
  }

  std::vector<std::pair<int, int>> match(const Features &previous, const Features &current, double reach) const override {
    if (!(reach >= 0))
      throw std::invalid_argument("FeatureTracker.match: expected a reach of at least 0 px, found " + std::to_string(reach));
    if (previous.descriptors.cols() != current.descriptors.cols() && !previous.points.empty() && !current.points.empty())
      throw std::invalid_argument("FeatureTracker.match: expected descriptors of one length, found " +
                                  std::to_string(previous.descriptors.cols()) + " and " +
                                  std::to_string(current.descriptors.cols()));
    const int n = static_cast<int>(previous.points.size()), m = static_cast<int>(current.points.size());
    const RowDistances distances(previous.descriptors, current.descriptors);
    std::vector<std::vector<Candidate>> of_previous(n), of_current(m);
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < m; ++j) {
        if ((previous.points[i] - current.points[j]).squaredNorm() > reach * reach)
          continue;
        const double distance = distances(i, j);
        of_previous[i].push_back({j, distance});
        of_current[j].push_back({i, distance});
      }
    const std::vector<int> forward = best_matches(of_previous, current.points, options_.ratio);
    const std::vector<int> backward = best_matches(of_current, previous.points, options_.ratio);
    std::vector<std::pair<int, int>> pairs;
    for (size_t i = 0; i < forward.size(); ++i)
      if (forward[i] >= 0 && backward[forward[i]] == static_cast<int>(i))
        pairs.emplace_back(static_cast<int>(i), forward[i]);
    return pairs;
  }

private:
  Features describe(const cv::Mat &grey, const cv::Mat &mask, const cv::Point &origin) const {
    // SIFT applies its own limit before the mask: ask for twice the budget, so that edges outside the mask cannot use it up.
    const cv::Ptr<cv::SIFT> sift = cv::SIFT::create(2 * options_.budget);
    std::vector<cv::KeyPoint> keypoints;
    cv::Mat descriptors;
    sift->detectAndCompute(grey, mask, keypoints, descriptors);
    const std::vector<int> chosen = chosen_keypoints(keypoints, options_.budget);
    Features features;
    features.descriptors.resize(chosen.size(), descriptors.cols);
    for (size_t i = 0; i < chosen.size(); ++i) {
      const cv::Point2f &p = keypoints[chosen[i]].pt;
      features.points.emplace_back(p.x + origin.x, p.y + origin.y);
      for (int c = 0; c < descriptors.cols; ++c)
        features.descriptors(i, c) = descriptors.at<float>(chosen[i], c);
    }
    return features;
  }

  FeatureTrackerOptions options_;
};

} // namespace

std::unique_ptr<FeatureTracker> FeatureTracker::create(const FeatureTrackerOptions &options) {
  options.validate();
  return std::make_unique<SiftTracker>(options);
}

} // namespace doublet
