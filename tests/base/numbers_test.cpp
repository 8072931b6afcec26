#include "base/numbers.h"

#include <array>
#include <charconv>
#include <cmath>
#include <random>

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

// Every value as the standard library writes it, those too whose last digit is hard to tell.
TEST(Numbers, CellsAreWhatTheStandardLibraryWrites) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> near_zero(-2, 2), power(-9, 12);
  for (int n = 0; n < 200000; ++n) {
    const int decimals = n % 8;
    double value = near_zero(random) * std::pow(10, power(random));
    if (n % 3 == 0) value = (std::floor(value) + 0.5) * std::pow(10, -decimals);
    if (n % 5 == 0) value = std::nextafter(value, 0);
    std::array<char, 400> expected{};
    const auto end = std::to_chars(expected.begin(), expected.end(), value, std::chars_format::fixed, decimals).ptr;
    *end = ',';
    std::string row;
    append_cells(row, decimals, {value});
    ASSERT_EQ(row, std::string(expected.begin(), end + 1)) << value;
  }
}

}  // namespace
}  // namespace camber
