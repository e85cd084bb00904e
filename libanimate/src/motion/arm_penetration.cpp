#include "doublet/animate/parts/arm_penetration.h"

#include "arms.h"
#include "require_motion.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <limits>

namespace doublet {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kSpacing = 0.03;   // m, of spheres along a capsule
constexpr int kRounds = 60;         // of clearing each frame, and smoothing over time
constexpr double kBlur = 0.06;      // s
constexpr double kDamping = 0.02;   // m^2, against the squared levers: what hardly helps is not turned
constexpr double kMostTurned = 0.1; // rad in a round
constexpr double kLongestArm = 1.2; // m
constexpr double kUnmoved = 1e-6;   // rad

/// A part of an arm, and how near to the body it may come.
struct Sphere {
  int joint;
  Vector3d rest; ///< m, world
  double radius, clearance;
};
struct Arm {
  int shoulder;
  std::vector<Sphere> spheres;
};

/// One frame of one arm, in the frame of its shoulder's parent, about the shoulder.
struct Reach {
  std::vector<Vector3d> spheres;
  std::vector<Capsule> obstacles;
  Vector3d turn = Vector3d::Zero(), looked_at = Vector3d::Zero(); ///< rotation vectors: of the arm; where `room` was found
  double room = 0;                                                ///< m, that were left there; less than zero = missing
};

/// The nearest obstacle: its distance, and the direction away from it.
double distance_to(const std::vector<Capsule> &obstacles, const Vector3d &point, Vector3d *outward = nullptr) {
  double nearest = std::numeric_limits<double>::infinity();
  const Capsule *found = nullptr;
  for (const Capsule &obstacle : obstacles)
    if (const double d = signed_distance(obstacle, point); d < nearest)
      nearest = d, found = &obstacle;
  constexpr double h = 1e-6; // m, of differences
  for (int k = 0; k < 3 && found && outward; ++k)
    (*outward)[k] =
        (signed_distance(*found, point + h * Vector3d::Unit(k)) - signed_distance(*found, point - h * Vector3d::Unit(k))) /
        (2 * h);
  return nearest;
}

std::vector<TaperedCapsule> capsules_of_the_rest(const Character &character, const std::vector<int> &arm_of) {
  std::vector<TaperedCapsule> rest;
  std::copy_if(character.proxies.begin(), character.proxies.end(), std::back_inserter(rest),
               [&](const TaperedCapsule &proxy) { return arm_of[proxy.joint] == 0; });
  return rest;
}

/// What the capsules below the elbow of an arm are made of.
std::vector<Sphere> spheres_of(const Character &character, const std::vector<int> &arm_of, int shoulder) {
  std::vector<Sphere> spheres;
  for (const TaperedCapsule &proxy : character.proxies) {
    if (arm_of[proxy.joint] != arm_of[shoulder] || proxy.joint == shoulder)
      continue;
    const Vector3d &origin = character.actor.skeleton.joints[proxy.joint].rest;
    const int steps = std::max(1, static_cast<int>(std::ceil((proxy.p1 - proxy.p0).norm() / kSpacing)));
    for (int i = 0; i <= steps; ++i) {
      const double t = static_cast<double>(i) / steps;
      spheres.push_back({proxy.joint, origin + (1 - t) * proxy.p0 + t * proxy.p1, (1 - t) * proxy.r0 + t * proxy.r1, 0});
    }
  }
  return spheres;
}

std::vector<Arm> find_arms(const Character &character, const std::vector<int> &arm_of,
                           const std::vector<TaperedCapsule> &obstacles) {
  const Skeleton &skeleton = character.actor.skeleton;
  const std::vector<Capsule> at_rest =
      pose_capsules(obstacles, skeleton, Transforms(skeleton.joint_count(), Eigen::Isometry3d::Identity()));
  const double clearance = 2 * character.solver.cloth.thickness;
  std::vector<Arm> arms;
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const Joint &joint = skeleton.joints[j];
    const bool shoulder = arm_of[j] != 0 && joint.name == detail::kShoulders[arm_of[j] - 1];
    if (!shoulder || joint.kind != JointKind::Ball || joint.parent < 0)
      continue;
    Arm &arm = arms.emplace_back(Arm{j, spheres_of(character, arm_of, j)});
    for (Sphere &sphere : arm.spheres)
      sphere.clearance = std::min(clearance, distance_to(at_rest, sphere.rest) - sphere.radius);
  }
  return arms;
}

Reach reach_of(const Skeleton &skeleton, const Arm &arm, const std::vector<TaperedCapsule> &obstacles,
               const Transforms &world_from_rest) {
  const Joint &joint = skeleton.joints[arm.shoulder];
  Eigen::Isometry3d about_from_world = Eigen::Isometry3d::Identity();
  about_from_world.linear() = world_from_rest[joint.parent].linear().transpose();
  about_from_world.translation() = -(about_from_world.linear() * (world_from_rest[arm.shoulder] * joint.rest));
  Reach reach;
  for (const Sphere &sphere : arm.spheres)
    reach.spheres.push_back(about_from_world * (world_from_rest[sphere.joint] * sphere.rest));
  reach.obstacles = pose_capsules(obstacles, skeleton, world_from_rest);
  for (Capsule &obstacle : reach.obstacles) {
    obstacle.p0 = about_from_world * obstacle.p0;
    obstacle.p1 = about_from_world * obstacle.p1;
  }
  return reach;
}

/// One Gauss-Newton step on what is missing. Nothing where there was more room than the arm has turned since it was looked at.
void clear(const Arm &arm, Reach &reach) {
  if (kLongestArm * (reach.turn - reach.looked_at).norm() < reach.room)
    return;
  const Matrix3d turned = rotation_from_vector(reach.turn);
  Matrix3d matrix = kDamping * Matrix3d::Identity();
  Vector3d right = Vector3d::Zero();
  reach.room = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < arm.spheres.size(); ++i) {
    const Vector3d centre = turned * reach.spheres[i];
    Vector3d outward;
    const double room = distance_to(reach.obstacles, centre) - arm.spheres[i].radius - arm.spheres[i].clearance;
    reach.room = std::min(reach.room, room);
    if (room >= 0)
      continue;
    distance_to(reach.obstacles, centre, &outward);
    const Vector3d gradient = centre.cross(outward);
    matrix += gradient * gradient.transpose();
    right -= room * gradient;
  }
  reach.looked_at = reach.turn;
  if (reach.room >= 0)
    return;
  const Vector3d by = matrix.ldlt().solve(right);
  reach.turn = vector_from_rotation(rotation_from_vector(std::min(1.0, kMostTurned / std::max(by.norm(), 1e-12)) * by) * turned);
}

/// Gaussian, over the frames; the ends go on.
void smooth(std::vector<Reach> &frames, double sigma) {
  const int count = static_cast<int>(frames.size()), wide = static_cast<int>(std::ceil(3 * sigma));
  std::vector<Vector3d> turns(frames.size(), Vector3d::Zero());
  for (int t = 0; t < count; ++t) {
    double sum = 0;
    for (int k = -wide; k <= wide; ++k) {
      const double weight = std::exp(-0.5 * (k / sigma) * (k / sigma));
      turns[t] += weight * frames[std::clamp(t + k, 0, count - 1)].turn;
      sum += weight;
    }
    turns[t] /= sum;
  }
  for (int t = 0; t < count; ++t)
    frames[t].turn = turns[t];
}

} // namespace

Motion resolve_arm_penetration(const Character &character, const Motion &motion, const Context &context) {
  const Skeleton &skeleton = character.actor.skeleton;
  require_steps(skeleton, motion, "resolve_arm_penetration");
  const std::vector<int> arm_of = detail::arms_of_joints(skeleton);
  const std::vector<TaperedCapsule> obstacles = capsules_of_the_rest(character, arm_of);
  Motion resolved = motion;
  const int count = static_cast<int>(motion.dofs.rows());
  for (const Arm &arm : find_arms(character, arm_of, obstacles)) {
    std::vector<Reach> frames(count);
    parallel_for(context, count, [&](int t) {
      frames[t] = reach_of(skeleton, arm, obstacles, forward_kinematics(skeleton, motion.dofs.row(t)));
    });
    for (int round = 0; round < kRounds; ++round) {
      parallel_for(context, count, [&](int t) { clear(arm, frames[t]); });
      if (std::all_of(frames.begin(), frames.end(), [](const Reach &reach) { return reach.room >= 0; }))
        break;
      smooth(frames, std::max(kBlur * motion.fps, 0.5));
    }
    const Joint &joint = skeleton.joints[arm.shoulder];
    for (int t = 0; t < count; ++t)
      if (frames[t].turn.norm() > kUnmoved) {
        const Vector3d own = motion.dofs.row(t).segment<3>(joint.first_dof);
        resolved.dofs.row(t).segment<3>(joint.first_dof) =
            vector_from_rotation(rotation_from_vector(frames[t].turn) * rotation_from_vector(own)).transpose();
      }
  }
  return resolved;
}

} // namespace doublet
