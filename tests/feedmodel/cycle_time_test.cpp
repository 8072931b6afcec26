#include "feedmodel/cycle_time.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "feedmodel/rapid.h"
#include "feedmodel/rests.h"
#include "tests/support/nc_program.h"
#include "tests/support/test_program.h"

namespace camber::feedmodel {
namespace {

using tests::interpreted;

machine::Machine quick_machine() {
  machine::Machine m;
  m.control.period_s = 1e-7;
  for (machine::Axis& axis : m.axis) {
    axis.max_velocity_mm_per_s = 500;
    axis.acceleration_mm_per_s2 = 2500;
  }
  return m;
}

constexpr double kLongRapid = 400 / 500.0 + 0.2;  // 400 mm

TEST(CycleTime, CodesComeBeforeTheMotionOrAlongWithIt) {
  machine::Machine m = quick_machine();
  m.cycle.m_code_s = 0.4;
  m.cycle.s_code_s = 0.3;
  m.cycle.t_code_s = 0.2;
  const nc::Interpretation program = interpreted("G0 X0 Y0 Z0\nG0 X400 T2 S500 M8\nM9\n");
  CycleSplit t = cycle_time(program, m).all.time;
  EXPECT_NEAR(t.m_code_s, 0.4 + 0.3 + 0.2 + 0.4, 1e-12);
  EXPECT_NEAR(t.total_s(), kLongRapid + 1.3, 1e-6);
  m.cycle.code_order = machine::CodeOrder::simultaneous;
  t = cycle_time(program, m).all.time;
  EXPECT_NEAR(t.m_code_s, 0.4, 1e-12);  // M9 by itself
  EXPECT_NEAR(t.total_s(), kLongRapid + 0.4, 1e-6);
}

TEST(CycleTime, IndexTableTurnsTheShorterWayBesideTheMotion) {
  machine::Machine m = quick_machine();
  m.index = {.present = true, .max_velocity_rad_per_s = kPi, .acceleration_rad_per_s2 = 2 * kPi, .clamp_s = 0.5};
  nc::InterpreterOptions options;
  options.index_table = true;
  const CycleSplit t = cycle_time(interpreted("B90\nB270\nB270\nG91 B-90\nG90 B0\nM30\n", options), m).all.time;
  const double quarter =
      2 * std::sqrt(0.5 / 2);   // 90 deg stays below full speed: half a turn a second squared each way
  const double half = 1 + 0.5;  // 180 deg: pi / pi + pi / 2 pi
  EXPECT_NEAR(t.index_s, (quarter + 0.5) + (half + 0.5) + (quarter + 0.5) + (half + 0.5), 1e-9);
}

TEST(CycleTime, PalletIsChangedAlone) {
  machine::Machine m = quick_machine();
  m.cycle.pallet_change_s = 12;
  const CycleSplit t = cycle_time(interpreted("G0 X0 Y0 Z0\nG0 X400 M60\nG0 X0\n"), m).all.time;
  EXPECT_EQ(t.pallet_s, 12);
  EXPECT_NEAR(t.total_s(), 12 + 2 * kLongRapid, 1e-6);
}

TEST(CycleTime, SpindleStopsAndReversesThroughRest) {
  machine::Machine m = quick_machine();
  m.spindle = {.gd2_kgf_m2 = 0.1, .power_W = 26000, .constant_torque_rpm = 1500, .constant_power_rpm = 6000};
  m.spindle.orient_s = 0.7;
  const double start = spindle_start_s(m.spindle, 3000), faster = spindle_start_s(m.spindle, 5000);
  const auto spindle_s = [&](const char* text) { return cycle_time(interpreted(text), m).all.time.spindle_s; };
  EXPECT_NEAR(spindle_s("S3000 M3\nM5\n"), 2 * start, 1e-12);
  EXPECT_NEAR(spindle_s("S3000 M3\nM4\n"), 3 * start, 1e-12);
  EXPECT_NEAR(spindle_s("S3000 M3\nS5000\n"), faster, 1e-12);
  EXPECT_NEAR(spindle_s("S3000\n"), 0, 1e-12);
  EXPECT_NEAR(spindle_s("S3000 M3\nM19\n"), 2 * start + 0.7, 1e-12);
}

TEST(CycleTime, OverlappingRapidsSaveTheEndOfTheBraking) {
  machine::Machine m = quick_machine();
  tests::TestProgram p;
  p.rapid(400, 0, 0).rapid(400, 400, 0).line(410, 400, 0, 1000).rapid(0, 400, 0);
  const double apart = cycle_time(p.program, m).all.time.positioning_s;
  m.cycle.rapid_overlap_percent = 50;
  EXPECT_NEAR(apart - cycle_time(p.program, m).all.time.positioning_s, 0.5 * 500 / 2500, 1e-9);
}

TEST(CycleTime, AnExactStopIsAtTheEndOfItsMove) {
  tests::TestProgram p;
  for (int i = 1; i <= 5; ++i) p.line(10 * i, 0, 0, 6000);
  p.program.moves[1].exact_stop = true;
  machine::Machine m = quick_machine();
  m.control.corner.law = machine::CornerLaw::blend;
  const CycleTime time = cycle_time(p.program, m);
  const double half_stop_s = 0.5 * 100 / 2500;
  for (const std::size_t move : {0, 1, 2, 4}) EXPECT_NEAR(time.move_s[move], 0.1 + half_stop_s, 1e-5) << move;
  EXPECT_NEAR(time.move_s[3], 0.1, 1e-5);
}

/// A rapid that is shorter than the braking before it begins early by half of its own time.
TEST(CycleTime, AShortRapidOverlapsByHalfOfIts) {
  machine::Machine m = quick_machine();
  tests::TestProgram p;
  p.rapid(400, 0, 0).rapid(400, 1, 0);
  const double apart = cycle_time(p.program, m).all.time.positioning_s;
  m.cycle.rapid_overlap_percent = 50;
  EXPECT_NEAR(apart - cycle_time(p.program, m).all.time.positioning_s, std::sqrt(1 / 2500.0), 1e-9);
}

TEST(CycleTime, OverridesActOnTheirKind) {
  machine::Machine m = quick_machine();
  tests::TestProgram p;
  p.rapid(400, 0, 0).line(500, 0, 0, 3000);
  m.cycle.feed_override_percent = 200;
  m.cycle.rapid_override_percent = 50;
  const CycleSplit t = cycle_time(p.program, m).all.time;
  EXPECT_NEAR(t.positioning_s, 400 / 250.0 + 0.1, 1e-6);
  EXPECT_NEAR(t.cutting_s, 1 + 100 / 2500.0, 1e-6);
}

TEST(CycleTime, ToolsAddUpToTheWhole) {
  machine::Machine m = quick_machine();
  m.tool_change.chip_to_chip_s = 3;
  m.cycle.m_code_s = 0.1;
  const CycleTime time = cycle_time(
      interpreted("T1 M6\nM8\nG0 X0 Y0 Z5\nG1 X50 F600\nT2 M6\nG1 X0 F300\nG4 P1.\nT1 M6\nG1 X20 F600\nM30\n"), m);
  ASSERT_EQ(time.tools.size(), 2u);
  EXPECT_EQ(time.tools[0].tool, 1);
  EXPECT_EQ(time.tools[0].tool_changes, 2u);
  EXPECT_NEAR(time.tools[0].cutting_mm, 70, 1e-9);
  EXPECT_NEAR(time.tools[1].cutting_mm, 50, 1e-9);
  EXPECT_NEAR(time.tools[1].time.dwell_s, 1, 1e-9);
  EXPECT_NEAR(time.tools[0].time.total_s() + time.tools[1].time.total_s(), time.all.time.total_s(), 1e-12);
  EXPECT_EQ(time.all.time.tool_change_s, 9);
}

TEST(CycleTime, TheWayToTheReferencePointIsCountedWhereItIsKnown) {
  const nc::Interpretation program = interpreted("G0 X0 Y0 Z50\nG91 G28 Z0\nG90 G0 X400\nG0 Z50\n");
  machine::Machine m = quick_machine();
  m.tool_change.x_mm = m.tool_change.y_mm = 0;
  EXPECT_EQ(cycle_time(program, m).unplaced_moves, 3u);
  EXPECT_NEAR(cycle_time(program, m).all.time.positioning_s, kLongRapid, 1e-9);
  m.tool_change.z_mm = 450;
  const CycleTime time = cycle_time(program, m);
  EXPECT_EQ(time.unplaced_moves, 0u);
  EXPECT_NEAR(time.all.time.positioning_s, 4 * kLongRapid, 1e-9);
}

TEST(CycleTime, GoesToTheSecondToFourthReferencePointWhereTheyAreGiven) {
  machine::Machine m = quick_machine();
  m.tool_change = {.x_mm = 0, .y_mm = 0, .z_mm = 500};
  m.reference_points[0] = {.z_mm = 200};
  m.reference_points[1] = {.x_mm = 400};
  const auto way_s = [&](const char* code) {
    const std::string head = "G90 G0 X0 Y0 Z100\n";
    return cycle_time(interpreted(head + "G91 " + code + "\n"), m).all.time.positioning_s -
           cycle_time(interpreted(head), m).all.time.positioning_s;
  };
  const auto rest_to_rest_s = [](double mm) { return mm < 100 ? 2 * std::sqrt(mm / 2500) : mm / 500 + 0.2; };
  EXPECT_NEAR(way_s("G28 Z0"), rest_to_rest_s(400), 1e-6);
  EXPECT_NEAR(way_s("G30 Z0"), rest_to_rest_s(100), 1e-6);
  EXPECT_NEAR(way_s("G30 P2 Z0"), rest_to_rest_s(100), 1e-6);
  EXPECT_NEAR(way_s("G30 P3 X0"), rest_to_rest_s(400), 1e-6);
  EXPECT_NEAR(way_s("G30 P4 Z0"), rest_to_rest_s(400), 1e-6);  // not given: the change position
  // From the second point to the first, and back into the program.
  EXPECT_NEAR(way_s("G30 Z0\nG28 Z0\nG90 G0 Z100"), rest_to_rest_s(100) + rest_to_rest_s(300) + rest_to_rest_s(400),
              1e-6);
}

TEST(CycleTime, TappingHoldsTheSpindlesRunUpAndStopInEachStroke) {
  machine::Machine m = quick_machine();
  m.spindle.max_rpm = 12000;
  m.spindle.start_time_s = 2.4;
  m.control.in_position_mm = std::numeric_limits<double>::infinity();
  // 1200 rpm in 0.24 s, F 1200 mm/min = 20 mm/s: a stroke of 30 mm takes 30/20 + 0.24 s.
  const auto cutting_s = [&](const std::string& cycle) {
    return cycle_time(interpreted("G90 G0 X0 Y0 Z10\nS1200 M3\nG99 " + cycle + " X0 Y0 Z-28 R2 F1200\nG80\n"), m)
        .all.time.cutting_s;
  };
  for (const char* cycle : {"G84", "G84.2", "G84.3", "G74"})
    EXPECT_NEAR(cutting_s(cycle), 2 * (1.5 + 0.24), 1e-5) << cycle;
  EXPECT_NEAR(cutting_s("G85"), 2 * (1.5 + 0.008), 1e-5);  // bored: the axes' acceleration alone
  // Too shallow for the speed: 2 sqrt(s t/F).
  const double shallow =
      cycle_time(interpreted("G90 G0 X0 Y0 Z10\nS1200 M3\nG99 G84.2 X0 Y0 Z0.8 R2 F1200\nG80\n"), m).all.time.cutting_s;
  EXPECT_NEAR(shallow, 2 * 2 * std::sqrt(1.2 * 0.24 / 20), 1e-5);
  m.spindle.start_time_s = 0;
  EXPECT_NEAR(cutting_s("G84.2"), 2 * (1.5 + 0.008), 1e-5);
}

TEST(CycleTime, ComesFromOneSideUnderG60) {
  machine::Machine m = quick_machine();
  nc::InterpreterOptions options;
  options.single_direction_mm = Vec3(-1, 0, 0);
  const auto time_s = [&](const char* text) {
    return cycle_time(interpreted(text, options), m).all.time.positioning_s;
  };
  const double before = time_s("G90 G0 X0 Y0 Z0\n"), last_s = 2 * std::sqrt(1 / 2500.0);
  EXPECT_NEAR(time_s("G90 G0 X0 Y0 Z0\nG60 X400\n") - before, 401 / 500.0 + 0.2 + last_s, 1e-6);
  EXPECT_NEAR(time_s("G90 G0 X0 Y0 Z0\nG60 Y400\n") - before, kLongRapid, 1e-6);  // Y has no such way
  m.cycle.creep_feed_mm_per_s = 10;
  EXPECT_NEAR(time_s("G90 G0 X0 Y0 Z0\nG60 X400\n") - before, 401 / 500.0 + 0.2 + 1 / 10.0 + 10 / 2500.0, 1e-6);
}

TEST(CycleTime, AMachineWithoutLimitsTakesLengthOverFeed) {
  machine::Machine m;
  m.cycle.rapid_overlap_percent = 50;
  tests::TestProgram p;
  p.rapid(400, 0, 0).rapid(0, 0, 0).line(60, 0, 0, 600).rapid(0, 0, 0);
  for (const auto law : {machine::AccelerationLaw::linear, machine::AccelerationLaw::exponential}) {
    m.cycle.acceleration_law = law;
    for (const auto path : {machine::RapidPath::dogleg, machine::RapidPath::linear}) {
      m.cycle.rapid_path = path;
      const CycleTime time = cycle_time(p.program, m);
      EXPECT_NEAR(time.all.time.total_s(), 6, 1e-9);
      EXPECT_EQ(time.below_full_rapid, 0u);
    }
  }
}

TEST(CycleTime, AnEmptyProgramTakesNoTime) {
  const CycleTime time = cycle_time({}, quick_machine());
  EXPECT_EQ(time.all.time.total_s(), 0);
  EXPECT_EQ(time.all.e(), 0);
  EXPECT_EQ(time.all.k(), 0);
}

TEST(DistanceHistogram, HasTheStepThatTheMachineFileGives) {
  machine::Machine m = quick_machine();
  m.cycle.histogram_step_mm = 10;
  tests::TestProgram p;
  p.rapid(10, 0, 0).rapid(25, 0, 0).rapid(0, 0, 0).rapid(1000, 0, 0);
  const CycleTime time = cycle_time(p.program, m);
  ASSERT_EQ(time.g00.edges_mm.size(), 20u);
  EXPECT_EQ(time.g00.counts[0], 1u);
  EXPECT_EQ(time.g00.counts[1], 1u);
  EXPECT_EQ(time.g00.counts[2], 1u);
  EXPECT_EQ(time.g00.counts.back(), 1u);
}

TEST(DistanceHistogram, CountsUpToAndWithTheEdge) {
  DistanceHistogram h;
  for (const double d : {0.1, 0.100001, 1000.0, 1000.1}) h.add(d);
  EXPECT_EQ(h.counts.front(), 1u);
  EXPECT_EQ(h.counts[1], 1u);
  EXPECT_EQ(h.counts[12], 1u);
  EXPECT_EQ(h.counts.back(), 1u);
}

}  // namespace
}  // namespace camber::feedmodel
