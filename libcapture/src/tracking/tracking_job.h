#pragma once
// What a run through the frames is given, and the order that it takes them in.

#include "doublet/capture/performance_capture.h"
#include "doublet/core/error.h"

#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <string>

namespace doublet::detail {

/// Of one call of PerformanceCapture::capture(), and no longer.
struct TrackingJob {
  const CaptureOptions &options;
  const CaptureParts &parts;
  const RiggedMesh &actor;
  const CameraRig &rig;
  FrameSource &frames;
  const SilhouetteExtractor *extractor;
  int count; ///< frames
  const Context &context;

  int views() const { return static_cast<int>(rig.size()); }
  /// The video frame of a frame index.
  int frame(int t) const { return options.first_frame + t; }
  /// null: no features are looked for.
  const FeatureTracker *tracker() const { return options.use_sift ? parts.features.get() : nullptr; }
  template <class... Values> void say(const char *format, Values... values) const {
    char line[200];
    std::snprintf(line, sizeof line, format, values...);
    context.log_line(std::string("capture: ") + line);
  }
};

/// Tracking goes from the start to the last frame, then from the start back to the first: "before" is one frame nearer to the
/// start. A take that begins in the scan's pose starts at its first frame.
struct TrackingOrder {
  int count = 0;
  int start = 0;      ///< frame index at which tracking begins
  bool again = false; ///< in the second pass

  /// The frame index that a step is about.
  int at(int step) const {
    const int k = step % count;
    return k < count - start ? start + k : count - 1 - k;
  }
  /// How many frames lie between this one and the start.
  int age(int t) const { return std::abs(t - start); }
  /// `n` frames nearer to the start.
  int before(int t, int n) const { return t < start ? t + n : t - n; }
};

/// The frames of a checkpoint are not those of this capture.
struct OtherCapture : Error {
  using Error::Error;
};

inline double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Adds the seconds of its life to a sum.
class Stopwatch {
public:
  explicit Stopwatch(double &sum) : sum_(sum), start_(now()) {}
  ~Stopwatch() { sum_ += now() - start_; }
  Stopwatch(const Stopwatch &) = delete;
  Stopwatch &operator=(const Stopwatch &) = delete;

private:
  double &sum_, start_;
};

} // namespace doublet::detail
