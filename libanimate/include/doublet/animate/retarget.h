#pragma once
// A motion of any human skeleton onto ours: joints by name, rest poses aligned bone by bone, lengths scaled by the legs.

#include "doublet/animate/motion.h"
#include "doublet/animate/motion_file.h"
#include "doublet/core/context.h"

#include <map>

namespace doublet {

struct RetargetOptions {
  double fps = 0;           ///< 1/s, of the result; 0 = that of the file
  double first_second = 0;  ///< s, where in the file to start
  double last_second = 1e9; ///< s, where to stop
  bool align_start = true;  ///< start where the actor stands in the rest pose, facing the same way
  bool apply_limits = true; ///< keep hinges and balls inside the skeleton's limits
  bool ground_feet = true;  ///< one height for the whole clip so that the feet reach the floor as in the rest pose, and not below
  double hold_seconds = 0.1;  ///< s, in the rest pose before the motion, see blend_in()
  double blend_seconds = 0.6; ///< s, from the rest pose to the first pose; 0 with hold_seconds 0 = the clip alone
  /// Our joint -> joint of the file, for names nobody guesses; the standard conventions (CMU, Acclaim, iClone, Mixamo, Biped, our
  /// own) need none.
  std::map<std::string, std::string> joint_names;
  void validate() const; ///< throws std::invalid_argument naming option, range and value
};

/// Throws Error naming the joints that could not be found and those that the file has.
Motion retarget(const SourceMotion &clip, const Skeleton &skeleton, const RetargetOptions &options = {},
                const Context &context = {});

/// Which joint of the clip plays which of our joints (standard name -> joint index of the clip), by name and topology.
std::map<std::string, int> match_joints(const SourceMotion &clip, const std::map<std::string, std::string> &given = {});

} // namespace doublet
