#pragma once
// A leg as feet are planted with it: a ball at the hip, one hinge at the knee, a foot whose sole is a line from heel to tip.

#include "doublet/core/skeleton.h"

#include <vector>

namespace doublet {

/// Points in the rest pose, world.
struct Leg {
  int hip, knee, ankle;
  Eigen::Vector3d heel, ball, tip; ///< on the floor
  double sole() const { return (tip - heel).norm(); }
};

/// The legs by their standard names; one whose joints are of other kinds cannot be planted and is left out.
std::vector<Leg> find_legs(const Skeleton &skeleton, double floor_height);

/// What a foot has to do in one frame.
struct FootGoal {
  Eigen::Vector3d point;    ///< of the foot, rest pose
  Eigen::Vector3d at;       ///< where it has to be
  Eigen::Matrix3d rotation; ///< of the foot, world from rest: the ankle comes as close as its hinge can
  double slope;             ///< (tip - heel).y / sole; met exactly unless the foot is steep or the ankle at its limit
};

/// The farthest that the ankle gets from the hip.
double longest_reach(const Skeleton &skeleton, const Leg &leg);

/// Hip, knee and ankle of `pose` so that the foot meets the goal. The leg turns the short way, so the knee keeps its plane.
/// Limits are kept (a pose beyond them gets no farther); out of reach, the leg points to the goal.
void solve_leg(const Skeleton &skeleton, const Leg &leg, const FootGoal &goal, Eigen::VectorXd &pose);

/// Lifts feet that are below the floor onto it.
void lift_feet(const Skeleton &skeleton, double floor_height, Eigen::VectorXd &pose);

} // namespace doublet
