#pragma once
// A second thread for work of a fraction of a millisecond, which waits for it: parallel_for() starts threads with every call.

#include <memory>

namespace doublet {

class HelperThread {
public:
  /// Where the machine gives no thread, run() does both parts one after the other.
  HelperThread();
  ~HelperThread();
  HelperThread(const HelperThread &) = delete;
  HelperThread &operator=(const HelperThread &) = delete;

  /// Calls here() on this thread and there() on the other, and returns when both are done. Rethrows what here() threw, else what
  /// there() threw. Allocates nothing. Not to be called from two threads at once.
  template <class Here, class There> void run(const Here &here, const There &there) {
    run_parts({[](const void *part) { (*static_cast<const Here *>(part))(); }, &here},
              {[](const void *part) { (*static_cast<const There *>(part))(); }, &there});
  }

private:
  struct Part {
    void (*call)(const void *);
    const void *what;
  };
  struct Thread;
  void run_parts(const Part &here, const Part &there);
  std::unique_ptr<Thread> thread_; ///< null = there is none
};

/// here() and there(), side by side if there is a helper.
template <class Here, class There> void run_both(HelperThread *helper, const Here &here, const There &there) {
  if (helper) {
    helper->run(here, there);
  } else {
    here();
    there();
  }
}

} // namespace doublet
