#include "person_start.h"

#include "doublet/core/error.h"
#include "doublet/core/parts/quantile.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>

namespace doublet::detail {
namespace {

constexpr std::array kFocals{0.6, 0.8, 1.1, 1.5, 2.1, 2.9}; // shares of the larger side that are tried where it is not known
constexpr int kPairs = 3;                                   // of cameras that are begun with, for each focal length
constexpr int kLeastCommon = 40;                            // keypoints that two cameras must share, or one and the others
constexpr int kStartIterations = 8;

/// What all starts share, without cameras and joints.
PersonBundle gather(const std::vector<PersonView> &views, const std::vector<int> &frames, double share,
                    const PersonCalibrationOptions &options) {
  PersonBundle bundle;
  bundle.keypoint_error = options.keypoint_error;
  for (const PersonView &view : views) {
    Camera camera;
    camera.name = view.name;
    camera.width = view.width;
    camera.height = view.height;
    const double focal = view.focal > 0 ? view.focal : share * larger_side(view);
    camera.K << focal, 0, (view.width - 1) / 2.0, 0, focal, (view.height - 1) / 2.0, 0, 0, 1;
    bundle.rig.push_back(camera);
    bundle.known_focal.push_back(view.focal);
  }
  bundle.focal_error = options.focal_error;
  bundle.log_focal = std::log(share);
  for (const int frame : frames) {
    bundle.seen.emplace_back();
    for (const PersonView &view : views)
      bundle.seen.back().push_back(&view.seen[static_cast<size_t>(frame) * kKeypoints]);
  }
  bundle.joints.resize(frames.size());
  for (int k = 0; k < kBoneLengths; ++k)
    bundle.log_lengths[k] = std::log(kCalibrationLengths[k].share * options.height);
  return bundle;
}

cv::Point2d on_unit_plane(const Camera &camera, const Eigen::Vector2d &pixel) {
  return {(pixel.x() - camera.K(0, 2)) / camera.K(0, 0), (pixel.y() - camera.K(1, 2)) / camera.K(1, 1)};
}

/// Two cameras and how well they could be a beginning.
struct CameraPair {
  int first = 0, second = 0;
  double score = 0;
  Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
  Eigen::Vector3d t = Eigen::Vector3d::Zero(); // of length 1
};

/// By Nister's five-point algorithm. The score: how many keypoints agree, times the sine of the angle between their rays.
CameraPair relative_pose(const PersonBundle &bundle, int first, int second) {
  std::vector<cv::Point2d> a, b;
  const Camera &one = bundle.rig[first], &other = bundle.rig[second];
  for (const auto &moment : bundle.seen)
    for (int j = 0; j < kKeypoints; ++j)
      if (moment[first][j].counts() && moment[second][j].counts()) {
        a.push_back(on_unit_plane(one, moment[first][j].pixel));
        b.push_back(on_unit_plane(other, moment[second][j].pixel));
      }
  CameraPair pair;
  pair.first = first;
  pair.second = second;
  if (static_cast<int>(a.size()) < kLeastCommon)
    return pair;
  const double side = std::max(larger_side(one), larger_side(other));
  const double error = 2 * bundle.keypoint_error * side / std::min(one.K(0, 0), other.K(0, 0));
  cv::Mat inside, R, t, points;
  const cv::Mat unit = cv::Mat::eye(3, 3, CV_64F);
  const cv::Mat essential = cv::findEssentialMat(a, b, unit, cv::RANSAC, 0.999, error, inside);
  if (essential.rows != 3 || cv::recoverPose(essential, a, b, unit, R, t, 50, inside, points) < kLeastCommon)
    return pair;
  cv::cv2eigen(R, pair.R);
  cv::cv2eigen(t, pair.t);
  const Eigen::Vector3d centre = -pair.R.transpose() * pair.t;
  for (int k = 0; k < points.cols; ++k)
    if (inside.at<uchar>(k)) {
      const Eigen::Vector3d x =
          Eigen::Vector3d(points.at<double>(0, k), points.at<double>(1, k), points.at<double>(2, k)) / points.at<double>(3, k);
      pair.score += x.cross(x - centre).norm() / (x.norm() * (x - centre).norm());
    }
  return pair;
}

/// The rig of the cameras that have a place, and only what they saw.
PersonBundle placed(const PersonBundle &whole, const std::vector<int> &cameras) {
  PersonBundle part = whole;
  part.rig.clear();
  part.known_focal.clear();
  for (auto &moment : part.seen)
    moment.clear();
  for (const int c : cameras) {
    part.rig.push_back(whole.rig[c]);
    part.known_focal.push_back(whole.known_focal[c]);
    for (size_t m = 0; m < whole.seen.size(); ++m)
      part.seen[m].push_back(whole.seen[m][c]);
  }
  return part;
}

/// By which all must be multiplied so that bones are as long as they are expected to be; 0 = none was found.
double metric_scale(const PersonBundle &bundle) {
  std::vector<double> factors;
  for (const JointPoints &joints : bundle.joints)
    for (const CalibrationBone &bone : kCalibrationBones)
      if (const auto &a = joints[bone.from], &b = joints[bone.to]; a && b && (*a - *b).norm() > 0)
        factors.push_back(std::exp(bundle.log_lengths[bone.length]) / (*a - *b).norm());
  return factors.empty() ? 0 : median(factors);
}

/// Which of the other cameras sees most of the joints that were found; -1 if none sees enough. Gives it its place.
int add_camera(PersonBundle &whole, const PersonBundle &part, const std::vector<int> &cameras) {
  int best = -1;
  size_t most = kLeastCommon - 1;
  std::vector<cv::Point3d> best_points;
  std::vector<cv::Point2d> best_pixels;
  for (int c = 0; c < static_cast<int>(whole.rig.size()); ++c) {
    if (std::find(cameras.begin(), cameras.end(), c) != cameras.end())
      continue;
    std::vector<cv::Point3d> points;
    std::vector<cv::Point2d> pixels;
    for (size_t m = 0; m < whole.seen.size(); ++m)
      for (int j = 0; j < kKeypoints; ++j)
        if (const auto &x = part.joints[m][j]; x && whole.seen[m][c][j].counts()) {
          points.emplace_back(x->x(), x->y(), x->z());
          pixels.push_back(on_unit_plane(whole.rig[c], whole.seen[m][c][j].pixel));
        }
    if (points.size() > most) {
      most = points.size();
      best = c;
      best_points = std::move(points);
      best_pixels = std::move(pixels);
    }
  }
  if (best < 0)
    return -1;
  Camera &camera = whole.rig[best];
  const auto error = static_cast<float>(2 * kAgreeing * whole.keypoint_error * larger_side(camera) / camera.K(0, 0));
  cv::Mat turn, shift, inside, R;
  if (!cv::solvePnPRansac(best_points, best_pixels, cv::Mat::eye(3, 3, CV_64F), cv::noArray(), turn, shift, false, 300, error,
                          0.99, inside, cv::SOLVEPNP_EPNP) ||
      inside.rows < kLeastCommon)
    return -1;
  cv::Rodrigues(turn, R);
  cv::cv2eigen(R, camera.R);
  cv::cv2eigen(shift, camera.t);
  return best;
}

constexpr double kNoCost = std::numeric_limits<double>::infinity();

/// Cameras one after the other, from a pair on. Returns the cost; infinite, with the name of a camera that finds no place, if
/// there is none.
double begin_with(PersonBundle &whole, const CameraPair &pair, double height, std::string &lost) {
  whole.rig[pair.first].R.setIdentity();
  whole.rig[pair.first].t.setZero();
  whole.rig[pair.second].R = pair.R;
  whole.rig[pair.second].t = pair.t;
  std::vector<int> cameras{pair.first, pair.second};
  PersonBundle part = placed(whole, cameras);
  part.triangulate_joints();
  const double scale = metric_scale(part);
  part.rig[1].t *= scale;
  for (;;) {
    part.triangulate_joints();
    part.adjust(kStartIterations, height);
    for (size_t k = 0; k < cameras.size(); ++k)
      whole.rig[cameras[k]] = part.rig[k];
    if (cameras.size() == whole.rig.size())
      break;
    const int added = add_camera(whole, part, cameras);
    if (added < 0) {
      for (size_t c = 0; c < whole.rig.size() && lost.empty(); ++c)
        if (std::find(cameras.begin(), cameras.end(), static_cast<int>(c)) == cameras.end())
          lost = whole.rig[c].name;
      return kNoCost;
    }
    cameras.push_back(added);
    whole.log_lengths = part.log_lengths;
    whole.log_focal = part.log_focal;
    part = placed(whole, cameras);
  }
  whole.log_lengths = part.log_lengths;
  whole.log_focal = part.log_focal;
  whole.triangulate_joints();
  return whole.adjust(kStartIterations, height);
}

/// One beginning, and what became of it.
struct Start {
  PersonBundle bundle;
  CameraPair pair;
  double cost = kNoCost;
  std::string lost = {}; // a camera that found no place
};

/// The pairs of cameras that could be a beginning, for each focal length that is tried.
std::vector<Start> find_starts(const std::vector<PersonView> &views, const std::vector<int> &frames,
                               const PersonCalibrationOptions &options, const Context &context) {
  std::vector<Start> starts;
  const bool known = std::all_of(views.begin(), views.end(), [](const PersonView &view) { return view.focal > 0; });
  const int view_count = static_cast<int>(views.size());
  for (const double share : kFocals) {
    const PersonBundle bundle = gather(views, frames, share, options);
    std::vector<CameraPair> pairs;
    for (int a = 0; a < view_count; ++a)
      for (int b = a + 1; b < view_count; ++b)
        pairs.push_back(CameraPair{a, b, 0, Eigen::Matrix3d::Identity(), Eigen::Vector3d::Zero()});
    parallel_for(context, static_cast<int>(pairs.size()),
                 [&](int k) { pairs[k] = relative_pose(bundle, pairs[k].first, pairs[k].second); });
    context.throw_if_cancelled();
    std::stable_sort(pairs.begin(), pairs.end(), [](const CameraPair &a, const CameraPair &b) { return a.score > b.score; });
    for (int k = 0; k < std::min<int>(kPairs, static_cast<int>(pairs.size())); ++k)
      if (pairs[k].score > 0)
        starts.push_back({bundle, pairs[k], kNoCost, {}});
    if (known)
      break;
  }
  return starts;
}

} // namespace

PersonBundle begin_bundle(const std::vector<PersonView> &views, const std::vector<int> &frames,
                          const PersonCalibrationOptions &options, const Context &context) {
  std::vector<Start> starts = find_starts(views, frames, options, context);
  if (starts.empty())
    throw Error("calibration from a person: expected two cameras with " + std::to_string(kLeastCommon) +
                " matching keypoints, found none; are they of one person, and of the same time?");
  const int count = static_cast<int>(starts.size()), together = context.thread_count();
  for (int first = 0; first < count; first += together) { // some seconds each: whoever waits may stop them in between
    context.report_progress("calibration", 0.5 * first / count);
    parallel_for(context, std::min(together, count - first), [&](int k) {
      Start &start = starts[first + k];
      start.cost = begin_with(start.bundle, start.pair, options.height, start.lost);
    });
  }
  const auto best =
      std::min_element(starts.begin(), starts.end(), [](const Start &a, const Start &b) { return a.cost < b.cost; });
  if (!std::isfinite(best->cost))
    throw Error("calibration from a person: camera '" + best->lost + "': expected " + std::to_string(kLeastCommon) +
                " keypoints that match those of other cameras, found fewer");
  return best->bundle;
}

} // namespace doublet::detail
