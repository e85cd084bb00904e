#include "snug_cloth.h"

#include "doublet/core/parts/edge_distances.h"
#include "doublet/segment/parts/diffusion.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace doublet::detail {
namespace {

/// m; nearer to cloth than this the surface may be cloth, too, and does not tell what skin does. Also how far skin tells it.
constexpr double kAround = 0.10;
constexpr int kRounds = 5;
constexpr double kNoSkin = std::numeric_limits<double>::quiet_NaN();

std::vector<int> members(const std::vector<char> &chosen) {
  std::vector<int> result;
  for (std::size_t i = 0; i < chosen.size(); ++i)
    if (chosen[i])
      result.push_back(static_cast<int>(i));
  return result;
}

/// (V) logarithm of `deviation` over that of the skin around, both at least `finest`, m, and at most `most` either way; NaN where
/// there is none.
Eigen::VectorXd over_skin(const Surface &surface, const Eigen::VectorXd &deviation, const std::vector<char> &skin, double finest,
                          double most) {
  const Eigen::VectorXd known = deviation.unaryExpr([&](double m) { return std::log(m < finest ? finest : m); }); // NaN stays
  Eigen::VectorXd of_skin = known;
  for (int i = 0; i < surface.size(); ++i)
    if (!skin[i])
      of_skin[i] = kNoSkin;
  Eigen::VectorXd ratio = known - diffuse_on_surface(surface.vertices, surface.faces, of_skin, kAround);
  for (double &value : ratio)
    value = std::isnan(value) ? value : std::clamp(value, -most, most);
  return ratio;
}

/// `cloth` and what of `grown` leaves more skin beside it than it takes: a garment ends on the body, it does not swallow a hand.
std::vector<char> without_swallowed(const Surface &surface, const std::vector<char> &cloth, std::vector<char> grown) {
  std::vector<double> left(grown.size(), 0); // of skin: the area of its patch
  for (const Patch &skin : connected_patches(surface, choose(surface, [&](int i) { return !grown[i]; })))
    for (int i : skin.members)
      left[i] = skin.area;
  for (const Patch &patch : connected_patches(surface, choose(surface, [&](int i) { return grown[i] && !cloth[i]; }))) {
    double beside = 0;
    for (int i : patch.members)
      for (int j : surface.neighbours[i])
        beside = std::max(beside, left[j]);
    for (int i : patch.members)
      grown[i] = beside > patch.area;
  }
  return grown;
}

/// The patches of `candidates` and `cloth` that have some of `cloth`.
std::vector<char> joined(const Surface &surface, const std::vector<char> &candidates, const std::vector<char> &cloth) {
  std::vector<char> result(cloth.size(), 0);
  for (const Patch &patch : connected_patches(surface, candidates))
    if (std::any_of(patch.members.begin(), patch.members.end(), [&](int i) { return cloth[i]; }))
      for (int i : patch.members)
        result[i] = 1;
  return result;
}

} // namespace

Eigen::VectorXd sliding_deviation(const std::vector<Vertices> &unposed, const Vertices &normals, double trim,
                                  const Context &context) {
  const int n = static_cast<int>(normals.rows()), frames = static_cast<int>(unposed.size());
  const int counted = std::max(1, frames - static_cast<int>(trim * frames));
  Eigen::VectorXd slide(n);
  parallel_for(context, n, [&](int i) {
    Eigen::RowVector3d mean = Eigen::RowVector3d::Zero();
    for (const Vertices &frame : unposed)
      mean += frame.row(i) / frames;
    std::vector<double> squares;
    for (const Vertices &frame : unposed) {
      const Eigen::RowVector3d way = frame.row(i) - mean;
      squares.push_back(way.squaredNorm() - std::pow(way.dot(normals.row(i)), 2));
    }
    std::sort(squares.begin(), squares.end());
    double sum = 0;
    for (int t = 0; t < counted; ++t)
      sum += squares[t];
    slide[i] = std::sqrt(std::max(0.0, sum) / counted);
  });
  return slide;
}

std::vector<char> with_snug_cloth(const Surface &surface, const Eigen::VectorXd &sigma, const Eigen::VectorXd &slide,
                                  std::vector<char> cloth, const SegmentOptions &options) {
  const std::vector<char> first = cloth;
  // Skin gives, over joints and muscles, however well it is tracked: up to rigid_threshold nothing is cloth.
  const double finest = options.rigid_threshold / options.contrast;
  for (int round = 0; round < kRounds; ++round) { // what was found leaves the skin that is compared with
    const Eigen::VectorXd way = edge_distances(surface.vertices, surface.neighbours, members(cloth), kAround);
    const std::vector<char> skin = choose(surface, [&](int i) { return !std::isfinite(way[i]); });
    // As much above as below the threshold counts: neither measure is enough alone, and what is very loose does not make cloth
    // of the skin beside it.
    const double least = std::log(options.contrast);
    Eigen::VectorXd ratio =
        0.5 * (over_skin(surface, sigma, skin, finest, 2 * least) + over_skin(surface, slide, skin, finest, 2 * least));
    for (double &value : ratio)
      value = value < 0 ? 0 : value; // NaN stays
    ratio = diffuse_on_surface(surface.vertices, surface.faces, ratio, options.diffusion);
    const std::vector<char> candidates =
        choose(surface, [&](int i) { return cloth[i] || (ratio[i] > least && !surface.seam[i]); });
    std::vector<char> grown = without_swallowed(surface, first, joined(surface, candidates, first));
    if (grown == cloth)
      break;
    cloth = std::move(grown);
  }
  return cloth;
}

} // namespace doublet::detail
