// Retargeting. For every bone b: R_target = W R_source C^T A_b, where C turns the source's zero pose to our rest pose (same up,
// same facing), W turns the source's world to ours, and A_b, constant, turns our bone's rest direction to that of the source's
// zero pose, so that both bones point the same way in every frame while the roll counts from the rest poses.

#include "doublet/animate/retarget.h"

#include "clip_figure.h"
#include "doublet/animate/plant_feet.h"
#include "doublet/core/error.h"
#include "doublet/core/parts/alignment.h"
#include "doublet/options/options.h"
#include "leg.h"
#include "match_joints.h"
#include "nearest_axes.h"

#include <Eigen/Cholesky>

#include <algorithm>
#include <array>
#include <cmath>

namespace doublet {
namespace {

using Eigen::Matrix3d;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Names = std::map<std::string, int>;

constexpr double kDegree = M_PI / 180;

/// A limb bone: from joint `name` to the first of `ends` that both skeletons have.
struct LimbBone {
  const char *name;
  std::vector<const char *> ends;
  const char *parent;
};
const std::array<LimbBone, 6> kLimb{{{"hip", {"knee"}, "pelvis"},
                                     {"knee", {"ankle"}, "hip"},
                                     {"ankle", {"toe"}, "knee"},
                                     {"shoulder", {"elbow"}, "chest"},
                                     {"elbow", {"wrist"}, "shoulder"},
                                     {"wrist", {"hand"}, "elbow"}}};

/// Columns left, up, forward. A left within 5 degrees of a coordinate axis is taken for it: marks have millimetres of noise,
/// files none.
Matrix3d body_frame(const Vector3d &left_raw, const Vector3d &up) {
  Vector3d left = left_raw - left_raw.dot(up) * up;
  if (left.norm() < 1e-9)
    return (Matrix3d() << up.unitOrthogonal(), up, up.unitOrthogonal().cross(up)).finished();
  left.normalize();
  const Vector3d axis = nearest_axis(left);
  if (std::abs(axis.dot(up)) < 1e-9 && left.dot(axis) > std::cos(5 * kDegree))
    left = axis;
  Matrix3d frame;
  frame << left, up, left.cross(up);
  return frame;
}

class Retargeter {
public:
  Retargeter(const SourceMotion &clip, const Skeleton &skeleton, const RetargetOptions &options)
      : clip_(clip), skeleton_(skeleton), figure_(clip, match_joints(clip, options.joint_names)),
        target_(match_target(skeleton)) {
    for (const Joint &joint : skeleton.joints)
      rest_.push_back(joint.rest);
    require_bones();
    scale_ = leg_length_target() / figure_.leg_length(); // once: the clip's legs are measured in all of its frames
    align_worlds();
    align_bones();
  }

  std::vector<Quaterniond> rotations(int t) const {
    std::vector<Quaterniond> result(skeleton_.joint_count(), Quaterniond::Identity());
    for (int j = 0; j < skeleton_.joint_count(); ++j) {
      const std::string &part = part_of_target_[j];
      if (!part.empty() && figure_.joints.count(part))
        result[j] = Quaterniond(bone_rotation(part, t));
      else if (skeleton_.joints[j].parent >= 0)
        result[j] = result[skeleton_.joints[j].parent];
    }
    return result;
  }

  /// The torso's joints as the pose has them (its fixed joints drive the free ones above); only limbs are left to fit.
  void keep_torso(const Transforms &world_from_rest, std::vector<Quaterniond> &rotations) const {
    std::vector<bool> limb(skeleton_.joint_count(), false);
    for (int j = 0; j < skeleton_.joint_count(); ++j) {
      const int p = skeleton_.joints[j].parent;
      limb[j] = bones_.count(part_of_target_[j]) > 0 || (p >= 0 && limb[p]);
      if (!limb[j])
        rotations[j] = Quaterniond(world_from_rest[j].linear());
    }
  }

  /// Where the root goes so that the middle of the hips follows the clip's.
  Vector3d root_position(int t) const {
    const Vector3d hips = 0.5 * (figure_.at("l_hip", t) + figure_.at("r_hip", t));
    const Vector3d rest_hips = 0.5 * (target_rest("l_hip") + target_rest("r_hip"));
    const Vector3d root = skeleton_.joints[0].rest;
    return scale_ * (world_ * hips) - bone_rotation("pelvis", t) * (rest_hips - root);
  }

  /// Turns and moves the clip so that frame t faces as the rest pose does.
  void face_rest(int t) {
    const Matrix3d pelvis = bone_rotation("pelvis", t) * target_frame_;
    Vector3d ahead = pelvis.col(2);
    if (std::hypot(ahead.x(), ahead.z()) < 0.3) // lies: on the belly the head is ahead, on the back the feet are
      ahead = (ahead.y() < 0 ? 1.0 : -1.0) * pelvis.col(1);
    const double now = std::atan2(ahead.x(), ahead.z()), wanted = std::atan2(target_frame_(0, 2), target_frame_(2, 2));
    world_ = Eigen::AngleAxisd(wanted - now, Vector3d::UnitY()).toRotationMatrix() * world_;
  }

  /// The file's world, if it is turned on its side against the zero pose.
  std::string turned_world() const {
    const char *axes[] = {"-X", "-Y", "-Z", "+X", "+Y", "+Z"};
    Eigen::Index axis;
    const bool positive = figure_.up.cwiseAbs().maxCoeff(&axis) > 0 && figure_.up[axis] > 0;
    const bool known = figure_.up == figure_.zero_up || figure_.up == clip_.up || !figure_.zero_is_stance;
    return known ? "" : axes[axis + (positive ? 3 : 0)];
  }

private:
  Names match_target(const Skeleton &skeleton) {
    std::vector<std::string> names;
    std::vector<int> parents;
    for (const Joint &joint : skeleton.joints) {
      names.push_back(joint.name);
      parents.push_back(joint.parent);
    }
    const Names found = match_human(names, parents, {}, {}, "skeleton");
    part_of_target_.assign(names.size(), "");
    for (const auto &[part, joint] : found)
      part_of_target_[joint] = part;
    return found;
  }

  Vector3d target_rest(const std::string &part) const { return rest_[target_.at(part)]; }

  Matrix3d source_rotation(const std::string &part, int t) const {
    // Where the forearm is split, its lower half carries the twist.
    const auto split = part.substr(1) == "_elbow" ? figure_.joints.find(part.substr(0, 2) + "forearm") : figure_.joints.end();
    return clip_.rotations[t][split == figure_.joints.end() ? figure_.joints.at(part) : split->second].toRotationMatrix();
  }

  Matrix3d bone_rotation(const std::string &part, int t) const {
    const auto bone = bones_.find(part);
    const Matrix3d turned = world_ * source_rotation(part, t) * from_zero_.transpose();
    return bone == bones_.end() ? turned : Matrix3d(turned * bone->second);
  }

  double leg_length_target() const {
    double sum = 0;
    for (const std::string side : {"l_", "r_"})
      sum += (target_rest(side + "hip") - target_rest(side + "knee")).norm() +
             (target_rest(side + "knee") - target_rest(side + "ankle")).norm();
    return sum / 2;
  }

  /// Thighs, shins, upper arms and forearms that have a length.
  void require_bones() const {
    if (!(leg_length_target() > 0))
      throw Error("skeleton: expected legs with a length, found none");
    for (const std::string side : {"l_", "r_"})
      for (const auto &[begin, end] : {std::pair{"hip", "knee"}, {"knee", "ankle"}, {"shoulder", "elbow"}, {"elbow", "wrist"}})
        if (figure_.at(side + begin, 0) == figure_.at(side + end, 0))
          throw Error(clip_.source + ": expected " + side + begin + " and " + side + end + " at two places, found '" +
                      clip_.joints[figure_.joints.at(side + begin)].name + "' and '" +
                      clip_.joints[figure_.joints.at(side + end)].name + "' at one");
  }

  void align_worlds() {
    const Vector3d left = figure_.zero("l_hip") - figure_.zero("r_hip"), our_left = target_rest("l_hip") - target_rest("r_hip");
    target_frame_ = body_frame(our_left, Vector3d::UnitY());
    const Matrix3d upright = target_frame_ * body_frame(left, figure_.zero_up).transpose();
    const Vector3d our_trunk = (target_rest("chest") - target_rest("pelvis")).normalized();
    from_zero_ = figure_.zero_leans
                     ? body_frame(our_left, our_trunk) * body_frame(left, figure_.zero_trunk().normalized()).transpose()
                     : upright;
    world_ = figure_.up == figure_.zero_up ? upright : shortest_turn(figure_.up, Vector3d::UnitY());
  }

  /// The part a bone ends at, or empty where a skeleton does not have it.
  std::string bone_end(const std::string &side, const LimbBone &bone) const {
    for (const char *end : bone.ends)
      if (figure_.joints.count(side + end) && target_.count(side + end))
        return side + end;
    return "";
  }

  void align_bones() {
    if (figure_.zero_is_stance)
      align_by_zero_pose();
    else
      align_by_clip();
    for (const std::string side : {"l_", "r_"}) // a file without hand ends: the hand is aligned as the forearm is
      if (const auto forearm = bones_.find(side + "elbow"); forearm != bones_.end())
        bones_.emplace(side + "wrist", forearm->second);
  }

  void align_by_zero_pose() {
    for (const std::string side : {"l_", "r_"})
      for (const LimbBone &bone : kLimb) {
        const std::string part = side + bone.name, end = bone_end(side, bone);
        if (end.empty())
          continue;
        Vector3d ours = target_rest(end) - target_rest(part), theirs = from_zero_ * (figure_.zero(end) - figure_.zero(part));
        if (std::string(bone.name) == "ankle") // both feet stand flat, whatever the height of the marks: only the heading counts
          ours.y() = theirs.y() = 0;
        if (ours.norm() > 1e-9 && theirs.norm() > 1e-9)
          bones_[part] = shortest_turn(ours, theirs);
        if (std::string(bone.name) == "ankle" && target_.count(end))
          bones_[end] = bones_[part];
        if (std::string(bone.name) == "wrist" && target_.count(end))
          bones_[end] = bones_[part];
      }
  }

  // --- Rigs whose zero pose is no stance: bone directions from the clip's joints, roll from a neutral frame and from bent
  // hinges.

  Vector3d direction_now(const std::string &part, const std::string &end, int t) const {
    return (world_ * (figure_.at(end, t) - figure_.at(part, t))).normalized();
  }

  /// The frame whose limbs, seen from the pelvis, point most nearly as in our rest pose.
  int neutral_frame() const {
    int best = 0;
    double best_score = -1e30;
    for (int t = 0; t < clip_.frame_count(); ++t) {
      const Matrix3d pelvis = bone_rotation("pelvis", t);
      double score = 0;
      for (const std::string side : {"l_", "r_"})
        for (const LimbBone &bone : kLimb) {
          const std::string end = bone_end(side, bone);
          if (!end.empty())
            score += (target_rest(end) - target_rest(side + bone.name))
                         .normalized()
                         .dot(pelvis.transpose() * direction_now(side + bone.name, end, t));
        }
      if (score > best_score) {
        best_score = score;
        best = t;
      }
    }
    return best;
  }

  void set_rotation_at(const std::string &part, int t, const Matrix3d &rotation) {
    bones_[part] = (world_ * source_rotation(part, t) * from_zero_.transpose()).transpose() * rotation;
  }

  /// The frame in which this foot stands: ankle and toe together at their lowest.
  int standing_frame(const std::string &ankle, const std::string &toe) const {
    int best = 0;
    double lowest = 1e30;
    for (int t = 0; t < clip_.frame_count(); ++t) {
      const double height = (world_ * (figure_.at(ankle, t) + figure_.at(toe, t))).y();
      if (height < lowest) {
        lowest = height;
        best = t;
      }
    }
    return best;
  }

  void align_by_clip() {
    const int neutral = neutral_frame();
    for (const std::string side : {"l_", "r_"})
      for (const LimbBone &bone : kLimb) {
        const std::string part = side + bone.name, end = bone_end(side, bone);
        if (end.empty())
          continue;
        const std::string parent =
            std::string(bone.parent) == "pelvis" || std::string(bone.parent) == "chest" ? bone.parent : side + bone.parent;
        const Vector3d ours = (target_rest(end) - target_rest(part)).normalized();
        if (std::string(bone.name) == "ankle") {
          const int standing = standing_frame(part, end);
          const Vector3d now = direction_now(part, end, standing);
          const Vector3d flat_now(now.x(), 0, now.z()), flat_ours(ours.x(), 0, ours.z());
          set_rotation_at(part, standing, shortest_turn(flat_ours, flat_now));
          set_rotation_at(end, standing, bone_rotation(part, standing));
          continue;
        }
        const Matrix3d base = bone_rotation(parent, neutral);
        set_rotation_at(part, neutral, shortest_turn(base * ours, direction_now(part, end, neutral)) * base);
        if (std::string(bone.name) == "wrist")
          set_rotation_at(end, neutral, bone_rotation(part, neutral));
        if (std::string(bone.name) == "knee")
          roll_by_hinge(side + "hip", side + "knee", side + "ankle");
        if (std::string(bone.name) == "elbow")
          roll_by_hinge(side + "shoulder", side + "elbow", side + "wrist");
      }
  }

  /// Where the limb is bent, its plane shows the roll of both bones: the hinge must be its normal. Mean over the clip, weighted
  /// by the bend.
  void roll_by_hinge(const std::string &upper, const std::string &hinge, const std::string &end) {
    const Joint &joint = skeleton_.joints[target_.at(hinge)];
    if (joint.kind != JointKind::Hinges)
      return;
    for (const std::string &part : {upper, hinge}) {
      const std::string &tip = part == upper ? hinge : end;
      double cosine = 0, sine = 0;
      for (int t = 0; t < clip_.frame_count(); ++t) {
        const Vector3d normal = direction_now(upper, hinge, t).cross(direction_now(hinge, end, t));
        if (normal.norm() < std::sin(20 * kDegree))
          continue;
        const Vector3d axis = bone_rotation(part, t) * joint.axes[0], along = direction_now(part, tip, t);
        cosine += axis.dot(normal);
        sine += along.dot(axis.cross(normal));
      }
      if (std::hypot(cosine, sine) < 1) // never bent: the neutral frame has to do
        continue;
      const Vector3d ours = (target_rest(tip) - target_rest(part)).normalized();
      bones_[part] = bones_[part] * Eigen::AngleAxisd(std::atan2(sine, cosine), ours).toRotationMatrix();
    }
  }

  const SourceMotion &clip_;
  const Skeleton &skeleton_;
  std::vector<std::string> part_of_target_;
  ClipFigure figure_;
  Names target_;
  std::vector<Vector3d> rest_;
  double scale_ = 1; ///< our legs to the clip's
  Matrix3d target_frame_, from_zero_, world_;
  std::map<std::string, Matrix3d> bones_;
};

/// Files often begin with one frame of reference pose somewhere else. Does the first step dwarf all others?
bool starts_with_reference(const SourceMotion &clip) {
  if (clip.frame_count() < 8)
    return false;
  const auto moved = [&](int t) { return (clip.positions[t + 1] - clip.positions[t]).rowwise().norm().mean(); };
  double largest = 0;
  for (int t = 1; t + 1 < clip.frame_count(); ++t)
    largest = std::max(largest, moved(t));
  return moved(0) > 3 * largest;
}

SourceMotion cut(const SourceMotion &clip, int first, int last) {
  SourceMotion part = clip;
  part.positions.assign(clip.positions.begin() + first, clip.positions.begin() + last + 1);
  part.rotations.assign(clip.rotations.begin() + first, clip.rotations.begin() + last + 1);
  return part;
}

SourceMotion chosen_frames(const SourceMotion &clip, const RetargetOptions &options, const Context &context) {
  const auto frame_at = [&](double second) {
    return static_cast<int>(std::min<double>(std::round(second * clip.fps), clip.frame_count()));
  };
  int first = frame_at(options.first_second);
  const int last = std::min(frame_at(options.last_second), clip.frame_count() - 1);
  if (first > last)
    throw Error(clip.source + ": expected frames between " + options::to_text(options.first_second) + " s and " +
                options::to_text(options.last_second) + " s, found a clip of " +
                options::to_text(clip.frame_count() / clip.fps, 4) + " s");
  if (first == 0 && last > 0 && starts_with_reference(clip)) {
    context.log_line(clip.source + ": the first frame stands apart from the motion (a reference pose) and is left out");
    first = 1;
  }
  return cut(clip, first, last);
}

/// Joints of the skeleton with the given world rotations and every joint free.
Vertices free_joints(const Skeleton &skeleton, const std::vector<Quaterniond> &rotations, const Vector3d &root) {
  Vertices positions(skeleton.joint_count(), 3);
  for (int j = 0; j < skeleton.joint_count(); ++j) {
    const int p = skeleton.joints[j].parent;
    positions.row(j) =
        p < 0 ? root
              : Vector3d(positions.row(p).transpose() + rotations[p] * (skeleton.joints[j].rest - skeleton.joints[p].rest));
  }
  return positions;
}

/// Hinges lose what they cannot turn; Gauss-Newton over the pose lets the joints above make up for it, so that the joints stand
/// where the free rotations put them. `pose` is start and prior (2 cm a radian: it only decides what positions leave open, such
/// as roll).
Eigen::VectorXd fit_to_joints(const Skeleton &skeleton, const Eigen::VectorXd &pose, const Vertices &wanted,
                              const Eigen::Matrix<bool, Eigen::Dynamic, Eigen::Dynamic> &moves, bool apply_limits) {
  constexpr double kPrior = 0.02, kRootPrior = 1e-3;
  const int dofs = skeleton.dof_count(), joints = skeleton.joint_count();
  Eigen::VectorXd prior = Eigen::VectorXd::Constant(dofs, kPrior * kPrior);
  prior.segment(skeleton.joints[0].first_dof, 3).setConstant(kRootPrior * kRootPrior);
  Eigen::VectorXd weight = Eigen::VectorXd::Ones(joints); // ends of feet and hands must not bend knees and elbows
  for (int j = 0; j < joints; ++j)
    if (skeleton.joints[j].kind == JointKind::Fixed)
      weight[j] = 0.5;
  Eigen::VectorXd x = pose;
  for (int iteration = 0; iteration < 6; ++iteration) {
    const Vertices now = joint_positions(skeleton, forward_kinematics(skeleton, x));
    const std::vector<DofTwist> twists = dof_twists(skeleton, x);
    Eigen::MatrixXd J = Eigen::MatrixXd::Zero(3 * joints, dofs);
    Eigen::VectorXd r(3 * joints);
    for (int j = 0; j < joints; ++j) {
      const Vector3d at = now.row(j);
      r.segment<3>(3 * j) = weight[j] * (wanted.row(j).transpose() - at);
      for (int d = 0; d < dofs; ++d)
        if (moves(d, j))
          J.block<3, 1>(3 * j, d) = weight[j] * (twists[d].angular.cross(at) + twists[d].linear);
    }
    Eigen::MatrixXd H = J.transpose() * J;
    H.diagonal() += prior;
    const Eigen::VectorXd step = H.ldlt().solve(J.transpose() * r - prior.cwiseProduct(x - pose));
    x += step * std::min(1.0, 0.5 / std::max(step.cwiseAbs().maxCoeff(), 1e-12));
    if (apply_limits)
      x = x.cwiseMax(skeleton.lower).cwiseMin(skeleton.upper);
    if (step.cwiseAbs().maxCoeff() < 1e-5)
      break;
  }
  return x;
}

/// How far the lowest foot of the pose is above its place in the rest pose.
double foot_clearance(const Skeleton &skeleton, const std::vector<int> &feet, const Eigen::VectorXd &dofs) {
  const Vertices joints = joint_positions(skeleton, forward_kinematics(skeleton, dofs));
  double lowest = 1e30;
  for (int j : feet)
    lowest = std::min(lowest, joints(j, 1) - skeleton.joints[j].rest.y());
  return lowest;
}

/// One height for all frames; 2 % of them may reach deeper, so that one bad frame does not lift the clip.
void ground_feet(const Skeleton &skeleton, Motion &motion) {
  std::vector<int> feet;
  for (int j = 0; j < skeleton.joint_count(); ++j)
    for (const char *name : {"l_ankle", "r_ankle", "l_toe", "r_toe"})
      if (skeleton.joints[j].name == name)
        feet.push_back(j);
  if (feet.empty())
    return;
  std::vector<double> clearance;
  for (Eigen::Index t = 0; t < motion.dofs.rows(); ++t)
    clearance.push_back(foot_clearance(skeleton, feet, motion.dofs.row(t)));
  const auto nth = clearance.begin() + static_cast<std::ptrdiff_t>(0.02 * clearance.size());
  std::nth_element(clearance.begin(), nth, clearance.end());
  motion.dofs.col(skeleton.joints[0].first_dof + 1).array() -= *nth;
}

} // namespace

void RetargetOptions::validate() const {
  options::check(*this);
  if (last_second < first_second)
    options::throw_invalid("RetargetOptions: last_second", "at least first_second, " + options::to_text(first_second) + " s",
                           options::to_text(last_second));
}

Vector3d up_of_world(const SourceMotion &clip, const std::map<std::string, std::string> &given) {
  validate(clip);
  return ClipFigure(clip, match_joints(clip, given)).up;
}

Motion retarget(const SourceMotion &clip, const Skeleton &skeleton, const RetargetOptions &options, const Context &context) {
  options.validate();
  validate(clip);
  const SourceMotion part = chosen_frames(clip, options, context);
  Retargeter retargeter(part, skeleton, options);
  if (const std::string up = retargeter.turned_world(); !up.empty())
    context.log_line(clip.source + ": the body stands along the file's axis " + up + ", which is taken for up");
  if (options.align_start)
    retargeter.face_rest(0);
  Motion motion{part.fps, MatrixRM(part.frame_count(), skeleton.dof_count())};
  Vector3d shift = Vector3d::Zero();
  if (options.align_start) {
    shift = skeleton.joints[0].rest - retargeter.root_position(0);
    shift.y() = 0;
  }
  const auto moves = dof_moves_joint(skeleton);
  for (int t = 0; t < part.frame_count(); ++t) {
    std::vector<Quaterniond> rotations = retargeter.rotations(t);
    const Vector3d root = retargeter.root_position(t) + shift;
    const Eigen::VectorXd pose = pose_from_rotations(skeleton, rotations, root, options.apply_limits);
    retargeter.keep_torso(forward_kinematics(skeleton, pose), rotations);
    motion.dofs.row(t) = fit_to_joints(skeleton, pose, free_joints(skeleton, rotations, root), moves, options.apply_limits);
    if (t % 100 == 0)
      context.report_progress("retarget", static_cast<double>(t) / part.frame_count());
  }
  if (options.ground_feet)
    ground_feet(skeleton, motion);
  if (options.fps > 0 && options.fps != motion.fps)
    motion = resample(skeleton, motion, options.fps);
  if (options.plant_feet)
    motion = plant_feet(skeleton, motion);
  context.report_progress("retarget", 1.0);
  const Eigen::Index frames = motion.dofs.rows();
  motion = blend_in(skeleton, motion, options.hold_seconds, options.blend_seconds);
  if (options.plant_feet)
    for (Eigen::Index t = 0; t < motion.dofs.rows() - frames; ++t) {
      Eigen::VectorXd pose = motion.dofs.row(t);
      lift_feet(skeleton, PlantOptions{}.floor_height, pose);
      motion.dofs.row(t) = pose;
    }
  return motion;
}

} // namespace doublet
