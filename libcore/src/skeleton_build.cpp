// From marked joints to a skeleton: order, default freedom, hinge axes from the rest geometry, human limits.

#include "doublet/core/error.h"
#include "doublet/core/parts/skeleton_tree.h"
#include "doublet/core/skeleton.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

namespace doublet {

namespace {

using Eigen::Vector3d;

constexpr double kDegree = 3.14159265358979323846 / 180;
constexpr double kPi = 180 * kDegree;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Below this bend the marks (millimetres of noise on bones of decimetres) say too little about the plane of the bend.
constexpr double kBendForAxis = 10 * kDegree;

/// "l_knee" and "r_knee" -> "knee".
std::string without_side(const std::string &name) {
  return name.rfind("l_", 0) == 0 || name.rfind("r_", 0) == 0 ? name.substr(2) : name;
}

int default_dof(const JointAnnotation &mark) {
  static const std::map<std::string, int> by_name = {{"spine", 3}, {"neck", 3}, {"shoulder", 3}, {"elbow", 2},
                                                     {"wrist", 2}, {"hip", 3},  {"knee", 1},     {"ankle", 1}};
  if (mark.parent.empty())
    return 6;
  const auto it = by_name.find(without_side(mark.name));
  return it == by_name.end() ? 0 : it->second;
}

std::map<std::string, int> index_by_name(const std::vector<JointAnnotation> &marks) {
  std::map<std::string, int> index;
  for (std::size_t i = 0; i < marks.size(); ++i) {
    if (marks[i].name.empty())
      throw Error("skeleton: joint " + std::to_string(i) + " has no name");
    if (!marks[i].position.allFinite())
      throw Error("skeleton: the position of joint '" + marks[i].name + "' is not finite");
    if (!index.emplace(marks[i].name, static_cast<int>(i)).second)
      throw Error("skeleton: two joints are named '" + marks[i].name + "'");
  }
  return index;
}

std::vector<int> parent_indices(const std::vector<JointAnnotation> &marks) {
  const std::map<std::string, int> index = index_by_name(marks);
  std::vector<int> parents;
  std::string root;
  for (const JointAnnotation &mark : marks) {
    if (mark.parent.empty()) {
      if (!root.empty())
        throw Error("skeleton: expected one root (a joint without parent), found '" + root + "' and '" + mark.name + "'");
      root = mark.name;
      parents.push_back(-1);
      continue;
    }
    const auto it = index.find(mark.parent);
    if (it == index.end())
      throw Error("skeleton: the parent '" + mark.parent + "' of joint '" + mark.name + "' is not a joint");
    parents.push_back(it->second);
  }
  if (root.empty())
    throw Error("skeleton: expected one root (a joint without parent), found none in " + std::to_string(marks.size()) +
                " joints");
  return parents;
}

/// Marks' indices, parents first, otherwise in the order given.
std::vector<int> parents_first(const std::vector<JointAnnotation> &marks, const std::vector<int> &parents) {
  std::vector<int> order;
  std::vector<bool> placed(marks.size(), false);
  for (std::size_t i = 0; i < marks.size(); ++i) {
    std::vector<int> line;
    for (int j = static_cast<int>(i); j >= 0 && !placed[j]; j = parents[j]) {
      line.push_back(j);
      if (line.size() > marks.size())
        throw Error("skeleton: joint '" + marks[i].name + "' is its own ancestor");
    }
    for (auto it = line.rbegin(); it != line.rend(); ++it) {
      placed[*it] = true;
      order.push_back(*it);
    }
  }
  return order;
}

JointKind kind_of(int dof, const std::string &name) {
  switch (dof) {
  case 0:
    return JointKind::Fixed;
  case 1:
  case 2:
    return JointKind::Hinges;
  case 3:
    return JointKind::Ball;
  case 6:
    return JointKind::Root;
  default:
    throw Error("skeleton: joint '" + name + "' has dof " + std::to_string(dof) + ", expected 0, 1, 2, 3 or 6");
  }
}

/// Directions of the standing body in the rest pose.
struct BodyAxes {
  Vector3d left, up, forward;
};

BodyAxes body_axes(const Skeleton &skeleton) {
  const auto across = [&](const std::string &joint) -> Vector3d {
    const Joint *l = nullptr, *r = nullptr;
    for (const Joint &j : skeleton.joints) {
      if (j.name == "l_" + joint)
        l = &j;
      if (j.name == "r_" + joint)
        r = &j;
    }
    return l && r ? Vector3d(l->rest - r->rest) : Vector3d::Zero();
  };
  Vector3d left = across("hip");
  if (left.norm() < 1e-6)
    left = across("shoulder");
  left.y() = 0; // +Y is up, and the actor stands
  if (left.norm() < 1e-6)
    left = Vector3d::UnitX();
  left.normalize();
  return {left, Vector3d::UnitY(), left.cross(Vector3d::UnitY())};
}

/// Bones that meet at a joint: unit directions from the parent into it and out of it to its first child.
struct Bones {
  Vector3d in = Vector3d::Zero(), out = Vector3d::Zero();
};

Vector3d direction(const Vector3d &v) {
  return v.norm() > 1e-9 ? Vector3d(v.normalized()) : Vector3d::Zero();
}

Bones bones_at(const Skeleton &skeleton, int joint) {
  const Joint &j = skeleton.joints[joint];
  Bones bones;
  if (j.parent >= 0)
    bones.in = direction(j.rest - skeleton.joints[j.parent].rest);
  if (const int child = first_child(skeleton, joint); child >= 0)
    bones.out = direction(skeleton.joints[child].rest - j.rest);
  if (bones.out.isZero())
    bones.out = bones.in;
  if (bones.in.isZero())
    bones.in = bones.out;
  if (bones.out.isZero())
    bones.in = bones.out = -Vector3d::UnitY();
  return bones;
}

/// The axis about which a positive angle moves `bone` towards `target` (or `other`, where the bone lies along `target`).
Vector3d axis_towards(const Vector3d &bone, const Vector3d &target, const Vector3d &other) {
  const Vector3d axis = bone.cross(target);
  return axis.norm() > 0.1 ? axis.normalized() : bone.cross(other).normalized();
}

double bend_angle(const Bones &b) {
  return std::atan2(b.in.cross(b.out).norm(), b.in.dot(b.out));
}

/// A positive angle bends the joint further; where it is straight, `target` says which way it bends.
Vector3d flexion_axis(const Bones &b, const Vector3d &target, const Vector3d &other) {
  return bend_angle(b) > kBendForAxis ? b.in.cross(b.out).normalized() : axis_towards(b.out, target, other);
}

struct Freedom {
  std::string suffix;
  Vector3d axis;
  double lower, upper; ///< rad, relative to the rest pose
};

/// Flexion of knee or elbow: anatomical range -10 (overstretched) to 155 degrees of bend, the rest pose's bend taken off.
Freedom flexion(const Bones &b, const Vector3d &axis) {
  const double rest_bend = std::atan2(axis.dot(b.in.cross(b.out)), b.in.dot(b.out));
  return {"flex", axis, -rest_bend - 10 * kDegree, 155 * kDegree - rest_bend};
}

std::vector<Freedom> elbow(const Bones &b, const BodyAxes &body) {
  // Pronation and supination together span about 160 degrees; where the rest pose lies in it is not marked.
  return {flexion(b, flexion_axis(b, body.forward, body.up)), {"twist", b.out, -100 * kDegree, 100 * kDegree}};
}

std::vector<Freedom> wrist(const Bones &b, const Vector3d &elbow_axis) {
  // Which way the palm faces is not marked, so both axes get the wider range (flexion, 80 degrees).
  const Vector3d across = elbow_axis - elbow_axis.dot(b.out) * b.out;
  const Vector3d flex = across.norm() > 0.1 ? across.normalized() : b.out.unitOrthogonal();
  return {{"flex", flex, -80 * kDegree, 80 * kDegree}, {"dev", b.out.cross(flex), -80 * kDegree, 80 * kDegree}};
}

std::vector<Freedom> knee(const Bones &b, const BodyAxes &body) {
  // Of the bent knee the shank turns by some 40 degrees about itself, between the extremes.
  return {flexion(b, flexion_axis(b, -body.forward, -body.up)), {"twist", b.out, -40 * kDegree, 40 * kDegree}};
}

std::vector<Freedom> ankle(const Bones &b, const BodyAxes &body, int dof) {
  // Positive lifts the toes. From standing: dorsiflexion in a deep lunge reaches 50 degrees, plantar flexion on tiptoe 60.
  const Freedom flex{"flex", flexion_axis(b, body.forward, body.up), -60 * kDegree, 50 * kDegree};
  if (dof == 1)
    return {flex};
  return {{"turn", b.in, -45 * kDegree, 45 * kDegree}, flex}; // toes in and out, about the shank
}

/// A hinge that is no joint we know: any axis across the bone, any angle.
std::vector<Freedom> unknown_hinges(const Bones &b, const BodyAxes &body, int dof) {
  const Vector3d a = flexion_axis(b, body.forward, body.up);
  std::vector<Freedom> out = {{"a", a, -kPi, kPi}};
  if (dof == 2)
    out.push_back({"b", b.out.cross(a).normalized(), -kPi, kPi});
  return out;
}

std::vector<Freedom> hinges(const Skeleton &skeleton, int joint, int dof, const BodyAxes &body) {
  const Joint &j = skeleton.joints[joint];
  const Bones b = bones_at(skeleton, joint);
  const std::string name = without_side(j.name);
  std::vector<Freedom> out;
  if (name == "knee")
    out = knee(b, body);
  else if (name == "ankle")
    out = ankle(b, body, dof);
  else if (name == "elbow")
    out = elbow(b, body);
  else if (name == "wrist" && j.parent >= 0)
    out = wrist(b, flexion_axis(bones_at(skeleton, j.parent), body.forward, body.up));
  else
    return unknown_hinges(b, body, dof);
  out.resize(dof);
  return out;
}

/// Limit of each component of a ball joint's rotation vector, rad. Generous: what the whole chain under one mark can do
/// (a shoulder includes the shoulder blade's share, a spine all vertebrae), because a wrong limit costs more than a missing one.
double ball_limit(const std::string &name) {
  static const std::map<std::string, double> limits = {{"hip", 2.3}, {"shoulder", 2.6}, {"spine", 1.2}, {"neck", 1.2}};
  const auto it = limits.find(without_side(name));
  return it == limits.end() ? kPi : it->second;
}

std::vector<Freedom> freedoms(const Skeleton &skeleton, int joint, int dof, const BodyAxes &body) {
  const Vector3d none = Vector3d::Zero();
  const double ball = ball_limit(skeleton.joints[joint].name);
  switch (skeleton.joints[joint].kind) {
  case JointKind::Fixed:
    return {};
  case JointKind::Root:
    return {{"tx", none, -kInfinity, kInfinity}, {"ty", none, -kInfinity, kInfinity}, {"tz", none, -kInfinity, kInfinity},
            {"ry", none, -kInfinity, kInfinity}, {"rx", none, -kInfinity, kInfinity}, {"rz", none, -kInfinity, kInfinity}};
  case JointKind::Ball:
    return {{"x", none, -ball, ball}, {"y", none, -ball, ball}, {"z", none, -ball, ball}};
  case JointKind::Hinges:
    return hinges(skeleton, joint, dof, body);
  }
  return {};
}

} // namespace

Skeleton make_skeleton(const std::vector<JointAnnotation> &marks) {
  const std::vector<int> parents = parent_indices(marks);
  const std::vector<int> order = parents_first(marks, parents);
  std::vector<int> place(marks.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    place[order[i]] = static_cast<int>(i);

  Skeleton skeleton;
  std::vector<int> dof;
  for (const int i : order) {
    Joint joint;
    joint.name = marks[i].name;
    joint.parent = parents[i] < 0 ? -1 : place[parents[i]];
    joint.rest = marks[i].position;
    dof.push_back(marks[i].dof.value_or(default_dof(marks[i])));
    joint.kind = kind_of(dof.back(), joint.name);
    skeleton.joints.push_back(joint);
  }

  const BodyAxes body = body_axes(skeleton);
  std::vector<double> lower, upper;
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    Joint &joint = skeleton.joints[j];
    joint.first_dof = skeleton.dof_count();
    joint.dof_count = dof[j];
    for (const Freedom &f : freedoms(skeleton, j, dof[j], body)) {
      skeleton.dof_names.push_back(joint.name + "." + f.suffix);
      lower.push_back(f.lower);
      upper.push_back(f.upper);
      if (joint.kind == JointKind::Hinges)
        joint.axes.push_back(f.axis);
    }
  }
  skeleton.lower = Eigen::Map<Eigen::VectorXd>(lower.data(), lower.size());
  skeleton.upper = Eigen::Map<Eigen::VectorXd>(upper.data(), upper.size());
  return skeleton;
}

std::vector<JointAnnotation> joint_annotations(const Skeleton &skeleton) {
  std::vector<JointAnnotation> marks;
  for (const Joint &j : skeleton.joints)
    marks.push_back({j.name, j.parent < 0 ? "" : skeleton.joints[j.parent].name, j.rest, j.dof_count});
  return marks;
}

bool Skeleton::is_leaf(int joint) const {
  return first_child(*this, joint) < 0;
}

std::vector<int> child_counts(const Skeleton &skeleton) {
  std::vector<int> counts(skeleton.joints.size(), 0);
  for (const Joint &joint : skeleton.joints)
    if (joint.parent >= 0)
      ++counts[joint.parent];
  return counts;
}

int first_child(const Skeleton &skeleton, int joint) {
  const auto found =
      std::find_if(skeleton.joints.begin(), skeleton.joints.end(), [&](const Joint &child) { return child.parent == joint; });
  return found == skeleton.joints.end() ? -1 : static_cast<int>(found - skeleton.joints.begin());
}

int Skeleton::find(const std::string &name) const {
  std::string known;
  for (int j = 0; j < joint_count(); ++j) {
    if (joints[j].name == name)
      return j;
    known += (j ? ", " : "") + joints[j].name;
  }
  throw Error("skeleton: unknown joint '" + name + "'; the joints are " + known);
}

} // namespace doublet
