#include "doublet/core/parts/connected_sets.h"

namespace doublet {

std::vector<std::vector<int>> connected_sets(const std::vector<std::vector<int>> &neighbours, const std::vector<char> &chosen) {
  std::vector<std::vector<int>> sets;
  std::vector<char> seen(chosen.size(), 0);
  for (std::size_t start = 0; start < chosen.size(); ++start) {
    if (!chosen[start] || seen[start])
      continue;
    std::vector<int> members{static_cast<int>(start)};
    seen[start] = 1;
    for (std::size_t i = 0; i < members.size(); ++i)
      for (int next : neighbours[members[i]])
        if (chosen[next] && !seen[next]) {
          seen[next] = 1;
          members.push_back(next);
        }
    sets.push_back(std::move(members));
  }
  return sets;
}

} // namespace doublet
