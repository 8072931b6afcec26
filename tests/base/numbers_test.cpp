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

TEST(Numbers, CellsAreRoundedCorrectlyAndEndWithCommas) {
  std::string row = "N1,";
  append_cells(row, 3, {0.0005, -0.0625, 1234567.0, -0.0});
  append_cells(row, 0, {2.5, 3.5, 99999.7});
  append_cells(row, 1, {1e300});
  EXPECT_EQ(row.substr(0, 55), "N1,0.001,-0.062,1234567.000,-0.000,2,4,100000,100000000");
  EXPECT_EQ(row.size(), 46u + 301 + 3);
  EXPECT_TRUE(row.ends_with(".0,")) << row;
}

}  // namespace
}  // namespace camber
