#pragma once
// Sets that are united one by one (union-find; Tarjan 1975).

#include <algorithm>
#include <numeric>
#include <vector>

namespace doublet {

class DisjointSets {
public:
  /// {0}, {1}, ... {count - 1}.
  explicit DisjointSets(int count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }
  /// The lowest member of i's set.
  int root(int i) {
    while (parent_[i] != i)
      i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  /// False if they were in one set before.
  bool unite(int a, int b) {
    a = root(a);
    b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
    return a != b;
  }

private:
  std::vector<int> parent_;
};

} // namespace doublet
