#include "compensate/trial.h"

#include <gtest/gtest.h>

namespace camber::compensate {
namespace {

std::pair<int, int> decimals(const std::string& text, std::optional<double> least_increment_mm = {}) {
  Diagnostics diagnostics;
  machine::Control control;
  control.least_increment_mm = least_increment_mm;
  const nc::EmitOptions o = decimals_for(control, nc::read_program(SourceText("p.nc", text), diagnostics));
  return {o.decimals_mm, o.decimals_inch};
}

TEST(Trial, EmitsAsManyDecimalsAsTheProgramOrTheControlHas) {
  EXPECT_EQ(decimals("G1 X1.5 Y2.125 Z3\nI.12345\n"), std::pair(3, 4));
  EXPECT_EQ(decimals("G1 X10 Y-5\n"), std::pair(3, 4));
  EXPECT_EQ(decimals("G1 X1.1250 Y2.\n"), std::pair(4, 4));
  EXPECT_EQ(decimals("G1 X1.125001 Y2.\n"), std::pair(4, 5));
  EXPECT_EQ(decimals("G1 X1.125 Y2.\n", 0.0001), std::pair(4, 5));
  EXPECT_EQ(decimals("G1 X1.12345 Y2.\n", 0.001), std::pair(3, 4));
  EXPECT_EQ(decimals("G1 X1.12345 Y2.\n", 0.01), std::pair(2, 3));
}

}  // namespace
}  // namespace camber::compensate
