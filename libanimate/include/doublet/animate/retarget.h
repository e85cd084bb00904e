#pragma once
// Retargets a motion of any human skeleton to ours: joints matched by name, rest poses aligned bone by bone, lengths scaled by
// the legs.

#include "doublet/animate/motion.h"
#include "doublet/animate/motion_file.h"
#include "doublet/core/context.h"
#include "doublet/options/options.h"

#include <map>

namespace doublet {

struct RetargetOptions {
  double fps = 0;
  double first_second = 0;
  double last_second = 1e9;
  bool align_start = true;
  bool apply_limits = true;
  bool ground_feet = true;
  bool plant_feet = true;
  double hold_seconds = 0.1;
  double blend_seconds = 0.6;
  std::map<std::string, std::string> joint_names;
  static constexpr auto describe() {
    using namespace options;
    using O = RetargetOptions;
    return Description{
        "RetargetOptions",
        option(&O::fps, "fps", at_least(0), "1/s", "Frame rate of the result; 0 = that of the file",
               "Set it to the character's 1/dt"),
        option(&O::first_second, "first_second", at_least(0), "s", "Time in the file at which the motion starts"),
        option(&O::last_second, "last_second", at_least(0), "s", "Time in the file at which the motion stops"),
        option(&O::align_start, "align_start", "The motion starts where the actor stands in the rest pose, facing the same way"),
        option(&O::apply_limits, "apply_limits", "Hinges and balls are kept inside the skeleton's limits"),
        option(&O::ground_feet, "ground_feet",
               "The whole clip is shifted vertically so that the feet reach the floor of the rest pose, not below it"),
        option(&O::plant_feet, "plant_feet", "Feet that stand are planted, and no foot is below the floor, see plant_feet()"),
        option(&O::hold_seconds, "hold_seconds", Range{0, 60}, "s", "Time in the rest pose before the motion, see blend_in()"),
        option(&O::blend_seconds, "blend_seconds", Range{0, 60}, "s",
               "Time from the rest pose to the first pose; 0 with hold_seconds 0 = the clip alone",
               "So that cloth is not torn away"),
        option(&O::joint_names, "joint_names", "Our joint -> joint of the file, for names that are not known",
               "CMU, Acclaim, iClone, Mixamo, Biped and our own are known"),
    };
  }
  void validate() const; ///< throws std::invalid_argument naming option, range and value
};

/// Throws Error naming the joints that could not be matched and those in the file.
Motion retarget(const SourceMotion &clip, const Skeleton &skeleton, const RetargetOptions &options = {},
                const Context &context = {});

/// The axis of the clip's world that points up, as retarget() determines it: the one along which the body stands on average, or
/// another one if it lies. Throws as match_joints.
Eigen::Vector3d up_of_world(const SourceMotion &clip, const std::map<std::string, std::string> &given = {});

/// Matches joints by name and topology: standard name -> joint index of the clip. `given`: standard name -> name in the clip, ""
/// = none. Throws Error if `given` has a name that is not standard or not in the clip, and if a joint is missing that retargeting
/// needs.
std::map<std::string, int> match_joints(const SourceMotion &clip, const std::map<std::string, std::string> &given = {});

/// The same with a reason for every match, for people who check and correct the matches; joints may be missing.
struct JointMatch {
  std::string part;   ///< standard name; unmatched ones are listed, too
  int joint = -1;     ///< of the clip; -1 = none
  std::string reason; ///< in words
};
std::vector<JointMatch> explain_match(const SourceMotion &clip, const std::map<std::string, std::string> &given = {});

} // namespace doublet
