#pragma once
// Where the time of an objective goes.

#include "doublet/fit/material_objective.h"

#include <ctime>
#include <mutex>

namespace doublet::fit {

inline double thread_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

/// The CPU time of this thread, sorted by what it was spent on.
class Stopwatch {
public:
  /// Adds the time since the last call, or since the start, to `part`.
  void lap(double EnergyTimes::*part) {
    const double now = thread_seconds();
    times_.*part += now - last_;
    last_ = now;
  }
  const EnergyTimes &times() const { return times_; }

private:
  EnergyTimes times_;
  double last_ = thread_seconds();
};

/// Of all threads.
class CpuTimes {
public:
  void add(const Stopwatch &watch) {
    const std::lock_guard lock(mutex_);
    for (double EnergyTimes::*part : {&EnergyTimes::set_up, &EnergyTimes::simulate, &EnergyTimes::project, &EnergyTimes::rims,
                                      &EnergyTimes::contour, &EnergyTimes::features, &EnergyTimes::surface})
      times_.*part += watch.times().*part;
  }
  EnergyTimes times() const {
    const std::lock_guard lock(mutex_);
    return times_;
  }

private:
  mutable std::mutex mutex_;
  EnergyTimes times_;
};

} // namespace doublet::fit
