#include "doublet/core/error.h"

#include <gtest/gtest.h>

#include <type_traits>

namespace doublet {
namespace {

// Who goes on without a file (catch (const Error &)) does not go on after Ctrl-C.
static_assert(!std::is_base_of_v<Error, Cancelled>);

TEST(ErrorTest, WhatIsLongLosesItsMiddleAndNotTheNameOfTheFile) {
  const std::string path = std::string(300, 'p') + ".json";
  const std::string said = Error(path + ": expected JSON, found '" + std::string(100000, 'x') + "' at the end").what();
  EXPECT_TRUE(said.starts_with(path + ": expected JSON, found 'xxx"));
  EXPECT_TRUE(said.ends_with("xxx' at the end"));
  EXPECT_LT(said.size(), path.size() + 420);
  const std::string whole = path + ": expected one, found two";
  EXPECT_EQ(Error(whole).what(), whole);
}

TEST(ErrorTest, NoCharacterIsCutInTwo) {
  for (int before = 0; before < 4; ++before) {
    std::string text(static_cast<std::size_t>(before), 'a');
    for (int i = 0; i < 500; ++i)
      text += "\u20ac";
    const std::string said = Error(text).what();
    EXPECT_LT(said.size(), 420u);
    EXPECT_EQ(Error(said).what(), said) << "what is not valid UTF-8 would become '?'";
  }
}

} // namespace
} // namespace doublet
