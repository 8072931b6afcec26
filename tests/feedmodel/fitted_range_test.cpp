#include "feedmodel/fitted_range.h"

#include <gtest/gtest.h>

#include <cmath>

#include "feedmodel/plan.h"
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
  EXPECT_EQ(
      texts[0],
      "p.nc:3:1: warning: 43.2 % of the cutting length (1 block: line 3) has a feed above 1000 mm/min, the highest "
      "that the machine was fitted on; the feed there is a guess [range-feed]");
  EXPECT_EQ(texts[1],
            "p.nc:2:1: warning: 21.6 % of the cutting length (1 block: line 2) has a corner sharper than 90.0 degrees, "
            "the sharpest that the machine was fitted on; the feed there is a guess [range-corner]");
  EXPECT_EQ(
      texts[2],
      "p.nc:4:1: warning: 13.6 % of the cutting length (1 block: line 4) has arcs, of which the machine was fitted "
      "on none; the feed there is a guess [range-arc]");
  EXPECT_EQ(
      texts[3],
      "p.nc:3:1: warning: 43.2 % of the cutting length (1 block: line 3) has motion of Z, which the machine was not "
      "fitted on; the feed there is a guess [range-axis]");
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
