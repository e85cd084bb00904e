// The stages in their order, and what each reads and writes.

#include "doublet/reconstruct/corrections_file.h"
#include "stages.h"

#include <stdexcept>

namespace doublet {

namespace {

Stage::Run as_text(detail::Json (*run)(Reconstruction &)) {
  return [run](Reconstruction &reconstruction) { return detail::text_of(run(reconstruction)); };
}

} // namespace

std::vector<Stage> default_stages() {
  using namespace detail;
  return {
      {.name = "check",
       .option_groups = {"silhouette", "key", "background"},
       .session_inputs = {"description", "scan", "joints", "calibration", "images"},
       .needs_scan = false,
       .run = as_text(run_check)},
      {.name = "template",
       .writes = {"template.ply", "template_high.ply", kSuggestedMask},
       .option_groups = {"template"},
       .session_inputs = {"scan"},
       .run = as_text(run_template)},
      {.name = "rig",
       .reads = {"template.ply", kSuggestedMask},
       .writes = {"actor.npz"},
       .may_read = {kEditedMask},
       .session_inputs = {"description", "joints"},
       .run = as_text(run_rig)},
      {.name = "performance",
       .reads = {"actor.npz"},
       .writes = {"performance.npz", "observations.npz"},
       .may_write = {kRefinedCalibration},
       .continues_from = {kCaptureCheckpoint},
       .option_groups = {"silhouette", "key", "background", "capture", "features", "pose", "limbs", "annealing", "surface",
                         "calibration"},
       .session_inputs = {"calibration", "images", "keypoints"},
       .uses_seed = true,
       .run = as_text(run_performance)},
      {.name = "segment",
       .reads = {"actor.npz", "performance.npz"},
       .writes = {"segmentation.npz"},
       .may_read = {kPaint, kRefinedCalibration},
       .option_groups = {"silhouette", "key", "background", "segment", "opposite", "body"},
       .session_inputs = {"scan_from_views", "joints", "calibration", "images"},
       .uses_body_model = true,
       .run = as_text(run_segment)},
      {.name = "body",
       .reads = {"actor.npz", "segmentation.npz"},
       .writes = {"body.npz", "proxies.json"},
       .option_groups = {"body", "proxy"},
       .session_inputs = {"joints"},
       .uses_body_model = true,
       .run = as_text(run_body)},
      {.name = "garment",
       .reads = {"actor.npz", "performance.npz", "segmentation.npz", "body.npz"},
       .writes = {"garment.npz"},
       .option_groups = {"garment"},
       .run = as_text(run_garment)},
      {.name = "fit",
       .reads = {"actor.npz", "performance.npz", "observations.npz", "segmentation.npz", "proxies.json", "garment.npz"},
       .writes = {"material.json", "fit_log.csv"},
       .continues_from = {kFitCheckpoint},
       .option_groups = {"cloth", "energy", "fit", "space"},
       .uses_seed = true,
       .run = as_text(run_fit)},
      {.name = "character",
       .reads = {"actor.npz", "template_high.ply", "performance.npz", "segmentation.npz", "body.npz", "proxies.json",
                 "garment.npz", "material.json"},
       .writes = {"simulated.npz", "character.glb"},
       .may_read = {kRefinedCalibration},
       .option_groups = {"silhouette", "key", "background", "cloth", "energy", "texture"},
       .session_inputs = {"name", "calibration", "images"},
       .run = as_text(run_character)},
  };
}

namespace detail {

std::vector<Path> session_files(const Session &session, const std::string &kind) {
  const auto if_any = [](const Path &path) { return path.empty() ? std::vector<Path>{} : std::vector{path}; };
  if (kind == "description")
    return {session.folder / "session.json"};
  if (kind == "scan")
    return if_any(session.scan);
  if (kind == "calibration")
    return if_any(session.calibration);
  if (kind == "joints")
    return if_any(session.markers);
  if (kind == "keypoints")
    return if_any(session.keypoints);
  if (kind == "name" || kind == "scan_from_views") // values of its description
    return {};
  if (kind != "images")
    throw std::invalid_argument("Stage: session_inputs: expected description, name, scan_from_views, scan, calibration, joints, "
                                "keypoints or images, found '" +
                                kind + "'");
  std::vector<Path> files;
  for (const SessionCamera &camera : session.cameras)
    for (const Path &path : {camera.video, camera.masks, camera.background})
      if (!path.empty()) // of a sequence of images, their folder
        files.push_back(path.filename().string().find('%') == std::string::npos ? path : path.parent_path());
  return files;
}

} // namespace detail
} // namespace doublet
