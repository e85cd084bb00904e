#pragma once
// A human skeleton by its shape, where the names of its joints say nothing.

#include "doublet/animate/motion_file.h"

#include <map>
#include <string>

namespace doublet {

/// Standard name -> index: legs and arms are the two longest pairs of limbs whose bones are equally long, the legs those nearer
/// to the root; knees and elbows halve them; left and right are told by their names, else by where the feet point. Empty if that
/// is not clear.
std::map<std::string, int> match_by_shape(const SourceMotion &clip);

} // namespace doublet
