#include "doublet/segment/cloth_segmenter.h"

#include "bare_limbs.h"
#include "colour_evidence.h"
#include "colour_seams.h"
#include "doublet/core/parts/edge_distances.h"
#include "doublet/core/parts/quantile.h"
#include "doublet/segment/parts/diffusion.h"
#include "snug_cloth.h"
#include "surface_patches.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>

namespace doublet {

using detail::choose;
using detail::connected_patches;
using detail::Patch;
using detail::Surface;

namespace {

/// What diffusion leaves below / above this is noise: rigid / cloth.
constexpr double kSnap = 0.05;
/// m, the widest transition from cloth to skin: a waistband, not a limb.
constexpr double kTransition = 0.10;
constexpr double kAboveNoise = 1.4; // t_rigid by what skin moves
constexpr double kSkin = 0.1;       // of the surface: everybody shows that much of head, hands or legs

/// m, the length of the border between the rigid patches `of` (V, -1 = cloth) and cloth, halfway between their vertices.
std::vector<double> borders_on_cloth(const Surface &surface, const std::vector<int> &of, std::size_t count) {
  std::vector<double> length(count, 0);
  for (int f = 0; f < surface.faces.rows(); ++f)
    for (int c = 0; c < 3; ++c) { // the corner that is alone on its side
      const int alone = surface.faces(f, c), a = surface.faces(f, (c + 1) % 3), b = surface.faces(f, (c + 2) % 3);
      if ((of[a] < 0) == (of[b] < 0) && (of[alone] < 0) != (of[a] < 0))
        length[std::max(of[alone], of[a])] += 0.5 * (surface.vertices.row(a) - surface.vertices.row(b)).norm();
    }
  return length;
}

/// Small rigid patches that border on cloth become cloth. The largest rigid patch is never a hole, nor is one that bulges: with
/// more than kBulge times the area of a disc with its border it is the end of a limb that sticks out of the garment.
void fill_holes(const Surface &surface, double smallest, Eigen::VectorXd &delta) {
  constexpr double kBulge = 2;
  const auto patches = connected_patches(surface, choose(surface, [&](int i) { return delta[i] <= 0.5; }));
  std::vector<int> of(surface.size(), -1);
  for (std::size_t p = 0; p < patches.size(); ++p)
    for (int i : patches[p].members)
      of[i] = static_cast<int>(p);
  const std::vector<double> border = borders_on_cloth(surface, of, patches.size());
  for (std::size_t p = 1; p < patches.size(); ++p)
    if (patches[p].area < std::min(smallest, kBulge * border[p] * border[p] / (4 * std::numbers::pi)))
      for (int i : patches[p].members)
        delta[i] = 1;
}

/// Rigid patches that cloth can hang from: an island inside a core, smaller than a region can be, holds nothing up.
std::vector<char> carrying(const Surface &surface, double smallest, const Eigen::VectorXd &delta) {
  std::vector<char> carries(surface.size(), 0);
  for (const Patch &patch : connected_patches(surface, choose(surface, [&](int i) { return delta[i] <= 0.5; })))
    for (int i : patch.members)
      carries[i] = patch.area >= smallest;
  return carries;
}

/// (V) seams at which something else than `core` is beside it, across its seam or the invented surface there. The others are the
/// edges of holes of the scan in it, which nothing hangs from.
std::vector<char> seams_on_others(const Surface &surface, const Patch &core) {
  std::vector<char> inside(surface.size(), 0);
  for (int i : core.members)
    inside[i] = 1;
  std::vector<char> open(surface.size(), 0); // by hole; there are fewer than vertices
  for (int i = 0; i < surface.size(); ++i)
    for (int j : surface.neighbours[i])
      if (surface.seam[i] && !surface.seam[j] && !inside[j])
        open[surface.hole[i]] = 1;
  return choose(surface, [&](int i) { return surface.seam[i] && open[surface.hole[i]]; });
}

/// Cloth hangs from something. A core whose upper part rises above all that borders on it stands: a head. One under a seam, with
/// its seams higher than its own middle and than the rigid surface beside it, is what comes out of a garment: a shank below a
/// hem, a hand below a cuff. Both are ends of limbs that were tracked badly.
bool hangs(const Surface &surface, const Patch &core, const std::vector<char> &carries) {
  double middle = 0, seams = 0, rigid = 0, top = -std::numeric_limits<double>::infinity(), highest = top;
  int seam_count = 0, rigid_count = 0;
  const std::vector<char> seam = seams_on_others(surface, core);
  for (int i : core.members) {
    middle += surface.areas[i] * surface.vertices(i, 1) / core.area;
    top = std::max(top, surface.vertices(i, 1));
    for (int j : surface.neighbours[i]) {
      const double height = surface.vertices(j, 1);
      if (seam[j]) {
        seams += height;
        ++seam_count;
      } else if (carries[j] && !surface.seam[j]) {
        rigid += height;
        ++rigid_count;
      } else {
        continue;
      }
      highest = std::max(highest, height);
    }
  }
  if (seam_count + rigid_count == 0)
    return true;
  const bool comes_out =
      seam_count > 0 && seams > middle * seam_count && (!rigid_count || seams * rigid_count > rigid * seam_count);
  return highest > (middle + top) / 2 && !comes_out;
}

/// Cloth stays where its core (delta > 0.5) is large enough, with its transition zone: every other vertex goes with the core
/// nearest along the surface, and is rigid beyond kTransition of any (bending joints and tracking leave faint clothness there).
/// Seams do not connect cores: where the invented surface was marked a little too small, what is left of it joins a hem to the
/// legs.
void drop_islands(const Surface &surface, double smallest, Eigen::VectorXd &delta) {
  const std::vector<char> carries = carrying(surface, smallest, delta);
  std::vector<int> kept, dropped;
  for (const Patch &core :
       connected_patches(surface, choose(surface, [&](int i) { return delta[i] > 0.5 && !surface.seam[i]; }))) {
    std::vector<int> &cores = core.area >= smallest && hangs(surface, core, carries) ? kept : dropped;
    cores.insert(cores.end(), core.members.begin(), core.members.end());
  }
  std::vector<std::vector<int>> loose = surface.neighbours; // ways lead through clothness alone
  for (std::vector<int> &around : loose)
    std::erase_if(around, [&](int v) { return delta[v] <= 0; });
  const Eigen::VectorXd to_kept = edge_distances(surface.vertices, loose, kept, kTransition),
                        to_dropped = edge_distances(surface.vertices, loose, dropped, kTransition);
  for (int i = 0; i < surface.size(); ++i)
    if (!(to_kept[i] < to_dropped[i])) // also where neither reaches
      delta[i] = 0;
}

/// The same test once the faint clothness around is counted in: a head of which only some moves enough for a core borders, there,
/// on the rest of itself.
void drop_what_stands(const Surface &surface, double smallest, Eigen::VectorXd &delta) {
  std::vector<char> carries = carrying(surface, smallest, delta);
  for (int i = 0; i < surface.size(); ++i)
    carries[i] = carries[i] && delta[i] <= 0;
  for (const Patch &patch : connected_patches(surface, choose(surface, [&](int i) { return delta[i] > 0 && !surface.seam[i]; })))
    if (!hangs(surface, patch, carries))
      for (int i : patch.members)
        delta[i] = 0;
}

void snap(Eigen::VectorXd &delta) {
  for (double &value : delta)
    value = std::isfinite(value) ? std::clamp((value - kSnap) / (1 - 2 * kSnap), 0.0, 1.0) : 0.0;
}

Surface sigma_surface(const Mesh &pose, const std::vector<std::uint8_t> &face_valid, const Eigen::VectorXd &sigma) {
  require_usable(pose, "first frame of the mesh sequence");
  if (sigma.size() != pose.vertices.rows())
    throw std::invalid_argument("sigma: expected " + std::to_string(pose.vertices.rows()) + " entries, one a vertex, found " +
                                std::to_string(sigma.size()));
  return detail::surface_of(pose, face_valid);
}

/// m; of the vertices whose deviation is known. 0 if none is.
double quantile_of_known(const Eigen::VectorXd &sigma, double share) {
  std::vector<double> known;
  std::copy_if(sigma.begin(), sigma.end(), std::back_inserter(known), [](double value) { return std::isfinite(value); });
  return known.empty() ? 0 : quantile(std::move(known), share);
}

/// Eq. 1, diffused; NaN is filled in by the diffusion.
Eigen::VectorXd raw_clothness(const Surface &surface, const Eigen::VectorXd &sigma, const SegmentOptions &options) {
  Eigen::VectorXd delta = (sigma.array() - options.rigid_threshold) / (options.cloth_threshold - options.rigid_threshold);
  for (double &value : delta)
    value = std::isnan(value) ? value : std::clamp(value, 0.0, 1.0);
  delta = diffuse_on_surface(surface.vertices, surface.faces, delta, options.diffusion);
  snap(delta);
  return delta;
}

/// Is more than half of the surface one core that hangs from nothing, or has the top of the person? Then it is not cloth alone.
bool all_moves(const Surface &surface, const Eigen::VectorXd &delta, double smallest) {
  const auto cores = connected_patches(surface, choose(surface, [&](int i) { return delta[i] > 0.5 && !surface.seam[i]; }));
  if (cores.empty() || cores.front().area < 0.5 * surface.areas.sum())
    return false;
  double top = -std::numeric_limits<double>::infinity(), reached = top;
  for (int i = 0; i < surface.size(); ++i)
    if (surface.areas[i] > 0)
      top = std::max(top, surface.vertices(i, 1));
  for (int i : cores.front().members)
    reached = std::max(reached, surface.vertices(i, 1));
  return reached == top || !hangs(surface, cores.front(), carrying(surface, smallest, delta));
}

/// Adds the cloth that lies on the body (with_snug_cloth) beside each core, unless that then hangs from nothing. `slide` as
/// sliding_deviation.
void add_snug_cloth(const Surface &surface, const Eigen::VectorXd &sigma, const Eigen::VectorXd &slide,
                    const SegmentOptions &options, Eigen::VectorXd &delta) {
  const auto cloth_of = [&] { return choose(surface, [&](int i) { return delta[i] > 0.5; }); };
  const std::vector<char> grown = detail::with_snug_cloth(surface, sigma, slide, cloth_of(), options);
  const Eigen::VectorXd before = delta;
  for (int i = 0; i < surface.size(); ++i)
    if (grown[i] && delta[i] <= 0.5)
      delta[i] = 1;
  const std::vector<char> carries = carrying(surface, options.smallest_region, delta);
  for (const Patch &patch : connected_patches(surface, choose(surface, [&](int i) { return grown[i] && !surface.seam[i]; })))
    if (!hangs(surface, patch, carries))
      for (int i : patch.members)
        delta[i] = before[i];
}

/// Eq. 1, diffusion, holes and islands, regions; with `slide` (V; may be empty) also the cloth that lies on the body.
Segmentation segmentation_of(const Mesh &pose, const std::vector<std::uint8_t> &face_valid, const Eigen::VectorXd &sigma,
                             const Eigen::VectorXd &slide, const SegmentOptions &options) {
  const Surface surface = sigma_surface(pose, face_valid, sigma);
  Segmentation result;
  result.sigma = sigma;
  Eigen::VectorXd delta = raw_clothness(surface, sigma, options);
  fill_holes(surface, options.smallest_region, delta);
  drop_islands(surface, options.smallest_region, delta);
  drop_what_stands(surface, options.smallest_region, delta);
  if (slide.size() > 0) {
    add_snug_cloth(surface, sigma, slide, options, delta);
    fill_holes(surface, options.smallest_region, delta);
  }
  delta = diffuse_on_surface(pose.vertices, surface.faces, delta, 0.5 * options.diffusion); // smooths the borders both left
  snap(delta);
  result.clothness = delta;
  detail::label_regions(surface, {}, result);
  return result;
}

/// (V) what deviations count times, by how much more a vertex looks like what surely is cloth than like what surely is skin.
Eigen::VectorXd weight_of_colour(const MeshSequence &sequence, const std::vector<std::uint8_t> &face_valid,
                                 const Eigen::VectorXd &sigma, const SegmentOptions &options) {
  constexpr double kStillest = 0.25; // of the surface: heads, hands, feet and what is tight on them
  constexpr double kSurelyCloth = 2; // times cloth_threshold
  Eigen::VectorXd factor = Eigen::VectorXd::Ones(sigma.size());
  if (sequence.colours.rows() == 0)
    return factor;
  const Mesh pose{sequence.frames.front(), sequence.faces};
  const Surface surface = sigma_surface(pose, face_valid, sigma);
  const double still = quantile_of_known(sigma, kStillest);
  const Eigen::VectorXd evidence = detail::colour_evidence(
      surface, sequence.faces, face_valid, sequence.colours, choose(surface, [&](int i) { return sigma[i] < still; }),
      choose(surface, [&](int i) { return sigma[i] > kSurelyCloth * options.cloth_threshold; }));
  return evidence.unaryExpr([&](double e) { return std::exp(-(e > 0 ? options.skin_colour : options.cloth_colour) * e); });
}

/// Regions do not connect where two garments touch.
void part_by_colour(const Mesh &pose, const MeshSequence &sequence, const std::vector<std::uint8_t> &face_valid,
                    const SegmentOptions &options, const Context &context, Segmentation &result) {
  const Surface surface = sigma_surface(pose, face_valid, result.sigma);
  const int before = result.region_count;
  detail::label_regions(surface, detail::colour_seams(surface, sequence, face_valid, result, options), result);
  if (result.region_count > before)
    context.say("segment: cloth of two looks meets where it moves little: " + std::to_string(result.region_count) +
                " garments in the place of " + std::to_string(before));
}

class OppositeRaySegmenter : public ClothSegmenter {
public:
  explicit OppositeRaySegmenter(const SegmentOptions &options) : options_(options) { options_.validate(); }

  Segmentation segment(const MeshSequence &sequence, const std::vector<std::uint8_t> &face_valid,
                       const Context &context) const override {
    if (sequence.frames.size() < 2)
      throw std::invalid_argument("segment: expected a sequence of at least 2 frames, found " +
                                  std::to_string(sequence.frames.size()));
    if (!sequence.unposed.empty() && sequence.unposed.size() != sequence.frames.size())
      throw std::invalid_argument("segment: expected as many unposed frames as frames, " +
                                  std::to_string(sequence.frames.size()) + ", found " + std::to_string(sequence.unposed.size()));
    require_frames(sequence.frames, sequence.frames.front().rows(), "segment: a frame");
    require_frames(sequence.unposed, sequence.frames.front().rows(), "segment: an unposed frame");
    if (sequence.colours.rows() % std::max<Eigen::Index>(sequence.faces.rows(), 1) != 0)
      throw std::invalid_argument("segment: expected as many colours on each of " + std::to_string(sequence.faces.rows()) +
                                  " faces, found " + std::to_string(sequence.colours.rows()) + " in all");
    context.report("segment", 0.0);
    const Mesh pose{sequence.frames.front(), sequence.faces};
    const OppositePoints points = find_opposite_points(pose, face_valid, options_.opposite, context);
    context.report("segment", 0.3);
    Eigen::VectorXd sigma = opposite_distance_deviation(sequence, points, options_.opposite, context);
    Eigen::VectorXd slide;
    if (!sequence.unposed.empty()) {
      const MeshSequence unposed{sequence.faces, sequence.unposed};
      sigma = sigma.cwiseMin(opposite_distance_deviation(unposed, points, options_.opposite, context));
      const Vertices normals = vertex_normals(pose.vertices, valid_faces(pose.faces, face_valid));
      slide = detail::sliding_deviation(sequence.unposed, normals, options_.opposite.trim, context);
    }
    context.report("segment", 0.8);
    const SegmentOptions raised = fitting_thresholds(pose, face_valid, sigma, options_);
    if (raised.rigid_threshold > options_.rigid_threshold)
      context.say("segment: skin moves too much in this capture for its thresholds, which are raised from " +
                  options::shown(1000 * options_.rigid_threshold) + " and " + options::shown(1000 * options_.cloth_threshold) +
                  " mm to " + options::shown(1000 * raised.rigid_threshold, 3) + " and " +
                  options::shown(1000 * raised.cloth_threshold, 3));
    const Eigen::VectorXd factor = weight_of_colour(sequence, face_valid, sigma, raised);
    slide.array() *= factor.head(slide.size()).array();
    Segmentation result = segmentation_of(pose, face_valid, sigma.cwiseProduct(factor), slide, raised);
    result.sigma = sigma;
    if (sequence.colours.rows() > 0)
      part_by_colour(pose, sequence, face_valid, raised, context, result);
    context.report("segment", 1.0);
    return result;
  }

private:
  SegmentOptions options_;
};

} // namespace

void SegmentOptions::validate() const {
  options::check(*this);
  if (!(rigid_threshold < cloth_threshold))
    options::refuse("SegmentOptions: rigid_threshold", "less than cloth_threshold, " + options::shown(cloth_threshold) + " m",
                    options::shown(rigid_threshold));
}

SegmentOptions fitting_thresholds(const Mesh &pose, const std::vector<std::uint8_t> &face_valid, const Eigen::VectorXd &sigma,
                                  const SegmentOptions &options) {
  options.validate();
  const Surface surface = sigma_surface(pose, face_valid, sigma);
  constexpr double kStep = 1.25, kMost = 8; // times the options
  SegmentOptions raised = options;
  for (double scale = std::max(1.0, kAboveNoise * quantile_of_known(sigma, kSkin) / options.rigid_threshold); scale < kMost;
       scale *= kStep) {
    raised.rigid_threshold = scale * options.rigid_threshold;
    raised.cloth_threshold = scale * options.cloth_threshold;
    Eigen::VectorXd delta = raw_clothness(surface, sigma, raised);
    fill_holes(surface, options.smallest_region, delta);
    if (!all_moves(surface, delta, options.smallest_region))
      return raised;
  }
  return options; // no level tells anything apart
}

Segmentation segmentation_from_deviation(const Mesh &pose, const std::vector<std::uint8_t> &face_valid,
                                         const Eigen::VectorXd &sigma, const SegmentOptions &options) {
  options.validate();
  return segmentation_of(pose, face_valid, sigma, {}, options);
}

SegmentSummary summarise_segmentation(const Mesh &pose, const std::vector<std::uint8_t> &face_valid,
                                      const Segmentation &segmentation) {
  const Eigen::VectorXd areas = vertex_areas(pose.vertices, valid_faces(pose.faces, face_valid));
  SegmentSummary summary;
  summary.regions = segmentation.region_count;
  int valid = 0, known = 0;
  for (int i = 0; i < areas.size(); ++i) {
    if (areas[i] <= 0)
      continue;
    ++valid;
    known += std::isfinite(segmentation.sigma[i]);
    if (segmentation.clothness[i] > 0.5)
      summary.cloth_area += areas[i];
    else if (segmentation.clothness[i] > 0)
      summary.transition_area += areas[i];
  }
  summary.known_fraction = valid ? static_cast<double>(known) / valid : 0;
  return summary;
}

std::unique_ptr<ClothSegmenter> ClothSegmenter::create(const SegmentOptions &options) {
  return std::make_unique<OppositeRaySegmenter>(options);
}

Segmentation segment_cloth(const MeshSequence &sequence, const std::vector<std::uint8_t> &face_valid,
                           const SegmentOptions &options, const Context &context) {
  return ClothSegmenter::create(options)->segment(sequence, face_valid, context);
}

namespace {

bool begins_in_scan_pose(const Skeleton &skeleton, const ReferencePerformance &performance) {
  constexpr double kBent = 0.15; // rad; a first frame in the scan's pose has 0.02, a dance 0.3
  double sum = 0, count = 0;
  for (const Joint &joint : skeleton.joints)
    for (int d = joint.first_dof; joint.kind != JointKind::Root && d < joint.first_dof + joint.dof_count; ++d) {
      sum += std::pow(performance.dofs(0, d), 2);
      count += 1;
    }
  return sum <= kBent * kBent * count;
}

} // namespace

Mesh segmented_pose(const RiggedMesh &actor, const ReferencePerformance &performance) {
  require_actor(actor, "segmented_pose");
  require_performance(performance, actor, "segmented_pose");
  if (begins_in_scan_pose(actor.skeleton, performance))
    return {performance.surface.frames.front(), performance.surface.faces};
  return actor.mesh;
}

Segmentation segment_performance(const RiggedMesh &actor, const ReferencePerformance &performance,
                                 const ClothSegmenter &segmenter, const FullnessOptions &fullness, const Context &context) {
  require_actor(actor, "segment_performance");
  MeshSequence sequence = performance.surface;
  sequence.unposed = unposed_frames(actor, performance, context);
  if (!begins_in_scan_pose(actor.skeleton, performance)) {
    sequence.frames.insert(sequence.frames.begin(), actor.mesh.vertices);
    sequence.unposed.insert(sequence.unposed.begin(), actor.mesh.vertices);
  }
  Segmentation segmentation = segmenter.segment(sequence, actor.face_valid, context);
  require_segmentation(segmentation, actor.mesh.vertices.rows(), "segment_performance: the segmenter's answer");
  detail::strip_bare_limbs(actor, segmented_pose(actor, performance), segmentation, context);
  segmentation.fullness = estimate_fullness(actor.mesh, actor.face_valid, segmentation, performance.surface, fullness, context);
  return segmentation;
}

} // namespace doublet
