#include "doublet/core/context.h"

#include "doublet/core/error.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <limits>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace doublet {

void Context::report_progress(const std::string &stage, double fraction) const {
  if (progress)
    progress(stage, std::clamp(fraction, 0.0, 1.0));
  throw_if_cancelled();
}

void Context::log_line(const std::string &line) const {
  if (log)
    log(line);
}

void Context::throw_if_cancelled() const {
  if (cancelled && cancelled())
    throw Cancelled();
}

int Context::thread_count() const {
  if (threads > 0)
    return threads;
  return std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

namespace {

/// Hands out runs of indices in rising order, so that when i throws every lower index has been handed out and will be finished.
class IndexQueue {
public:
  IndexQueue(int count, int workers, const std::function<void(int)> &body)
      : count_(count), chunk_(std::max(1, count / (workers * 64))), body_(body) {}

  void work() {
    while (!stop_) {
      const std::int64_t begin = next_.fetch_add(chunk_);
      if (begin >= count_)
        return;
      run(static_cast<int>(begin), static_cast<int>(std::min<std::int64_t>(begin + chunk_, count_)));
    }
  }

  void rethrow() const {
    if (error_)
      std::rethrow_exception(error_);
  }

private:
  void run(int begin, int end) {
    int i = begin;
    try {
      for (; i < end; ++i)
        body_(i);
    } catch (...) {
      stop_ = true;
      const std::lock_guard<std::mutex> lock(mutex_);
      if (i < error_index_) {
        error_index_ = i;
        error_ = std::current_exception();
      }
    }
  }

  int count_, chunk_;
  const std::function<void(int)> &body_;
  std::atomic<std::int64_t> next_{0};
  std::atomic<bool> stop_{false};
  std::mutex mutex_;
  int error_index_ = std::numeric_limits<int>::max();
  std::exception_ptr error_;
};

} // namespace

void parallel_for(const Context &context, int count, const std::function<void(int)> &body) {
  if (count <= 0)
    return;
  const int workers = std::min(context.thread_count(), count);
  IndexQueue queue(count, workers, body);
  {
    std::vector<std::jthread> threads;
    try {
      for (int w = 1; w < workers; ++w)
        threads.emplace_back([&queue] { queue.work(); });
    } catch (const std::system_error &) {
      // The machine gives no more threads: those there are do the work, with the same result.
    }
    queue.work();
  }
  queue.rethrow();
}

} // namespace doublet
