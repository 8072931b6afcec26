// Rows A2-A20 of the checks taken from Yan & Shirase 1997 (A1 stands in tests/nc). Suite PrintedFigures: rows that only
// do arithmetic on what the paper prints; nothing is simulated.
#include "feedmodel/yan_shirase.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/units.h"
#include "feedmodel/cycle_time.h"
#include "feedmodel/limits.h"
#include "feedmodel/lookahead.h"
#include "feedmodel/segment_motion.h"
#include "tests/support/test_program.h"

namespace camber::feedmodel {
namespace {

constexpr double kT1 = 0.032, kT2 = 0.033;

/// Axes alike; a control whose period costs nothing; every block ends at rest.
machine::Machine stopping_machine(double acceleration_mm_per_s2) {
  machine::Machine m;
  m.control.period_s = 1e-7;
  m.control.corner.law = machine::CornerLaw::exact_stop;
  for (machine::Axis& axis : m.axis) {
    axis.max_velocity_mm_per_s = 1000;
    axis.acceleration_mm_per_s2 = acceleration_mm_per_s2;
  }
  return m;
}

/// Straight blocks of one length, with a corner of 90 degrees after each.
nc::Interpretation staircase(int blocks, double length_mm, double feed_mm_per_s) {
  tests::TestProgram p;
  double x = 0, y = 0;
  for (int i = 0; i < blocks; ++i) {
    (i % 2 == 0 ? x : y) += length_mm;
    p.line(x, y, 0, mm_per_min_from_mm_per_s(feed_mm_per_s));
  }
  return p.program;
}

CycleTime minutes(double cutting, double other) {
  CycleTime time;
  time.all.time.cutting_s = 60 * cutting;
  time.all.time.positioning_s = 60 * other;
  return time;
}

double percent_of_total(const CycleTime& time) { return 100 * time.all.time.cutting_s / time.all.time.total_s(); }

TEST(YanShirase, A02_ExponentialFeedHasItsLimits) {
  for (const double t2 : {kT2, kT1}) {  // and the limit form for T1 = T2
    const ExponentialRamp ramp{20, 75, kT1, t2};
    EXPECT_DOUBLE_EQ(ramp.speed_at(0), 20);
    EXPECT_NEAR(ramp.speed_at(1e-9), 20, 1e-6);
    EXPECT_NEAR(ramp.speed_at(10), 75, 1e-12);
  }
  const ExponentialRamp equal{20, 75, kT1, kT1}, near{20, 75, kT1, kT1 * 1.00001};
  EXPECT_NEAR(equal.speed_at(0.05), near.speed_at(0.05), 1e-3);
}

TEST(YanShirase, A03_DistanceIsTheIntegralOfTheFeedAndNotThePrintedForm) {
  const ExponentialRamp ramp{20, 75, kT1, kT2};
  EXPECT_NEAR(ramp.distance_at(0.2), 11.4560, 5e-5);
  EXPECT_GT(std::abs(ramp.distance_at(0.2) - 10.1360), 1);
  EXPECT_EQ(ramp.distance_at(0), 0);
  EXPECT_NEAR(ramp.distance_at(1e-12), 0, 1e-9);  // printed: -1.32 mm
  for (const ExponentialRamp& any : {ramp, ExponentialRamp{60, 10, 0.04, 0.04}, ExponentialRamp{0, 30, 0.02, 0}}) {
    double sum = 0;
    const int steps = 20000;
    for (int i = 0; i < steps; ++i) sum += any.speed_at((i + 0.5) * 0.2 / steps) * 0.2 / steps;
    EXPECT_NEAR(any.distance_at(0.2), sum, 1e-5);
    EXPECT_NEAR(any.time_of(any.distance_at(0.137)), 0.137, 1e-9);
  }
}

TEST(YanShirase, A04_LongBlockFromRestToRest) {
  EXPECT_NEAR(exponential_rest_to_rest_s(100, 75, kT1, kT2), 1.4633, 5e-5);
  machine::Machine m = stopping_machine(machine::kNoLimit);
  m.cycle.acceleration_law = machine::AccelerationLaw::exponential;
  m.cycle.time_constant_1_s = kT1;
  m.cycle.time_constant_2_s = kT2;
  EXPECT_NEAR(cycle_time(staircase(1, 100, 75), m).all.time.cutting_s, 1.4633, 5e-5);
  // Two blocks in line do not stop between: the second one starts at the first one's speed.
  tests::TestProgram p;
  p.line(50, 0, 0, 4500).line(100, 0, 0, 4500);
  EXPECT_NEAR(cycle_time(p.program, m).all.time.cutting_s, 1.4633, 5e-5);
}

TEST(YanShirase, A05_LongBlockWithConstantAcceleration) {
  const CycleTime time = cycle_time(staircase(1, 10, 75), stopping_machine(750));
  EXPECT_NEAR(time.all.time.cutting_s, 0.23333, 5e-6);
  EXPECT_NEAR(2 * make_trapezoid(10, 0, 0, 75, 750).accelerate_s * 75 / 2, 7.5, 1e-12);  // d'
}

TEST(YanShirase, A06_ShortBlockFromRestToRest) {
  EXPECT_NEAR(make_trapezoid(4, 0, 0, 75, 750).peak, 54.772, 5e-4);
  EXPECT_NEAR(cycle_time(staircase(1, 4, 75), stopping_machine(750)).all.time.cutting_s, 0.14606, 5e-6);
}

TEST(YanShirase, A07_AccelerationAndDecelerationWithinABlock) {
  std::vector<PlanRow> rows = {{.length_mm = 0.6, .speed_limit_mm_per_s = 30, .acceleration_mm_per_s2 = 750},
                               {.length_mm = 1, .speed_limit_mm_per_s = 75, .acceleration_mm_per_s2 = 750},
                               {.length_mm = 9, .speed_limit_mm_per_s = 75, .acceleration_mm_per_s2 = 750}};
  for (PlanRow& row : rows) row.entry_speed_mm_per_s = 1e9;
  plan_speeds(rows, 0);
  EXPECT_NEAR(rows[1].entry_speed_mm_per_s, 30, 1e-9);
  EXPECT_NEAR(rows[2].entry_speed_mm_per_s, 48.990, 5e-4);
  const double up_s = make_trapezoid(1, 30, rows[2].entry_speed_mm_per_s, 75, 750).duration_s();
  const double down_s = make_trapezoid(1, rows[2].entry_speed_mm_per_s, 30, 75, 750).duration_s();
  EXPECT_NEAR(up_s, 0.025320, 5e-7);
  EXPECT_NEAR(down_s, 0.025320, 5e-7);  // printed: negative
}

/// Speeds of a path that cruises at 75 mm/s and brakes over short blocks to `exit`.
std::vector<double> braked_speeds(double exit, int blocks) {
  std::vector<PlanRow> rows(
      static_cast<std::size_t>(blocks) + 2,
      PlanRow{.length_mm = 0.4, .speed_limit_mm_per_s = 75, .acceleration_mm_per_s2 = 750, .entry_speed_mm_per_s = 75});
  rows.front().length_mm = rows.back().length_mm = 100;
  rows.back().speed_limit_mm_per_s = exit;
  plan_speeds(rows, 0);
  std::vector<double> speeds;
  for (std::size_t i = 1; i < rows.size(); ++i) speeds.push_back(rows[i].entry_speed_mm_per_s);
  return speeds;
}

TEST(YanShirase, A08_BackCorrectionTelescopesAndIsFirstOrder) {
  const std::vector<double> planned = braked_speeds(20, 6);
  std::vector<BrakingBlock> blocks{{75, planned.front()}};
  for (std::size_t i = 1; i < planned.size(); ++i) blocks.push_back({planned[i - 1], planned[i]});
  double last_error = 0;
  for (const double change : {-2.0, -1.0}) {
    const BackCorrection correction = back_correction(blocks, change, 750);
    EXPECT_NEAR(correction.time_s(), -change / 750, 1e-15);
    const std::vector<double> exact = braked_speeds(20 + change, 6);
    double error = 0;
    for (std::size_t i = 0; i < exact.size(); ++i)
      error = std::max(error, std::abs(planned[i] + correction.exit_change_mm_per_s[i] - exact[i]));
    EXPECT_GT(error, 0);
    EXPECT_LT(error, 0.1);  // mm/s of 20
    if (change == -1.0) {
      EXPECT_NEAR(last_error / error, 4, 0.3);  // half the change, a quarter of the error
    }
    last_error = error;
  }
}

TEST(YanShirase, A09_ArcAndCornerClamps) {
  const double v = 75, r_given = 4;  // a control told by "this speed at this radius": v = V sqrt(r / R)
  const double a = v * v / r_given;
  for (const double r : {0.5, 4.0, 25.0}) EXPECT_NEAR(arc_speed(r, a, 1), v * std::sqrt(r / r_given), 1e-9);
  // In the program's time: a full circle of r = 10 mm at sqrt(a r).
  tests::TestProgram p;
  p.line(10, 0, 0, 60000).arc_xy(10, 0, 0, 0, 2 * kPi, 60000);
  machine::Machine m = stopping_machine(machine::kNoLimit);
  m.cycle.arc_acceleration_mm_per_s2 = a;
  m.cycle.linear_acceleration_mm_per_s2 = machine::kNoLimit;
  const CycleTime time = cycle_time(p.program, m);
  const double top = arc_speed(10, a, 1);
  EXPECT_NEAR(time.move_s[1], 2 * kPi * 10 / top + top / a, 1e-6);
  // r_eq, chosen as the circle through three points.
  EXPECT_NEAR(three_point_radius({5, 0, 0}, {0, 5, 0}, {-3, 4, 0}), 5, 1e-12);
  EXPECT_TRUE(std::isinf(three_point_radius({0, 0, 0}, {1, 1, 0}, {2, 2, 0})));
  EXPECT_NEAR(arc_speed(three_point_radius({5, 0, 0}, {0, 5, 0}, {-3, 4, 0}), 750, 1), std::sqrt(750.0 * 5), 1e-9);
}

TEST(YanShirase, A10_EfficiencyAgainstTheSimulation) {
  EXPECT_DOUBLE_EQ(stop_at_every_block_efficiency(1), 0.5);
  EXPECT_NEAR(stop_at_every_block_efficiency(1 - 1e-9), 0.5, 1e-8);
  for (double k = 0.05; k < 4.01; k += 0.05) {
    const double feed = 50, a = 750, length = feed * feed / (a * k);
    const CycleTime time = cycle_time(staircase(40, length, feed), stopping_machine(a));
    EXPECT_NEAR(time.all.k(), k, 1e-9 + 1e-6 * k);
    EXPECT_NEAR(time.all.e(), stop_at_every_block_efficiency(k), 1e-4) << k;
  }
}

TEST(PrintedFigures, A12_SharesOfCuttingTime) {
  EXPECT_NEAR(percent_of_total(minutes(71.2, 73.1 - 71.2)), 97.4, 0.05);  // Conrod
  // Iron: 17.60 min of cutting are 88.9 % of 19.80 min; the printed 90.3 % would leave 1.89 min for all else.
  const CycleTime iron = minutes(17.60, 2.20);
  EXPECT_NEAR(percent_of_total(iron), 88.9, 0.05);
  EXPECT_GT(std::abs(percent_of_total(iron) - 90.3), 1);
}

/// A tool path of a given length and mean feed, as a program: its time is length / feed.
TEST(YanShirase, A13_TimeIsDistanceOverActualFeed) {
  for (const double parts_min : {34.27 + 36.75, 17.60, 0.86}) {
    const double feed = 40;
    const CycleTime time = cycle_time(staircase(1, feed * 60 * parts_min, feed), stopping_machine(machine::kNoLimit));
    EXPECT_NEAR(time.all.cutting_mm / time.all.average_feed_mm_per_s() / 60, parts_min, 1e-9);
    EXPECT_NEAR(time.all.time.cutting_s / 60, parts_min, 1e-6);
  }
  EXPECT_NEAR(34.27 + 36.75, 71.2, 0.2);  // what the paper prints as 71.2
}

struct TableRow {
  double acceleration_mm_per_s2, model_e, actual_e;
};
constexpr TableRow kTable1b[] = {{748, 0.364, 0.543}, {766, 0.575, 0.767}, {484, 0.599, 0.945}, {877, 0.378, 0.549}};

double k_of(double e) { return e > 0.5 ? 1 / e - 1 : 1 / (4 * e * e); }

TEST(YanShirase, A14_AccelerationComesBackFromKFeedAndLength) {
  for (const TableRow& row : kTable1b) {
    const double feed = 75, length = feed * feed / (row.acceleration_mm_per_s2 * k_of(row.model_e));
    const CycleTime time = cycle_time(staircase(30, length, feed), stopping_machine(row.acceleration_mm_per_s2));
    EXPECT_NEAR(feed * feed / (time.all.k() * length), row.acceleration_mm_per_s2, 0.01);
    EXPECT_NEAR(time.all.acceleration_mm_per_s2(), row.acceleration_mm_per_s2, 0.01);
  }
}

/// Blocks of one length with the same speed at every corner, in the long run: each goes up from it and down to it
/// again, to the feed where the length allows. V t = L / e.
double efficiency_at_corner_speed(double length, double feed, double acceleration, double corner) {
  const double peak = std::min(feed, std::sqrt(corner * corner + acceleration * length));
  const double ramps = (peak * peak - corner * corner) / acceleration;
  return length / feed / (2 * (peak - corner) / acceleration + (length - ramps) / peak);
}

TEST(YanShirase, A15_StoppingAtEveryBlockIsALowerBoundAndPassedCornersReachTheMeasuredEfficiency) {
  for (const TableRow& row : kTable1b) {
    const double feed = 75, length = feed * feed / (row.acceleration_mm_per_s2 * k_of(row.model_e));
    const nc::Interpretation program = staircase(600, length, feed);
    machine::Machine m = stopping_machine(row.acceleration_mm_per_s2);
    const double stopping = cycle_time(program, m).all.e();
    EXPECT_NEAR(stopping, row.model_e, 1e-3);
    EXPECT_LT(stopping, row.actual_e);
    // Corners of 90 degrees passed at some speed: above the bound, and by as much as the closed form says.
    m.control.corner.law = machine::CornerLaw::speed_difference;
    double last = stopping;
    for (const double permitted : {5.0, 20.0, 60.0}) {
      m.control.corner.speed_difference_mm_per_s = permitted;
      const double e = cycle_time(program, m).all.e();
      const double closed = efficiency_at_corner_speed(length, feed, row.acceleration_mm_per_s2, permitted);
      EXPECT_GT(e, last) << permitted;
      EXPECT_NEAR(e, closed, 0.005 * closed) << permitted;  // the first and the last block stand at one end
      last = e;
    }
    // What was measured lies between the bound and a control that hardly slows.
    EXPECT_GT(last, row.actual_e);
  }
}

TEST(PrintedFigures, A16_MeanEfficiencyOfTwoPrograms) {
  CycleUse both;  // two parts with together 46.81 min at the commanded and 71.02 min at the actual feed
  both.time.cutting_s = 60 * (34.27 + 36.75);
  both.commanded_s = 60 * 46.81;
  EXPECT_NEAR(both.e(), 0.659, 5e-4);
  EXPECT_NEAR(both.e(), 0.655, 0.01 * 0.655);  // table 3
}

TEST(PrintedFigures, A17_ProductivityRatio) {
  const CycleTime real = minutes(71.2, 73.09 - 71.2), simulated = minutes(71.2, 72.64 - 71.2);
  EXPECT_NEAR(100 * real.all.time.total_s() / simulated.all.time.total_s(), 100.7, 0.1);
}

TEST(YanShirase, A18_TwiceTheAcceleration) {
  // The mean e of 0.655 becomes 0.784 in table 3: on a program whose blocks all stop it must do the same or better.
  const double k = k_of(0.655), feed = 75, length = feed * feed / (748 * k);
  const nc::Interpretation program = staircase(100, length, feed);
  const CycleUse once = cycle_time(program, stopping_machine(748)).all;
  const CycleUse twice = cycle_time(program, stopping_machine(2 * 748)).all;
  EXPECT_NEAR(once.e(), 0.655, 1e-3);
  EXPECT_NEAR(twice.e(), 0.784, 0.01);
  CycleTime conrod = minutes(46.81 / 0.784, 73.09 - 71.2);
  EXPECT_NEAR(conrod.all.time.cutting_s / 60, 59.7, 0.05);
  EXPECT_NEAR(conrod.all.time.total_s() / 60, 61.6, 0.05);
  EXPECT_NEAR(73.1 * 60 / conrod.all.time.total_s(), 1.188, 0.002);
  EXPECT_GT(std::abs(conrod.all.time.total_s() / 60 - 59.0), 2);  // printed as the total: nearer the cutting time
}

TEST(PrintedFigures, A19_TotalsOfTableFourDisagreeWithTheirOwnFeed) {
  const auto gain = [](double after) {
    return 100 * minutes(5.52, 0).all.time.total_s() / minutes(after, 0).all.time.total_s();
  };
  EXPECT_NEAR(gain(1.09), 506, 0.5);
  EXPECT_NEAR(gain(0.97), 569, 0.5);
  // 4.722 m in 4.74 min at e = 0.996: 5.52 min would leave 0.78 min for all else, against 0.11 in the other rows.
  CycleUse row;
  row.cutting_mm = 4722;
  row.time.cutting_s = 60 * 4.74;
  row.commanded_s = 0.996 * row.time.cutting_s;
  EXPECT_NEAR(mm_per_min_from_mm_per_s(row.commanded_feed_mm_per_s()), 1000, 1);
  EXPECT_NEAR(5.52 - row.time.cutting_s / 60, 0.78, 0.005);
}

TEST(YanShirase, A20_OverrideHelpsLessWhereKIsLarger) {
  double last_gain = 10;
  for (const double k : {0.05, 0.3, 1.0, 3.0}) {
    machine::Machine m = stopping_machine(750);
    const nc::Interpretation program = staircase(50, 50.0 * 50 / (750 * k), 50);
    double times[3];
    for (int i = 0; i < 3; ++i) {
      m.cycle.feed_override_percent = 50 * (i + 1);
      times[i] = cycle_time(program, m).all.time.cutting_s;
    }
    EXPECT_GT(times[0], times[1]);
    EXPECT_GE(times[1], times[2] - 1e-12);
    const double gain = times[0] / times[2];
    EXPECT_LT(gain, last_gain);
    last_gain = gain;
  }
}

}  // namespace
}  // namespace camber::feedmodel
