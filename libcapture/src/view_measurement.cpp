#include "view_measurement.h"

#include "doublet/core/error.h"

#include <algorithm>
#include <cmath>

namespace doublet {
namespace {

void require_size(const Image &image, const Camera &camera, int frame, const char *what) {
  if (image.width != camera.width || image.height != camera.height)
    throw Error("camera '" + camera.name + "': " + what + " of frame " + std::to_string(frame) + " is " +
                std::to_string(image.width) + " x " + std::to_string(image.height) + ", the calibration says " +
                std::to_string(camera.width) + " x " + std::to_string(camera.height));
}

} // namespace

ViewMeasurement measure_view(FrameSource &frames, int view, int frame, const Camera &camera, const SilhouetteExtractor *extractor,
                             const FeatureTracker *tracker) {
  ViewMeasurement measured;
  const Image image = frames.image(view, frame);
  measured.mask = frames.mask(view, frame);
  if (!image.empty())
    require_size(image, camera, frame, "the image");
  if (measured.mask.empty() && !image.empty()) {
    if (!extractor)
      throw Error("camera '" + camera.name + "': frame " + std::to_string(frame) +
                  " has no mask, and no silhouette extractor was given");
    measured.mask = extractor->extract(view, image);
  }
  if (measured.mask.empty())
    return measured;
  require_size(measured.mask, camera, frame, "the mask");
  measured.outline = trace_outline(measured.mask);
  float top = 1e9f, bottom = 0;
  for (const Eigen::Vector2f &p : measured.outline.points) {
    top = std::min(top, p.y());
    bottom = std::max(bottom, p.y());
  }
  measured.height = static_cast<int>(std::max(0.f, bottom - top));
  if (tracker && !image.empty())
    measured.features = tracker->detect(image, measured.mask);
  return measured;
}

std::vector<SurfaceTrack> lift_matches(const std::vector<FeatureMatch> &matches, int view, const Vertices &surface,
                                       const RiggedMesh &actor, const Camera &camera, const FaceBuffer &visible) {
  constexpr double kGrazing = 0.2; // cosine between ray and normal; below it a pixel is five on the surface
  std::vector<SurfaceTrack> tracks;
  for (const FeatureMatch &match : matches) {
    const int x = static_cast<int>(std::lround(match.previous.x())), y = static_cast<int>(std::lround(match.previous.y()));
    if (x < 0 || y < 0 || x >= visible.width || y >= visible.height)
      continue;
    const int face = visible.face_at(x, y);
    if (face < 0 || !actor.face_valid[face])
      continue;
    const Eigen::Vector3d a = surface.row(actor.mesh.faces(face, 0)), b = surface.row(actor.mesh.faces(face, 1)),
                          c = surface.row(actor.mesh.faces(face, 2));
    const Eigen::Vector3d normal = (b - a).cross(c - a).normalized();
    if (std::abs(normal.dot(camera.ray_direction(match.previous.cast<double>()))) < kGrazing)
      continue;
    SurfaceTrack track;
    track.view = view;
    track.surface.face = face;
    track.surface.barycentric = barycentric_at(surface, actor.mesh.faces, face, camera, match.previous.cast<double>());
    track.pixel = match.current.cast<double>();
    if (track.surface.barycentric.allFinite() && track.surface.barycentric.cwiseAbs().maxCoeff() < 3)
      tracks.push_back(track);
  }
  return tracks;
}

} // namespace doublet
