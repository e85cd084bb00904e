#include "doublet/core/parts/helper_thread.h"
#include "support/no_threads.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <thread>

using namespace doublet;

TEST(HelperThread, DoesBothPartsSideBySide) {
  HelperThread helper;
  for (int i = 0; i < 1000; ++i) {
    std::atomic<bool> here{false}, there{false};
    helper.run(
        [&] {
          here = true;
          while (!there) // ends only if the other part runs meanwhile
            std::this_thread::yield();
        },
        [&] {
          there = true;
          while (!here)
            std::this_thread::yield();
        });
    ASSERT_TRUE(here && there);
  }
}

TEST(HelperThread, IsAnotherThreadAndAlwaysTheSame) {
  HelperThread helper;
  std::thread::id first, second;
  helper.run([] {}, [&] { first = std::this_thread::get_id(); });
  helper.run([] {}, [&] { second = std::this_thread::get_id(); });
  EXPECT_NE(first, std::this_thread::get_id());
  EXPECT_EQ(first, second);
}

TEST(HelperThread, RethrowsWhenBothAreDone) {
  HelperThread helper;
  std::atomic<bool> done{false};
  const auto fail = [](const char *what) { throw std::runtime_error(what); };
  const auto slow = [&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    done = true;
  };
  EXPECT_THROW(helper.run([&] { fail("here"); }, slow), std::runtime_error);
  EXPECT_TRUE(done);
  done = false;
  EXPECT_THROW(helper.run(slow, [&] { fail("there"); }), std::runtime_error);
  EXPECT_TRUE(done);
  done = false;
  helper.run([] {}, slow); // as if nothing had happened
  EXPECT_TRUE(done);
  try {
    helper.run([&] { fail("here"); }, [&] { fail("there"); });
    FAIL();
  } catch (const std::runtime_error &error) {
    EXPECT_STREQ(error.what(), "here");
  }
}

TEST(HelperThread, ManagesWithoutAThread) {
  const NoThreads none;
  HelperThread helper;
  int parts = 0;
  helper.run([&] { ++parts; }, [&] { ++parts; });
  run_both(
      nullptr, [&] { ++parts; }, [&] { ++parts; });
  EXPECT_EQ(parts, 4);
}
