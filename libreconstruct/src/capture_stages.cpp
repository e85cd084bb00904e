// Sect. 4: the session, scan and videos to a rigged template and a reference performance.

#include "doublet/capture/calibration_file.h"
#include "doublet/capture/mesh_file.h"
#include "doublet/capture/performance_capture.h"
#include "doublet/capture/session_check.h"
#include "doublet/capture/template_builder.h"
#include "doublet/reconstruct/corrections_file.h"
#include "stages.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numeric>

namespace doublet::detail {

namespace {

constexpr double kMillimetres = 1000;

void add_quality(Json &numbers, const std::string &name, const SurfaceQuality &quality) {
  numbers[name + "_triangles"] = quality.triangles;
  numbers[name + "_self_intersections"] = quality.self_intersections;
  numbers[name + "_suggested_invalid_area_m2"] = quality.invalid_area;
  numbers[name + "_smallest_angle_degrees"] = quality.smallest_angle;
  numbers[name + "_smallest_angle_1_percent_degrees"] = quality.first_centile_angle;
  numbers[name + "_from_scan_mean_mm"] = kMillimetres * quality.scan_mean;
  numbers[name + "_from_scan_max_mm"] = kMillimetres * quality.scan_max;
  numbers[name + "_valid_to_scan_mean_mm"] = kMillimetres * quality.mean_to_scan;
  numbers[name + "_valid_to_scan_max_mm"] = kMillimetres * quality.max_to_scan;
}

double mean(const std::vector<double> &values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Of those that are not NaN; NaN if all are.
double mean_known(std::vector<double> values) {
  values.erase(std::remove_if(values.begin(), values.end(), [](double x) { return std::isnan(x); }), values.end());
  return mean(values);
}

double rounded(double value, int decimals) {
  const double unit = std::pow(10.0, decimals);
  return std::round(unit * value) / unit;
}

Json camera_numbers(const RefinedCamera &camera) {
  return {{"camera", camera.camera},
          {"seen", camera.seen},
          {"moved_mm", rounded(kMillimetres * camera.moved, 2)},
          {"sure_mm", rounded(kMillimetres * camera.sure, 2)},
          {"turned_degrees", rounded(camera.turned, 4)},
          {"shifted_mm", rounded(kMillimetres * camera.shifted, 2)},
          {"focal_percent", rounded(100 * camera.focal, 3)},
          {"late_frames", rounded(camera.late, 3)},
          {"late_sure_frames", rounded(camera.late_sure, 3)}};
}

/// What the take says about its cameras, in one line.
std::string refinement_text(const std::vector<RefinedCamera> &cameras, const Path &file) {
  double sum = 0;
  int seen = 0;
  std::string late;
  for (const RefinedCamera &camera : cameras) {
    if (camera.seen) {
      sum += camera.moved * camera.moved;
      ++seen;
    }
    if (camera.delay)
      late += (late.empty() ? ", and frames late: " : ", ") + camera.camera + " by " + std::to_string(camera.delay);
  }
  char off[32];
  std::snprintf(off, sizeof off, "%.1f", kMillimetres * std::sqrt(sum / std::max(seen, 1)));
  return std::string("performance: the calibration was ") + off + " mm off on the actor" + late + "; " + file.string() +
         " has the refined cameras";
}

/// calibration.yml, which all later stages go by; none if the session's calibration is as good.
void write_refined_cameras(Reconstruction &reconstruction, const CaptureResult &result) {
  if (!result.summary.cameras_refined)
    return;
  const Path file = reconstruction.path(kRefinedCalibration);
  const Session session = filmed(reconstruction.session(), result);
  std::vector<CalibratedCamera> cameras;
  for (std::size_t i = 0; i < session.cameras.size(); ++i)
    cameras.push_back({session.rig[i], session.lenses[i], session.cameras[i].late});
  write_calibration(file, cameras);
  reconstruction.announce(refinement_text(result.summary.cameras, file));
}

/// Whoever stops it is told where it goes on, which is the last that it says.
CaptureResult capture(Reconstruction &reconstruction, const CaptureOptions &options) {
  std::string last;
  Context context = reconstruction.context();
  context.log = [&](const std::string &line) {
    const std::size_t name = line.find(": ");
    last = name == std::string::npos ? line : line.substr(name + 2);
    reconstruction.context().log_line(line);
  };
  const auto frames = FrameSource::open(reconstruction.session());
  try {
    return PerformanceCapture::create(options)->capture(reconstruction.results().actor(), reconstruction.session().rig, *frames,
                                                        reconstruction.silhouettes(), context);
  } catch (...) {
    if (std::filesystem::exists(options.checkpoint))
      reconstruction.announce("performance: " + last);
    throw;
  }
}

Json capture_numbers(const CaptureResult &result) {
  const CaptureSummary &summary = result.summary;
  Json numbers{{"frames", result.performance.frames.size()},
               {"rim_px", mean(summary.rim_px)},
               {"sift_px", mean(summary.sift_px)},
               {"silhouette_iou_against_measured_masks", mean(summary.silhouette_iou)},
               {"start_frame", summary.start_frame},
               {"lost_limbs", summary.lost_limbs.size()},
               {"lost_limbs_recovered", std::count_if(summary.lost_limbs.begin(), summary.lost_limbs.end(),
                                                      [](const LostLimb &lost) { return lost.recovered; })},
               {"frames_inferred", Json::object()},
               {"frames_lost", Json::object()},
               {"cameras_refined", summary.cameras_refined},
               {"cameras", Json::array()},
               {"seconds_per_frame", summary.seconds_per_frame}};
  if (const double distance = mean_known(summary.keypoint_distance); std::isfinite(distance))
    numbers["keypoint_mm"] = kMillimetres * distance;
  for (const JointVisibility &joint : summary.joints) {
    if (joint.inferred)
      numbers["frames_inferred"][joint.joint] = joint.inferred;
    if (joint.lost)
      numbers["frames_lost"][joint.joint] = joint.lost;
  }
  for (const RefinedCamera &camera : summary.cameras)
    numbers["cameras"].push_back(camera_numbers(camera));
  return numbers;
}

} // namespace

Json run_check(Reconstruction &reconstruction) {
  const auto frames = FrameSource::open(reconstruction.session());
  const SessionCheck check =
      check_session(reconstruction.session(), *frames, reconstruction.silhouettes(), reconstruction.context());
  if (!check.start_text.empty())
    reconstruction.announce("check: " + check.start_text);
  return {{"findings", to_json(check.findings)}, {"frame", check.frame()}};
}

Json run_template(Reconstruction &reconstruction) {
  const Mesh scan = read_mesh(reconstruction.session().scan);
  const Template surface = build_template(scan, reconstruction.options.template_, reconstruction.context());
  write_mesh(reconstruction.path("template.ply"), surface.mesh);
  write_mesh(reconstruction.path("template_high.ply"), surface.high);
  write_template_suggestion(reconstruction.path(kSuggestedMask), surface);
  const TemplateSummary summary = summarise_template(surface, scan, reconstruction.context());
  Json numbers = Json::object();
  add_quality(numbers, "template", summary.mesh);
  add_quality(numbers, "display", summary.high);
  return numbers;
}

Json run_rig(Reconstruction &reconstruction) {
  Template surface;
  surface.mesh = read_mesh(reconstruction.path("template.ply"));
  surface.face_valid = read_template_mask(reconstruction.out());
  const RiggedMesh actor = rig_template(surface, reconstruction.session().joints, reconstruction.context());
  write_actor(reconstruction.path("actor.npz"), actor);
  const Eigen::VectorXd areas = face_areas(actor.mesh.vertices, actor.mesh.faces);
  double invalid = 0;
  for (Eigen::Index f = 0; f < areas.size(); ++f)
    invalid += surface.face_valid[f] ? 0 : areas[f];
  return {{"mask", std::filesystem::exists(reconstruction.path(kEditedMask)) ? "edited" : "suggested"},
          {"invalid_area_m2", invalid},
          {"degrees_of_freedom", actor.skeleton.dof_count()}};
}

Json run_performance(Reconstruction &reconstruction) {
  CaptureOptions options = reconstruction.options.capture;
  options.limbs.annealing.seed = reconstruction.options.seed;
  options.checkpoint = reconstruction.path(kCaptureCheckpoint);
  const CaptureResult result = capture(reconstruction, options);
  write_observations(reconstruction.path("observations.npz"), result.observations);
  write_performance(reconstruction.path("performance.npz"), result.performance);
  write_refined_cameras(reconstruction, result);
  std::filesystem::remove(options.checkpoint);
  return capture_numbers(result);
}

} // namespace doublet::detail
