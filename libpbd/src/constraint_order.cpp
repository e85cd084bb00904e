#include "constraint_order.h"

#include <algorithm>
#include <list>
#include <numeric>

namespace doublet::pbd {

std::vector<int> spread_order(const std::vector<int> &vertices, int arity, const std::vector<int> &levels, int vertex_count,
                              int gap) {
  const int count = static_cast<int>(levels.size());
  std::vector<int> sorted(count);
  std::iota(sorted.begin(), sorted.end(), 0);
  std::stable_sort(sorted.begin(), sorted.end(), [&](int a, int b) { return levels[a] < levels[b]; });

  // Far enough to find a free constraint on any real mesh, near enough to keep the levels in order and the search linear.
  constexpr int kLookAhead = 256;
  std::list<int> pending(sorted.begin(), sorted.end());
  std::vector<int> last_use(vertex_count, -gap - 1), order;
  order.reserve(count);
  while (!pending.empty()) {
    const int now = static_cast<int>(order.size());
    auto best = pending.begin();
    int best_rest = -1, seen = 0;
    for (auto it = pending.begin(); it != pending.end() && seen < kLookAhead && best_rest < gap; ++it, ++seen) {
      int rest = gap;
      for (int k = 0; k < arity; ++k)
        rest = std::min(rest, now - last_use[vertices[*it * arity + k]] - 1);
      if (rest > best_rest) {
        best_rest = rest;
        best = it;
      }
    }
    for (int k = 0; k < arity; ++k)
      last_use[vertices[*best * arity + k]] = now;
    order.push_back(*best);
    pending.erase(best);
  }
  return order;
}

} // namespace doublet::pbd
