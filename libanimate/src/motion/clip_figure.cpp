#include "clip_figure.h"

#include "doublet/core/parts/quantile.h"
#include "nearest_axes.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace doublet {

using Eigen::Vector3d;

ClipFigure::ClipFigure(const SourceMotion &clip, std::map<std::string, int> found)
    : joints(std::move(found)), clip_(clip), zero_(clip.zero_positions()) {
  zero_up = nearest_axis(zero_trunk());
  zero_leans = leans();
  zero_is_stance = is_stance();
  up = up_of_world();
}

Vector3d ClipFigure::zero_trunk() const {
  constexpr double kNoWay = 0.01; // of the way from hips to shoulders: it has no direction
  const Vector3d trunk = zero("chest") - zero("pelvis"),
                 whole = 0.5 * (zero("l_shoulder") + zero("r_shoulder") - zero("l_hip") - zero("r_hip"));
  return trunk.norm() > kNoWay * whole.norm() ? trunk : whole;
}

bool ClipFigure::leans() const {
  const Vector3d trunk = zero_trunk().normalized(), left = (zero("l_hip") - zero("r_hip")).normalized();
  const bool human = trunk.norm() > 0 && left.norm() > 0 && std::abs(trunk.dot(left)) < 0.35;
  constexpr double kAslant = 0.26, kTilted = 0.17; // rad
  return human && (trunk.dot(zero_up) < std::cos(kAslant) || std::abs(left.dot(zero_up)) > std::sin(kTilted));
}

bool ClipFigure::is_stance() const {
  for (const std::string side : {"l_", "r_"}) {
    const Vector3d thigh = (zero(side + "knee") - zero(side + "hip")).normalized();
    const Vector3d shin = (zero(side + "ankle") - zero(side + "knee")).normalized();
    const Vector3d arm = (zero(side + "elbow") - zero(side + "shoulder")).normalized();
    if (thigh.dot(zero_up) > -0.5 || shin.dot(zero_up) > -0.5 || arm.dot(zero_up) > 0.7)
      return false;
  }
  return !zero_leans;
}

double ClipFigure::leg_length() const {
  double sum = 0;
  for (int t = 0; t < clip_.frame_count(); ++t)
    for (const std::string side : {"l_", "r_"})
      sum += (at(side + "hip", t) - at(side + "knee", t)).norm() + (at(side + "knee", t) - at(side + "ankle", t)).norm();
  return sum / clip_.frame_count() / 2;
}

Vector3d ClipFigure::body_at(int t) const {
  return at("chest", t) - 0.5 * (at("l_ankle", t) + at("r_ankle", t));
}

/// That along which the body stands on average, if the body does not lie.
Vector3d ClipFigure::up_of_world() const {
  const Vector3d usual = zero_is_stance ? zero_up : Vector3d::UnitY();
  if (clip_.up == usual)
    return usual;
  Vector3d sum = Vector3d::Zero();
  for (int t = 0; t < clip_.frame_count(); ++t)
    sum += body_at(t);
  const Vector3d mean = nearest_axis(sum);
  if (clip_.up == mean)
    return mean;
  for (const Vector3d &axis : {clip_.up, usual})
    if (!axis.isZero() && axis != mean && (stands_along(axis) || lies(axis, mean)))
      return axis;
  return mean;
}

/// For a while at least: who lies or crawls for most of a clip gets up in it, or lies down.
bool ClipFigure::stands_along(const Vector3d &axis) const {
  constexpr double kUpright = 0.87, kShare = 0.1;
  int standing = 0;
  for (int t = 0; t < clip_.frame_count(); ++t)
    standing += body_at(t).dot(axis) > kUpright * body_at(t).norm();
  return standing > kShare * clip_.frame_count();
}

/// Along an axis, in lengths of a leg: the lowest joint, the hips over that, and by how much both vary.
struct ClipFigure::Heights {
  double lowest, lowest_spread, hips, hips_spread;
};

ClipFigure::Heights ClipFigure::heights_along(const Vector3d &axis) const {
  const double leg = leg_length();
  std::vector<double> lowest, hips;
  for (int t = 0; t < clip_.frame_count(); ++t) {
    lowest.push_back((clip_.positions[t] * axis).minCoeff() / leg);
    hips.push_back(0.5 * (at("l_hip", t) + at("r_hip", t)).dot(axis) / leg);
  }
  const auto spread = [](const std::vector<double> &values) { return quantile(values, 0.95) - quantile(values, 0.05); };
  return {median(lowest), spread(lowest), median(hips) - median(lowest), spread(hips)};
}

/// Who lies all the time, where that is up, looks like somebody who stands along `mean` in a world turned on its side. But
/// files have the floor at height 0: does he lie on that, and is that none on which he would stand? Wherever it is, the lowest
/// joint stays on it, whatever else moves. If nothing tells: X is up in no file unless it is in its zero pose.
bool ClipFigure::lies(const Vector3d &if_up, const Vector3d &mean) const {
  const Heights lying = heights_along(if_up), standing = heights_along(mean);
  if (lying.hips > 0.6)
    return false;
  const bool on_floor = lying.lowest > -0.1 && lying.lowest < 0.2 && lying.lowest + lying.hips > 0.06 && lying.hips_spread < 0.2;
  if (on_floor && std::abs(standing.lowest) > 0.3)
    return true;
  const auto [steady, moving] = std::minmax(lying.lowest_spread, standing.lowest_spread);
  if (moving > 0.1 && steady < 0.5 * moving)
    return lying.lowest_spread < standing.lowest_spread;
  return std::abs(mean.x()) == 1;
}

} // namespace doublet
