#include "colour_evidence.h"

#include "doublet/core/parts/colour_histogram.h"
#include "doublet/segment/parts/diffusion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace doublet::detail {
namespace {

constexpr double kUnseen = std::numeric_limits<double>::quiet_NaN();

} // namespace

Eigen::VectorXd colour_evidence(const Surface &surface, const Faces &faces, const std::vector<std::uint8_t> &face_valid,
                                const Vertices &colours, const Eigen::VectorXd &first, const Eigen::VectorXd &second) {
  const auto per_face = static_cast<int>(colours.rows() / std::max<Eigen::Index>(faces.rows(), 1));
  const Eigen::VectorXd areas = face_areas(surface.vertices, faces);
  const auto valid = [&](int f) { return face_valid.empty() || face_valid[f]; };
  std::vector<int> bins(colours.rows());
  for (int s = 0; s < colours.rows(); ++s)
    bins[s] = colours.row(s).allFinite() ? colour_bin(colours.row(s).transpose()) : -1;

  std::array<Eigen::VectorXd, 2> histograms;
  for (std::size_t kind = 0; kind < 2; ++kind) {
    const Eigen::VectorXd &weight = kind == 0 ? first : second;
    Eigen::VectorXd &histogram = histograms[kind] = Eigen::VectorXd::Zero(colour_bin_count());
    for (int f = 0; f < faces.rows(); ++f) {
      if (!valid(f))
        continue;
      const double of_face = areas[f] * std::min({weight[faces(f, 0)], weight[faces(f, 1)], weight[faces(f, 2)]});
      for (int k = 0; k < per_face; ++k)
        if (bins[f * per_face + k] >= 0)
          histogram[bins[f * per_face + k]] += of_face;
    }
    if (!(histogram.sum() > 0))
      return Eigen::VectorXd::Zero(surface.size()); // nothing to compare with
    histogram = colour_likelihoods(histogram);
  }
  // A factor of e counts fully: a fabric has more colours than were seen to move.
  const Eigen::VectorXd ratio = (histograms[0].array() / histograms[1].array()).log().max(-1.0).min(1.0);

  Eigen::VectorXd sum = Eigen::VectorXd::Zero(surface.size()), seen = sum;
  for (int f = 0; f < faces.rows(); ++f)
    for (int k = 0; k < per_face && valid(f); ++k)
      if (const int bin = bins[f * per_face + k]; bin >= 0)
        for (int corner = 0; corner < 3; ++corner) {
          sum[faces(f, corner)] += areas[f] * ratio[bin];
          seen[faces(f, corner)] += areas[f];
        }
  Eigen::VectorXd evidence =
      diffuse_on_surface(surface.vertices, surface.faces, (seen.array() > 0).select(sum.array() / seen.array(), kUnseen), 0.0);
  return evidence.unaryExpr([](double value) { return std::isfinite(value) ? value : 0.0; });
}

} // namespace doublet::detail
