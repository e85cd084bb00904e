#include "doublet/core/context.h"

#include "doublet/core/error.h"
#include "support/no_threads.h"

#include <gtest/gtest.h>

#include <atomic>
#include <numeric>
#include <stdexcept>
#include <system_error>
#include <thread>
#include <vector>

namespace doublet {

TEST(Context, ParallelForVisitsEveryIndexOnce) {
  for (const int threads : {1, 2, 7}) {
    Context context;
    context.threads = threads;
    std::vector<int> visits(10007, 0);
    parallel_for(context, static_cast<int>(visits.size()), [&](int i) { ++visits[i]; });
    EXPECT_EQ(visits, std::vector<int>(visits.size(), 1));
  }
  parallel_for(Context{}, 0, [](int) { FAIL(); });
  parallel_for(Context{}, -5, [](int) { FAIL(); });
}

TEST(Context, ParallelForRethrowsTheExceptionOfTheLowestIndex) {
  Context context;
  context.threads = 4;
  for (int repeat = 0; repeat < 50; ++repeat) {
    try {
      parallel_for(context, 1000, [](int i) {
        if (i % 100 == 37)
          throw Error(std::to_string(i));
      });
      FAIL();
    } catch (const Error &error) {
      EXPECT_STREQ(error.what(), "37");
    }
  }
}

TEST(Context, ParallelForDoesWithTheThreadsThereAre) {
  const NoThreads none;
  EXPECT_THROW(std::thread([] {}).join(), std::system_error);
  Context context;
  context.threads = 7;
  std::vector<int> visits(1000, 0);
  parallel_for(context, static_cast<int>(visits.size()), [&](int i) { ++visits[i]; });
  EXPECT_EQ(visits, std::vector<int>(visits.size(), 1));
}

TEST(Context, ReportsProgressAndStops) {
  Context context;
  std::vector<double> seen;
  bool stop = false;
  context.progress = [&](const std::string &stage, double f) {
    EXPECT_EQ(stage, "stage");
    seen.push_back(f);
  };
  context.cancelled = [&] { return stop; };
  context.report_progress("stage", 0.25);
  context.report_progress("stage", 7);
  stop = true;
  EXPECT_THROW(context.report_progress("stage", 0.5), Cancelled);
  EXPECT_EQ(seen, (std::vector<double>{0.25, 1, 0.5}));
  EXPECT_NO_THROW(Context{}.report_progress("stage", 0.1)); // nobody listens
  Context{}.log_line("nobody listens");
  EXPECT_GE(Context{}.thread_count(), 1);
}

TEST(Context, WhoGoesOnAfterAnErrorDoesNotGoOnAfterCtrlC) {
  Context context;
  context.cancelled = [] { return true; };
  const auto tolerant = [&] {
    try {
      context.throw_if_cancelled();
    } catch (const std::runtime_error &) { // and so Error
    }
  };
  EXPECT_THROW(tolerant(), Cancelled);
  EXPECT_STREQ(Cancelled().what(), "cancelled");
}

} // namespace doublet
