#pragma once
// What a stage is told about its surroundings: progress, cancellation, threads, log. One object, passed in; no globals.

#include <functional>
#include <string>

namespace doublet {

struct Context {
  /// Called with (stage name, fraction in [0, 1]); may be empty. Only ever called from the thread that called the stage.
  std::function<void(const std::string &, double)> progress;
  /// Polled often from the calling thread; returning true makes the stage throw Cancelled. May be empty.
  std::function<bool()> cancelled;
  /// One line for the user, without newline; may be empty.
  std::function<void(const std::string &)> log;
  /// Worker threads, 0 = one a core. Results do not depend on it.
  int threads = 0;

  /// Reports progress and throws Cancelled if the user asked to stop.
  void report(const std::string &stage, double fraction) const;
  void say(const std::string &line) const;
  void check_cancelled() const;
  int thread_count() const;
};

/// Runs body(i) for i in [0, count) on context.thread_count() threads; the order is unspecified, so body(i) may only write what
/// belongs to i. Rethrows the exception of the lowest i that threw. Does not poll cancellation inside; call in chunks for that.
void parallel_for(const Context &context, int count, const std::function<void(int)> &body);

} // namespace doublet
