#include "body_bound.h"

#include "doublet/core/parts/sparse_solve.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

namespace doublet::detail {

namespace {

constexpr double kSlice = 0.01, kPixel = 0.005; // m; between slices, of their pictures

/// Where a mesh crosses a height, drawn from above.
class SlicePicture {
public:
  SlicePicture(const Mesh &body) : body_(body) {
    const Eigen::RowVector3d low = body.vertices.colwise().minCoeff(), high = body.vertices.colwise().maxCoeff();
    origin_ = {low.x() - 4 * kPixel, low.z() - 4 * kPixel};
    size_ = cv::Size(static_cast<int>((high.x() - low.x()) / kPixel) + 9, static_cast<int>((high.z() - low.z()) / kPixel) + 9);
  }

  /// Convex hull of the parts that are large, m, and how many they are: two legs, or one trunk.
  std::pair<std::vector<cv::Point2f>, int> around(double height) const {
    constexpr double kLarge = 0.35; // of the largest; hands are smaller
    cv::Mat picture = drawn(height), labels, stats, centres;
    const int count = cv::connectedComponentsWithStats(picture, labels, stats, centres, 8, CV_32S);
    int largest = 0;
    for (int c = 1; c < count; ++c)
      largest = std::max(largest, stats.at<int>(c, cv::CC_STAT_AREA));
    int parts = 0;
    std::vector<cv::Point> pixels, hull;
    for (int c = 1; c < count; ++c)
      if (stats.at<int>(c, cv::CC_STAT_AREA) >= kLarge * largest) {
        std::vector<cv::Point> of_part;
        cv::findNonZero(labels == c, of_part);
        pixels.insert(pixels.end(), of_part.begin(), of_part.end());
        ++parts;
      }
    std::vector<cv::Point2f> result;
    if (!pixels.empty())
      cv::convexHull(pixels, hull);
    for (const cv::Point &p : hull)
      result.emplace_back(static_cast<float>(origin_.x() + kPixel * p.x), static_cast<float>(origin_.y() + kPixel * p.y));
    return {result, parts};
  }

private:
  cv::Mat drawn(double height) const {
    cv::Mat lines(size_, CV_8UC1, cv::Scalar(0));
    for (Eigen::Index f = 0; f < body_.faces.rows(); ++f) {
      std::vector<cv::Point> ends;
      for (int c = 0; c < 3; ++c) {
        const Eigen::Vector3d a = body_.vertices.row(body_.faces(f, c)), b = body_.vertices.row(body_.faces(f, (c + 1) % 3));
        if ((a.y() > height) != (b.y() > height))
          ends.push_back(pixel(a + (height - a.y()) / (b.y() - a.y()) * (b - a)));
      }
      if (ends.size() == 2)
        cv::line(lines, ends[0], ends[1], 255);
    }
    cv::Mat outside = lines.clone();
    cv::floodFill(outside, {0, 0}, 128);
    return outside != 128;
  }
  cv::Point pixel(const Eigen::Vector3d &p) const {
    return {static_cast<int>(std::lround((p.x() - origin_.x()) / kPixel)),
            static_cast<int>(std::lround((p.z() - origin_.y()) / kPixel))};
  }

  const Mesh &body_;
  Eigen::Vector2d origin_; // x, z; m
  cv::Size size_;
};

} // namespace

LegGap::LegGap(const Mesh &body) {
  const SlicePicture picture(body);
  lowest_ = body.vertices.col(1).minCoeff();
  const double highest = body.vertices.col(1).maxCoeff();
  constexpr double kGroin = 0.15; // m above the gap, where the thighs still stand out
  double gap = lowest_ - kGroin;  // the highest with two legs so far
  for (double height = lowest_ + kSlice / 2; height < highest; height += kSlice) {
    auto [hull, parts] = picture.around(height);
    if (parts == 2)
      gap = height;
    const bool taken = !hull.empty() && (parts == 2 || (parts == 1 && height - gap < kGroin));
    slice_at_.push_back(taken ? static_cast<int>(slices_.size()) : -1);
    if (taken)
      slices_.push_back({height, std::move(hull)});
  }
}

std::vector<Eigen::Vector3d> LegGap::middles() const {
  std::vector<Eigen::Vector3d> result;
  for (const Slice &slice : slices_) {
    const cv::Moments m = cv::moments(slice.hull);
    result.emplace_back(m.m10 / m.m00, slice.height, m.m01 / m.m00);
  }
  return result;
}

void LegGap::keep(const std::vector<bool> &spanned) {
  for (int &slice : slice_at_)
    if (slice >= 0 && !spanned[slice])
      slice = -1;
}

LegGap::Side LegGap::nearest(const Eigen::Vector3d &point) const {
  Side best{1e3, point, point, 0};
  const double index = std::floor((point.y() - lowest_) / kSlice);
  if (!(index >= 0) || index >= static_cast<double>(slice_at_.size()) || slice_at_[static_cast<std::size_t>(index)] < 0)
    return best;
  const std::vector<cv::Point2f> &hull = slices_[slice_at_[static_cast<std::size_t>(index)]].hull;
  const cv::Point2f here(static_cast<float>(point.x()), static_cast<float>(point.z()));
  for (std::size_t i = 0; i < hull.size(); ++i) {
    const cv::Point2f &a = hull[i], &b = hull[(i + 1) % hull.size()], along = b - a;
    const float share = std::clamp((here - a).dot(along) / along.dot(along), 0.0F, 1.0F);
    if (const double off = cv::norm(here - a - share * along); off < best.distance)
      best = {off, {a.x, point.y(), a.y}, {b.x, point.y(), b.y}, share};
  }
  if (cv::pointPolygonTest(hull, here, false) > 0)
    best.distance = -best.distance;
  return best;
}

BodyBound::BodyBound(const Mesh &body, const std::function<bool(const Eigen::Vector3d &)> &filled)
    : body_(body), scene_(body), gap_(body), normals_(vertex_normals(body.vertices, body.faces)),
      clearance_(Eigen::VectorXd::Zero(body.vertices.rows())) {
  std::vector<bool> spanned;
  for (const Eigen::Vector3d &middle : gap_.middles())
    spanned.push_back(filled(middle));
  gap_.keep(spanned);
}

BodyBound::Look BodyBound::look(const Eigen::Vector3d &point) const {
  const ClosestPoint closest = scene_.closest(point);
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (int c = 0; c < 3; ++c)
    normal += closest.barycentric[c] * normals_.row(body_.faces(closest.face, c)).transpose();
  const bool outside = normal.dot(point - closest.point) >= 0;
  const double off = outside ? closest.distance : -closest.distance;
  const LegGap::Side side = gap_.nearest(point);
  return {std::min(off, side.distance), closest, side, side.distance < off};
}

double BodyBound::clearance_at(const ClosestPoint &on_body) const {
  double clearance = 0;
  for (int c = 0; c < 3; ++c)
    clearance += on_body.barycentric[c] * clearance_[body_.faces(on_body.face, c)];
  return clearance;
}

void BodyBound::learn(const std::vector<Contact> &contacts) {
  constexpr double kHeat = 2;    // weight of an edge against that of a contact at a vertex
  constexpr double kHold = 1e-6; // of a clearance of 0 where no heat comes
  const auto vertices = body_.vertices.rows();
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(vertices), weight = Eigen::VectorXd::Constant(vertices, kHold);
  for (const Contact &contact : contacts) {
    const ClosestPoint at = scene_.closest(contact.point);
    for (int c = 0; c < 3; ++c) {
      sum[body_.faces(at.face, c)] += at.barycentric[c] * contact.clearance;
      weight[body_.faces(at.face, c)] += at.barycentric[c];
    }
  }
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index i = 0; i < vertices; ++i)
    entries.emplace_back(i, i, weight[i]);
  for (Eigen::Index f = 0; f < body_.faces.rows(); ++f)
    for (int c = 0; c < 3; ++c) { // both faces of an edge count
      const int a = body_.faces(f, c), b = body_.faces(f, (c + 1) % 3);
      entries.emplace_back(a, a, kHeat / 2);
      entries.emplace_back(b, b, kHeat / 2);
      entries.emplace_back(a, b, -kHeat / 2);
      entries.emplace_back(b, a, -kHeat / 2);
    }
  clearance_ = solve_symmetric(entries, sum, "scan: clearance of the clothes");
}

double BodyBound::inside_clearance(const Eigen::Vector3d &point) const {
  constexpr double kClose = 0.015, kSlack = 0.25; // m; of what lies beyond: a garment is wider here and narrower there
  const Look at = look(point);
  const double clearance = at.in_gap ? (1 - at.side.share) * clearance_at(scene_.closest(at.side.from)) +
                                           at.side.share * clearance_at(scene_.closest(at.side.to))
                                     : clearance_at(at.on_body);
  return clearance + kSlack * std::max(0.0, clearance - kClose) - at.distance;
}

void BodyBound::reach(const std::vector<Contact> &contacts, double radius) {
  constexpr double kWidth = 1e-3; // m; a line is a triangle as thin as this
  Mesh lines{Vertices(3 * contacts.size(), 3), Faces(contacts.size(), 3)};
  for (Eigen::Index i = 0; i < lines.faces.rows(); ++i) {
    const Eigen::Vector3d &end = contacts[static_cast<std::size_t>(i)].point, start = scene_.closest(end).point;
    const Eigen::Vector3d aside = kWidth / 2 * (end - start).unitOrthogonal();
    lines.vertices.middleRows<3>(3 * i) << start.transpose(), (end + aside).transpose(), (end - aside).transpose();
    lines.faces.row(i) << static_cast<int>(3 * i), static_cast<int>(3 * i + 1), static_cast<int>(3 * i + 2);
  }
  lines_.emplace(lines);
  radius_ = radius;
}

double BodyBound::inside(const Eigen::Vector3d &point) const {
  const double inside = inside_clearance(point);
  return lines_ && inside < radius_ ? std::max(inside, radius_ - lines_->closest(point).distance) : inside;
}

} // namespace doublet::detail
