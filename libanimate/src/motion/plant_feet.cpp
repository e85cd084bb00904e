// Planting feet, as in Kovar, Schreiner, Gleicher 2002 (footskate cleanup): contacts, the floor under the motion, a plan of each
// foot, the hips low enough for it, and the legs that follow. All in one pass over the whole motion, so what is blended begins
// before a foot stands.

#include "doublet/animate/plant_feet.h"

#include "leg.h"
#include "require_motion.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace doublet {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using Flags = std::vector<std::uint8_t>;
using Series = std::vector<double>;

constexpr double kGroundWindow = 0.75;                                  // s: a jump is shorter than twice that
constexpr double kReleaseHeight = 1.4, kReleaseSpeed = 1.6;             // of what a contact begins with
constexpr double kShortest = 0.05;                                      // s, of contacts and of gaps between them
constexpr double kGroundBlur = 0.15, kDropBlur = 0.1, kLiftBlur = 0.07; // s
constexpr double kStraight = 0.99; // of the leg: further, millimetres are many degrees of the knee

constexpr double kHalfWidth = 0.15; // of the sole, of its length
constexpr double kClearance = 0.03; // m, of a foot that swings
// Winter 1992, Foot trajectory in human gait: the toe of a walker's swinging foot is never lower than this, on average, and his
// heel touches down at 0.87 m/s, so that this is how far it goes in the last 1/20 s.
constexpr double kLeastSwing = 0.013, kNearStand = 0.043; // m

enum class Stand : std::uint8_t { Air, Heel, Flat, Toe };

/// One foot in one frame. What is `wanted` is the plan.
struct Step {
  Matrix3d rotation;
  Vector3d ankle;
  double slope = 0;
  Stand stand = Stand::Air;
  Vector3d pivot, pivot_at;           ///< point of the foot in the rest pose, and where it has to be
  Vector3d offset = Vector3d::Zero(); ///< wanted ankle - ankle, the root's new height counted in
};

struct Foot {
  Leg leg;
  Vector3d ankle_rest;
  std::vector<Step> steps;
  Vector3d point(int t, const Vector3d &rest) const { return steps[t].ankle + steps[t].rotation * (rest - ankle_rest); }
};

int frames(double seconds, double fps) {
  return static_cast<int>(std::lround(seconds * fps));
}

Series lowest_around(const Series &values, int radius) {
  const int count = static_cast<int>(values.size());
  Series result(values.size());
  for (int t = 0; t < count; ++t)
    result[t] = *std::min_element(values.begin() + std::max(0, t - radius), values.begin() + std::min(count, t + radius + 1));
  return result;
}

Series mean_around(const Series &values, int radius) {
  const int count = static_cast<int>(values.size());
  Series result(values.size());
  for (int t = 0; t < count; ++t) { // the ends go on beyond the motion
    double sum = 0;
    for (int k = t - radius; k <= t + radius; ++k)
      sum += values[std::clamp(k, 0, count - 1)];
    result[t] = sum / (2 * radius + 1);
  }
  return result;
}

/// [first, last] of the frames that `flag` holds for, in order.
template <class Flag> std::vector<std::pair<int, int>> runs(int count, const Flag &flag) {
  std::vector<std::pair<int, int>> result;
  for (int t = 0; t < count; ++t)
    if (flag(t)) {
      if (t > 0 && flag(t - 1))
        result.back().second = t;
      else
        result.emplace_back(t, t);
    }
  return result;
}

/// Where a run of frames ends and the frames beside it begin, at either side.
struct RunEnd {
  int frame, inside; ///< the last of the run and the one before it, which is the same in a run of one
  int direction;     ///< away from the run
  int gap;           ///< frames to the next run, or to what would be the first beyond the motion
};

std::vector<RunEnd> ends_of(const std::vector<std::pair<int, int>> &known, int count) {
  std::vector<RunEnd> result;
  for (std::size_t r = 0; r < known.size(); ++r) {
    const auto [first, last] = known[r];
    result.push_back({first, std::min(first + 1, last), -1, r > 0 ? first - known[r - 1].second : first + 1});
    result.push_back({last, std::max(last - 1, first), 1, r + 1 < known.size() ? known[r + 1].first - last : count - last});
  }
  return result;
}

/// Values known in some runs of frames, blended to zero from there within `blend` frames: cubic, with the slope at the run's end.
template <class Value> void ease(std::vector<Value> &values, const std::vector<std::pair<int, int>> &known, int blend) {
  for (const RunEnd &end : ends_of(known, static_cast<int>(values.size()))) {
    const int b = std::min(blend, end.gap);
    const Value start = values[end.frame];
    const Value slope = values[end.frame] - values[end.inside];
    for (int k = 1; k < b; ++k) {
      const double x = static_cast<double>(k) / b;
      values[end.frame + end.direction * k] += (1 - x) * (1 - x) * ((1 + 2 * x) * start + x * b * slope);
    }
  }
}

/// The contacts of one point: near its ground and slow, for as long as it is nearly so.
Flags contacts(const Series &height, const Series &speed, double fps, const PlantOptions &options) {
  const int count = static_cast<int>(height.size()), shortest = frames(kShortest, fps);
  const auto stays = [&](int t) {
    return height[t] <= kReleaseHeight * options.contact_height && speed[t] <= kReleaseSpeed * options.contact_speed;
  };
  Flags result(height.size(), 0);
  int last_end = -1;
  for (const auto &[first, last] : runs(count, stays)) {
    bool stands = last - first + 1 >= shortest, begins = false;
    for (int t = first; t <= last; ++t)
      begins = begins || (height[t] <= options.contact_height && speed[t] <= options.contact_speed);
    if (!stands || !begins)
      continue;
    const int from = last_end >= 0 && first - last_end <= shortest ? last_end : first;
    std::fill(result.begin() + from, result.begin() + last + 1, 1);
    last_end = last;
  }
  return result;
}

Series speeds(const std::vector<Vector3d> &points, double fps) {
  const int count = static_cast<int>(points.size()), radius = std::max(1, frames(0.02, fps));
  Series result(points.size(), 0);
  for (int t = 0; t < count; ++t) {
    const int a = std::max(0, t - radius), b = std::min(count - 1, t + radius);
    if (b > a)
      result[t] = (points[b] - points[a]).norm() / (b - a) * fps;
  }
  return result;
}

class Planter {
public:
  Planter(const Skeleton &skeleton, const Motion &motion, const PlantOptions &options)
      : skeleton_(skeleton), options_(options), motion_(motion), count_(static_cast<int>(motion.dofs.rows())) {
    for (const Leg &leg : find_legs(skeleton, options.floor_height))
      feet_.push_back({leg, skeleton.joints[leg.ankle].rest, std::vector<Step>(count_)});
    hips_.assign(feet_.size(), std::vector<Vector3d>(count_));
    for (int t = 0; t < count_; ++t) {
      const Transforms world = forward_kinematics(skeleton, motion.dofs.row(t));
      for (std::size_t f = 0; f < feet_.size(); ++f) {
        const Leg &leg = feet_[f].leg;
        Step &step = feet_[f].steps[t];
        step.rotation = world[leg.ankle].linear();
        step.ankle = world[leg.ankle] * feet_[f].ankle_rest;
        step.slope = slope(leg, step.rotation);
        hips_[f][t] = world[leg.hip] * skeleton.joints[leg.hip].rest;
      }
    }
  }

  std::vector<FootContacts> contacts_of_feet() const {
    Series lowest(count_, 1e30);
    for (const Foot &foot : feet_)
      for (int t = 0; t < count_; ++t)
        lowest[t] = std::min({lowest[t], foot.point(t, foot.leg.heel).y(), foot.point(t, foot.leg.ball).y()});
    const Series ground = lowest_around(lowest, frames(kGroundWindow, motion_.fps));
    std::vector<FootContacts> result;
    for (const Foot &foot : feet_) {
      const auto of = [&](const Vector3d &rest) {
        Series height;
        std::vector<Vector3d> points;
        for (int t = 0; t < count_; ++t) {
          points.push_back(foot.point(t, rest));
          height.push_back(points.back().y() - ground[t]);
        }
        return contacts(height, speeds(points, motion_.fps), motion_.fps, options_);
      };
      result.push_back({skeleton_.joints[foot.leg.ankle].name, of(foot.leg.heel), of(foot.leg.ball)});
    }
    return result;
  }

  Motion plant() {
    const std::vector<FootContacts> found = contacts_of_feet();
    for (std::size_t f = 0; f < feet_.size(); ++f) {
      for (int t = 0; t < count_; ++t)
        feet_[f].steps[t].stand =
            found[f].heel[t] ? (found[f].ball[t] ? Stand::Flat : Stand::Heel) : (found[f].ball[t] ? Stand::Toe : Stand::Air);
      plan_slopes(feet_[f]);
      plan_pivots(feet_[f]);
    }
    lower_root(ground());
    lower_root(drop());
    for (std::size_t f = 0; f < feet_.size(); ++f) {
      plan_offsets(feet_[f]);
      let_go(f);
      plan_holds(feet_[f]);
      follow(feet_[f]);
    }
    return motion_;
  }

private:
  static double slope(const Leg &leg, const Matrix3d &rotation) { return (rotation * (leg.tip - leg.heel)).y() / leg.sole(); }

  std::vector<std::pair<int, int>> standing(const Foot &foot) const {
    return runs(count_, [&](int t) { return foot.steps[t].stand != Stand::Air; });
  }

  int blend_frames() const { return std::max(1, frames(options_.blend_seconds, motion_.fps)); }

  /// Flat where heel and ball stand; on one of them, the other is not below it. Turns the rotations.
  void plan_slopes(Foot &foot) const {
    Series change(count_, 0);
    for (int t = 0; t < count_; ++t)
      if (foot.steps[t].stand == Stand::Flat)
        change[t] = -foot.steps[t].slope;
    ease(change, runs(count_, [&](int t) { return foot.steps[t].stand == Stand::Flat; }), blend_frames());
    for (int t = 0; t < count_; ++t) {
      const Step &step = foot.steps[t];
      if (step.stand == Stand::Toe)
        change[t] = std::min(change[t], -step.slope);
      else if (step.stand == Stand::Heel)
        change[t] = std::max(change[t], -step.slope);
      else if (step.stand == Stand::Air)
        change[t] = 0;
    }
    ease(change, standing(foot), blend_frames());
    for (int t = 0; t < count_; ++t) {
      Step &step = foot.steps[t];
      const double wanted = std::clamp(step.slope + change[t], -1.0, 1.0);
      const Vector3d across = (step.rotation * (foot.leg.tip - foot.leg.heel)).cross(Vector3d::UnitY());
      if (across.norm() < 0.1 * foot.leg.sole()) // upright: no side to turn about
        continue;
      const double angle = std::asin(wanted) - std::asin(std::clamp(step.slope, -1.0, 1.0));
      step.rotation = Eigen::AngleAxisd(angle, across.normalized()).toRotationMatrix() * step.rotation;
      step.slope = wanted;
    }
  }

  /// A foot stands on its heel, flat on its ball, at last on its tip; each takes over where the one before has brought it. Then
  /// the whole stand goes to where the motion's own foot is on average; but a motion that begins standing begins there.
  void plan_pivots(Foot &foot) const {
    for (const auto &[first, last] : standing(foot)) {
      Vector3d away = Vector3d::Zero();
      for (int t = first; t <= last; ++t) {
        Step &step = foot.steps[t];
        step.pivot = step.stand == Stand::Heel ? foot.leg.heel : step.stand == Stand::Flat ? foot.leg.ball : foot.leg.tip;
        if (t == first)
          step.pivot_at = foot.point(t, step.pivot);
        else
          step.pivot_at = foot.steps[t - 1].pivot_at + foot.steps[t - 1].rotation * (step.pivot - foot.steps[t - 1].pivot);
        step.pivot_at.y() = options_.floor_height + edge(foot, t);
        away += foot.point(t, step.pivot) - step.pivot_at;
      }
      away *= first == 0 ? 0.0 : 1.0 / (last - first + 1);
      away.y() = 0;
      for (int t = first; t <= last; ++t)
        foot.steps[t].pivot_at += away;
    }
  }

  Vector3d planned_ankle(const Foot &foot, int t) const {
    const Step &step = foot.steps[t];
    return step.pivot_at + step.rotation * (foot.ankle_rest - step.pivot);
  }

  /// Height of the floor under the motion as it is: where feet stand, straight between.
  Series ground() const {
    Series height(count_, 0), feet(count_, 0);
    for (const Foot &foot : feet_)
      for (int t = 0; t < count_; ++t)
        if (foot.steps[t].stand != Stand::Air) {
          height[t] += std::min(foot.point(t, foot.leg.heel).y(), foot.point(t, foot.leg.ball).y()) - options_.floor_height;
          ++feet[t];
        }
    int known = -1;
    for (int t = 0; t < count_; ++t) {
      if (feet[t] == 0)
        continue;
      height[t] /= feet[t];
      for (int k = known + 1; k < t; ++k)
        height[k] = known < 0 ? height[t] : height[known] + (height[t] - height[known]) * (k - known) / (t - known);
      known = t;
    }
    for (int k = known + 1; known >= 0 && k < count_; ++k)
      height[k] = height[known];
    const int radius = frames(kGroundBlur, motion_.fps);
    return mean_around(mean_around(height, radius), radius);
  }

  /// How far the leg may stretch: nearly straight, or as far as it is.
  double limit(std::size_t f, int t) const {
    return std::max((feet_[f].steps[t].ankle - hips_[f][t]).norm(), kStraight * longest_reach(skeleton_, feet_[f].leg));
  }

  /// How far the hips have to go down for the feet to reach where they stand; never less, but smooth.
  Series drop() const {
    Series up(count_, 0);
    for (std::size_t f = 0; f < feet_.size(); ++f)
      for (int t = 0; t < count_; ++t) {
        if (feet_[f].steps[t].stand == Stand::Air)
          continue;
        const Vector3d down = hips_[f][t] - planned_ankle(feet_[f], t);
        const double height = std::sqrt(std::max(0.0, std::pow(limit(f, t), 2) - std::pow(std::hypot(down.x(), down.z()), 2)));
        up[t] = std::min(up[t], -std::clamp(down.y() - height, 0.0, options_.max_pelvis_drop));
      }
    const int radius = frames(kDropBlur, motion_.fps);
    Series result = mean_around(lowest_around(up, radius), radius);
    for (double &value : result)
      value = -value;
    return result;
  }

  void lower_root(const Series &by) {
    for (int t = 0; t < count_; ++t) {
      motion_.dofs(t, skeleton_.joints[0].first_dof + 1) -= by[t];
      for (std::size_t f = 0; f < feet_.size(); ++f) {
        feet_[f].steps[t].ankle.y() -= by[t];
        hips_[f][t].y() -= by[t];
      }
    }
  }

  /// Where the foot stands the plan, blended out around it; and no end of the sole below the floor, or, away from contacts, near
  /// it: a foot that swings does not scrape.
  void plan_offsets(Foot &foot) const {
    std::vector<Vector3d> offsets(count_, Vector3d::Zero());
    for (int t = 0; t < count_; ++t)
      if (foot.steps[t].stand != Stand::Air)
        offsets[t] = planned_ankle(foot, t) - foot.steps[t].ankle;
    ease(offsets, standing(foot), blend_frames());
    meet_at_rest(foot, offsets);
    const Series away = swing_weight(foot), least = least_heights(foot, offsets);
    Series need(count_), lift(count_);
    for (int t = 0; t < count_; ++t) {
      const double lowest = std::min(foot.point(t, foot.leg.heel).y(), foot.point(t, foot.leg.tip).y()) - edge(foot, t);
      const double clear = std::max(kClearance * away[t], least[t]);
      need[t] = std::max(0.0, options_.floor_height + clear - lowest - offsets[t].y());
      lift[t] = -need[t];
    }
    const int radius = frames(kLiftBlur, motion_.fps);
    lift = mean_around(lowest_around(lift, radius), radius);
    for (int t = 0; t < count_; ++t)
      foot.steps[t].offset = offsets[t] + std::max(need[t], -lift[t] * away[t]) * Vector3d::UnitY();
  }

  static Vector3d along_floor(const Vector3d &v) { return {v.x(), 0, v.z()}; }

  /// A foot is slowed down in the air, not by the floor: the step between a stand and the frame beside it is taken out, fading
  /// into the clip's own path like the blend. The height goes on as it did.
  void meet_at_rest(const Foot &foot, std::vector<Vector3d> &offsets) const {
    for (const RunEnd &end : ends_of(standing(foot), count_)) {
      const int blend = std::min(blend_frames(), end.gap);
      if (blend < 2)
        continue;
      const Vector3d &pivot = foot.steps[end.frame].pivot;
      const auto at = [&](int t) -> Vector3d { return foot.point(t, pivot) + offsets[t]; };
      const Vector3d step = along_floor(at(end.frame) - at(end.frame + end.direction));
      for (int k = 1; k < blend; ++k) {
        const double x = static_cast<double>(k) / blend;
        offsets[end.frame + end.direction * k] += k * (1 - x) * (1 - x) * step;
      }
    }
  }

  /// How high a foot has to be: not at all where it stands, and the higher the farther along the floor it is from there, for it
  /// does not skim the floor on its way.
  Series least_heights(const Foot &foot, const std::vector<Vector3d> &offsets) const {
    Series heights(count_);
    for (int t = 0; t < count_; ++t)
      heights[t] = foot.steps[t].stand == Stand::Air ? kLeastSwing : 0;
    for (const RunEnd &end : ends_of(standing(foot), count_)) {
      const Step &stand = foot.steps[end.frame];
      for (int k = 1; k < end.gap; ++k) {
        const int t = end.frame + end.direction * k;
        const double far = along_floor(foot.point(t, stand.pivot) + offsets[t] - stand.pivot_at).norm();
        heights[t] = std::min(heights[t], kLeastSwing * (1 - std::exp(-far / kNearStand)));
      }
    }
    return heights;
  }

  /// How far the sole's edge is below its middle line, the foot being rolled.
  static double edge(const Foot &foot, int t) {
    const Matrix3d &rotation = foot.steps[t].rotation;
    const Vector3d across = (foot.leg.tip - foot.leg.heel).cross(Vector3d::UnitY());
    return kHalfWidth * std::abs((rotation * across).y());
  }

  /// 0 where the foot stands to 1 well away from there.
  Series swing_weight(const Foot &foot) const {
    Series result(count_, 1);
    for (const auto &[first, last] : standing(foot)) {
      const int around = 2 * blend_frames();
      for (int t = std::max(0, first - around); t <= std::min(count_ - 1, last + around); ++t) {
        const double x = std::max({0, first - t, t - last}) / static_cast<double>(around);
        result[t] = std::min(result[t], x * x * (3 - 2 * x));
      }
    }
    return result;
  }

  /// Where a leg is too short all the same, the offset shrinks to what it reaches, smoothly. Not its way up: feet do not sink.
  void let_go(std::size_t f) {
    std::vector<Step> &steps = feet_[f].steps;
    Series share(count_, 1);
    const auto up = [&](int t) { return Vector3d(0, std::max(0.0, steps[t].offset.y()), 0); };
    for (int t = 0; t < count_; ++t) {
      const Vector3d now = steps[t].ankle + up(t) - hips_[f][t], by = steps[t].offset - up(t);
      const double far = limit(f, t), a = by.squaredNorm(), b = now.dot(by), c = now.squaredNorm() - far * far;
      if ((now + by).norm() > far && a > 0)
        share[t] = std::clamp((-b + std::sqrt(std::max(0.0, b * b - a * c))) / a, 0.0, 1.0);
    }
    const int radius = frames(kDropBlur, motion_.fps);
    share = mean_around(lowest_around(share, radius), radius);
    for (int t = 0; t < count_; ++t)
      steps[t].offset = up(t) + share[t] * (steps[t].offset - up(t));
  }

  /// A swinging foot is held by its ball, near a stand by what it stands on: other poses where the ankle cannot turn so far.
  void plan_holds(Foot &foot) const {
    for (Step &step : foot.steps)
      if (step.stand == Stand::Air)
        step.pivot = foot.leg.ball;
    for (const RunEnd &end : ends_of(standing(foot), count_)) {
      const int blend = std::min(blend_frames(), end.gap);
      for (int k = 1; k < blend; ++k) {
        const double x = static_cast<double>(k) / blend;
        foot.steps[end.frame + end.direction * k].pivot +=
            (1 - x) * (1 - x) * (1 + 2 * x) * (foot.steps[end.frame].pivot - foot.leg.ball);
      }
    }
  }

  void follow(const Foot &foot) {
    Eigen::VectorXd pose;
    for (int t = 0; t < count_; ++t) {
      const Step &step = foot.steps[t];
      pose = motion_.dofs.row(t);
      solve_leg(skeleton_, foot.leg, {step.pivot, foot.point(t, step.pivot) + step.offset, step.rotation, step.slope}, pose);
      motion_.dofs.row(t) = pose;
    }
  }

  const Skeleton &skeleton_;
  const PlantOptions &options_;
  Motion motion_;
  int count_;
  std::vector<Foot> feet_;
  std::vector<std::vector<Vector3d>> hips_; ///< foot x frame
};

} // namespace

void PlantOptions::validate() const {
  options::check(*this);
}

std::vector<FootContacts> find_contacts(const Skeleton &skeleton, const Motion &motion, const PlantOptions &options) {
  options.validate();
  require_steps(skeleton, motion, "find_contacts");
  return Planter(skeleton, motion, options).contacts_of_feet();
}

Motion plant_feet(const Skeleton &skeleton, const Motion &motion, const PlantOptions &options) {
  options.validate();
  require_steps(skeleton, motion, "plant_feet");
  return Planter(skeleton, motion, options).plant();
}

} // namespace doublet
