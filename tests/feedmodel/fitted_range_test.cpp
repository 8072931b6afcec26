#include "feedmodel/fitted_range.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "feedmodel/motion_plan.h"
#include "tests/support/test_program.h"

namespace camber::feedmodel {
namespace {

machine::Machine fitted_on(const nc::Interpretation& program) {
  machine::Machine m;
  m.fitted_range = range_of({&program});
  return m;
}

std::vector<std::string> warnings(const nc::Interpretation& program, const machine::Machine& machine) {
  Diagnostics diagnostics;
  check_range(program, "p.nc", machine, diagnostics);
  std::vector<std::string> texts;
  for (const Diagnostic& d : diagnostics.all()) texts.push_back(to_string(d));
  return texts;
}

nc::Interpretation square() {
  tests::TestProgram p;
  return p.line(10, 0, 0, 1000).line(10, 10, 0, 1000).line(0, 10, 0, 1000).line(0, 0, 0, 1000).program;
}

TEST(FittedRange, HoldsWhatTheProgramsHeld) {
  tests::TestProgram p;
  const auto program =
      p.line(10, 0, 0, 500).line(10, 2, 0, 1000).arc_xy(10, 6, 10, 4, kPi, 1000).rapid(0, 0, 0).program;
  const machine::FittedRange r = range_of({&program});
  EXPECT_TRUE(r.known);
  EXPECT_NEAR(r.feed_mm_per_s[1], 1000 / 60.0, 1e-12);
  EXPECT_NEAR(r.corner_rad[1], kPi / 2, 1e-9);
  EXPECT_NEAR(r.line_mm[0], 2, 1e-12);
  EXPECT_NEAR(r.arc_radius_mm[0], 2, 1e-9);
  EXPECT_EQ(r.axis, (std::array<bool, 3>{true, true, false}));
}

TEST(FittedRange, IsSilentWithinItAndWithoutOne) {
  EXPECT_TRUE(warnings(square(), fitted_on(square())).empty());
  EXPECT_TRUE(warnings(square(), machine::Machine{}).empty());
}

TEST(FittedRange, NamesBlocksAndShareOfWhatLeavesIt) {
  tests::TestProgram p;
  p.line(10, 0, 0, 1000).line(0, 0, 0, 1000).line(0, 0, 20, 3000).arc_xy(0, 0, 1, 0, 2 * kPi, 1000);
  const auto texts = warnings(p.program, fitted_on(square()));
  ASSERT_EQ(texts.size(), 4u);
  EXPECT_EQ(texts[0],
            "p.nc:3:1: warning: 43.2 % of the cutting length (1 block: line 3) has a feed above 1000 mm/min, the "
            "highest that the machine was fitted on; the time there is an extrapolation: 0.4 s, from 0.4 s at the "
            "programmed feed to 0.4 s with a stop after every block [range-feed]");
  EXPECT_EQ(texts[1],
            "p.nc:2:1: warning: 21.6 % of the cutting length (1 block: line 2) has a corner sharper than 90.0 degrees, "
            "the sharpest that the machine was fitted on; the time there is an extrapolation: 0.6 s, from 0.6 s at the "
            "programmed feed to 0.6 s with a stop after every block [range-corner]");
  EXPECT_EQ(texts[2],
            "p.nc:4:1: warning: 13.6 % of the cutting length (1 block: line 4) has arcs, of which the machine was "
            "fitted on none; the time there is an extrapolation: 0.377 s, from 0.377 s at the programmed feed to 0.377 "
            "s with a stop after every block [range-arc]");
  EXPECT_EQ(texts[3],
            "p.nc:3:1: warning: 43.2 % of the cutting length (1 block: line 3) has motion of Z, which the machine was "
            "not fitted on; the time there is an extrapolation: 0.4 s, from 0.4 s at the programmed feed to 0.4 s with "
            "a stop after every block [range-axis]");
}

TEST(FittedRange, FineFacetsAreMoreBlocksASecond) {
  tests::TestProgram coarse, fine;
  for (int i = 1; i <= 20; ++i) coarse.line(i, 0, 0, 600);      // 10 blocks a second
  for (int i = 1; i <= 20; ++i) fine.line(0.1 * i, 0, 0, 600);  // 100
  const auto texts = warnings(fine.program, fitted_on(coarse.program));
  ASSERT_EQ(texts.size(), 2u);
  EXPECT_NE(texts[0].find("lines shorter than 1 mm"), std::string::npos) << texts[0];
  EXPECT_NE(
      texts[1].find("65.0 % of the cutting length (13 blocks: lines 8, 9, 10, 11, 12 ...) has more than 10 blocks a "
                    "second"),
      std::string::npos)
      << texts[1];
}

/// A helix in short blocks and a small circle, on a machine that was fitted on long lines and wide circles.
TEST(FittedRange, TellsTheSizeOfTheGuess) {
  tests::TestProgram wide, tight;
  wide.line(20, 0, 0, 3000).arc_xy(20, 0, 0, 0, 2 * kPi, 3000).line(20, 0, -5, 3000);
  tight.rapid(2, 0, 0);
  double phi = 0;
  for (int i = 1; i <= 90; ++i, phi += kPi / 18)  // blocks of 0.35 mm, 143 a second at the programmed feed
    tight.arc_xy(2 * std::cos(phi + kPi / 18), 2 * std::sin(phi + kPi / 18), 0, 0, kPi / 18, 3000);
  machine::Machine m = fitted_on(wide.program);
  for (machine::Axis& axis : m.axis) axis.acceleration_mm_per_s2 = 500;
  m.control.corner = {.law = machine::CornerLaw::angle, .time_s = 10};
  m.control.block_time_s = 0.02;
  const auto texts = warnings(tight.program, m);
  ASSERT_EQ(texts.size(), 3u);
  // 0.349 mm in 20 ms: 17.45 mm/s, and 0.0349 s for each of the two ramps. Centripetal: sqrt(500 * 2) = 31.6 mm/s.
  const double length = 5 * kPi * 2, time = length / 17.453 + 17.453 / 500,
               stop = 90 * 2 * std::sqrt(length / 90 / 500);
  for (const auto& [text, check] : {std::pair(texts[0], "[range-arc]"), {texts[1], "[range-arc-length]"}}) {
    EXPECT_NE(text.find(check), std::string::npos) << text;
    double predicted = 0, least = 0, most = 0;
    const std::size_t at = text.find("an extrapolation: ");
    ASSERT_NE(at, std::string::npos) << text;
    ASSERT_EQ(std::sscanf(text.c_str() + at, "an extrapolation: %lf s, from %lf s at the programmed feed to %lf s",
                          &predicted, &least, &most),
              3)
        << text;
    EXPECT_NEAR(predicted, time, 0.006);  // three digits
    EXPECT_NEAR(least, length / 50, 0.0006);
    EXPECT_NEAR(most, stop, 90 * 0.001);  // at most a period for each start from rest
  }
  EXPECT_NE(texts[2].find("[range-blocks]"), std::string::npos) << texts[2];
}

/// Time from the first to the last commanded motion.
double time_s(const nc::Interpretation& program, const machine::Machine& machine) {
  const auto times = plan_motion(program, machine).times;
  return times.back().start_s + times.back().duration_s;
}

TEST(StopAngle, StopsAtSharperCornersAndWaitsThere) {
  machine::Machine m;
  m.control.period_s = 1e-6;
  m.control.path_acceleration_mm_per_s2 = 500;
  m.control.corner = {.law = machine::CornerLaw::angle, .time_s = 10};  // no corner slows down by the law
  const double v = 1000 / 60.0, through = 40 / v + v / 500;             // closed form: one ramp up, one down
  EXPECT_NEAR(time_s(square(), m), through, 1e-4);
  m.control.corner.stop_angle_rad = 1.0;
  m.control.corner.stop_time_s = 0.03;
  EXPECT_NEAR(time_s(square(), m), through + 3 * (v / 500 + 0.03), 1e-4);
  m.control.corner.stop_angle_rad = 1.6;  // more than the corners turn by
  EXPECT_NEAR(time_s(square(), m), through, 1e-4);
}

TEST(RapidChange, StopsAndWaitsBetweenRapidAndFeed) {
  machine::Machine m;
  m.control.period_s = 1e-6;
  m.control.path_acceleration_mm_per_s2 = 500;
  for (auto& axis : m.axis) axis.max_velocity_mm_per_s = 100;
  m.control.corner = {.law = machine::CornerLaw::angle, .time_s = 10};
  m.control.rapid_change_s = 0.1;
  tests::TestProgram p;
  p.rapid(50, 0, 0).line(70, 0, 0, 1200).rapid(120, 0, 0);
  // rapid 50 mm: 100 / 500 + 50 / 100; feed 20 mm at 20 mm/s: 1 + 20 / 500; two waits
  EXPECT_NEAR(time_s(p.program, m), 2 * (0.2 + 0.5) + 1.04 + 0.2, 1e-4);
}

}  // namespace
}  // namespace camber::feedmodel
