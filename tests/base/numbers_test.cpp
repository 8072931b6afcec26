#include "base/numbers.h"

#include <gtest/gtest.h>

namespace camber {
namespace {

TEST(Numbers, ReadTheFormsThatNcProgramsAndTracesUse) {
  EXPECT_EQ(parse_number("1."), 1.0);
  EXPECT_EQ(parse_number("-.5"), -0.5);
  EXPECT_EQ(parse_number("+2.25"), 2.25);
  EXPECT_EQ(parse_number("1e-3"), 1e-3);
}

TEST(Numbers, RefuseWhatIsNotOneFiniteNumber) {
  for (const char* text : {"", "-", ".", "nan", "inf", "0x10", "1 ", " 1", "1,5", "+-1", "1e999", "--1"})
    EXPECT_FALSE(parse_number(text).has_value()) << text;
}

TEST(Numbers, AreWrittenWithoutTrailingZerosOrMinusZero) {
  EXPECT_EQ(format_trimmed(1.5, 4), "1.5");
  EXPECT_EQ(format_trimmed(-0.00001, 4), "0");
  EXPECT_EQ(format_trimmed(200.0, 3), "200");
}

}  // namespace
}  // namespace camber
