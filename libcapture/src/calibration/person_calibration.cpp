#include "doublet/capture/person_calibration.h"

#include "doublet/core/error.h"
#include "doublet/core/parts/quantile.h"
#include "person_start.h"
#include "person_world.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <opencv2/imgproc.hpp>
#include <set>
#include <stdexcept>

namespace doublet {
namespace {

using detail::PersonBundle;

constexpr int kBundleRounds = 6;
constexpr double kLeastAgreeing = 0.4;
constexpr double kWidestTangent = 0.1, kNarrowestTangent = 0.012; // m, Geman-McClure scale of silhouettes, first and last round

void validate(const std::vector<PersonView> &views) {
  if (views.size() < 2)
    throw std::invalid_argument("calibrate_from_person: expected at least two views, found " + std::to_string(views.size()));
  for (const PersonView &view : views) {
    if (view.width <= 0 || view.height <= 0 || !(view.focal >= 0) || !std::isfinite(view.focal))
      throw std::invalid_argument("calibrate_from_person: view '" + view.name +
                                  "': expected a size above 0 and a focal length of at least 0");
    if (view.seen.size() != views[0].seen.size() || view.seen.size() % kKeypoints)
      throw std::invalid_argument("calibrate_from_person: view '" + view.name + "': expected " +
                                  std::to_string(views[0].seen.size()) + " keypoints, " + std::to_string(kKeypoints) +
                                  " a frame, found " + std::to_string(view.seen.size()));
    if (!view.silhouettes.empty() && view.silhouettes.size() * kKeypoints != view.seen.size())
      throw std::invalid_argument("calibrate_from_person: view '" + view.name + "': expected silhouettes of " +
                                  std::to_string(view.seen.size() / kKeypoints) + " frames or none, found " +
                                  std::to_string(view.silhouettes.size()));
  }
}

/// Frames in which two cameras see half of the joints: so many, spread evenly, and all that have silhouettes.
std::vector<int> choose_moments(const std::vector<PersonView> &views, int count) {
  std::vector<int> useful;
  const int frames = static_cast<int>(views[0].seen.size()) / kKeypoints;
  for (int f = 0; f < frames; ++f) {
    const auto sees = [&](const PersonView &view) {
      const auto first = view.seen.begin() + f * kKeypoints;
      return 2 * std::count_if(first, first + kKeypoints, std::mem_fn(&Keypoint::counts)) >= kKeypoints;
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
  for (size_t f = 0; f * kKeypoints < views[0].seen.size(); ++f) {
    std::vector<const std::vector<Eigen::Vector2d> *> hulls;
    for (const PersonView &view : views)
      hulls.push_back(f < view.silhouettes.size() ? &view.silhouettes[f] : nullptr);
    const std::vector<detail::TangentPair> found = detail::match_tangents(bundle.rig, hulls, centre);
    all.insert(all.end(), found.begin(), found.end());
  }
  return all;
}

/// How well each camera's evidence goes together with that of the others.
std::vector<PersonCamera> describe(const PersonBundle &bundle) {
  std::vector<PersonCamera> cameras;
  for (size_t v = 0; v < bundle.rig.size(); ++v) {
    std::vector<double> errors, apart;
    double all = 0;
    for (size_t m = 0; m < bundle.seen.size(); ++m)
      for (int j = 0; j < kKeypoints; ++j) {
        const Keypoint &seen = bundle.seen[m][v][j];
        if (!seen.counts())
          continue;
        all += 1;
        if (const auto &joint = bundle.joints[m][j])
          if (const double r = detail::keypoint_residual(bundle.rig[v], seen, *joint, bundle.keypoint_error);
              r < detail::kAgreeing)
            errors.push_back(r * bundle.keypoint_error * detail::larger_side(bundle.rig[v]));
      }
    for (const detail::TangentPair &pair : bundle.tangents)
      if (pair.first == static_cast<int>(v) || pair.second == static_cast<int>(v))
        apart.push_back(std::abs(detail::tangent_residual(bundle.rig[pair.first], bundle.rig[pair.second], pair)));
    PersonCamera camera;
    camera.agreeing = all > 0 ? static_cast<double>(errors.size()) / all : 0;
    camera.error = errors.empty() ? std::numeric_limits<double>::quiet_NaN() : median(errors);
    camera.tangent_error = apart.empty() ? std::numeric_limits<double>::quiet_NaN() : median(apart);
    cameras.push_back(camera);
  }
  return cameras;
}

} // namespace

std::vector<Eigen::Vector2d> silhouette_hull(const Image &mask) {
  if (mask.channels != 1 && !mask.empty())
    throw std::invalid_argument("silhouette_hull: expected a mask of one channel, found " + std::to_string(mask.channels));
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
  PersonBundle bundle = detail::begin_bundle(views, frames, options, context);
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
  detail::stand_upright(views, frames, options.height, bundle);
  result.rig = bundle.rig;
  result.frames = frames;
  result.joints =
      Vertices::Constant(static_cast<Eigen::Index>(frames.size()) * kKeypoints, 3, std::numeric_limits<double>::quiet_NaN());
  for (size_t m = 0; m < frames.size(); ++m)
    for (int j = 0; j < kKeypoints; ++j)
      if (const auto &joint = bundle.joints[m][j])
        result.joints.row(static_cast<Eigen::Index>(m) * kKeypoints + j) = *joint;
  context.report_progress("calibration", 1);
  return result;
}

} // namespace doublet
