#include "doublet/core/parts/colour_histogram.h"

#include <algorithm>

namespace doublet {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

/// Bins of log(R / G), log(B / G) and half the logarithm of the brightness: a tenth, or a factor of 1.4 in brightness, is
/// nothing.
const Vector3i kColourBins(40, 30, 12);
const Vector3d kLowest(-1.5, -1.5, 0.6), kHighest(2.5, 1.5, 2.9);
constexpr double kDark = 4;     // grey levels: below, there is no colour
constexpr double kCommon = 0.1; // share that may have any colour: an unseen one tells nothing

/// A pass of (1 2 1) / 4 along every axis, borders repeated.
Eigen::VectorXd smoothed(const Eigen::VectorXd &histogram) {
  Eigen::VectorXd values = histogram;
  for (int axis = 0, stride = kColourBins[1] * kColourBins[2]; axis < 3; ++axis) {
    const Eigen::VectorXd before = values;
    for (int i = 0; i < values.size(); ++i) {
      const int at = i / stride % kColourBins[axis];
      values[i] =
          0.5 * before[i] + 0.25 * before[at > 0 ? i - stride : i] + 0.25 * before[at + 1 < kColourBins[axis] ? i + stride : i];
    }
    if (axis + 1 < 3)
      stride /= kColourBins[axis + 1];
  }
  return values;
}

} // namespace

int colour_bin_count() {
  return kColourBins.prod();
}

int colour_bin(const Vector3d &bgr) {
  const Vector3d log = bgr.cwiseMax(kDark).array().log();
  const Vector3d at(log[2] - log[1], log[0] - log[1], 0.5 * log.mean());
  const Vector3d share = (at - kLowest).cwiseQuotient(kHighest - kLowest);
  int bin = 0;
  for (int k = 0; k < 3; ++k)
    bin = bin * kColourBins[k] + std::clamp(static_cast<int>(share[k] * kColourBins[k]), 0, kColourBins[k] - 1);
  return bin;
}

Eigen::VectorXd colour_likelihoods(const Eigen::VectorXd &seen) {
  Eigen::VectorXd likelihoods = smoothed(smoothed(seen / seen.sum()));
  likelihoods.array() += kCommon / static_cast<double>(likelihoods.size());
  return likelihoods;
}

} // namespace doublet
