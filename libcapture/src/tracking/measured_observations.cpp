#include "doublet/capture/measured_observations.h"

#include "feature_map.h"
#include "view_measurement.h"

#include "doublet/core/error.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>

namespace doublet {
namespace {

void require_numbers(const std::vector<int> &numbers, int frame_count) {
  if (numbers.empty() || !std::is_sorted(numbers.begin(), numbers.end(), std::less_equal<>()) || numbers.front() < 0 ||
      numbers.back() >= frame_count)
    throw std::invalid_argument("measure_observations: expected rising numbers of the " + std::to_string(frame_count) +
                                " frames of the film");
}

std::vector<FeatureMatch> matches_of(const FeatureTracker &tracker, const ViewMeasurement &before, const ViewMeasurement &here,
                                     double max_displacement) {
  std::vector<FeatureMatch> matches;
  for (const auto &[i, j] : checked_match(tracker, before.features, here.features, max_displacement * here.height))
    matches.push_back({before.features.points[i], here.features.points[j]});
  return matches;
}

} // namespace

Observations measure_observations(const CameraRig &rig, FrameSource &frames, const SilhouetteExtractor *extractor,
                                  std::vector<int> numbers, const FeatureTracker *tracker, const FeatureTrackerOptions &options,
                                  const Context &context) {
  options.validate();
  const int views = static_cast<int>(rig.size());
  if (views != frames.camera_count())
    throw std::invalid_argument("measure_observations: the rig has " + std::to_string(views) + " cameras, the film " +
                                std::to_string(frames.camera_count()));
  if (numbers.empty()) {
    numbers.resize(frames.frame_count());
    std::iota(numbers.begin(), numbers.end(), 0);
  }
  require_numbers(numbers, frames.frame_count());
  Observations found{rig, numbers, {}};
  std::vector<ViewMeasurement> before;
  for (std::size_t t = 0; t < numbers.size(); ++t) {
    context.throw_if_cancelled();
    context.report_progress("observations", static_cast<double>(t) / static_cast<double>(numbers.size()));
    std::vector<ViewMeasurement> here(views);
    std::vector<ViewObservation> seen(views);
    parallel_for(context, views, [&](int v) {
      here[v] = measure_view(frames, v, numbers[t], rig[v], extractor, tracker);
      seen[v].contour = here[v].outline.points;
      if (tracker && t > 0)
        seen[v].matches = matches_of(*tracker, before[v], here[v], options.max_displacement);
    });
    if (std::all_of(seen.begin(), seen.end(), [](const ViewObservation &view) { return view.contour.empty(); }))
      throw Error("observations: no camera shows the actor at frame " + std::to_string(numbers[t]));
    found.views.push_back(std::move(seen));
    before = std::move(here);
  }
  return found;
}

} // namespace doublet
