#include "take_measurements.h"

#include "doublet/core/parts/fingerprint.h"
#include "feature_map.h"

#include <algorithm>
#include <system_error>
#include <utility>

namespace doublet::detail {
namespace {

/// Of the images and masks of all cameras.
std::uint64_t fingerprint(const std::vector<ViewMeasurement> &views) {
  Fingerprint print;
  for (const ViewMeasurement &view : views)
    print.bytes(&view.fingerprint, sizeof view.fingerprint);
  return print.value();
}

std::vector<FeatureMatch> swapped(std::vector<FeatureMatch> matches) {
  for (FeatureMatch &match : matches)
    std::swap(match.previous, match.current);
  return matches;
}

} // namespace

std::vector<Image> masks_of(const std::vector<ViewMeasurement> &views) {
  std::vector<Image> masks;
  for (const ViewMeasurement &view : views)
    masks.push_back(view.mask);
  return masks;
}

TakeMeasurements::TakeMeasurements(const TrackingJob &job, const TrackingOrder &order, CaptureResult &result)
    : job_(job), order_(order), result_(result), kept_(job.count), kept_joints_(job.count) {}

std::vector<ViewMeasurement> TakeMeasurements::look(int t, const FeatureTracker *tracker) {
  const Stopwatch watch(result_.summary.measure_seconds);
  if (ahead_.valid()) {
    std::vector<ViewMeasurement> ahead = ahead_.get();
    if (t == ahead_t_ && tracker == ahead_tracker_)
      return ahead;
  }
  return all_views(t, tracker);
}

std::vector<ViewMeasurement> TakeMeasurements::all_views(int t, const FeatureTracker *tracker) const {
  std::vector<ViewMeasurement> views(job_.rig.size());
  parallel_for(job_.context, job_.views(),
               [&](int v) { views[v] = measure_view(job_.frames, v, job_.frame(t), job_.rig[v], job_.extractor, tracker); });
  return views;
}

/// Parts of tracking keep one thread alone; the next frame is measured on the others meanwhile. What goes wrong there is thrown
/// when its turn has come.
void TakeMeasurements::look_ahead(int t, const FeatureTracker *tracker) {
  if (job_.context.thread_count() < 2 || t >= job_.count)
    return;
  ahead_t_ = t;
  ahead_tracker_ = tracker;
  try {
    ahead_ = std::async(std::launch::async, [this, t, tracker] { return all_views(t, tracker); });
  } catch (const std::system_error &) {
    // The machine gives no more threads: the frame is measured when its turn has come.
  }
}

void TakeMeasurements::measure(int t, TrackedFrame &found) {
  std::vector<ViewMeasurement> current = measure_next(t, job_.tracker());
  const auto has_image = [](const ViewMeasurement &view) { return view.has_image; };
  if (t == order_.start && job_.tracker() && std::none_of(current.begin(), current.end(), has_image))
    job_.context.log_line("capture: masks without images: silhouettes alone, no texture features");
  found.images = fingerprint(current);
  found.matches = match(t, current);
  keep(t, std::move(current), found.matches);
}

void TakeMeasurements::measure_again(int t, const TrackedFrame &found, bool with_features) {
  std::vector<ViewMeasurement> current = measure_next(t, with_features ? job_.tracker() : nullptr);
  if (fingerprint(current) != found.images)
    throw OtherCapture("was made from other images");
  keep(t, std::move(current), found.matches);
}

/// As look(). On the way back a stretch of frames is read at once, forwards: to go back in a video by one frame may be to decode
/// hundreds.
std::vector<ViewMeasurement> TakeMeasurements::measure_next(int t, const FeatureTracker *tracker) {
  constexpr int kStretch = 16; // frames
  if (t >= order_.start) {
    const bool known = t == order_.start && !start_views_.empty();
    std::vector<ViewMeasurement> views = known ? std::exchange(start_views_, {}) : look(t, tracker);
    look_ahead(t + 1, tracker);
    return views;
  }
  if (stretch_.empty() || stretch_tracker_ != tracker) {
    stretch_.clear();
    stretch_tracker_ = tracker;
    for (int s = std::max(0, t + 1 - kStretch); s <= t; ++s) {
      job_.context.throw_if_cancelled();
      stretch_.push_back(look(s, tracker));
    }
  }
  std::vector<ViewMeasurement> views = std::move(stretch_.back());
  stretch_.pop_back();
  return views;
}

/// [cameras] features of the frame before in this one.
std::vector<std::vector<FeatureMatch>> TakeMeasurements::match(int t, const std::vector<ViewMeasurement> &current) {
  const Stopwatch watch(result_.summary.measure_seconds);
  std::vector<std::vector<FeatureMatch>> matches(job_.rig.size());
  const double most = job_.options.features.max_displacement;
  if (job_.tracker() && t != order_.start)
    parallel_for(job_.context, job_.views(), [&](int v) {
      const Features &before = latest_[v].features, &here = current[v].features;
      for (const auto &[i, j] : checked_match(*job_.tracker(), before, here, most * current[v].height))
        matches[v].push_back({before.points[i], here.points[j]});
    });
  return matches;
}

/// What was measured becomes the latest frame, and is kept for the second pass.
void TakeMeasurements::keep(int t, std::vector<ViewMeasurement> current, const std::vector<std::vector<FeatureMatch>> &matches) {
  int present = 0;
  outlines_.resize(job_.rig.size());
  masks_.resize(job_.rig.size());
  for (int v = 0; v < job_.views(); ++v) {
    present += !current[v].outline.empty();
    result_.observations.views[t][v].contour = current[v].outline.points;
    observe(t, v, matches[v]);
    outlines_[v] = std::move(current[v].outline);
    masks_[v] = std::move(current[v].mask);
  }
  if (present == 0)
    throw Error("capture: no camera shows the actor at frame " + std::to_string(job_.frame(t)));
  joints_ = kept_joints_[t] = seen_joints(current, job_.rig);
  latest_ = std::move(current);
  result_.summary.views[t] = present;
  kept_[t] = pack(masks_);
}

/// Observations are matches of a frame with the one that was filmed before it, whichever was tracked first.
void TakeMeasurements::observe(int t, int view, const std::vector<FeatureMatch> &matches) {
  if (t >= order_.start)
    result_.observations.views[t][view].matches = matches;
  else
    result_.observations.views[t + 1][view].matches = swapped(matches);
}

std::vector<FeatureMatch> TakeMeasurements::matches_at(int t, int view) const {
  const auto &views = result_.observations.views;
  return t >= order_.start ? views[t][view].matches : swapped(views[t + 1][view].matches);
}

void TakeMeasurements::recall(int t) {
  masks_ = unpack(kept_[t]);
  outlines_ = traced(masks_);
  joints_ = kept_joints_[t];
}

std::vector<Outline> TakeMeasurements::outlines_at(int t) const {
  return traced(unpack(kept_[t]));
}

std::vector<Outline> TakeMeasurements::traced(const std::vector<Image> &masks) const {
  std::vector<Outline> outlines(masks.size());
  parallel_for(job_.context, job_.views(), [&](int v) { outlines[v] = trace_outline(masks[v]); });
  return outlines;
}

} // namespace doublet::detail
