#include "label_colours.h"

#include "doublet/core/parts/colour_histogram.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace doublet::detail {
namespace {

using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double kPlace = 0.10, kSurroundings = 0.20; // m
constexpr double kRareShare = 0.05;
constexpr float kMuchLikelier = 3;

/// The likelihood that the colours of such a share of all that was seen (bins) are below.
float rare_likelihood(const VectorXd &seen, const Eigen::VectorXf &likelihoods) {
  std::vector<int> bins;
  for (int bin = 0; bin < seen.size(); ++bin)
    if (seen[bin] > 0)
      bins.push_back(bin);
  std::sort(bins.begin(), bins.end(), [&](int a, int b) { return std::pair(likelihoods[a], a) < std::pair(likelihoods[b], b); });
  double left = kRareShare * seen.sum();
  for (int bin : bins)
    if ((left -= seen[bin]) < 0)
      return likelihoods[bin];
  return 0;
}

} // namespace

LabelColours::LabelColours(const Mesh &mesh, const std::vector<SurfaceLabel> &face_labels,
                           const std::vector<std::vector<int>> &seen, const Context &context) {
  Vertices centres = Vertices::Zero(mesh.faces.rows(), 3);
  for (int k = 0; k < 3; ++k)
    centres += mesh.vertices(mesh.faces.col(k), Eigen::all) / 3;
  find_places(centres, face_labels);
  const VectorXd areas = face_areas(mesh.vertices, mesh.faces);
  parallel_for(context, static_cast<int>(places_.size()), [&](int p) {
    Place &place = places_[p];
    VectorXd histogram = VectorXd::Zero(colour_bin_count());
    for (Eigen::Index f = 0; f < centres.rows(); ++f)
      if (face_labels[f] == place.label && (centres.row(f).transpose() - place.centre).norm() < kSurroundings)
        for (int bin : seen[f])
          histogram[bin] += areas[f];
    if (!(histogram.sum() > 0) || !std::isfinite(histogram.sum()))
      return; // nothing was seen, or the mesh is beyond measure
    place.likelihoods = colour_likelihoods(histogram).cast<float>();
    place.rare = rare_likelihood(histogram, place.likelihoods);
  });
}

void LabelColours::find_places(const Vertices &centres, const std::vector<SurfaceLabel> &face_labels) {
  std::map<std::array<double, 4>, int> places;
  for (Eigen::Index f = 0; f < centres.rows(); ++f) {
    const Eigen::RowVector3d cell = (centres.row(f) / kPlace).array().floor();
    const std::array key{static_cast<double>(face_labels[f]), cell.x(), cell.y(), cell.z()};
    const auto [at, fresh] = places.try_emplace(key, static_cast<int>(places_.size()));
    if (fresh)
      places_.push_back({face_labels[f], kPlace * (cell.array() + 0.5).matrix().transpose(), {}, 0});
    place_.push_back(at->second);
  }
}

bool LabelColours::rare(int face, int bin) const {
  const Place &place = places_[place_[face]];
  return place.likelihoods.size() > 0 && place.likelihoods[bin] < place.rare;
}

bool LabelColours::likelier(int bin, int other, int face) const {
  const Place &there = places_[place_[other]], &here = places_[place_[face]];
  return there.likelihoods.size() > 0 && here.likelihoods.size() > 0 &&
         there.likelihoods[bin] >= kMuchLikelier * here.likelihoods[bin];
}

} // namespace doublet::detail
