#include "peak_memory.h"

#include <sys/resource.h>

#include <cmath>
#include <fstream>

namespace doublet::detail {

PeakMemory::PeakMemory() {
  std::ofstream reset("/proc/self/clear_refs");
  reset << "5" << std::flush;
  of_stage_ = reset.good();
}

double PeakMemory::megabytes() const {
  double kilobytes = 0;
  if (of_stage_) {
    std::ifstream status("/proc/self/status");
    for (std::string word; status >> word;)
      if (word == "VmHWM:")
        status >> kilobytes;
  }
  if (kilobytes == 0) {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    kilobytes = static_cast<double>(usage.ru_maxrss);
  }
  return std::round(10 * kilobytes / 1024) / 10;
}

} // namespace doublet::detail
