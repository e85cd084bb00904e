#include "colour_evidence.h"

#include "doublet/segment/parts/diffusion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace doublet::detail {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr double kUnseen = std::numeric_limits<double>::quiet_NaN();
/// Bins of log(R / G), log(B / G) and half the logarithm of the brightness: a tenth, or a factor of 1.4 in brightness, is
/// nothing.
const Vector3i kBins(40, 30, 12);
const Vector3d kLowest(-1.5, -1.5, 0.6), kHighest(2.5, 1.5, 2.9);
constexpr double kDark = 4;      // grey levels: below, there is no colour
constexpr double kCommon = 0.1;  // share of both kinds that may have any colour: an unseen one tells nothing
constexpr double kSurest = 2;    // logarithm of a ratio that is as good as certain: one in seven
constexpr double kSpread = 0.02; // m, over which colours tell the same: a pattern's scale

int bin_of(const Vector3d &bgr) {
  const Vector3d log = bgr.cwiseMax(kDark).array().log();
  const Vector3d at(log[2] - log[1], log[0] - log[1], 0.5 * log.mean());
  const Vector3d share = (at - kLowest).cwiseQuotient(kHighest - kLowest);
  int bin = 0;
  for (int k = 0; k < 3; ++k)
    bin = bin * kBins[k] + std::clamp(static_cast<int>(share[k] * kBins[k]), 0, kBins[k] - 1);
  return bin;
}

/// A pass of (1 2 1) / 4 along every axis, borders repeated.
Eigen::VectorXd smoothed(const Eigen::VectorXd &histogram) {
  Eigen::VectorXd values = histogram;
  for (int axis = 0, stride = kBins[1] * kBins[2]; axis < 3; ++axis) {
    const Eigen::VectorXd before = values;
    for (int i = 0; i < values.size(); ++i) {
      const int at = i / stride % kBins[axis];
      values[i] = 0.5 * before[i] + 0.25 * before[at > 0 ? i - stride : i] + 0.25 * before[at + 1 < kBins[axis] ? i + stride : i];
    }
    if (axis + 1 < 3)
      stride /= kBins[axis + 1];
  }
  return values;
}

} // namespace

Eigen::VectorXd colour_evidence(const Surface &surface, const Faces &faces, const std::vector<std::uint8_t> &face_valid,
                                const Vertices &colours, const std::vector<char> &skin, const std::vector<char> &cloth) {
  const auto per_face = static_cast<int>(colours.rows() / std::max<Eigen::Index>(faces.rows(), 1));
  const Eigen::VectorXd areas = face_areas(surface.vertices, faces);
  const auto valid = [&](int f) { return face_valid.empty() || face_valid[f]; };
  const auto all_of = [&](const std::vector<char> &kind, int f) {
    return kind[faces(f, 0)] && kind[faces(f, 1)] && kind[faces(f, 2)];
  };
  std::vector<int> bins(colours.rows());
  for (int s = 0; s < colours.rows(); ++s)
    bins[s] = colours.row(s).allFinite() ? bin_of(colours.row(s).transpose()) : -1;

  std::array<Eigen::VectorXd, 2> histograms;
  for (std::size_t kind = 0; kind < 2; ++kind) {
    Eigen::VectorXd &histogram = histograms[kind] = Eigen::VectorXd::Zero(kBins.prod());
    for (int f = 0; f < faces.rows(); ++f)
      for (int k = 0; k < per_face && valid(f) && all_of(kind == 0 ? skin : cloth, f); ++k)
        if (bins[f * per_face + k] >= 0)
          histogram[bins[f * per_face + k]] += areas[f];
    if (!(histogram.sum() > 0))
      return Eigen::VectorXd::Zero(surface.size()); // nothing to compare with
    histogram = smoothed(smoothed(histogram / histogram.sum()));
    histogram.array() += kCommon / static_cast<double>(histogram.size());
  }
  const Eigen::VectorXd ratio = (histograms[0].array() / histograms[1].array()).log().max(-kSurest).min(kSurest) / kSurest;

  Eigen::VectorXd sum = Eigen::VectorXd::Zero(surface.size()), seen = sum;
  for (int f = 0; f < faces.rows(); ++f)
    for (int k = 0; k < per_face && valid(f); ++k)
      if (const int bin = bins[f * per_face + k]; bin >= 0)
        for (int corner = 0; corner < 3; ++corner) {
          sum[faces(f, corner)] += areas[f] * ratio[bin];
          seen[faces(f, corner)] += areas[f];
        }
  Eigen::VectorXd evidence = diffuse_on_surface(surface.vertices, surface.faces,
                                                (seen.array() > 0).select(sum.array() / seen.array(), kUnseen), kSpread);
  return evidence.unaryExpr([](double value) { return std::isfinite(value) ? value : 0.0; });
}

} // namespace doublet::detail
