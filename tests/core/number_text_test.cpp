#include "doublet/core/parts/number_text.h"

#include <gtest/gtest.h>

#include <cmath>

namespace doublet {

TEST(NumberText, TheWholeTextIsANumberOrThereIsNone) {
  EXPECT_EQ(parse_number("-12.5e-1"), -1.25);
  EXPECT_EQ(parse_number("+7"), 7);
  EXPECT_TRUE(std::isnan(parse_number("nan").value()));
  for (const char *text : {"", "+", "+-7", "7 ", " 7", "7,5", "7m", "0x10", "1e999", "1e-999"})
    EXPECT_FALSE(parse_number(text)) << text;
}

TEST(NumberText, DecimalsAreThoseAskedFor) {
  EXPECT_EQ(fixed_point(-1.0 / 3, 6), "-0.333333");
  EXPECT_EQ(fixed_point(1e300, 0).size(), 301u);
}

} // namespace doublet
