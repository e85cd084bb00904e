// Sect. 5: what is cloth, the body under it, and the garment's own mesh.

#include "doublet/animate/texture_baker.h"
#include "doublet/bodymodel/body_fitter.h"
#include "doublet/bodymodel/body_model.h"
#include "doublet/bodymodel/proxies.h"
#include "doublet/reconstruct/corrections_file.h"
#include "doublet/segment/cloth_segmenter.h"
#include "doublet/segment/corrections.h"
#include "doublet/segment/garment_mesher.h"
#include "stages.h"

namespace doublet::detail {

namespace {

constexpr const char *kCrown = "head_top"; // a glove or a boot may be a garment, a head is none

/// What the surface looks like in the first captured frame, for SegmentInputs::colours.
Vertices first_colours(Reconstruction &reconstruction, const ReferencePerformance &performance) {
  const RiggedMesh &actor = reconstruction.results().actor();
  const Session session = reconstruction.filmed();
  const FrameViews views = read_views(session, performance.frames[0], reconstruction.silhouettes());
  const Mesh first{performance.surface.frames[0], actor.mesh.faces};
  return sample_colours(first, actor.face_valid, session.rig, views.images, views.masks, {}, reconstruction.context());
}

/// As a person painted it, if anybody did; what was found is then kept beside it, for the page that edits it.
Segmentation corrected(Reconstruction &reconstruction, const Mesh &pose, const Segmentation &found,
                       const std::optional<Eigen::VectorXi> &painted) {
  if (!painted) {
    std::filesystem::remove(reconstruction.path(kFoundSegmentation));
    return found;
  }
  const RiggedMesh &actor = reconstruction.results().actor();
  write_segmentation(reconstruction.path(kFoundSegmentation), found);
  return apply_corrections(pose, actor.face_valid, found, *painted);
}

std::vector<Finding> end_findings(const std::vector<std::string> &ends) {
  std::vector<Finding> findings;
  for (const std::string &joint : ends)
    findings.push_back(
        {joint == kCrown,
         "expected a garment without sole, hand or head, found the cloth to include what ends at " + joint + "; look at it",
         "cloth_ends"});
  return findings;
}

} // namespace

Json run_segment(Reconstruction &reconstruction) {
  const ReconstructionOptions &options = reconstruction.options;
  const RiggedMesh &actor = reconstruction.results().actor();
  const ReferencePerformance performance = reconstruction.results().performance();
  const auto segmenter = ClothSegmenter::create(options.segment);
  const Vertices colours = options.segment.colour > 0 ? first_colours(reconstruction, performance) : Vertices(0, 3);
  const Segmentation found = segment_performance(actor, performance, *segmenter, colours, reconstruction.context());
  const auto painted = read_segmentation_paint(reconstruction.out(), found.clothness.size());
  const Mesh pose = segmentation_pose(actor, performance);
  const Segmentation result = corrected(reconstruction, pose, found, painted);
  write_segmentation(reconstruction.path("segmentation.npz"), result);
  const SegmentSummary summary = summarise_segmentation(pose, actor.face_valid, result);
  const Eigen::VectorXd areas = vertex_areas(actor.mesh.vertices, actor.mesh.faces);
  const Eigen::ArrayXd cloth = (result.clothness.array() > 0.5).select(areas.array(), 0.0);
  const std::vector<std::string> ends = cloth_ends(actor, result);
  return {{"findings", to_json(end_findings(ends))},
          {"noise_mm", 1000 * summary.noise},
          {"uncertain_area", summary.uncertain_area},
          {"corrections", painted ? "painted" : "none"},
          {"regions", result.region_count},
          {"doubtful_ends", ends},
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
  const Garment garment = mesh_garment(results.actor(), results.segmentation(), results.body().body,
                                       results.performance().surface, reconstruction.options.garment, reconstruction.context());
  write_garment(reconstruction.path("garment.npz"), garment);
  const GarmentSummary found = summarise_garment(garment);
  std::vector<double> areas;
  for (const Garment &width : width_variants(garment))
    areas.push_back(face_areas(width.rest, garment.mesh.faces).sum());
  return {{"vertices", found.vertices},
          {"triangles", found.faces},
          {"regions", found.regions},
          {"boundary_loops", found.loops},
          {"loops_that_hang", found.hanging_loops},
          {"edge_mm", 1000 * found.mean_edge},
          {"smallest_angle_1_percent_degrees", found.smallest_angle},
          {"areas_m2", areas}};
}

} // namespace doublet::detail
