#include "doublet/capture/person_calibration.h"

#include "doublet/core/error.h"
#include "person_bundle.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <limits>
#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <set>
#include <stdexcept>

namespace doublet {
namespace {

using detail::PersonBundle;

constexpr std::array kFocals{0.6, 0.8, 1.1, 1.5, 2.1, 2.9}; // shares of the larger side that are tried where it is not known
constexpr int kPairs = 3;                                   // of cameras that are begun with, for each focal length
constexpr double kOutlier = 3;                              // expected errors, beyond which a keypoint does not agree
constexpr int kLeastCommon = 40;                            // keypoints that two cameras must share, or one and the others
constexpr int kStartIterations = 8, kBundleRounds = 6;
constexpr double kAnkle = 0.045; // height of the ankle over the floor, as a share of the person's; Winter 2009 has 0.039
constexpr double kFloorQuantile = 0.1;   // quantile of the lower ankle's height at which it stands on the floor
constexpr double kLeastAgreeing = 0.4;
constexpr double kLean = 0.07, kRoll = 0.026; // rad: of the mean of how a person stands, and of a camera on a tripod
constexpr int kLevelSteps = 10;
constexpr double kWidestTangent = 0.1, kNarrowestTangent = 0.012; // m, Geman-McClure scale of silhouettes, first and last round

double larger_side(const PersonView &view) {
  return std::max(view.width, view.height);
}

double median(std::vector<double> values) {
  if (values.empty())
    return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

void validate(const std::vector<PersonView> &views) {
  if (views.size() < 2)
    throw std::invalid_argument("calibrate_from_person: expected at least two views, found " + std::to_string(views.size()));
  for (const PersonView &view : views) {
    if (view.width <= 0 || view.height <= 0 || !(view.focal >= 0) || !std::isfinite(view.focal))
      throw std::invalid_argument("calibrate_from_person: view '" + view.name +
                                  "': expected a size above 0 and a focal length of at least 0");
    if (view.seen.size() != views[0].seen.size() || view.seen.size() % kCalibrationJoints)
      throw std::invalid_argument("calibrate_from_person: view '" + view.name + "': expected " +
                                  std::to_string(views[0].seen.size()) + " keypoints, " + std::to_string(kCalibrationJoints) +
                                  " a frame, found " + std::to_string(view.seen.size()));
    if (!view.silhouettes.empty() && view.silhouettes.size() * kCalibrationJoints != view.seen.size())
      throw std::invalid_argument("calibrate_from_person: view '" + view.name + "': expected silhouettes of " +
                                  std::to_string(view.seen.size() / kCalibrationJoints) + " frames or none, found " +
                                  std::to_string(view.silhouettes.size()));
  }
}

/// Frames in which two cameras see half of the joints: so many, spread evenly, and all that have silhouettes.
std::vector<int> choose_moments(const std::vector<PersonView> &views, int count) {
  std::vector<int> useful;
  const int frames = static_cast<int>(views[0].seen.size()) / kCalibrationJoints;
  for (int f = 0; f < frames; ++f) {
    const auto sees = [&](const PersonView &view) {
      const auto first = view.seen.begin() + f * kCalibrationJoints;
      return 2 * std::count_if(first, first + kCalibrationJoints, detail::is_confident) >= kCalibrationJoints;
    };
    if (std::count_if(views.begin(), views.end(), sees) >= 2)
      useful.push_back(f);
  }
  if (static_cast<int>(useful.size()) <= count)
    return useful;
  std::set<int> chosen;
  for (int k = 0; k < count; ++k)
    chosen.insert(useful[static_cast<size_t>(k) * useful.size() / static_cast<size_t>(count)]);
  for (const int frame : useful)
    if (std::any_of(views.begin(), views.end(), [&](const PersonView &view) {
          return static_cast<size_t>(frame) < view.silhouettes.size() && !view.silhouettes[static_cast<size_t>(frame)].empty();
        }))
      chosen.insert(frame);
  return {chosen.begin(), chosen.end()};
}

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
      bundle.seen.back().push_back(&view.seen[static_cast<size_t>(frame) * kCalibrationJoints]);
  }
  bundle.joints.resize(frames.size());
  for (int k = 0; k < detail::kBoneLengths; ++k)
    bundle.log_lengths[k] = std::log(detail::kCalibrationLengths[k].share * options.height);
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
    for (int j = 0; j < kCalibrationJoints; ++j)
      if (detail::is_confident(moment[first][j]) && detail::is_confident(moment[second][j])) {
        a.push_back(on_unit_plane(one, moment[first][j].pixel));
        b.push_back(on_unit_plane(other, moment[second][j].pixel));
      }
  CameraPair pair;
  pair.first = first;
  pair.second = second;
  if (static_cast<int>(a.size()) < kLeastCommon)
    return pair;
  const double side = std::max({one.width, one.height, other.width, other.height});
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
  for (const detail::JointPoints &joints : bundle.joints)
    for (const detail::CalibrationBone &bone : detail::kCalibrationBones)
      if (const auto &a = joints[bone.from], &b = joints[bone.to]; a && b && (*a - *b).norm() > 0)
        factors.push_back(std::exp(bundle.log_lengths[bone.length]) / (*a - *b).norm());
  return median(factors);
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
      for (int j = 0; j < kCalibrationJoints; ++j)
        if (const auto &x = part.joints[m][j]; x && detail::is_confident(whole.seen[m][c][j])) {
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
  const auto error =
      static_cast<float>(2 * kOutlier * whole.keypoint_error * std::max(camera.width, camera.height) / camera.K(0, 0));
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

/// The best of several beginnings.
PersonBundle begin(const std::vector<PersonView> &views, const std::vector<int> &frames, const PersonCalibrationOptions &options,
                   const Context &context) {
  std::vector<Start> starts = find_starts(views, frames, options, context);
  if (starts.empty())
    throw Error("calibration from a person: expected two cameras with " + std::to_string(kLeastCommon) +
                " keypoints that go together, found none; are they of one person, and of the same time?");
  parallel_for(context, static_cast<int>(starts.size()),
               [&](int k) { starts[k].cost = begin_with(starts[k].bundle, starts[k].pair, options.height, starts[k].lost); });
  context.throw_if_cancelled();
  const auto best =
      std::min_element(starts.begin(), starts.end(), [](const Start &a, const Start &b) { return a.cost < b.cost; });
  if (!std::isfinite(best->cost))
    throw Error("calibration from a person: camera '" + best->lost + "': expected " + std::to_string(kLeastCommon) +
                " keypoints that go together with those of other cameras, found fewer");
  return best->bundle;
}

/// Mean of all joints that were found.
Eigen::Vector3d centre_of(const PersonBundle &bundle) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double count = 0;
  for (const detail::JointPoints &joints : bundle.joints)
    for (const auto &joint : joints)
      if (joint) {
        sum += *joint;
        count += 1;
      }
  return count > 0 ? Eigen::Vector3d(sum / count) : sum;
}

/// The silhouettes' tangents under the cameras as they are now.
std::vector<detail::TangentPair> find_tangents(const std::vector<PersonView> &views, const PersonBundle &bundle) {
  std::vector<detail::TangentPair> all;
  const Eigen::Vector3d centre = centre_of(bundle);
  for (size_t f = 0; f * kCalibrationJoints < views[0].seen.size(); ++f) {
    std::vector<const std::vector<Eigen::Vector2d> *> hulls;
    for (const PersonView &view : views)
      hulls.push_back(f < view.silhouettes.size() ? &view.silhouettes[f] : nullptr);
    const std::vector<detail::TangentPair> found = detail::match_tangents(bundle.rig, hulls, centre);
    all.insert(all.end(), found.begin(), found.end());
  }
  return all;
}

Eigen::Vector3d middle(const detail::JointPoints &joints, int left) {
  return (*joints[left] + *joints[left + 1]) / 2;
}
constexpr int kShoulders = 0, kWrists = 4, kHips = 6, kAnkles = 10; // the left ones of kCalibrationJointNames

bool has(const detail::JointPoints &joints, std::initializer_list<int> pairs) {
  return std::all_of(pairs.begin(), pairs.end(), [&](int left) { return joints[left] && joints[left + 1]; });
}

/// The half of the moments in which she stands straightest, by the distance from ankles to shoulders.
std::vector<size_t> standing_moments(const PersonBundle &bundle) {
  std::vector<size_t> moments;
  for (size_t m = 0; m < bundle.joints.size(); ++m)
    if (has(bundle.joints[m], {kShoulders, kHips, kAnkles}))
      moments.push_back(m);
  if (moments.empty())
    throw Error("calibration from a person: expected frames with shoulders, hips and ankles, found none");
  const auto stretch = [&](size_t m) {
    return (middle(bundle.joints[m], kShoulders) - middle(bundle.joints[m], kAnkles)).squaredNorm();
  };
  std::stable_sort(moments.begin(), moments.end(), [&](size_t a, size_t b) { return stretch(a) > stretch(b); });
  moments.resize((moments.size() + 1) / 2);
  return moments;
}

/// From the ankles to the shoulders where she stands, and across the cameras that are level in most.
Eigen::Vector3d find_up(const PersonBundle &bundle, const std::vector<size_t> &standing) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const size_t m : standing)
    sum += (middle(bundle.joints[m], kShoulders) - middle(bundle.joints[m], kAnkles)).normalized();
  const Eigen::Vector3d body = sum.normalized();
  Eigen::Vector3d up = body;
  for (int k = 0; k < kLevelSteps; ++k) {
    // Least squares of (up - body) / kLean and (up . x of each camera) / kRoll, robust against cameras that are not level.
    Eigen::Matrix3d normal = Eigen::Matrix3d::Identity() / (kLean * kLean);
    for (const Camera &camera : bundle.rig) {
      const Eigen::Vector3d across = camera.R.row(0);
      const double roll = up.dot(across) / kRoll, scale = kOutlier * kOutlier / (roll * roll + kOutlier * kOutlier);
      normal += scale * scale / (kRoll * kRoll) * across * across.transpose();
    }
    up = normal.inverse() * body / (kLean * kLean);
    up.normalize();
  }
  return up;
}

/// Heights (m, along `up`) of what hulls of silhouettes begin and end with: floor and crown, medians over the moments in which
/// she stands with hands below the shoulders. None without silhouettes.
struct Standing {
  double floor = 0, crown = 0;
};
std::optional<Standing> measure_standing(const std::vector<PersonView> &views, const PersonBundle &bundle,
                                         const std::vector<int> &frames, const std::vector<size_t> &standing,
                                         const Eigen::Vector3d &up) {
  std::vector<double> floors, crowns;
  for (const size_t m : standing) {
    const detail::JointPoints &joints = bundle.joints[m];
    if (!has(joints, {kWrists}) ||
        std::max(up.dot(*joints[kWrists]), up.dot(*joints[kWrists + 1])) > up.dot(middle(joints, kShoulders)))
      continue;
    for (size_t v = 0; v < views.size(); ++v) {
      const auto frame = static_cast<size_t>(frames[m]);
      if (frame >= views[v].silhouettes.size() || views[v].silhouettes[frame].empty())
        continue;
      const auto height = [&](const Eigen::Vector2d &pixel, const Eigen::Vector3d &beside) { // of a ray as far away as a point
        const Eigen::Vector3d ray = bundle.rig[v].ray_direction(pixel), to = beside - bundle.rig[v].centre();
        const Eigen::Vector3d level_ray = ray - up.dot(ray) * up, level_to = to - up.dot(to) * up;
        return up.dot(bundle.rig[v].centre() + level_ray.dot(level_to) / level_ray.squaredNorm() * ray);
      };
      double floor = std::numeric_limits<double>::infinity(), crown = -floor;
      for (const Eigen::Vector2d &corner : views[v].silhouettes[frame]) {
        floor = std::min(floor, height(corner, middle(joints, kAnkles)));
        crown = std::max(crown, height(corner, middle(joints, kShoulders)));
      }
      floors.push_back(floor);
      crowns.push_back(crown);
    }
  }
  if (floors.empty())
    return {};
  return Standing{median(floors), median(crowns)};
}

/// By ankles alone.
double floor_below_ankles(const PersonBundle &bundle, const Eigen::Vector3d &up, double height) {
  std::vector<double> lower;
  for (const detail::JointPoints &joints : bundle.joints)
    if (has(joints, {kAnkles}))
      lower.push_back(std::min(up.dot(*joints[kAnkles]), up.dot(*joints[kAnkles + 1])));
  std::sort(lower.begin(), lower.end());
  return lower[static_cast<size_t>(kFloorQuantile * static_cast<double>(lower.size()))] - kAnkle * height;
}

/// Turns, shifts and scales the world: +Y up, y = 0 the floor, she stands at the origin in the first of her standing moments,
/// looks along +Z, and is as tall as was said.
void stand_upright(const std::vector<PersonView> &views, const std::vector<int> &frames, double height, PersonBundle &bundle) {
  const std::vector<size_t> standing = standing_moments(bundle);
  const Eigen::Vector3d up = find_up(bundle, standing);
  const std::optional<Standing> measured = measure_standing(views, bundle, frames, standing, up);
  const double scale = measured && measured->crown > measured->floor ? height / (measured->crown - measured->floor) : 1;
  const double floor = measured ? measured->floor : floor_below_ankles(bundle, up, height);
  const detail::JointPoints &first = bundle.joints[*std::min_element(standing.begin(), standing.end())];
  const Eigen::Vector3d across = *first[kHips] - *first[kHips + 1], feet = middle(first, kAnkles);
  Eigen::Matrix3d world; // rows: the new axes
  world.row(0) = (across - up * up.dot(across)).normalized();
  world.row(1) = up;
  world.row(2) = world.row(0).cross(world.row(1));
  const Eigen::Vector3d origin = feet + (floor - up.dot(feet)) * up;
  for (Camera &camera : bundle.rig) {
    const Eigen::Vector3d centre = scale * (world * (camera.centre() - origin));
    camera.R = camera.R * world.transpose();
    camera.t = -camera.R * centre;
  }
  for (detail::JointPoints &joints : bundle.joints)
    for (auto &joint : joints)
      if (joint)
        joint = Eigen::Vector3d(scale * (world * (*joint - origin)));
}

/// How well each camera's evidence goes together with that of the others.
std::vector<PersonCamera> describe(const PersonBundle &bundle) {
  std::vector<PersonCamera> cameras;
  for (size_t v = 0; v < bundle.rig.size(); ++v) {
    std::vector<double> errors, apart;
    double all = 0;
    for (size_t m = 0; m < bundle.seen.size(); ++m)
      for (int j = 0; j < kCalibrationJoints; ++j) {
        const Keypoint &seen = bundle.seen[m][v][j];
        if (!detail::is_confident(seen))
          continue;
        all += 1;
        if (const auto &joint = bundle.joints[m][j])
          if (const double r = detail::keypoint_residual(bundle.rig[v], seen, *joint, bundle.keypoint_error); r < kOutlier)
            errors.push_back(r * bundle.keypoint_error * std::max(bundle.rig[v].width, bundle.rig[v].height));
      }
    for (const detail::TangentPair &pair : bundle.tangents)
      if (pair.first == static_cast<int>(v) || pair.second == static_cast<int>(v))
        apart.push_back(std::abs(detail::tangent_residual(bundle.rig[pair.first], bundle.rig[pair.second], pair)));
    PersonCamera camera;
    camera.agreeing = all > 0 ? static_cast<double>(errors.size()) / all : 0;
    camera.error = median(errors);
    camera.tangent_error = apart.empty() ? std::numeric_limits<double>::quiet_NaN() : median(apart);
    cameras.push_back(camera);
  }
  return cameras;
}

} // namespace

std::vector<Eigen::Vector2d> silhouette_hull(const Image &mask) {
  const cv::Mat pixels(mask.height, mask.width, CV_8UC1, const_cast<std::uint8_t *>(mask.data.data()));
  std::vector<cv::Point> inside, corners;
  cv::findNonZero(pixels, inside);
  std::vector<Eigen::Vector2d> hull;
  if (inside.empty())
    return hull;
  cv::convexHull(inside, corners);
  for (const cv::Point &corner : corners) {
    if (corner.x == 0 || corner.y == 0 || corner.x == mask.width - 1 || corner.y == mask.height - 1)
      return {};
    hull.emplace_back(corner.x, corner.y);
  }
  return hull;
}

PersonCalibration calibrate_from_person(const std::vector<PersonView> &views, const PersonCalibrationOptions &options,
                                        const Context &context) {
  options.validate();
  validate(views);
  const std::vector<int> frames = choose_moments(views, options.moments);
  context.report_progress("calibration", 0);
  PersonBundle bundle = begin(views, frames, options, context);
  for (int round = 0; round < kBundleRounds; ++round) {
    context.report_progress("calibration", 0.5 + 0.5 * round / kBundleRounds);
    bundle.triangulate_joints();
    bundle.tangents = find_tangents(views, bundle);
    bundle.tangent_scale = kWidestTangent * std::pow(kNarrowestTangent / kWidestTangent, round / (kBundleRounds - 1.0));
    bundle.adjust(options.iterations, options.height);
    context.throw_if_cancelled();
  }
  PersonCalibration result;
  result.cameras = describe(bundle);
  for (size_t v = 0; v < views.size(); ++v)
    if (result.cameras[v].agreeing < kLeastAgreeing)
      throw Error("calibration from a person: camera '" + views[v].name + "': expected that at least " +
                  std::to_string(static_cast<int>(100 * kLeastAgreeing)) +
                  " % of its keypoints agree with the other cameras, found " +
                  std::to_string(static_cast<int>(100 * result.cameras[v].agreeing)) +
                  " %; is it synchronous, did it stand still, is it the same person?");
  stand_upright(views, frames, options.height, bundle);
  result.rig = bundle.rig;
  result.frames = frames;
  result.joints = Vertices::Constant(static_cast<Eigen::Index>(frames.size()) * kCalibrationJoints, 3,
                                     std::numeric_limits<double>::quiet_NaN());
  for (size_t m = 0; m < frames.size(); ++m)
    for (int j = 0; j < kCalibrationJoints; ++j)
      if (const auto &joint = bundle.joints[m][j])
        result.joints.row(static_cast<Eigen::Index>(m) * kCalibrationJoints + j) = *joint;
  context.report_progress("calibration", 1);
  return result;
}

} // namespace doublet
