// libcore's loop over indices on the one thread that a page has.

#include "doublet/core/context.h"

namespace doublet {

void parallel_for(const Context &, int count, const std::function<void(int)> &body) {
  for (int i = 0; i < count; ++i)
    body(i);
}

void Context::report_progress(const std::string &, double) const {}

void Context::log_line(const std::string &line) const {
  if (log)
    log(line);
}

} // namespace doublet
