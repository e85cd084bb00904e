#include "colour_seams.h"

#include "doublet/core/parts/quantile.h"
#include "doublet/segment/garment_mesher.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace doublet::detail {
namespace {

constexpr int kMostRounds = 8;
constexpr double kDistinct = 0.75; // mean evidence of each side, of at most 1: shades of one fabric have up to 0.74

/// (V, 3) mean logarithm of the colours around each vertex; NaN where none is seen.
Vertices looks_of(const Faces &faces, const Vertices &colours, int vertices) {
  const Eigen::Index per_face = colours.rows() / std::max<Eigen::Index>(faces.rows(), 1);
  Vertices sum = Vertices::Zero(vertices, 3);
  Eigen::VectorXd seen = Eigen::VectorXd::Zero(vertices);
  for (Eigen::Index row = 0; row < colours.rows(); ++row)
    if (colours.row(row).allFinite())
      for (int k = 0; k < 3; ++k) {
        const int v = faces(row / per_face, k);
        sum.row(v) += colours.row(row).cwiseMax(1.0).array().log().matrix();
        seen[v] += 1;
      }
  for (int v = 0; v < vertices; ++v)
    sum.row(v) /= seen[v]; // 0 / 0 is the NaN
  return sum;
}

/// (V) which of `members` look more like `b` than like `a`, two looks; the means of both become the looks, until they stay.
std::vector<char> second_kind(const Surface &surface, const std::vector<int> &members, const Vertices &looks,
                              Eigen::RowVector3d a, Eigen::RowVector3d b) {
  std::vector<char> second(surface.size(), 0);
  for (int round = 0; round < kMostRounds; ++round) {
    Eigen::RowVector3d sum_a = Eigen::RowVector3d::Zero(), sum_b = sum_a;
    double area_a = 0, area_b = 0;
    for (int v : members) {
      second[v] = (looks.row(v) - b).squaredNorm() < (looks.row(v) - a).squaredNorm();
      (second[v] ? sum_b : sum_a) += surface.areas[v] * looks.row(v);
      (second[v] ? area_b : area_a) += surface.areas[v];
    }
    if (!(area_a > 0 && area_b > 0))
      break;
    a = sum_a / area_a;
    b = sum_b / area_b;
  }
  return second;
}

/// (V) which of `member` look like its lowest vertices rather than its highest: where one garment ends, the next begins below it.
std::vector<char> first_guess(const Surface &surface, const std::vector<char> &member, const Vertices &looks) {
  std::vector<int> members;
  for (int v = 0; v < surface.size(); ++v)
    if (member[v] && looks.row(v).allFinite())
      members.push_back(v);
  if (members.empty())
    return std::vector<char>(surface.size(), 0);
  std::sort(members.begin(), members.end(), [&](int a, int b) { return surface.vertices(a, 1) < surface.vertices(b, 1); });
  const std::size_t tenth = members.size() / 10 + 1;
  const auto mean_of = [&](std::size_t first) {
    Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
    for (std::size_t i = first; i < std::min(first + tenth, members.size()); ++i)
      sum += looks.row(members[i]) / static_cast<double>(tenth);
    return sum;
  };
  return second_kind(surface, members, looks, mean_of(members.size() - std::min(tenth, members.size())), mean_of(0));
}

struct Kinds {
  std::vector<char> second; ///< (V)
  Eigen::VectorXd evidence; ///< (V) for the first
};

/// The two looks of `member`, by all their colours: what each side looks like decides what belongs to it, until that stays.
Kinds two_kinds(const Surface &surface, const SegmentInputs &inputs, const std::vector<char> &member, const Vertices &looks) {
  Kinds kinds{first_guess(surface, member, looks), {}};
  for (int round = 0; round < kMostRounds; ++round) {
    Eigen::VectorXd first = Eigen::VectorXd::Zero(surface.size()), second = first;
    for (int v = 0; v < surface.size(); ++v)
      (kinds.second[v] ? second : first)[v] = member[v];
    kinds.evidence = colour_evidence(surface, inputs.surface.faces, inputs.face_valid, inputs.colours, first, second);
    std::vector<char> now = choose(surface, [&](int v) { return member[v] && kinds.evidence[v] < 0; });
    if (now == kinds.second)
      break;
    kinds.second = std::move(now);
  }
  return kinds;
}

struct Side {
  double area = 0, evidence = 0;
  std::vector<double> sigma;
};

/// Vertices of `member` where its kinds meet, if that is a seam; else none.
std::vector<int> seam_of(const Surface &surface, const std::vector<char> &member, const Kinds &kinds,
                         const Eigen::VectorXd &sigma, double smallest) {
  std::array<Side, 2> sides;
  std::vector<double> at_seam;
  std::vector<int> seam;
  for (int v = 0; v < surface.size(); ++v) {
    if (!member[v])
      continue;
    Side &side = sides[kinds.second[v] ? 1 : 0];
    side.area += surface.areas[v];
    side.evidence += surface.areas[v] * (kinds.second[v] ? -1 : 1) * kinds.evidence[v];
    const bool meets = std::any_of(surface.neighbours[v].begin(), surface.neighbours[v].end(),
                                   [&](int w) { return member[w] && kinds.second[w] != kinds.second[v]; });
    if (meets)
      seam.push_back(v);
    if (std::isfinite(sigma[v]))
      (meets ? at_seam : side.sigma).push_back(sigma[v]);
  }
  const bool stands = std::all_of(sides.begin(), sides.end(), [&](const Side &side) {
    return side.area >= smallest && side.evidence >= kDistinct * side.area && !side.sigma.empty() && !at_seam.empty() &&
           median(at_seam) < median(side.sigma);
  });
  return stands ? seam : std::vector<int>{};
}

} // namespace

std::vector<char> colour_seams(const Surface &surface, const SegmentInputs &inputs, const Segmentation &segmentation) {
  const double smallest = GarmentOptions{}.min_piece_area; // what is smaller makes no garment
  const Vertices looks = looks_of(inputs.surface.faces, inputs.colours, surface.size());
  std::vector<char> seams(surface.size(), 0);
  for (int region = 0; region < segmentation.region_count; ++region) {
    const std::vector<char> member = choose(surface, [&](int v) { return segmentation.region[v] == region; });
    Kinds kinds = two_kinds(surface, inputs, member, looks);
    merge_small(surface, member, smallest, kinds.second);
    for (int v : seam_of(surface, member, kinds, segmentation.sigma, smallest))
      seams[v] = 1;
  }
  return seams;
}

} // namespace doublet::detail
