#pragma once
// What a stage gets from its caller: callbacks for progress, cancellation and log, and the number of threads. No globals.

#include <functional>
#include <string>
#include <utility>

namespace doublet {

struct Context {
  /// Called with (stage name, fraction in [0, 1]); may be empty. Only ever called from the thread that called the stage.
  std::function<void(const std::string &, double)> progress;
  /// Polled often from the calling thread; returning true makes the stage throw Cancelled. May be empty.
  std::function<bool()> cancelled;
  /// One line for the user, without newline; may be empty.
  std::function<void(const std::string &)> log;
  /// Number of threads, 0 = one per core. Results do not depend on it.
  int threads = 0;

  /// Reports progress and throws Cancelled if the user asked to stop.
  void report_progress(const std::string &stage, double fraction) const;
  void log_line(const std::string &line) const;
  void throw_if_cancelled() const;
  int thread_count() const;
  template <class... A> [[deprecated("use log_line")]] decltype(auto) say(A &&...a) const {
    return log_line(std::forward<A>(a)...);
  }
  template <class... A> [[deprecated("use report_progress")]] decltype(auto) report(A &&...a) const {
    return report_progress(std::forward<A>(a)...);
  }
  template <class... A> [[deprecated("use throw_if_cancelled")]] decltype(auto) check_cancelled(A &&...a) const {
    return throw_if_cancelled(std::forward<A>(a)...);
  }
};

/// Runs body(i) for i in [0, count) on context.thread_count() threads; the order is unspecified, so body(i) may only write what
/// belongs to i. Rethrows the exception of the lowest i that threw. Does not poll cancellation inside; call in chunks for that.
void parallel_for(const Context &context, int count, const std::function<void(int)> &body);

} // namespace doublet
