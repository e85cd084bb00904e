#include "observed_frames.h"

#include "doublet/core/rasterizer.h"

#include <algorithm>
#include <cmath>

namespace doublet::fit {
namespace {

constexpr int kFramesPerChunk = 32; // between two polls for cancellation
constexpr int kEveryFrame = 4;      // has a captured shape: the frames between tell the same

struct Box {
  float x0 = 1e9f, y0 = 1e9f, x1 = -1e9f, y1 = -1e9f;
  void add(const Eigen::Vector2d &p) {
    x0 = std::min(x0, static_cast<float>(p.x())), x1 = std::max(x1, static_cast<float>(p.x()));
    y0 = std::min(y0, static_cast<float>(p.y())), y1 = std::max(y1, static_cast<float>(p.y()));
  }
  bool empty() const { return x0 > x1 || y0 > y1; }
};

int field_cell(const Camera &camera, int field_size) {
  return std::max(1, static_cast<int>(std::lround(std::max(camera.width, camera.height) / static_cast<double>(field_size))));
}

/// Everything that is not cloth, drawn once and cut to the box where cloth can be.
CoarseBuffer draw_others(const CharacterSimulator &simulator, const ClothTopology &topology, const PosedFrame &frame,
                         const CoarseCamera &camera, const Box &box) {
  const Faces &faces = simulator.actor().mesh.faces;
  std::vector<std::uint8_t> rest = simulator.actor().face_valid;
  for (std::size_t f = 0; f < rest.size(); ++f)
    rest[f] = rest[f] && !topology.face_is_cloth[f];
  const Camera coarse = camera.camera.resized(camera.width, camera.height);
  const FaceBuffer body = rasterize(frame.skinned, faces, coarse, rest);
  const Mesh capsules = capsule_mesh(frame.capsules);
  const FaceBuffer legs = rasterize(capsules.vertices, capsules.faces, coarse);

  CoarseBuffer result;
  result.x0 = std::clamp(static_cast<int>(camera.coarse_x(box.x0)) - 2, 0, camera.width - 1);
  result.y0 = std::clamp(static_cast<int>(camera.coarse_y(box.y0)) - 2, 0, camera.height - 1);
  result.width = std::clamp(static_cast<int>(camera.coarse_x(box.x1)) + 3, 1, camera.width) - result.x0;
  result.height = std::clamp(static_cast<int>(camera.coarse_y(box.y1)) + 3, 1, camera.height) - result.y0;
  result.inverse_depth.reserve(static_cast<std::size_t>(result.width) * result.height);
  for (int y = result.y0; y < result.y0 + result.height; ++y)
    for (int x = result.x0; x < result.x0 + result.width; ++x)
      result.inverse_depth.push_back(1.f / std::min(body.depth_at(x, y), legs.depth_at(x, y))); // 1 / infinity = 0
  return result;
}

} // namespace

ObservedFrames::ObservedFrames(const std::vector<const CharacterSimulator *> &models, const ReferencePerformance &performance,
                               const Observations &observations, double frame_seconds, const EnergyOptions &energy,
                               const std::vector<int> &starts, CpuTimes &times, const Context &context)
    : widths(models), simulator(models.front()), dt(frame_seconds), options(energy), topology(cloth_topology(*models.front())) {
  const CharacterSimulator &model = *simulator;
  for (const Camera &camera : observations.cameras)
    cameras.emplace_back(camera, options.outline_size);
  const int count = static_cast<int>(performance.dofs.rows());
  frames.resize(count);
  views.assign(count, std::vector<FrameView>(observations.cameras.size()));
  captured.assign(count, std::vector<CapturedView>(observations.cameras.size()));
  shapes.resize(count);
  probes = probes_of(topology);
  if (count > 0 && model.has_rest_shape())
    for (const Eigen::VectorXd &dofs : doublet::lead_in_poses(model.actor().skeleton, performance.dofs.row(0).transpose(), dt))
      lead_in_poses.push_back(model.pose(dofs));
  prepare(0, times, context, [&](int t) {
    frames[t] = model.pose(performance.dofs.row(t).transpose());
    for (std::size_t c = 0; c < cameras.size(); ++c)
      keep_image(t, c, performance.surface.frames[t], observations.views[t][c], cameras[c]);
  });
  prepare(0.5, times, context, [&](int t) {
    keep_captured(t, std::find(starts.begin(), starts.end(), t) != starts.end(), performance.surface, observations);
  });
  for (int r = 0; r < regions(); ++r) {
    worst.emplace_back();
    for (int t = 0; t < count; ++t)
      worst[r].push_back(worst_terms(r, t));
  }
}

/// Calls frame(t) for every frame, on all threads: one half of the preparation, which begins when `done` of it is over.
void ObservedFrames::prepare(double done, CpuTimes &times, const Context &context, const std::function<void(int)> &frame) {
  for (int from = 0; from < frame_count(); from += kFramesPerChunk) {
    context.report_progress("fit: images", done + 0.5 * from / static_cast<double>(frame_count()));
    parallel_for(context, std::min(kFramesPerChunk, frame_count() - from), [&](int i) {
      Stopwatch watch;
      frame(from + i);
      watch.lap(&EnergyTimes::set_up);
      times.add(watch);
    });
  }
}

void ObservedFrames::keep_image(int t, std::size_t c, const Vertices &surface, const ViewObservation &observation,
                                const CoarseCamera &camera) {
  if (observation.contour.empty())
    return;
  const Camera &full = camera.camera;
  Box box;
  for (std::size_t i = 0; i < topology.vertices.size(); ++i)
    for (const Vertices *place : {static_cast<const Vertices *>(&frames[t].skinned), &surface}) {
      const Eigen::Vector3d point = place->row(topology.vertices[i]).transpose();
      if (full.depth(point) > 0.05)
        box.add(full.project(point));
    }
  const float reach = static_cast<float>(options.rim_cap) * larger_side(full);
  box.x0 = std::max(0.f, box.x0 - reach), box.y0 = std::max(0.f, box.y0 - reach);
  box.x1 = std::min(static_cast<float>(full.width - 1), box.x1 + reach);
  box.y1 = std::min(static_cast<float>(full.height - 1), box.y1 + reach);
  if (box.empty())
    return;
  FrameView &view = views[t][c];
  view.contour =
      DistanceField(observation.contour, {box.x0, box.y0, box.x1, box.y1}, field_cell(full, options.field_size), reach);
  view.others = draw_others(*simulator, topology, frames[t], camera, box);
  view.seen = true;
}

/// What the captured cloth shows at frame t, after the images of this frame and of the one before have been kept.
void ObservedFrames::keep_captured(int t, bool starts, const MeshSequence &surface, const Observations &observations) {
  CapturedCloth cloth(*simulator, topology, options);
  const Vertices &now = surface.frames[t];
  const auto seen = [](const FrameView &view) { return view.seen; };
  if (options.delta > 0 && t % kEveryFrame == 0 && std::any_of(views[t].begin(), views[t].end(), seen))
    shapes[t] = CapturedShape(*simulator, topology, cameras, now);
  for (std::size_t c = 0; c < cameras.size(); ++c) {
    const ViewObservation &observed = observations.views[t][c];
    CapturedView &view = captured[t][c];
    view.rims.assign(regions(), 0);
    view.contour.first.assign(regions() + 1, 0);
    if (!starts)
      view.features = cloth.features(cameras[c], surface.frames[t - 1], views[t - 1][c].others, now, observed.matches);
    if (views[t][c].seen)
      view.rims = cloth.rims(cameras[c], now, views[t][c].others);
    if (views[t][c].seen && options.gamma > 0)
      view.contour = cloth.contour(cameras[c], now, views[t][c].others, observed.contour);
  }
}

/// What a region costs at most in a frame: a term is 0 where the captured cloth has nothing to compare a sample with.
FrameTerms ObservedFrames::worst_terms(int region, int t) const {
  double side = 0;
  for (const CoarseCamera &camera : cameras)
    side = std::max(side, static_cast<double>(larger_side(camera.camera)));
  FrameTerms result;
  for (const CapturedView &view : captured[t]) {
    result.rims += view.rims[region];
    result.points += view.contour.first[region + 1] - view.contour.first[region];
    for (int i = 0; i < view.features.count(); ++i)
      if (view.features.face[i] >= 0 && topology.face_region[view.features.face[i]] == region) {
        result.feature += view.features.largest[i];
        ++result.features;
      }
  }
  const double farthest_rim = std::pow(options.rim_cap * side, 2);
  result.feature = result.features > 0 ? result.feature / result.features : 0;
  result.silhouette = result.rims > 0 ? farthest_rim : 0;
  result.contour = result.points > 0 ? farthest_rim : 0;
  result.surface = shapes[t].has(region) ? farthest_rim : 0;
  if (!options.fixed_correspondences) { // every frame counts
    result.silhouette = farthest_rim;
    result.feature = std::max(result.feature, std::pow(options.feature_cap * side, 2));
  }
  return result;
}

std::size_t ObservedFrames::image_bytes() const {
  std::size_t bytes = 0;
  for (std::size_t t = 0; t < views.size(); ++t)
    for (std::size_t c = 0; c < cameras.size(); ++c)
      bytes += views[t][c].contour.bytes() + views[t][c].others.inverse_depth.size() * sizeof(float) +
               captured[t][c].features.bytes() + captured[t][c].contour.bytes();
  return bytes;
}

} // namespace doublet::fit
