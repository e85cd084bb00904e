#pragma once
// Order statistics without interpolation: what comes back is one of the values.

#include <algorithm>
#include <cstddef>
#include <vector>

namespace doublet {

/// The value that a share of all lies below: the one of index share * (n - 1), rounded down, in rising order. Of at least one.
inline double quantile(std::vector<double> values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

/// The upper of the two in the middle if there are two; of at least one value.
inline double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

} // namespace doublet
