#pragma once
// Connected parts of a graph.

#include <vector>

namespace doublet {

/// Connected components of the nodes that are `chosen` (N), each listed from its lowest node outwards, ordered by lowest node.
/// `neighbours` [N]: adjacent nodes, in both directions.
std::vector<std::vector<int>> connected_sets(const std::vector<std::vector<int>> &neighbours, const std::vector<char> &chosen);

} // namespace doublet
