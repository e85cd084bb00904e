#include "view_measurement.h"

#include "feature_map.h"

#include "doublet/core/error.h"
#include "doublet/core/parts/fingerprint.h"
#include "doublet/options/options.h"

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

std::uint64_t fingerprint_of(const Image &image, const Image &mask, const std::vector<Keypoint> &keypoints) {
  Fingerprint print;
  print.add(image.data).add(mask.data);
  for (const Keypoint &keypoint : keypoints)
    print.add(keypoint.pixel).bytes(&keypoint.confidence, sizeof keypoint.confidence);
  return print.value();
}

/// Trackers may come from outside.
void require_usable(const Features &features, const Camera &camera, int frame) {
  const std::string where = "camera '" + camera.name + "': the features of frame " + std::to_string(frame);
  if (features.descriptors.rows() != static_cast<Eigen::Index>(features.points.size()))
    throw Error(where + " are " + std::to_string(features.points.size()) + " points and " +
                std::to_string(features.descriptors.rows()) + " descriptors");
  for (const Eigen::Vector2f &p : features.points)
    if (!(p.x() >= 0 && p.y() >= 0 && p.x() <= float(camera.width - 1) && p.y() <= float(camera.height - 1)))
      throw Error(where + " have a point outside the image of " + std::to_string(camera.width) + " x " +
                  std::to_string(camera.height) + " at (" + options::to_text(p.x(), 4) + ", " + options::to_text(p.y(), 4) + ")");
}

} // namespace

ViewMeasurement measure_view(FrameSource &frames, int view, int frame, const Camera &camera, const SilhouetteExtractor *extractor,
                             const FeatureTracker *tracker) {
  ViewMeasurement measured;
  auto [image, mask] = read_view(frames, view, frame, extractor);
  measured.keypoints = frames.keypoints(view, frame);
  if (!measured.keypoints.empty() && measured.keypoints.size() != static_cast<std::size_t>(kKeypoints))
    throw Error("camera '" + camera.name + "': frame " + std::to_string(frame) + " has " +
                std::to_string(measured.keypoints.size()) + " keypoints, expected " + std::to_string(kKeypoints) + ", or none");
  measured.fingerprint = fingerprint_of(image, mask, measured.keypoints);
  measured.mask = std::move(mask);
  measured.has_image = !image.empty();
  if (measured.has_image)
    require_size(image, camera, frame, "the image");
  if (measured.mask.empty() && !image.empty() && !extractor)
    throw Error("camera '" + camera.name + "': frame " + std::to_string(frame) +
                " has no mask, and no silhouette extractor was given");
  if (measured.mask.empty())
    return measured;
  require_size(measured.mask, camera, frame, "the mask");
  if (measured.mask.channels != 1)
    throw Error("camera '" + camera.name + "': the mask of frame " + std::to_string(frame) + " has " +
                std::to_string(measured.mask.channels) + " channels, expected 1");
  measured.outline = trace_outline(measured.mask);
  float top = 1e9f, bottom = 0;
  for (const Eigen::Vector2f &p : measured.outline.points) {
    top = std::min(top, p.y());
    bottom = std::max(bottom, p.y());
  }
  measured.height = static_cast<int>(std::max(0.f, bottom - top));
  if (tracker && !image.empty()) {
    measured.features = tracker->detect(image, measured.mask);
    require_usable(measured.features, camera, frame);
  }
  return measured;
}

std::vector<SurfaceTrack> lift_matches(const std::vector<FeatureMatch> &matches, int view, const Vertices &surface,
                                       const RiggedMesh &actor, const Camera &camera, const FaceBuffer &visible) {
  std::vector<SurfaceTrack> tracks;
  for (const FeatureMatch &match : matches) {
    const SurfacePoint point = lift(match.previous.cast<double>(), surface, actor, camera, visible);
    if (point.face >= 0)
      tracks.push_back({view, point, match.current.cast<double>()});
  }
  return tracks;
}

} // namespace doublet
