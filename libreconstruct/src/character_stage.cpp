// Sect. 7: the animatable character, and how it moves in the motion of the film.

#include "doublet/animate/character.h"
#include "doublet/animate/character_file.h"
#include "doublet/animate/display_surface.h"
#include "doublet/animate/texture_baker.h"
#include "doublet/capture/mesh_file.h"
#include "doublet/core/rasterizer.h"
#include "stages.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <set>

namespace doublet::detail {

namespace {

constexpr int kCompared = 8; // frames in which the character is compared with the film

std::vector<pbd::Material> checked_materials(Reconstruction &reconstruction) {
  const Path file = reconstruction.path("material.json");
  std::vector<pbd::Material> materials = read_materials(file, reconstruction.solver_settings());
  const int regions = reconstruction.results().dressed().segmentation.region_count;
  if (static_cast<int>(materials.size()) != regions)
    throw Error(file.string() + ": expected a material for each of " + std::to_string(regions) + " cloth regions, found " +
                std::to_string(materials.size()));
  return materials;
}

/// The images of a session, which are quickly read only in rising order.
class Film {
public:
  explicit Film(Reconstruction &reconstruction)
      : session_(reconstruction.filmed()), source_(FrameSource::open(session_)), silhouettes_(reconstruction.silhouettes()) {}

  const CameraRig &rig() const { return session_.rig; }
  FrameViews views(int frame) {
    FrameViews found;
    for (int camera = 0; camera < source_->camera_count(); ++camera) {
      auto [image, mask] = read_view(*source_, camera, frame, silhouettes_);
      found.images.push_back(std::move(image));
      found.masks.push_back(std::move(mask));
    }
    return found;
  }

private:
  Session session_;
  std::unique_ptr<FrameSource> source_;
  const SilhouetteExtractor *silhouettes_;
};

/// Texture from the images of the take. Returns the share of the surface that was seen, 0 without images.
double bake_take(Reconstruction &reconstruction, Character &character, const ReferencePerformance &performance) {
  Film film(reconstruction);
  bool any = false;
  const auto images = [&](int row) {
    auto [pictures, masks] = film.views(performance.frames[row]);
    any |= std::any_of(pictures.begin(), pictures.end(), [](const Image &image) { return !image.empty(); });
    return FrameImages{std::move(pictures), std::move(masks)};
  };
  const FilmedSurface filmed{static_cast<int>(performance.frames.size()),
                             [&](int row) { return performance.surface.frames[row]; }, images};
  Character textured = character;
  const double seen = texture_character(textured, filmed, film.rig(), reconstruction.options.texture, reconstruction.context());
  if (!any) {
    reconstruction.context().log_line("character: no camera has an image of the chosen frames, so the character has no texture");
    return 0;
  }
  character = std::move(textured);
  return seen;
}

bool shows_somebody(const Image &mask) {
  return std::any_of(mask.data.begin(), mask.data.end(), [](std::uint8_t pixel) { return pixel > 0; });
}

/// IoU of the re-animated surface with the silhouettes, mean over frames of means over the cameras that see the actor; none if
/// none does in any frame.
std::optional<double> overlap_with_film(Reconstruction &reconstruction, const ReferencePerformance &performance,
                                        const std::vector<Vertices> &simulated) {
  const RiggedMesh &actor = reconstruction.results().dressed().actor;
  Film film(reconstruction);
  std::set<std::size_t> rows;
  for (int i = 0; i < kCompared; ++i)
    rows.insert(i * (performance.frames.size() - 1) / (kCompared - 1));
  double sum = 0;
  int frames = 0;
  for (const std::size_t row : rows) {
    const FrameViews views = film.views(performance.frames[row]);
    double overlap = 0;
    int cameras = 0;
    for (std::size_t c = 0; c < views.masks.size(); ++c) {
      if (!shows_somebody(views.masks[c]))
        continue;
      const FaceBuffer drawn = rasterize(simulated[row], actor.mesh.faces, film.rig()[c], actor.face_valid);
      overlap += mask_iou(silhouette(drawn), views.masks[c]);
      ++cameras;
    }
    if (cameras == 0)
      continue;
    sum += overlap / cameras;
    ++frames;
  }
  return frames ? std::optional(sum / frames) : std::nullopt;
}

/// m, over the cloth of all frames; none without cloth.
std::optional<double> rms_to_captured(const Segmentation &segmentation, const ReferencePerformance &performance,
                                      const std::vector<Vertices> &simulated) {
  const auto cloth = (segmentation.clothness.array() > 0.5).eval();
  if (!cloth.any())
    return std::nullopt;
  double sum = 0;
  for (std::size_t t = 0; t < simulated.size(); ++t)
    sum += cloth.select((simulated[t] - performance.surface.frames[t]).rowwise().squaredNorm().array(), 0.0).sum();
  return std::sqrt(sum / static_cast<double>(cloth.count() * simulated.size()));
}

} // namespace

Json run_character(Reconstruction &reconstruction) {
  Results &results = reconstruction.results();
  const SolverSettings solver = reconstruction.solver_settings();
  const std::vector<pbd::Material> materials = checked_materials(reconstruction);
  const ReferencePerformance performance = results.dressed_performance();
  const DressedActor &dressed = results.dressed();
  const std::vector<Vertices> simulated =
      simulate_reference(results.simulator(solver.cloth), performance, materials, solver.dt,
                         reconstruction.options.fit.energy.settle_frames, reconstruction.context());
  const DisplayMesh display = build_display_mesh(dressed.actor, dressed.segmentation,
                                                 read_mesh(reconstruction.path("template_high.ply")), results.body().body);
  Character character = make_character(dressed.actor, dressed.segmentation, results.body(), results.proxies(), materials, solver,
                                       display.mesh, display.valid, display.garment_subdivisions);
  character.name = reconstruction.session().name;
  Json numbers{{"texture_seen", bake_take(reconstruction, character, performance)}};
  write_simulated(reconstruction.path("simulated.npz"), simulated, results.actor().mesh.vertices.rows());
  write_character(reconstruction.path("character.glb"), character);
  if (const auto overlap = overlap_with_film(reconstruction, performance, simulated))
    numbers["overlap_of_character"] = *overlap;
  if (const auto rms = rms_to_captured(dressed.segmentation, performance, simulated))
    numbers["rms_to_captured_cloth_cm"] = 100 * *rms;
  return numbers;
}

} // namespace doublet::detail
