#include "visual_hull.h"

#include "body_bound.h"
#include "calibration/ray_bundle.h"
#include "doublet/core/error.h"

#include <opencv2/imgproc.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

namespace doublet::detail {
namespace {

/// Cells along the side of a block: the hull is looked for block by block, most of which are far from it.
constexpr int kBlock = 8;

/// One camera's silhouette as a signed distance.
struct Silhouette {
  const Camera *camera;
  cv::Mat distance; ///< float, px: to the outline, positive inside
  double focal;     ///< px
  cv::Rect box;     ///< of the actor

  bool cut = false; ///< at the picture's edge: what lies beyond is not known. A whole silhouette says that nothing does.

  /// m, about: how far inside this camera's cone the point is. False where the camera has no say.
  bool inside(const Eigen::Vector3d &point, double &metres) const {
    const double depth = camera->depth(point);
    const Eigen::Vector2d pixel = depth > 1e-3 ? camera->project(point) : Eigen::Vector2d(-1e6, -1e6);
    const Eigen::Vector2d shown(std::clamp(pixel.x(), 0.0, distance.cols - 1.001),
                                std::clamp(pixel.y(), 0.0, distance.rows - 1.001));
    const double beyond = (pixel - shown).norm();
    if (beyond > 0 && cut)
      return false;
    const int x = static_cast<int>(shown.x()), y = static_cast<int>(shown.y());
    const float fx = static_cast<float>(shown.x() - x), fy = static_cast<float>(shown.y() - y);
    const float *row = distance.ptr<float>(y) + x, *next = distance.ptr<float>(y + 1) + x;
    const float at = (1 - fy) * ((1 - fx) * row[0] + fx * row[1]) + fy * ((1 - fx) * next[0] + fx * next[1]);
    metres = (at - beyond) * std::max(depth, 1e-3) / focal;
    return true;
  }
};

Silhouette silhouette_of(const Camera &camera, const Image &mask) {
  const cv::Mat inside = cv::Mat(mask.height, mask.width, CV_8UC1, const_cast<std::uint8_t *>(mask.data.data())) >= 128;
  cv::Mat to_outside, to_inside;
  cv::distanceTransform(inside, to_outside, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  cv::distanceTransform(~inside, to_inside, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  // Distances run between centres of pixels; the outline lies half a pixel before the first of the other kind.
  cv::Mat shift(inside.size(), CV_32FC1, cv::Scalar(0.5));
  shift.setTo(-0.5, inside);
  const cv::Rect box = cv::boundingRect(inside);
  const bool cut = box.x == 0 || box.y == 0 || box.br().x == inside.cols || box.br().y == inside.rows;
  return {&camera, to_outside - to_inside + shift, (camera.K(0, 0) + camera.K(1, 1)) / 2, box, cut};
}

/// The hull as an implicit function, m: positive inside.
class Hull {
public:
  Hull(std::vector<Silhouette> silhouettes, int max_missing_views)
      : silhouettes_(std::move(silhouettes)), outvoted_(max_missing_views) {}

  const std::vector<Silhouette> &silhouettes() const { return silhouettes_; }

  /// From now on less what lies outside it, which must live on.
  void bound_by(const BodyBound &body) { body_ = &body; }

  /// The least of what the cameras say, but for the max_missing_views ones; points that fewer than half of them see are outside.
  double operator()(const Eigen::Vector3d &point) const {
    std::array<double, ViewScanOptions::kMaxMissingViews + 1> least;
    least.fill(std::numeric_limits<double>::infinity());
    int count = 0;
    for (const Silhouette &silhouette : silhouettes_) {
      double said = 0;
      if (!silhouette.inside(point, said))
        continue;
      ++count;
      for (double &value : least) // sorts it in; the largest falls out
        if (said < value)
          std::swap(said, value);
    }
    const int fewest = std::max(2, static_cast<int>(silhouettes_.size() + 1) / 2);
    const double hull = count < fewest ? -1 : least[std::min(outvoted_, count - 2)];
    return body_ && hull > 0 ? std::min(hull, body_->inside(point)) : hull;
  }

  Eigen::Vector3d outward(const Eigen::Vector3d &point, double step) const {
    Eigen::Vector3d gradient;
    for (int axis = 0; axis < 3; ++axis) {
      const Eigen::Vector3d offset = step * Eigen::Vector3d::Unit(axis);
      gradient[axis] = (*this)(point - offset) - (*this)(point + offset);
    }
    return gradient.normalized();
  }

private:
  std::vector<Silhouette> silhouettes_;
  int outvoted_;
  const BodyBound *body_ = nullptr;
};

/// A cube that holds the actor: about the point nearest to the rays through the silhouettes' middles.
struct Cube {
  Eigen::Vector3d corner;
  double side;
};

Cube cube_around(const std::vector<Silhouette> &silhouettes) {
  RayBundle rays;
  const auto middle = [](const Silhouette &s) {
    return Eigen::Vector2d(s.box.x + s.box.width / 2.0, s.box.y + s.box.height / 2.0);
  };
  for (const Silhouette &silhouette : silhouettes)
    rays.add(*silhouette.camera, middle(silhouette));
  const Eigen::Vector3d centre = rays.point();
  double half = 0;
  for (const Silhouette &silhouette : silhouettes) {
    const double depth = silhouette.camera->depth(centre);
    const double off = (silhouette.camera->project(centre) - middle(silhouette)).norm();
    if (depth > 0) // boxes are seen from one side: their far corners may lie farther out
      half = std::max(half, 1.3 * (std::hypot(silhouette.box.width, silhouette.box.height) / 2 + off) * depth / silhouette.focal);
  }
  constexpr double kLargest = 5; // m; cameras that do not agree send it anywhere
  if (!centre.allFinite() || !(half > 0) || half > kLargest)
    throw Error("scan: the silhouettes do not surround one person of at most 10 m: wrong calibration, units or order of cameras");
  return {centre.array() - half, 2 * half};
}

/// Of the places on a pixel's line of sight where the hull ends by no more than `slack` (m), the one that is nearest to the body.
std::optional<Contact> contact_at(const Hull &hull, const Silhouette &silhouette, cv::Point pixel, const Cube &cube,
                                  const BodyBound &body, double cell, double slack) {
  constexpr double kFarthest = 0.5; // m, from the body
  const Eigen::Vector3d from = silhouette.camera->centre(), middle = cube.corner.array() + cube.side / 2;
  const Eigen::Vector3d direction = silhouette.camera->ray_direction(Eigen::Vector2d(pixel.x, pixel.y));
  const double first = std::max(0.0, (middle - from).norm() - cube.side), last = (middle - from).norm() + cube.side;
  Contact best{from, kFarthest};
  for (double s = first, clearance = 0; s < last; s += std::max(cell, clearance - best.clearance)) { // nothing nearer between
    const Eigen::Vector3d point = from + s * direction;
    clearance = body.distance(point);
    if (clearance < best.clearance && hull(point) > -slack)
      best = {point, clearance};
  }
  return best.clearance < kFarthest ? std::optional(best) : std::nullopt;
}

/// Where the lines of sight along an outline touch the actor.
std::vector<Contact> contacts_of(const Hull &hull, const Silhouette &silhouette, const Cube &cube, const BodyBound &body,
                                 double cell) {
  constexpr float kOn = 0.71F; // px from the outline
  std::vector<Contact> contacts;
  for (int y = silhouette.box.y; y < silhouette.box.br().y; ++y)
    for (int x = silhouette.box.x; x < silhouette.box.br().x; ++x)
      if (const float off = silhouette.distance.at<float>(y, x); off >= 0 && off <= kOn)
        if (const auto contact = contact_at(hull, silhouette, {x, y}, cube, body, cell, 1.5 * cell))
          contacts.push_back(*contact);
  return contacts;
}

/// Where the parts of a silhouette are, as near to the body as the hull allows, in which none of `points` shows, which lie about
/// a cell apart. Narrow parts do not count: an outline is off by that much.
std::vector<Contact> missed_by(const Vertices &points, const Hull &hull, const Silhouette &silhouette, const Cube &cube,
                               const BodyBound &body, double cell) {
  constexpr double kNarrow = 0.03; // m
  const Camera &camera = *silhouette.camera;
  const double pixel = camera.depth(cube.corner.array() + cube.side / 2) / silhouette.focal; // m
  if (!(pixel > 0))
    return {}; // it looks away: a wrong calibration, which blame() finds
  const int step = std::max(1, static_cast<int>(std::lround(cell / pixel)));
  const auto place = [&](int x, int y) -> cv::Point { return silhouette.box.tl() + step * cv::Point(x, y); };
  cv::Mat missed(silhouette.box.height / step + 1, silhouette.box.width / step + 1, CV_8UC1, cv::Scalar(0));
  for (int y = 0; y < missed.rows; ++y)
    for (int x = 0; x < missed.cols; ++x)
      if (silhouette.box.contains(place(x, y)) && silhouette.distance.at<float>(place(x, y)) > 0)
        missed.at<std::uint8_t>(y, x) = 255;
  for (const auto &point : points.rowwise()) {
    if (!(camera.depth(point) > 0))
      continue;
    const Eigen::Vector2d at = camera.project(point);
    cv::circle(missed, (cv::Point2d(at.x(), at.y()) - cv::Point2d(silhouette.box.tl())) / step, 1, 0, cv::FILLED);
  }
  const int wide = static_cast<int>(std::ceil(kNarrow / (step * pixel)));
  cv::morphologyEx(missed, missed, cv::MORPH_OPEN, cv::getStructuringElement(cv::MORPH_ELLIPSE, {wide, wide}));
  std::vector<cv::Point> pixels;
  cv::findNonZero(missed, pixels);
  std::vector<Contact> contacts;
  for (const cv::Point &at : pixels)
    if (const auto contact = contact_at(hull, silhouette, place(at.x, at.y), cube, body, cell, 0);
        contact && contact->clearance > cell)
      contacts.push_back(*contact);
  return contacts;
}

std::vector<Contact> of_all_cameras(const std::vector<Silhouette> &silhouettes,
                                    const std::function<std::vector<Contact>(const Silhouette &)> &contacts_of,
                                    const Context &context) {
  std::vector<std::vector<Contact>> of_camera(silhouettes.size());
  parallel_for(context, static_cast<int>(silhouettes.size()), [&](int c) { of_camera[c] = contacts_of(silhouettes[c]); });
  std::vector<Contact> all;
  for (const std::vector<Contact> &contacts : of_camera)
    all.insert(all.end(), contacts.begin(), contacts.end());
  return all;
}

/// Sums up one block's samples.
struct Samples {
  std::vector<Eigen::Vector3d> points, normals;
};

Samples sample_block(const Hull &hull, const Eigen::Vector3d &corner, double cell) {
  constexpr int n = kBlock + 1;
  std::array<double, n * n * n> value;
  const auto at = [&](int x, int y, int z) -> double & { return value[(z * n + y) * n + x]; };
  const auto place = [&](int x, int y, int z) -> Eigen::Vector3d { return corner + cell * Eigen::Vector3d(x, y, z); };
  for (int z = 0; z < n; ++z)
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x)
        at(x, y, z) = hull(place(x, y, z));
  Samples samples;
  for (int z = 0; z < kBlock; ++z)
    for (int y = 0; y < kBlock; ++y)
      for (int x = 0; x < kBlock; ++x)
        for (int axis = 0; axis < 3; ++axis) {
          const double a = at(x, y, z), b = at(x + (axis == 0), y + (axis == 1), z + (axis == 2));
          if ((a > 0) == (b > 0))
            continue;
          const Eigen::Vector3d point = place(x, y, z) + cell * a / (a - b) * Eigen::Vector3d::Unit(axis);
          const Eigen::Vector3d normal = hull.outward(point, cell / 2);
          if (normal.squaredNorm() > 0.5) { // none where the function has no slope
            samples.points.push_back(point);
            samples.normals.push_back(normal);
          }
        }
  return samples;
}

OrientedPoints sample(const Hull &hull, const Cube &cube, double cell, const Context &context) {
  const double block = kBlock * cell, reach = 1.5 * std::sqrt(3.0) / 2 * block; // the function is a distance only nearly
  const int blocks = static_cast<int>(std::ceil(cube.side / block));
  std::vector<Samples> of_layer(blocks);
  constexpr int kChunk = 8;
  for (int first = 0; first < blocks; first += kChunk) {
    context.report_progress("scan: visual hull", static_cast<double>(first) / blocks);
    parallel_for(context, std::min(kChunk, blocks - first), [&](int offset) {
      const int z = first + offset;
      for (int y = 0; y < blocks; ++y)
        for (int x = 0; x < blocks; ++x) {
          const Eigen::Vector3d corner = cube.corner + block * Eigen::Vector3d(x, y, z);
          if (std::abs(hull(corner.array() + block / 2)) > reach)
            continue;
          Samples samples = sample_block(hull, corner, cell);
          Samples &layer = of_layer[z];
          layer.points.insert(layer.points.end(), samples.points.begin(), samples.points.end());
          layer.normals.insert(layer.normals.end(), samples.normals.begin(), samples.normals.end());
        }
    });
  }
  Samples all;
  for (const Samples &layer : of_layer) {
    all.points.insert(all.points.end(), layer.points.begin(), layer.points.end());
    all.normals.insert(all.normals.end(), layer.normals.begin(), layer.normals.end());
  }
  OrientedPoints result{Vertices(all.points.size(), 3), Vertices(all.points.size(), 3)};
  for (std::size_t i = 0; i < all.points.size(); ++i) {
    result.points.row(static_cast<Eigen::Index>(i)) = all.points[i].transpose();
    result.normals.row(static_cast<Eigen::Index>(i)) = all.normals[i].transpose();
  }
  return result;
}

/// Of the hull, what lies no farther from a body than the silhouettes say: their outlines tell how far off cloth is on average,
/// and where something shows that is farther yet, they tell that.
OrientedPoints sample_around(const Mesh &body, const Hull &hull, const Cube &cube, double cell, const Context &context) {
  const auto of_all = [&](const auto &contacts) { return of_all_cameras(hull.silhouettes(), contacts, context); };
  BodyBound bound(body, [&](const Eigen::Vector3d &point) { return hull(point) > 0; });
  bound.learn(of_all([&](const Silhouette &s) { return contacts_of(hull, s, cube, bound, cell); }));
  Hull bounded = hull;
  bounded.bound_by(bound);
  OrientedPoints points = sample(bounded, cube, cell, context);
  const auto missed = of_all([&](const Silhouette &s) { return missed_by(points.points, hull, s, cube, bound, cell); });
  if (missed.empty())
    return points;
  bound.reach(missed, 1.5 * cell); // the grid must see it
  return sample(bounded, cube, cell, context);
}

constexpr int kFewestPoints = 1000;

/// Which camera is to blame: the one without which the hull is largest, if it is by far.
std::string blame(const std::vector<Silhouette> &silhouettes, const ViewScanOptions &options, const Context &context) {
  constexpr double kCoarse = 4, kByFar = 2; // times the cell: only whether there is something; times the next
  Eigen::Index largest = 0, next = 0;
  std::string name;
  for (std::size_t without = 0; silhouettes.size() > 3 && without < silhouettes.size(); ++without) {
    std::vector<Silhouette> others = silhouettes;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(without));
    Eigen::Index size = 0;
    try {
      size = sample(Hull(others, options.max_missing_views), cube_around(others), kCoarse * options.cell, context).points.rows();
    } catch (const Error &) { // then it is not this camera alone
    }
    if (size > largest)
      name = silhouettes[without].camera->name;
    next = std::max(next, std::min(size, largest));
    largest = std::max(largest, size);
  }
  if (static_cast<double>(largest) > kByFar * static_cast<double>(next))
    return "; without camera '" + name + "' they have: look at its calibration and mask";
  return ": wrong calibration, order of cameras or masks";
}

} // namespace

OrientedPoints visual_hull(const CameraRig &rig, const std::vector<CameraView> &views, const Mesh *body,
                           const ViewScanOptions &options, const Context &context) {
  std::vector<Silhouette> silhouettes;
  for (std::size_t c = 0; c < rig.size(); ++c) {
    const Image &mask = views[c].mask;
    if (mask.empty() || std::none_of(mask.data.begin(), mask.data.end(), [](std::uint8_t p) { return p >= 128; }))
      continue;
    silhouettes.push_back(silhouette_of(rig[c], mask));
  }
  constexpr int kFewest = 3;
  if (static_cast<int>(silhouettes.size()) < kFewest)
    throw Error("scan: expected the actor in at least 3 cameras, found " + std::to_string(silhouettes.size()) + " of " +
                std::to_string(rig.size()) + " with a silhouette");
  const Cube cube = cube_around(silhouettes);
  const Hull hull(silhouettes, options.max_missing_views);
  OrientedPoints points =
      body ? sample_around(*body, hull, cube, options.cell, context) : sample(hull, cube, options.cell, context);
  if (points.points.rows() < kFewestPoints)
    throw Error("scan: the silhouettes have no point in common" + blame(silhouettes, options, context));
  return points;
}

} // namespace doublet::detail
