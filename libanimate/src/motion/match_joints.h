#pragma once
// A human skeleton by its standard joint names, found by name and topology.

#include <map>
#include <string>
#include <vector>

namespace doublet {

/// Standard name -> index. `rest` distances are only used to tell a forearm twist bone from a wrist; may be empty.
/// Throws Error naming `source`, what was not found and the names that are there.
std::map<std::string, int> match_human(const std::vector<std::string> &names, const std::vector<int> &parents,
                                       const std::vector<double> &bone_lengths, const std::map<std::string, std::string> &given,
                                       const std::string &source);

} // namespace doublet
