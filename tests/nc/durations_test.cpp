#include "nc/durations.h"

#include <gtest/gtest.h>

#include "tests/support/nc_program.h"

namespace camber::nc {
namespace {

std::string refusal(const std::string& text) {
  try {
    tests::interpreted(text);
  } catch (const InputError& e) {
    return e.what();
  }
  return {};
}

TEST(Durations, RefusesAFeedThatNeedsDays) {
  EXPECT_EQ(refusal("G21 G90 G94\nG0 X0 Y0 Z0\nG1 X1000 F0.0001\nM30\n"),
            "test.nc:3:1: error: 1000 mm at 0.0001 mm/min take 1.67e+05 h; a feed that needs a day (24 h) at most was "
            "expected [block-time]\n    G1 X1000 F0.0001\n    ^");
}

TEST(Durations, RefusesADwellOfDays) {
  EXPECT_EQ(refusal("G21 G90 G94\nG4 P1e12\nM30\n").find("test.nc:2:"), 0u);
  EXPECT_EQ(refusal("G21 G90 G94\nG4 P100000.\nM30\n"),
            "test.nc:2:1: error: a dwell of 100000 s; a day (86400 s) at most was expected [block-time]\n"
            "    G4 P100000.\n    ^");
}

TEST(Durations, SaysTheSameOnce) {
  const std::string message = refusal("G21 G90 G94\nG1 X1000 F0.0001\nX0\nX1000\nM30\n");
  EXPECT_EQ(message.find("[block-time]"), message.rfind("[block-time]"));
  EXPECT_NE(message.find("(and 2 more like it)"), std::string::npos) << message;
}

TEST(Durations, ADayMayBe) {
  EXPECT_EQ(refusal("G21 G90 G94\nG4 P86400\nG1 X1440 F1\nM30\n"), "");
  const Interpretation moves = tests::interpreted("G21 G90 G94\nG0 X5\nG4 P2\nG1 X65 F120\nG2 X65 Y0 I-10 J0\nM30\n");
  EXPECT_NEAR(programmed_time_s(moves), 2 + 30 + 2 * kPi * 10 / 2, 1e-9);
}

}  // namespace
}  // namespace camber::nc
