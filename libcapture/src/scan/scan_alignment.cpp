#include "doublet/capture/scan_alignment.h"

#include "doublet/core/parts/alignment.h"
#include "doublet/core/parts/quantile.h"
#include "doublet/rays/ray_scene.h"
#include "placed.h"
#include "sentences.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <stdexcept>

namespace doublet {
namespace {

using detail::placed;
using detail::printed;

struct ScanUnit {
  const char *name;
  double metres;
};
constexpr std::array<ScanUnit, 4> kScanUnits{{{"m", 1}, {"cm", 0.01}, {"mm", 0.001}, {"inches", 0.0254}}};
constexpr std::array kScanAxes{"+x", "-x", "+y", "-y", "+z", "-z"};

constexpr double kSameHeight = 0.15;  // share by which the heights of scan and hull may differ
constexpr double kFloorLevel = 0.02;  // of the scan's height, in which a floor lies
constexpr double kAboveFloor = 0.006; // of the scan's height, below which nothing is kept where there is a floor: a centimetre
constexpr double kSpeck = 0.01;       // of the area: smaller pieces go
constexpr double kFlat = 0.97;        // cosine to the upward direction from which a face is floor
constexpr double kFloorShare = 0.1;   // of the area that is flat at the bottom, from which it is a floor and no soles
constexpr int kHeadings = 36, kSamples = 600, kRounds = 40;
constexpr double kKept = 0.8;             // share of the samples that counts: the nearest
constexpr std::size_t kRefined = 6;       // placements that are refined
constexpr double kLargestDistance = 0.03; // m, mean distance to the hull from which on the scan is of something else
constexpr double kSurroundings = 0.10;    // m outside the hull from which on it is not the person

// --- the mesh

double height_of(const Vertices &vertices) {
  return vertices.col(1).maxCoeff() - vertices.col(1).minCoeff();
}

/// Middle of the bounding box, at its bottom.
Eigen::RowVector3d foot_of(const Vertices &vertices) {
  const Eigen::RowVector3d low = vertices.colwise().minCoeff(), high = vertices.colwise().maxCoeff();
  return {(low.x() + high.x()) / 2, low.y(), (low.z() + high.z()) / 2};
}

template <class Keep> Mesh faces_where(const Mesh &mesh, const Keep &keep) {
  std::vector<int> kept;
  for (int f = 0; f < mesh.faces.rows(); ++f)
    if (keep(f))
      kept.push_back(f);
  return submesh(mesh, kept);
}

/// The pieces of some size: a scan with holes has several.
Mesh without_specks(const Mesh &mesh) {
  int count = 0;
  const Eigen::VectorXi piece = vertex_components(mesh.faces, static_cast<int>(mesh.vertices.rows()), &count);
  const Eigen::VectorXd areas = face_areas(mesh.vertices, mesh.faces);
  Eigen::VectorXd of_piece = Eigen::VectorXd::Zero(count);
  for (Eigen::Index f = 0; f < areas.size(); ++f)
    of_piece[piece[mesh.faces(f, 0)]] += areas[f];
  const double smallest = kSpeck * of_piece.sum(); // noise may be a hundred thousand pieces: not for every face
  return faces_where(mesh, [&](int f) { return of_piece[piece[mesh.faces(f, 0)]] > smallest; });
}

struct Standing {
  Mesh person; ///< in the scan's unit, +Y up
  bool floor = false;
};

/// What stands on the floor.
Standing without_floor(const Mesh &mesh) {
  const Eigen::VectorXd areas = face_areas(mesh.vertices, mesh.faces);
  const Vertices normals = face_normals(mesh.vertices, mesh.faces);
  Eigen::VectorXd middles(mesh.faces.rows());
  for (Eigen::Index f = 0; f < middles.size(); ++f)
    middles[f] =
        (mesh.vertices(mesh.faces(f, 0), 1) + mesh.vertices(mesh.faces(f, 1), 1) + mesh.vertices(mesh.faces(f, 2), 1)) / 3;
  const double tall = height_of(mesh.vertices), lowest = middles.minCoeff();
  std::vector<double> levels;
  double flat_area = 0;
  for (Eigen::Index f = 0; f < middles.size(); ++f)
    if (middles[f] < lowest + kFloorLevel * tall && std::abs(normals(f, 1)) > kFlat) {
      levels.push_back(middles[f]);
      flat_area += areas[f];
    }
  if (levels.empty() || flat_area < kFloorShare * areas.sum())
    return {without_specks(mesh), false};
  const double level = median(levels) + kAboveFloor * tall;
  return {without_specks(faces_where(mesh, [&](int f) { return middles[f] > level; })), true};
}

Mesh without_surroundings(const Mesh &mesh, const RayScene &hull, const Context &context) {
  std::vector<char> near(mesh.vertices.rows());
  parallel_for(context, static_cast<int>(near.size()),
               [&](int v) { near[v] = hull.closest(mesh.vertices.row(v)).distance < kSurroundings; });
  return faces_where(mesh, [&](int f) { return near[mesh.faces(f, 0)] && near[mesh.faces(f, 1)] && near[mesh.faces(f, 2)]; });
}

/// (kSamples, 3) centres of faces, as many on equal areas.
Vertices area_samples(const Mesh &mesh) {
  const Eigen::VectorXd areas = face_areas(mesh.vertices, mesh.faces);
  std::vector<double> reached(areas.size());
  std::partial_sum(areas.begin(), areas.end(), reached.begin());
  Vertices samples(kSamples, 3);
  for (int s = 0; s < kSamples; ++s) {
    const auto at = std::lower_bound(reached.begin(), reached.end(), (s + 0.5) / kSamples * reached.back());
    const auto f = std::min<std::ptrdiff_t>(at - reached.begin(), areas.size() - 1);
    samples.row(s) =
        (mesh.vertices.row(mesh.faces(f, 0)) + mesh.vertices.row(mesh.faces(f, 1)) + mesh.vertices.row(mesh.faces(f, 2))) / 3;
  }
  return samples;
}

/// A rotation that turns the scan's axis to +Y.
Eigen::Matrix3d upright(std::size_t axis) {
  Eigen::Vector3d up = Eigen::Vector3d::Zero();
  up[static_cast<Eigen::Index>(axis / 2)] = axis % 2 ? -1 : 1;
  const Eigen::Vector3d aside(up.z(), up.x(), up.y());
  Eigen::Matrix3d rotation;
  rotation << aside.transpose(), up.transpose(), aside.cross(up).transpose();
  return rotation;
}

// --- the place

/// A person found in the scan, if it was in some unit and on some axis.
struct Candidate {
  Mesh person; ///< m, +Y up
  Vertices samples;
  const char *unit = "", *up = "";
  bool floor = false;
};

struct Placement {
  std::size_t candidate = 0;
  Eigen::Isometry3d hull_from_person = Eigen::Isometry3d::Identity();
  double distance = 0; ///< m
};

/// Samples by their distance to the hull, the nearest kKept of them; `closest` (kSamples, 3).
std::vector<std::pair<double, int>> nearest_samples(const RayScene &hull, const Vertices &points, Vertices &closest) {
  std::vector<std::pair<double, int>> order;
  closest.resize(points.rows(), 3);
  for (int i = 0; i < points.rows(); ++i) {
    const ClosestPoint found = hull.closest(points.row(i));
    closest.row(i) = found.point;
    order.emplace_back(found.distance, i);
  }
  std::sort(order.begin(), order.end());
  order.resize(static_cast<std::size_t>(kKept * static_cast<double>(points.rows())));
  return order;
}

double distance_to(const RayScene &hull, const Vertices &points) {
  Vertices closest;
  double sum = 0;
  const auto kept = nearest_samples(hull, points, closest);
  for (const auto &[distance, i] : kept)
    sum += distance;
  return sum / static_cast<double>(kept.size());
}

/// Iterative closest points over the nearest kKept.
Placement refined(Placement placement, const RayScene &hull, const Vertices &samples) {
  Vertices closest;
  for (int round = 0; round < kRounds; ++round) {
    const Vertices points = placed(samples, placement.hull_from_person);
    const auto kept = nearest_samples(hull, points, closest);
    Eigen::Matrix3Xd from(3, kept.size()), to(3, kept.size());
    for (std::size_t k = 0; k < kept.size(); ++k) {
      from.col(k) = points.row(kept[k].second);
      to.col(k) = closest.row(kept[k].second);
    }
    placement.hull_from_person =
        Eigen::Isometry3d(nearest_similarity(from, to, AlignmentScale::One)) * placement.hull_from_person;
  }
  placement.distance = distance_to(hull, placed(samples, placement.hull_from_person));
  return placement;
}

/// Those as high as the hull.
std::vector<Candidate> candidates_of(const Mesh &scan, double wanted) {
  std::vector<Candidate> candidates;
  for (std::size_t axis = 0; axis < kScanAxes.size(); ++axis) {
    const Standing standing = without_floor({scan.vertices * upright(axis).transpose(), scan.faces});
    if (standing.person.faces.rows() == 0)
      continue;
    const double tall = height_of(standing.person.vertices);
    for (const ScanUnit &unit : kScanUnits)
      if (std::abs(unit.metres * tall / wanted - 1) < kSameHeight) {
        Mesh person{unit.metres * standing.person.vertices, standing.person.faces};
        Vertices samples = area_samples(person);
        candidates.push_back({std::move(person), std::move(samples), unit.name, kScanAxes[axis], standing.floor});
      }
  }
  return candidates;
}

std::vector<Placement> headings_of(const std::vector<Candidate> &candidates, const RayScene &target, const Mesh &hull,
                                   const Context &context) {
  std::vector<Placement> tried(candidates.size() * kHeadings);
  parallel_for(context, static_cast<int>(tried.size()), [&](int i) {
    Placement &placement = tried[i];
    placement.candidate = i / kHeadings;
    const Candidate &candidate = candidates[placement.candidate];
    placement.hull_from_person.linear() =
        Eigen::AngleAxisd(i % kHeadings * 2 * std::numbers::pi / kHeadings, Eigen::Vector3d::UnitY()).toRotationMatrix();
    const Vertices turned = candidate.person.vertices * placement.hull_from_person.linear().transpose();
    placement.hull_from_person.translation() = (foot_of(hull.vertices) - foot_of(turned)).transpose();
    placement.distance = distance_to(target, placed(candidate.samples, placement.hull_from_person));
  });
  std::stable_sort(tried.begin(), tried.end(), [](const Placement &a, const Placement &b) { return a.distance < b.distance; });
  return tried;
}

} // namespace

AlignedScan align_scan(const Mesh &scan, const Mesh &hull, const Context &context) {
  require_usable(scan, "align_scan: scan");
  require_usable(hull, "align_scan: hull");
  const double wanted = height_of(hull.vertices);
  const std::vector<Candidate> candidates = candidates_of(scan, wanted);
  if (candidates.empty()) {
    const Eigen::RowVector3d sides = scan.vertices.colwise().maxCoeff() - scan.vertices.colwise().minCoeff();
    throw std::invalid_argument("scan: expected a person as high as the cameras see, " + printed("%.2f", wanted) +
                                " m, in m, cm, mm or inches along an axis, found " + printed("%.3g", sides.x()) + ", " +
                                printed("%.3g", sides.y()) + ", " + printed("%.3g", sides.z()) + " units");
  }
  const RayScene target(hull);
  std::vector<Placement> best = headings_of(candidates, target, hull, context);
  best.resize(std::min(best.size(), kRefined));
  parallel_for(context, static_cast<int>(best.size()),
               [&](int i) { best[i] = refined(best[i], target, candidates[best[i].candidate].samples); });
  const Placement &chosen =
      *std::min_element(best.begin(), best.end(), [](const Placement &a, const Placement &b) { return a.distance < b.distance; });
  if (!(chosen.distance <= kLargestDistance))
    throw std::invalid_argument("scan: expected the person and the pose that the cameras see, found it at least " +
                                printed("%.0f", 1000 * chosen.distance) + " mm from the visual hull");
  const Candidate &found = candidates[chosen.candidate];
  Mesh mesh = without_surroundings({placed(found.person.vertices, chosen.hull_from_person), found.person.faces}, target, context);
  return {std::move(mesh), found.unit, found.up, found.floor, chosen.distance};
}

} // namespace doublet
