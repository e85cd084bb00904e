#pragma once
// Order statistics without interpolation: the result is one of the values.

#include <algorithm>
#include <cstddef>
#include <vector>

namespace doublet {

/// The quantile `share` in [0, 1] of at least one value: the element of index share * (n - 1), rounded down, in ascending order.
inline double quantile(std::vector<double> values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// The median of at least one value; for an even number the upper of the two in the middle.
inline double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

} // namespace doublet
