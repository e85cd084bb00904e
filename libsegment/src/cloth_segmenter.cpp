#include "doublet/segment/cloth_segmenter.h"

#include "colour_evidence.h"
#include "colour_seams.h"
#include "doublet/core/parts/labelling.h"
#include "doublet/core/parts/quantile.h"
#include "doublet/segment/cloth_prior.h"
#include "doublet/segment/garment_mesher.h"
#include "doublet/segment/parts/diffusion.h"
#include "doublet/segment/slack.h"
#include "limb_ends.h"
#include "log_odds.h"
#include "surface_patches.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

namespace doublet {

using detail::choose;
using detail::kSurest;
using detail::probability;
using detail::snapped;
using detail::Surface;

namespace {

constexpr double kStillest = 0.1;    // of the surface: everybody shows that much of head, hands or legs
constexpr double kFinest = 0.0005;   // m, no capture is more exact
constexpr double kLeastFromGap = -2; // log odds: cloth rests on the body in places
constexpr int kColourRounds = 4;     // of learning what skin and cloth look like
constexpr double kCertain = 6;       // log odds, of margins that are told apart
constexpr int kMarginSteps = 25;     // odd: one of the shifts is 0, so that probabilities agree with the labels

Surface surface_of_inputs(const Mesh &pose, const std::vector<std::uint8_t> &face_valid, const Eigen::VectorXd &sigma) {
  require_usable(pose, "first frame of the mesh sequence");
  if (sigma.size() != pose.vertices.rows())
    throw std::invalid_argument("sigma: expected " + std::to_string(pose.vertices.rows()) + " entries, one per vertex, found " +
                                std::to_string(sigma.size()));
  return detail::surface_of(pose, face_valid);
}

/// m: the deviation of the stillest tenth of the vertices whose deviation is known; 0 if none is.
double noise_of(const Eigen::VectorXd &sigma) {
  std::vector<double> known;
  std::copy_if(sigma.begin(), sigma.end(), std::back_inserter(known), [](double value) { return std::isfinite(value); });
  return known.empty() ? 0 : quantile(std::move(known), kStillest);
}

/// (V) log odds of cloth by the deviation: a logistic curve over its logarithm. NaN takes the harmonic interpolation of its
/// surroundings, 0 where there are none.
Eigen::VectorXd odds_of_motion(const Surface &surface, const Eigen::VectorXd &sigma, const SegmentOptions &options) {
  const double even = options.even_odds * std::max(noise_of(sigma), kFinest);
  Eigen::VectorXd odds = sigma.unaryExpr([&](double m) { // NaN stays
    return std::isnan(m) ? m : std::clamp(options.slope * std::log(std::max(m, 1e-9) / even), -kSurest, kSurest);
  });
  odds = diffuse_on_surface(surface.vertices, surface.faces, odds, 0.0);
  return odds.unaryExpr([](double value) { return std::isfinite(value) ? value : 0.0; });
}

/// (V) log odds of cloth by the distance from the body within: the same curve over its logarithm. 0 where that is not known.
Eigen::VectorXd odds_of_gap(const Eigen::VectorXd &gap, const SegmentOptions &options) {
  return gap.unaryExpr([&](double m) {
    return std::clamp(options.gap_slope * std::log(std::max(m, 1e-9) / options.even_gap), kLeastFromGap, kSurest);
  });
}

/// (V) `odds` and what the colours add to them. What skin and cloth look like is what the more probable of each does, and so on
/// (as GrabCut: Rother et al. 2004, with probabilities in the place of labels).
Eigen::VectorXd with_colours(const Surface &surface, const SegmentInputs &inputs, const Eigen::VectorXd &odds,
                             const SegmentOptions &options) {
  Eigen::VectorXd all = odds;
  for (int round = 0; round < kColourRounds; ++round) {
    const Eigen::VectorXd cloth = all.unaryExpr([](double x) { return probability(x); });
    const Eigen::VectorXd evidence = detail::colour_evidence(surface, inputs.surface.faces, inputs.face_valid, inputs.colours,
                                                             cloth, (1 - cloth.array()).matrix());
    all = odds + options.colour * evidence;
  }
  return all;
}

/// The energy: vertex areas times log odds, for each edge the length of border between its vertices, and for each vertex half its
/// area times the log odds that it is what its mirrored one is, which has the other half.
LabellingEnergy labelling_energy(const Surface &surface, const Eigen::VectorXd &odds, const Eigen::VectorXi &mirrored,
                                 const SegmentOptions &options) {
  LabellingEnergy energy;
  energy.gain = surface.areas.cwiseProduct(odds);
  for (Eigen::Index f = 0; f < surface.faces.rows(); ++f) {
    const Eigen::RowVector3i corners = surface.faces.row(f);
    const Eigen::RowVector3d centre = surface.vertices(corners.transpose(), Eigen::all).colwise().mean();
    for (int k = 0; k < 3; ++k) { // the border between two corners runs from the middle of their edge to the middle of the face
      const int a = corners[k], b = corners[(k + 1) % 3];
      const Eigen::RowVector3d middle = 0.5 * (surface.vertices.row(a) + surface.vertices.row(b));
      energy.edges.emplace_back(a, b);
      energy.cost.push_back(options.border * (centre - middle).norm());
    }
  }
  for (int v = 0; v < mirrored.size(); ++v)
    if (mirrored[v] >= 0) {
      energy.edges.emplace_back(v, mirrored[v]);
      energy.cost.push_back(options.symmetry * surface.areas[v] / 2);
    }
  return energy;
}

/// Clothness out of labels (V): 0 and 1 with a smooth border.
Eigen::VectorXd smooth_labels(const Surface &surface, const std::vector<char> &labels, double diffusion) {
  Eigen::VectorXd delta(surface.size());
  for (int v = 0; v < surface.size(); ++v)
    delta[v] = surface.areas[v] > 0 && labels[v];
  return snapped(diffuse_on_surface(surface.vertices, surface.faces, delta, diffusion));
}

/// Labels, probabilities, clothness and regions. `inputs` without what is not known.
Segmentation segmentation_of(const Mesh &pose, const SegmentInputs &inputs, const Eigen::VectorXd &sigma,
                             const SegmentOptions &options) {
  const Surface surface = surface_of_inputs(pose, inputs.face_valid, sigma);
  Segmentation result;
  result.sigma = sigma;
  Eigen::VectorXd odds = odds_of_motion(surface, sigma, options);
  if (inputs.prior.size() > 0)
    odds += inputs.prior;
  if (inputs.gap.size() > 0)
    odds += odds_of_gap(inputs.gap, options);
  if (options.colour > 0 && inputs.colours.rows() > 0)
    odds = with_colours(surface, inputs, odds, options);
  const LabellingEnergy energy = labelling_energy(surface, odds, inputs.mirrored, options);
  result.clothness = smooth_labels(surface, lowest_labelling(energy), options.diffusion);
  result.probability = labelling_margins(energy, surface.areas, kCertain, kMarginSteps).unaryExpr([](double margin) {
    return probability(margin);
  });
  detail::label_regions(surface, {}, result);
  return result;
}

/// Regions do not connect where two garments touch.
void part_by_colour(const Mesh &pose, const SegmentInputs &inputs, const Context &context, Segmentation &result) {
  const Surface surface = surface_of_inputs(pose, inputs.face_valid, result.sigma);
  const int before = result.region_count;
  detail::label_regions(surface, detail::colour_seams(surface, inputs, result), result, GarmentOptions{}.min_piece_area);
  if (result.region_count > before)
    context.log_line("segment: cloth is split where two colours meet and it moves little: " +
                     std::to_string(result.region_count) + " regions instead of " + std::to_string(before));
}

void require_one_each(const Eigen::VectorXd &values, Eigen::Index vertices, const char *name, const char *what) {
  if (values.size() > 0 && (values.size() != vertices || !values.allFinite()))
    throw std::invalid_argument(std::string("segment: ") + name + ": expected " + std::to_string(vertices) + " finite " + what +
                                ", one per vertex, found " + std::to_string(values.size()) +
                                (values.allFinite() ? "" : ", some not finite"));
}

void require_inputs(const SegmentInputs &inputs) {
  const std::vector<Vertices> &frames = inputs.surface.frames;
  if (frames.size() < 2)
    throw std::invalid_argument("segment: expected a sequence of at least 2 frames, found " + std::to_string(frames.size()));
  if (!inputs.canonical.empty() && inputs.canonical.size() != frames.size())
    throw std::invalid_argument("segment: expected as many canonical frames as frames, " + std::to_string(frames.size()) +
                                ", found " + std::to_string(inputs.canonical.size()));
  require_frames(frames, frames.front().rows(), "segment: a frame");
  require_frames(inputs.canonical, frames.front().rows(), "segment: a canonical frame");
  if (inputs.colours.rows() % std::max<Eigen::Index>(inputs.surface.faces.rows(), 1) != 0)
    throw std::invalid_argument("segment: expected as many colours on each of " + std::to_string(inputs.surface.faces.rows()) +
                                " faces, found " + std::to_string(inputs.colours.rows()) + " in all");
  require_one_each(inputs.prior, frames.front().rows(), "prior", "log odds");
  require_one_each(inputs.gap, frames.front().rows(), "gap", "distances in m");
  const Eigen::Index vertices = inputs.mirrored.size() > 0 ? frames.front().rows() : 0;
  if (inputs.mirrored.size() != vertices || (inputs.mirrored.array() < -1).any() || (inputs.mirrored.array() >= vertices).any())
    throw std::invalid_argument(
        "segment: mirrored: expected a vertex or -1 for each of " + std::to_string(frames.front().rows()) + " vertices, found " +
        (inputs.mirrored.size() == vertices ? "one that is not there" : std::to_string(inputs.mirrored.size())));
}

class OppositeRaySegmenter : public ClothSegmenter {
public:
  explicit OppositeRaySegmenter(const SegmentOptions &options) : options_(options) { options_.validate(); }

  Segmentation segment(const SegmentInputs &inputs, const Context &context) const override {
    require_inputs(inputs);
    context.report_progress("segment", 0.0);
    const Mesh pose{inputs.surface.frames.front(), inputs.surface.faces};
    const OppositePoints points = find_opposite_points(pose, inputs.face_valid, options_.opposite, context);
    context.report_progress("segment", 0.3);
    // Of both deviations the smaller counts: skin that a bent joint or a twisted spine deforms keeps its place in the scan pose,
    // and skin that the skin weights misplace keeps its shape.
    Eigen::VectorXd sigma = opposite_distance_deviation(inputs.surface, points, options_.opposite, context);
    if (!inputs.canonical.empty())
      sigma = sigma.cwiseMin(
          opposite_distance_deviation({inputs.surface.faces, inputs.canonical}, points, options_.opposite, context));
    context.report_progress("segment", 0.8);
    Segmentation result = segmentation_of(pose, inputs, sigma, options_);
    if (inputs.colours.rows() > 0 && options_.colour > 0)
      part_by_colour(pose, inputs, context, result);
    context.report_progress("segment", 1.0);
    return result;
  }

private:
  SegmentOptions options_;
};

} // namespace

void SegmentOptions::validate() const {
  options::check(*this);
}

Segmentation segmentation_from_deviation(const Mesh &pose, const std::vector<std::uint8_t> &face_valid,
                                         const Eigen::VectorXd &sigma, const SegmentOptions &options) {
  options.validate();
  SegmentInputs inputs;
  inputs.face_valid = face_valid;
  return segmentation_of(pose, inputs, sigma, options);
}

SegmentSummary summarise_segmentation(const Mesh &pose, const std::vector<std::uint8_t> &face_valid,
                                      const Segmentation &segmentation) {
  require_segmentation(segmentation, pose.vertices.rows(), "summarise_segmentation");
  const Eigen::VectorXd areas = surface_of_inputs(pose, face_valid, segmentation.sigma).areas;
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
  summary.noise = noise_of(segmentation.sigma);
  double uncertain = 0;
  for (Eigen::Index i = 0; i < segmentation.probability.size(); ++i)
    uncertain += segmentation.probability[i] > 0.1 && segmentation.probability[i] < 0.9 ? areas[i] : 0.0;
  summary.uncertain_area = uncertain > 0 ? uncertain / areas.sum() : 0;
  return summary;
}

std::vector<ClothEnd> cloth_ends(const RiggedMesh &actor, const Segmentation &segmentation) {
  const Eigen::ArrayXd areas = vertex_areas(actor.mesh.vertices, actor.mesh.faces).array();
  std::vector<ClothEnd> ends;
  for (const detail::LimbEnd &limb : detail::limb_ends(actor)) {
    const Eigen::ArrayXd area = areas * actor.weights.col(limb.mover).array();
    const double cloth = (segmentation.clothness.array() > 0.5).select(area, 0.0).sum();
    if (area.sum() > 0 && cloth > 0.5 * area.sum())
      ends.push_back({actor.skeleton.joints[limb.leaf].name, cloth / area.sum()});
  }
  return ends;
}

std::unique_ptr<ClothSegmenter> ClothSegmenter::create(const SegmentOptions &options) {
  return std::make_unique<OppositeRaySegmenter>(options);
}

Segmentation segment_cloth(const SegmentInputs &inputs, const SegmentOptions &options, const Context &context) {
  return ClothSegmenter::create(options)->segment(inputs, context);
}

Segmentation segment_performance(const RiggedMesh &actor, const ReferencePerformance &performance,
                                 const ClothSegmenter &segmenter, const Vertices &colours, const Mesh &body,
                                 const Context &context) {
  require_actor(actor, "segment_performance");
  require_performance(performance, actor, "segment_performance");
  SegmentInputs inputs{performance.surface, actor.face_valid, canonical_frames(actor, performance, context), colours,
                       cloth_prior(actor)};
  for (std::vector<Vertices> *frames : {&inputs.surface.frames, &inputs.canonical})
    frames->insert(frames->begin(), actor.mesh.vertices);
  if (body.faces.rows() > 0)
    inputs.gap = cloth_slack(body, {actor.mesh.vertices}, context);
  inputs.mirrored = mirrored_vertices(actor);
  Segmentation segmentation = segmenter.segment(inputs, context);
  require_segmentation(segmentation, actor.mesh.vertices.rows(), "segment_performance: the segmenter's answer");
  return segmentation;
}

} // namespace doublet
