// libcore's loop over indices, and its helper, on the one thread that a page has.

#include "doublet/core/context.h"
#include "doublet/core/parts/helper_thread.h"

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

struct HelperThread::Thread {};
HelperThread::HelperThread() = default;
HelperThread::~HelperThread() = default;

void HelperThread::run_parts(const Part &here, const Part &there) {
  here.call(here.what);
  there.call(there.what);
}

} // namespace doublet
