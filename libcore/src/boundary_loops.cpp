#include "doublet/core/parts/boundary_loops.h"

#include <array>
#include <map>
#include <set>

namespace doublet {

std::vector<std::vector<int>> boundary_loops(const Faces &faces) {
  std::map<int, int> next;
  std::set<std::array<int, 2>> directed;
  for (Eigen::Index f = 0; f < faces.rows(); ++f)
    for (int k = 0; k < 3; ++k)
      directed.insert({faces(f, k), faces(f, (k + 1) % 3)});
  for (const auto &[a, b] : directed)
    if (!directed.count({b, a}))
      next[a] = b;
  std::vector<std::vector<int>> loops;
  while (!next.empty()) {
    std::vector<int> loop;
    for (auto it = next.begin(); it != next.end();) {
      loop.push_back(it->first);
      const int to = it->second;
      next.erase(it);
      it = next.find(to);
    }
    loops.push_back(std::move(loop));
  }
  return loops;
}

} // namespace doublet
