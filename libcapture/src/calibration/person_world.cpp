#include "person_world.h"

#include "doublet/core/error.h"
#include "doublet/core/parts/quantile.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <initializer_list>
#include <limits>
#include <optional>

namespace doublet::detail {
namespace {

constexpr double kAnkle = 0.045;       // height of the ankle over the floor, as a share of the person's; Winter 2009 has 0.039
constexpr double kFloorQuantile = 0.1; // of the lower ankle's height, at which it stands on the floor
constexpr double kLean = 0.07, kRoll = 0.026; // rad: of the mean of how a person stands, and of a camera on a tripod
constexpr int kLevelSteps = 10;

Eigen::Vector3d middle(const JointPoints &joints, int left) {
  return (*joints[left] + *joints[left + 1]) / 2;
}
constexpr int kShoulders = 0, kWrists = 4, kHips = 6, kAnkles = 10; // the left ones of kKeypointNames

bool has(const JointPoints &joints, std::initializer_list<int> pairs) {
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
      const double roll = up.dot(across) / kRoll, scale = kAgreeing * kAgreeing / (roll * roll + kAgreeing * kAgreeing);
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
    const JointPoints &joints = bundle.joints[m];
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
  for (const JointPoints &joints : bundle.joints)
    if (has(joints, {kAnkles}))
      lower.push_back(std::min(up.dot(*joints[kAnkles]), up.dot(*joints[kAnkles + 1])));
  return quantile(lower, kFloorQuantile) - kAnkle * height;
}

} // namespace

void stand_upright(const std::vector<PersonView> &views, const std::vector<int> &frames, double height, PersonBundle &bundle) {
  const std::vector<size_t> standing = standing_moments(bundle);
  const Eigen::Vector3d up = find_up(bundle, standing);
  const std::optional<Standing> measured = measure_standing(views, bundle, frames, standing, up);
  const double scale = measured && measured->crown > measured->floor ? height / (measured->crown - measured->floor) : 1;
  const double floor = measured ? measured->floor : floor_below_ankles(bundle, up, height);
  const JointPoints &first = bundle.joints[*std::min_element(standing.begin(), standing.end())];
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
  for (JointPoints &joints : bundle.joints)
    for (auto &joint : joints)
      if (joint)
        joint = Eigen::Vector3d(scale * (world * (*joint - origin)));
}

} // namespace doublet::detail
