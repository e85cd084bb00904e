#include "feature_map.h"

#include "doublet/capture/surface_refiner.h"
#include "doublet/core/error.h"

#include <cmath>

namespace doublet {
namespace {

constexpr double kSameView =
    0.77; // cosine of 40 degrees; SIFT finds less than half of its features again beyond that (Mikolajczyk & Schmid 2005)

/// From a surface point to the camera, in the rest pose.
Eigen::Vector3d rest_view(const SurfacePoint &point, const RiggedMesh &actor, const PosedSurface &surface, const Camera &camera) {
  const Eigen::Vector3d x = point.position(surface.vertices, actor.mesh.faces);
  const Eigen::Isometry3d &world_from_rest = surface.blend[actor.mesh.faces(point.face, 0)];
  return world_from_rest.linear().transpose() * (camera.centre() - x).normalized();
}

} // namespace

std::vector<std::pair<int, int>> checked_match(const FeatureTracker &tracker, const Features &previous, const Features &current,
                                               double reach) {
  const auto pairs = tracker.match(previous, current, reach);
  const int n = static_cast<int>(previous.points.size()), m = static_cast<int>(current.points.size());
  for (const auto &[i, j] : pairs)
    if (i < 0 || i >= n || j < 0 || j >= m)
      throw Error("capture: the feature tracker matched feature " + std::to_string(i) + " of " + std::to_string(n) + " with " +
                  std::to_string(j) + " of " + std::to_string(m));
  return pairs;
}

SurfacePoint lift(const Eigen::Vector2d &pixel, const Vertices &surface, const RiggedMesh &actor, const Camera &camera,
                  const FaceBuffer &visible) {
  constexpr double kGrazing = 0.2; // cosine between ray and normal; below it a pixel is five on the surface
  SurfacePoint point;
  const int x = static_cast<int>(std::lround(pixel.x())), y = static_cast<int>(std::lround(pixel.y()));
  if (x < 0 || y < 0 || x >= visible.width || y >= visible.height)
    return point;
  const int face = visible.face_at(x, y);
  if (face < 0 || !actor.face_valid[face] || is_overstretched(surface, actor.mesh, face))
    return point;
  const Faces &faces = actor.mesh.faces;
  const Eigen::Vector3d a = surface.row(faces(face, 0)), b = surface.row(faces(face, 1)), c = surface.row(faces(face, 2));
  const Eigen::Vector3d normal = (b - a).cross(c - a).normalized();
  if (!(std::abs(normal.dot(camera.ray_direction(pixel))) > kGrazing))
    return point;
  point.barycentric = barycentric_at(surface, faces, face, camera, pixel);
  if (point.barycentric.allFinite() && point.barycentric.cwiseAbs().maxCoeff() < 3) // slivers extrapolate wildly
    point.face = face;
  return point;
}

void FeatureMap::add(const Features &features, const RiggedMesh &actor, const PosedSurface &surface, const Camera &camera,
                     const FaceBuffer &visible) {
  for (size_t i = 0; i < features.points.size(); ++i) {
    const SurfacePoint point = lift(features.points[i].cast<double>(), surface.vertices, actor, camera, visible);
    if (point.face >= 0)
      entries_.push_back({point, rest_view(point, actor, surface, camera), features.descriptors.row(i)});
  }
}

std::vector<SurfaceTrack> FeatureMap::find(const Features &features, const FeatureTracker &tracker, const RiggedMesh &actor,
                                           const PosedSurface &expected, int view, const Camera &camera, double reach) const {
  std::vector<SurfaceTrack> tracks;
  if (features.points.empty())
    return tracks;
  std::vector<int> candidates;
  Features predicted;
  for (size_t e = 0; e < entries_.size(); ++e) {
    const Entry &entry = entries_[e];
    if (rest_view(entry.surface, actor, expected, camera).dot(entry.seen_from) < kSameView)
      continue;
    const Eigen::Vector3d x = entry.surface.position(expected.vertices, actor.mesh.faces);
    if (camera.depth(x) <= 0)
      continue;
    if (entry.descriptor.size() != features.descriptors.cols())
      throw Error("capture: the feature tracker returned descriptors of " + std::to_string(features.descriptors.cols()) +
                  " numbers, in the first frame of " + std::to_string(entry.descriptor.size()));
    candidates.push_back(static_cast<int>(e));
    predicted.points.push_back(camera.project(x).cast<float>());
  }
  predicted.descriptors.resize(candidates.size(), features.descriptors.cols());
  for (size_t i = 0; i < candidates.size(); ++i)
    predicted.descriptors.row(i) = entries_[candidates[i]].descriptor;
  for (const auto &[i, j] : checked_match(tracker, predicted, features, reach))
    tracks.push_back({view, entries_[candidates[i]].surface, features.points[j].cast<double>()});
  return tracks;
}

} // namespace doublet
