#include "../../libcapture/src/frames/file_memo.h"
#include "support/temp_folder.h"

#include <chrono>
#include <fstream>
#include <gtest/gtest.h>
#include <stdexcept>

namespace doublet::detail {
namespace file_memo_test {

TEST(FileMemo, AsksOnceWhileAFileStaysAsItIs) {
  const testing::TempFolder folder;
  const std::filesystem::path file = folder / "a";
  FileMemo<int> memo;
  int asked = 0;
  const auto answer = [&](const std::string &question) { return memo.of(file, question, [&] { return ++asked; }); };
  std::ofstream(file) << "one";
  EXPECT_EQ(answer("x"), 1);
  EXPECT_EQ(answer("x"), 1);
  EXPECT_EQ(answer("y"), 2);
  EXPECT_EQ(answer("x"), 1);
  const auto then = std::filesystem::last_write_time(file);
  std::ofstream(file) << "three";
  std::filesystem::last_write_time(file, then);
  EXPECT_EQ(answer("x"), 3) << "another size";
  std::filesystem::last_write_time(file, then + std::chrono::seconds(1));
  EXPECT_EQ(answer("x"), 4) << "another time";
}

TEST(FileMemo, WhatIsThrownIsNotKept) {
  FileMemo<int> memo;
  EXPECT_THROW(memo.of("nowhere", "x", []() -> int { throw std::runtime_error("no file"); }), std::runtime_error);
  EXPECT_EQ(memo.of("nowhere", "x", [] { return 7; }), 7);
}

} // namespace file_memo_test
} // namespace doublet::detail
