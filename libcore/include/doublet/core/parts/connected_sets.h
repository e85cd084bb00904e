#pragma once
// Connected parts of a graph.

#include <vector>

namespace doublet {

/// Those of the nodes that are chosen (N), each from its lowest node outwards; the one with the lowest node first. `neighbours`
/// (N): of each node, both ways.
std::vector<std::vector<int>> connected_sets(const std::vector<std::vector<int>> &neighbours, const std::vector<char> &chosen);

} // namespace doublet
