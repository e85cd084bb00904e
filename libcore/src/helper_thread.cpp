#include "doublet/core/parts/helper_thread.h"

#include <atomic>
#include <exception>
#include <system_error>
#include <thread>
#include <utility>

namespace doublet {

struct HelperThread::Thread {
  enum State { Idle, Given, Ended };
  std::atomic<int> state{Idle};
  Part part{};
  std::exception_ptr error;
  std::thread thread{[this] { work(); }}; // the last: it reads the others

  ~Thread() {
    give(Ended);
    thread.join();
  }
  void give(State to) {
    state = to;
    state.notify_one();
  }
  void work() {
    for (;;) {
      state.wait(Idle);
      if (state == Ended)
        return;
      try {
        part.call(part.what);
      } catch (...) {
        error = std::current_exception();
      }
      give(Idle);
    }
  }
  /// What the part threw, or null.
  std::exception_ptr done() {
    state.wait(Given);
    return std::exchange(error, nullptr);
  }
};

HelperThread::HelperThread() {
  try {
    thread_ = std::make_unique<Thread>();
  } catch (const std::system_error &) { // the machine gives no more threads
  }
}
HelperThread::~HelperThread() = default;

void HelperThread::run_parts(const Part &here, const Part &there) {
  if (!thread_) {
    here.call(here.what);
    there.call(there.what);
    return;
  }
  thread_->part = there;
  thread_->give(Thread::Given);
  try {
    here.call(here.what);
  } catch (...) {
    thread_->done(); // it uses what belongs to the caller
    throw;
  }
  if (const std::exception_ptr error = thread_->done())
    std::rethrow_exception(error);
}

} // namespace doublet
