#pragma once

#include <string>

namespace doublet::detail {

/// Peak resident memory of a stretch of this process, from the construction on. Linux resets its high-water mark on request;
/// where it may not be reset the number is the peak since the process started, and scope() says so.
class PeakMemory {
public:
  PeakMemory();
  const char *scope() const { return of_stage_ ? "stage" : "process"; }
  double megabytes() const; ///< to a tenth

private:
  bool of_stage_ = false;
};

} // namespace doublet::detail
