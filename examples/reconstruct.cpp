// The whole way in C++, every stage with its defaults: scan and videos -> character.glb and the files between (docs/formats.md),
// the same that `doublet reconstruct` writes. Each stage reads what the ones before it wrote, so any may be another program's.
//   reconstruct SESSION OUT body_model.npz

#include "doublet/animate/character_file.h"
#include "doublet/animate/display_surface.h"
#include "doublet/animate/texture_baker.h"
#include "doublet/bodymodel/body_fitter.h"
#include "doublet/bodymodel/proxies.h"
#include "doublet/capture/mesh_file.h"
#include "doublet/capture/performance_capture.h"
#include "doublet/capture/template_builder.h"
#include "doublet/core/error.h"
#include "doublet/files/files.h"
#include "doublet/fit/material_estimator.h"
#include "doublet/segment/cloth_segmenter.h"
#include "doublet/segment/garment_mesher.h"

#include <cstdio>

using namespace doublet;

void reconstruct(const Session &session, const Path &out, const Path &body_model, const Context &context) {
  // Sect. 4: template and reference performance
  Template surface = build_template(read_mesh(session.scan), {}, context);
  write_mesh(out / "template.ply", surface.mesh);
  write_mesh(out / "template_high.ply", surface.high);
  write_template_suggestion(out / "template_suggestion.npz", surface);
  surface.mesh = read_mesh(out / "template.ply");
  write_actor(out / "actor.npz", rig_template(surface, session.joints, context));
  const RiggedMesh actor = read_actor(out / "actor.npz");
  const auto frames = FrameSource::open(session);
  const auto silhouettes = session_silhouettes(session, *frames, {}, context);
  const CaptureResult captured = PerformanceCapture::create()->capture(actor, session.rig, *frames, silhouettes.get(), context);
  write_observations(out / "observations.npz", captured.observations);
  write_performance(out / "performance.npz", captured.performance);
  const ReferencePerformance performance = read_performance(out / "performance.npz", actor);
  const Observations observations = read_observations(out / "observations.npz");
  // Sect. 5: cloth, with what it looks like in the first frame, and body
  const Session seen = filmed(session, captured);
  const auto film = FrameSource::open(seen);
  std::vector<Image> images, masks;
  for (int camera = 0; camera < film->camera_count(); ++camera) {
    auto [image, mask] = read_view(*film, camera, performance.frames[0], silhouettes.get());
    images.push_back(std::move(image));
    masks.push_back(std::move(mask));
  }
  const Mesh first{performance.surface.frames[0], actor.mesh.faces};
  const Vertices colours = sample_colours(first, actor.face_valid, seen.rig, images, masks, {}, context);
  write_segmentation(out / "segmentation.npz",
                     segment_performance(actor, performance, *ClothSegmenter::create(), colours, {}, context));
  const Segmentation segmentation = read_segmentation(out / "segmentation.npz");
  const BodyFit fitted = BodyFitter::create()->fit(actor, segmentation, *BodyModel::read(body_model), session.landmarks, context);
  write_body(out / "body.npz", fitted);
  write_proxies(out / "proxies.json", fit_proxies(fitted, actor, segmentation), actor.skeleton);
  const BodyFit body = read_body(out / "body.npz");
  const std::vector<TaperedCapsule> proxies = read_proxies(out / "proxies.json", actor.skeleton);
  // The garment, in several widths
  write_garment(out / "garment.npz", mesh_garment(actor, segmentation, body.body, performance.surface, {}, context));
  const Garment garment = read_garment(out / "garment.npz", actor);
  const ReferencePerformance motion = dress(performance, actor, garment);
  // Sect. 6: material and width
  std::vector<CharacterSimulator> widths;
  for (const Garment &width : width_variants(garment)) {
    const DressedActor worn = dress(actor, segmentation, width);
    widths.emplace_back(worn.actor, worn.segmentation, proxies);
  }
  Take take{{}, &motion, &observations, 1 / session.fps};
  for (const CharacterSimulator &width : widths)
    take.widths.push_back(&width);
  FitOptions fit;
  fit.log = out / "fit_log.csv";
  const FitResult result = estimate_material({take}, fit, context);
  write_materials(out / "material.json", result);
  const DressedActor dressed = dress(actor, segmentation, choose_widths(garment, result.chosen_widths()));
  const CharacterSimulator simulator(dressed.actor, dressed.segmentation, proxies);
  // Sect. 7: the character
  const auto simulated =
      simulate_reference(simulator, motion, result.materials(), result.solver.dt, fit.energy.settle_frames, context);
  write_simulated(out / "simulated.npz", simulated, actor.mesh.vertices.rows());
  const DisplayMesh display = build_display_mesh(dressed.actor, dressed.segmentation, read_mesh(out / "template_high.ply"));
  Character character = make_character(dressed.actor, dressed.segmentation, body, proxies, result.materials(), result.solver,
                                       display.mesh, display.valid, display.garment_subdivisions);
  character.name = session.name;
  texture_character(character, motion.surface.frames[0], seen.rig, images, masks, {}, context);
  write_character(out / "character.glb", character);
}

int main(int count, char **arguments) try {
  if (count != 4)
    throw Error("usage: reconstruct SESSION OUT body_model.npz");
  Context context;
  context.log = [](const std::string &text) { std::fprintf(stderr, "%s\n", text.c_str()); };
  std::filesystem::create_directories(arguments[2]);
  reconstruct(read_session(arguments[1]), arguments[2], arguments[3], context);
} catch (const std::exception &error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
