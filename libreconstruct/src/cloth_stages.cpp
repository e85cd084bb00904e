// Sect. 5: what is cloth, the body under it, and the garment's own mesh.

#include "doublet/animate/texture_baker.h"
#include "doublet/bodymodel/body_fitter.h"
#include "doublet/bodymodel/body_model.h"
#include "doublet/bodymodel/proxies.h"
#include "doublet/reconstruct/corrections_file.h"
#include "doublet/segment/cloth_prior.h"
#include "doublet/segment/cloth_segmenter.h"
#include "doublet/segment/corrections.h"
#include "doublet/segment/garment_mesher.h"
#include "doublet/segment/slack.h"
#include "stages.h"

namespace doublet::detail {

namespace {

/// A glove or a boot may be a garment, a head is none. `joint`: the last one, "head" in a skeleton without "head_top".
bool is_head(const std::string &joint) {
  return joint.rfind("head", 0) == 0;
}

/// What the surface looks like in the first captured frame, for SegmentInputs::colours.
Vertices first_colours(Reconstruction &reconstruction, const ReferencePerformance &performance) {
  const RiggedMesh &actor = reconstruction.results().actor();
  const Session session = reconstruction.filmed();
  const FrameViews views = read_views(session, performance.frames[0], reconstruction.silhouettes());
  const Mesh first{performance.surface.frames[0], actor.mesh.faces};
  return sample_colours(first, actor.face_valid, session.rig, views.images, views.masks, {}, reconstruction.context());
}

/// Whether the scan's distance from a body is evidence for clothes. A scan made from the views bulges between their outlines by
/// as much as clothes do; colours, where there are any, are better evidence.
bool use_gap(Reconstruction &reconstruction, const Vertices &colours) {
  if (!reconstruction.session().scan_from_views || !colours.array().isFinite().any())
    return true;
  reconstruction.announce("segment: the scan was made from the videos, so its distance from a body is not used");
  return false;
}

/// A body that fits into the surface wherever it may be dressed; empty, and said so, where the model does not know the skeleton.
Mesh body_within(Reconstruction &reconstruction) {
  const RiggedMesh &actor = reconstruction.results().actor();
  const Segmentation dressed = dressed_all_over(actor);
  const auto model = BodyModel::read(reconstruction.options.body_model);
  try {
    return BodyFitter::create(reconstruction.options.body)
        ->fit(actor, dressed, *model, reconstruction.session().landmarks, reconstruction.context())
        .body;
  } catch (const Error &error) {
    reconstruction.announce(std::string("segment: no body was fitted, so only motion, colour and prior decide what is cloth: ") +
                            error.what());
    return {};
  }
}

/// As a person painted it, if anybody did; what was found is then kept beside it, for the page that edits it.
Segmentation corrected(Reconstruction &reconstruction, const Segmentation &found, const std::optional<Eigen::VectorXi> &painted) {
  if (!painted) {
    std::filesystem::remove(reconstruction.path(kFoundSegmentation));
    return found;
  }
  const RiggedMesh &actor = reconstruction.results().actor();
  write_segmentation(reconstruction.path(kFoundSegmentation), found);
  return apply_corrections(actor.mesh, actor.face_valid, found, *painted);
}

std::string percent(double share) {
  return options::to_text(100 * share, 3) + " %";
}

std::vector<Finding> end_findings(const std::vector<ClothEnd> &ends) {
  std::vector<Finding> findings;
  for (const ClothEnd &end : ends)
    findings.push_back({is_head(end.joint),
                        "expected skin at the ends of limbs, found " + percent(end.share) + " of the surface at " + end.joint +
                            " to be cloth; look at it",
                        "cloth_ends"});
  return findings;
}

/// Cloth of a region, as shares of the surface.
struct RegionShare {
  double cloth = 0, carried = 0;
  double slack = 0; ///< m, mean of the cloth's
};

/// [R] how much of each region the body carries.
std::vector<RegionShare> region_shares(const RiggedMesh &actor, const Segmentation &segmentation,
                                       const Eigen::VectorXd &attachment) {
  const Eigen::VectorXd areas = vertex_areas(actor.mesh.vertices, valid_faces(actor.mesh.faces, actor.face_valid));
  std::vector<RegionShare> shares(segmentation.region_count);
  for (Eigen::Index v = 0; v < areas.size(); ++v) {
    if (segmentation.region[v] < 0 || segmentation.clothness[v] <= 0.5)
      continue;
    RegionShare &region = shares[segmentation.region[v]];
    const double share = areas[v] / areas.sum();
    region.cloth += share;
    region.carried += attachment[v] >= 0.5 ? share : 0.0;
    region.slack += share * segmentation.slack[v];
  }
  for (RegionShare &region : shares)
    region.slack /= std::max(region.cloth, 1e-12);
  return shares;
}

/// Regions that make no garment: the body carries them, or they hang on nothing.
std::vector<Finding> carried_findings(const std::vector<RegionShare> &regions) {
  std::vector<Finding> findings;
  for (std::size_t r = 0; r < regions.size(); ++r)
    if (regions[r].cloth > 0 && regions[r].carried >= regions[r].cloth)
      findings.push_back({false,
                          "expected cloth that hangs free, found region " + std::to_string(r) + " (" + percent(regions[r].cloth) +
                              " of the surface) within " + options::to_text(1000 * regions[r].slack, 3) +
                              " mm of the body on average: the body carries it, it is not simulated",
                          "carried"});
  return findings;
}

} // namespace

Json run_segment(Reconstruction &reconstruction) {
  const ReconstructionOptions &options = reconstruction.options;
  const RiggedMesh &actor = reconstruction.results().actor();
  const ReferencePerformance performance = reconstruction.results().performance();
  const auto segmenter = ClothSegmenter::create(options.segment);
  const Vertices colours = options.segment.colour > 0 ? first_colours(reconstruction, performance) : Vertices(0, 3);
  const bool has_gap = options.segment.gap_slope > 0 && use_gap(reconstruction, colours);
  const Mesh body = has_gap ? body_within(reconstruction) : Mesh();
  const Segmentation found = segment_performance(actor, performance, *segmenter, colours, body, reconstruction.context());
  const auto painted = read_segmentation_paint(reconstruction.out(), found.clothness.size());
  const Segmentation result = corrected(reconstruction, found, painted);
  write_segmentation(reconstruction.path("segmentation.npz"), result);
  const SegmentSummary summary = summarise_segmentation(actor.mesh, actor.face_valid, result);
  const Eigen::VectorXd areas = vertex_areas(actor.mesh.vertices, actor.mesh.faces);
  const Eigen::ArrayXd cloth = (result.clothness.array() > 0.5).select(areas.array(), 0.0);
  const std::vector<ClothEnd> ends = cloth_ends(actor, result);
  std::vector<std::string> joints;
  for (const ClothEnd &end : ends)
    joints.push_back(end.joint);
  return {{"findings", to_json(end_findings(ends))},
          {"noise_mm", 1000 * summary.noise},
          {"uncertain_area", summary.uncertain_area},
          {"corrections", painted ? "painted" : "none"},
          {"regions", result.region_count},
          {"doubtful_ends", joints},
          {"cloth_area_m2", cloth.sum()}};
}

Json run_body(Reconstruction &reconstruction) {
  const ReconstructionOptions &options = reconstruction.options;
  const RiggedMesh &actor = reconstruction.results().actor();
  const auto model = BodyModel::read(options.body_model);
  const Segmentation segmentation = reconstruction.results().segmentation();
  const BodyFit fit = BodyFitter::create(options.body)
                          ->fit(actor, segmentation, *model, reconstruction.session().landmarks, reconstruction.context());
  const std::vector<TaperedCapsule> proxies = fit_proxies(fit, actor, segmentation, options.proxy);
  write_body(reconstruction.path("body.npz"), fit);
  write_proxies(reconstruction.path("proxies.json"), proxies, actor.skeleton);
  return {{"residual_mm", 1000 * fit.residual},
          {"largest_coefficient", fit.coefficients.size() ? fit.coefficients.cwiseAbs().maxCoeff() : 0.0},
          {"model", fit.model},
          {"proxies", proxies.size()}};
}

Json run_garment(Reconstruction &reconstruction) {
  Results &results = reconstruction.results();
  const RiggedMesh &actor = results.actor();
  const ReferencePerformance performance = results.performance();
  const Mesh body = results.body().body;
  Segmentation segmentation = results.segmentation();
  segmentation.slack =
      cloth_slack(body, canonical_frames(actor, performance, reconstruction.context()), reconstruction.context());
  const Garment garment =
      mesh_garment(actor, segmentation, body, performance.surface, reconstruction.options.garment, reconstruction.context());
  write_garment(reconstruction.path("garment.npz"), garment);
  const GarmentSummary found = summarise_garment(garment);
  std::vector<double> areas;
  for (const Garment &width : width_variants(garment))
    areas.push_back(face_areas(width.rest, garment.mesh.faces).sum());
  const std::vector<RegionShare> regions = region_shares(actor, segmentation, garment.attachment);
  double carried = 0;
  for (const RegionShare &region : regions)
    carried += region.carried;
  if (carried > 0)
    reconstruction.announce("garment: " + percent(carried) +
                            " of the surface is cloth that the body carries; it is not simulated");
  return {{"findings", to_json(carried_findings(regions))},
          {"carried_area", carried},
          {"vertices", found.vertices},
          {"triangles", found.faces},
          {"regions", found.regions},
          {"boundary_loops", found.loops},
          {"loops_that_hang", found.hanging_loops},
          {"edge_mm", 1000 * found.mean_edge},
          {"smallest_angle_1_percent_degrees", found.smallest_angle},
          {"areas_m2", areas}};
}

} // namespace doublet::detail
