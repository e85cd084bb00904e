#include "surface_tracks.h"

#include "shown_surface.h"

#include <utility>

namespace doublet::detail {
namespace {

void append(const std::vector<std::vector<SurfaceTrack>> &of_views, std::vector<SurfaceTrack> &all) {
  for (const std::vector<SurfaceTrack> &part : of_views)
    all.insert(all.end(), part.begin(), part.end());
}

} // namespace

SurfaceTracks::SurfaceTracks(const TrackingJob &job, const TrackingOrder &order, const TakeMeasurements &measured,
                             CaptureSummary &summary)
    : job_(job), order_(order), measured_(measured), summary_(summary), mapped_(job.count) {}

void SurfaceTracks::lift(int t) {
  const Stopwatch watch(summary_.map_seconds);
  std::vector<std::vector<SurfaceTrack>> tracks(job_.rig.size());
  const ShownSurface shown(surface_, timing_);
  if (t != order_.start)
    parallel_for(job_.context, job_.views(), [&](int v) {
      tracks[v] = lift_matches(measured_.matches_at(t, v), v, shown.in(v), job_.actor, job_.rig[v], visible_[v]);
    });
  lifted_.clear();
  append(tracks, lifted_);
}

std::vector<SurfaceTrack> SurfaceTracks::find(const Eigen::VectorXd &dofs, const Vertices &offset, int t) {
  const Stopwatch watch(summary_.map_seconds);
  std::vector<SurfaceTrack> all = lifted_;
  if (order_.again)
    all.insert(all.end(), mapped_[t].begin(), mapped_[t].end());
  if (order_.again || map_.size() == 0)
    return all;
  const PosedSurface expected = pose_surface(job_.actor, dofs, offset);
  std::vector<std::vector<SurfaceTrack>> found(job_.rig.size());
  parallel_for(job_.context, job_.views(), [&](int v) {
    const ViewMeasurement &view = measured_.latest()[v];
    found[v] = map_.find(view.features, *job_.parts.features, job_.actor, expected, v, job_.rig[v],
                         job_.options.map_search_radius * view.height);
  });
  append(found, all);
  return all;
}

std::vector<SurfaceTrack> SurfaceTracks::mapped(const std::vector<SurfaceTrack> &found) const {
  return {found.begin() + static_cast<long>(lifted_.size()), found.end()};
}

double SurfaceTracks::take(const Vertices &surface, const ViewTiming &timing) {
  surface_ = surface;
  timing_ = timing;
  const ShownSurface shown(surface_, timing_);
  visible_.resize(job_.rig.size());
  std::vector<double> overlap(job_.rig.size(), -1);
  parallel_for(job_.context, job_.views(), [&](int v) {
    visible_[v] = rasterize(shown.in(v), job_.actor.mesh.faces, job_.rig[v]);
    if (!measured_.outlines()[v].empty())
      overlap[v] = mask_iou(silhouette(visible_[v]), measured_.masks()[v]);
  });
  double sum = 0, count = 0;
  for (double o : overlap)
    if (o >= 0) {
      sum += o;
      count += 1;
    }
  return sum / count;
}

void SurfaceTracks::map(const Transforms &blend) {
  for (size_t v = 0; v < job_.rig.size(); ++v)
    map_.add(measured_.latest()[v].features, job_.actor, {blend, surface_}, job_.rig[v], visible_[v]);
}

void SurfaceTracks::go_back_to(Vertices surface, std::vector<FaceBuffer> visible) {
  surface_ = std::move(surface);
  timing_ = {}; // where tracking begins nothing moves yet, as far as is known
  visible_ = std::move(visible);
}

} // namespace doublet::detail
