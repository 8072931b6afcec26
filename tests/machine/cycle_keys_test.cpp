// Inputs of cycle time: machine.toml, what-if by key, cases.
#include <gtest/gtest.h>

#include "machine/cycle_cases.h"
#include "machine/set_number.h"
#include "tests/support/temp_folder.h"

namespace camber::machine {
namespace {

using tests::TempFolder;

Machine machine_of(std::string_view text) {
  const TempFolder folder;
  Diagnostics diagnostics;
  return read_machine(folder.write("m.toml", text), diagnostics);
}

std::string message_of(const TempFolder& folder, const auto& read) {
  try {
    Diagnostics diagnostics;
    read(diagnostics);
  } catch (const InputError& problem) {
    return tests::replaced(problem.what(), folder.path() + "/", "");
  }
  return "";
}

std::string machine_message(std::string_view text) {
  const TempFolder folder;
  const std::string path = folder.write("m.toml", text);
  return message_of(folder, [&](Diagnostics& d) { read_machine(path, d); });
}

TEST(CycleKeys, ReadsEveryInputInItsUnit) {
  const Machine m = machine_of(R"([axis.x]
rapid_mm_per_min = 18000
g60_mm = -0.5
rapid_acceleration_mm_per_s2 = 3530
[spindle]
gd2_kgf_m2 = 0.1
power_W = 26000
constant_torque_rpm = 1500
constant_power_rpm = 6000
orient_s = 0.4
[cycle]
rapid_path = "linear"
acceleration_law = "exponential"
time_constant_1_ms = 32
time_constant_2_ms = 33
code_order = "simultaneous"
rapid_override_percent = 50
feed_override_percent = 120
rapid_overlap_percent = 40
linear_acceleration_mm_per_s2 = 800
arc_acceleration_mm_per_s2 = 900
arc_tolerance_mm = 0.01
arc_loop_factor = 8
jerk_filter_ms = 10
m_code_s = 0.1
s_code_s = 0.2
t_code_s = 0.3
pallet_change_s = 12
creep_feed_mm_per_min = 15000
[tool_change]
chip_to_chip_s = 5.5
tool_to_tool_s = 1.5
z_mm = 250
[index]
max_velocity_deg_per_min = 10800
acceleration_deg_per_s2 = 360
clamp_s = 0.4
)");
  EXPECT_EQ(m.axis[0].rapid_mm_per_s, 300);
  EXPECT_EQ(m.axis[0].g60_mm, -0.5);
  EXPECT_EQ(m.cycle.creep_feed_mm_per_s, 250);
  EXPECT_EQ(m.axis[0].rapid_acceleration_mm_per_s2, 3530);
  EXPECT_EQ(m.spindle.gd2_kgf_m2, 0.1);
  EXPECT_EQ(m.spindle.constant_power_rpm, 6000);
  EXPECT_EQ(m.spindle.orient_s, 0.4);
  EXPECT_EQ(m.cycle.rapid_path, RapidPath::linear);
  EXPECT_EQ(m.cycle.acceleration_law, AccelerationLaw::exponential);
  EXPECT_EQ(m.cycle.time_constant_1_s, 0.032);
  EXPECT_EQ(m.cycle.time_constant_2_s, 0.033);
  EXPECT_EQ(m.cycle.code_order, CodeOrder::simultaneous);
  EXPECT_EQ(m.cycle.rapid_override_percent, 50);
  EXPECT_EQ(m.cycle.feed_override_percent, 120);
  EXPECT_EQ(m.cycle.rapid_overlap_percent, 40);
  EXPECT_EQ(m.cycle.linear_acceleration_mm_per_s2, 800);
  EXPECT_EQ(m.cycle.arc_acceleration_mm_per_s2, 900);
  EXPECT_EQ(m.cycle.arc_tolerance_mm, 0.01);
  EXPECT_EQ(m.cycle.arc_loop_factor, 8);
  EXPECT_EQ(m.cycle.jerk_filter_s, 0.01);
  EXPECT_EQ(m.cycle.m_code_s, 0.1);
  EXPECT_EQ(m.cycle.s_code_s, 0.2);
  EXPECT_EQ(m.cycle.t_code_s, 0.3);
  EXPECT_EQ(m.cycle.pallet_change_s, 12);
  EXPECT_EQ(m.tool_change.chip_to_chip_s, 5.5);
  EXPECT_EQ(m.tool_change.tool_to_tool_s, 1.5);
  EXPECT_EQ(m.tool_change.x_mm, kNoLimit);
  EXPECT_EQ(m.tool_change.z_mm, 250);
  EXPECT_TRUE(m.index.present);
  EXPECT_NEAR(m.index.max_velocity_rad_per_s, 3.14159265358979, 1e-12);
  EXPECT_NEAR(m.index.acceleration_rad_per_s2, 6.28318530717959, 1e-12);
  EXPECT_EQ(m.index.clamp_s, 0.4);
  EXPECT_EQ(to_toml(machine_of(to_toml(m))), to_toml(m));
}

TEST(CycleKeys, RapidPathComesFromTheDialect) {
  EXPECT_EQ(machine_of("[control]\ndialect = \"fanuc\"\n").cycle.rapid_path, RapidPath::dogleg);
  EXPECT_EQ(machine_of("[control]\ndialect = \"linuxcnc\"\n").cycle.rapid_path, RapidPath::linear);
}

TEST(CycleKeys, ASpindleWithAFlywheelNeedsItsPower) {
  EXPECT_EQ(machine_message("[spindle]\ngd2_kgf_m2 = 0.1\nconstant_torque_rpm = 1500\n"),
            "m.toml:1:1: error: power_W is missing in [spindle]; a number greater than zero or inf was expected "
            "[key-missing]\n"
            "    [spindle]\n"
            "    ^");
}

TEST(CycleKeys, ZonesOfTheSpindleStandInOrder) {
  EXPECT_EQ(machine_message("[spindle]\nconstant_torque_rpm = 1500\nconstant_power_rpm = 900\n"),
            "m.toml:3:22: error: constant_power_rpm is 900; at least constant_torque_rpm, 1500, was expected "
            "[value-range]\n"
            "    constant_power_rpm = 900\n"
            "                         ^");
}

TEST(SetNumber, SetsInTheUnitOfTheFile) {
  Machine m;
  EXPECT_EQ(set_number(m, "axis.y.max_velocity_mm_per_min", 6000), "");
  EXPECT_EQ(set_number(m, "axis.all.acceleration_mm_per_s2", 700), "");
  EXPECT_EQ(set_number(m, "cycle.jerk_filter_ms", 10), "");
  EXPECT_EQ(m.axis[1].max_velocity_mm_per_s, 100);
  EXPECT_EQ(m.axis[0].max_velocity_mm_per_s, kNoLimit);
  EXPECT_EQ(m.axis[2].acceleration_mm_per_s2, 700);
  EXPECT_EQ(m.cycle.jerk_filter_s, 0.01);
}

TEST(SetNumber, TellsWhatIsWrong) {
  Machine m;
  EXPECT_EQ(set_number(m, "axis.x.accelerations_mm_per_s2", 700),
            "axis.x.accelerations_mm_per_s2 is not a machine parameter; did you mean axis.x.acceleration_mm_per_s2?");
  EXPECT_EQ(set_number(m, "axis.all.acceleration_mm_per_s2", -1),
            "axis.x.acceleration_mm_per_s2 is -1; a number greater than zero or inf was expected");
}

TEST(Cases, ReadsMachinesWithTheirChanges) {
  const TempFolder folder;
  folder.write("m.toml", "[axis.x]\nacceleration_mm_per_s2 = 500\n");
  const std::string path = folder.write("cases.toml", R"([case.b]
machine = "m.toml"
set = { "axis.all.acceleration_mm_per_s2" = 700 }
[case.a]
title = "as it is"
machine = "m.toml"
)");
  Diagnostics diagnostics;
  const auto cases = read_cases(path, nullptr, diagnostics);
  ASSERT_EQ(cases.size(), 2u);
  EXPECT_EQ(cases[0].title, "as it is");
  EXPECT_EQ(cases[0].machine.axis[0].acceleration_mm_per_s2, 500);
  EXPECT_EQ(cases[1].machine.axis[0].acceleration_mm_per_s2, 700);
  EXPECT_EQ(cases[1].machine.axis[1].acceleration_mm_per_s2, 700);
}

TEST(Cases, TellsWhereACaseIsWrong) {
  const TempFolder folder;
  const auto message = [&](std::string_view text) {
    const std::string path = folder.write("cases.toml", text);
    return message_of(folder, [&](Diagnostics& d) { read_cases(path, nullptr, d); });
  };
  EXPECT_EQ(message("[case.1]\nmachine = \"none.toml\"\n"),
            "cases.toml:2:11: error: machine: no such file: none.toml (paths are relative to the folder of the cases) "
            "[file-missing]\n"
            "    machine = \"none.toml\"\n"
            "              ^");
  folder.write("m.toml", "[spindle]\nmax_rpm = 8000\n");
  EXPECT_EQ(
      message("[case.1]\nmachine = \"m.toml\"\nset = { \"spindle.max_rp\" = 9000 }\n"),
      "cases.toml:3:28: error: spindle.max_rp is not a machine parameter; did you mean spindle.max_rpm? [case-set]\n"
      "    set = { \"spindle.max_rp\" = 9000 }\n"
      "                               ^");
}

TEST(CycleKeys, ReadsAndWritesReferencePointsTwoToFour) {
  const Machine m =
      machine_of("[axis.x]\n[reference_point.2]\nx_mm = -280\ny_mm = 0\nz_mm = 0\n[reference_point.4]\nz_mm = 7\n");
  EXPECT_EQ(m.reference_points[0].x_mm, -280);
  EXPECT_EQ(m.reference_points[1], ReferencePoint{});
  EXPECT_EQ(m.reference_points[2].z_mm, 7);
  const Machine again = machine_of(to_toml(m));
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(again.reference_points[k], m.reference_points[k]) << k;
  Machine swept = m;
  EXPECT_EQ(set_number(swept, "reference_point.3.y_mm", 50), "");
  EXPECT_EQ(swept.reference_points[1].y_mm, 50);
}

TEST(CycleKeys, NamesWhatIsWrongWithThem) {
  EXPECT_EQ(
      machine_message("[axis.x]\ng60_mm = 2000\n"),
      "m.toml:2:10: error: g60_mm is 2000; a number from -1000 to 1000 was expected [value-range]\n    g60_mm = 2000\n"
      "             ^");
  EXPECT_EQ(machine_message("[cycle]\ncreep_feed_mm_per_min = 0\n"),
            "m.toml:2:25: error: creep_feed_mm_per_min is 0; a number greater than zero or inf was expected "
            "[value-range]\n    "
            "creep_feed_mm_per_min = 0\n                            ^");
  EXPECT_EQ(machine_message("[reference_point.5]\nx_mm = 0\n"),
            "m.toml:1:18: error: unknown key 5 in [reference_point]; did you mean 2? [key-unknown]\n    "
            "[reference_point.5]\n                     ^");
  EXPECT_EQ(
      machine_message("[reference_point.2]\nw_mm = 0\n"),
      "m.toml:2:1: error: unknown key w_mm in [reference_point.2]; did you mean x_mm? [key-unknown]\n    w_mm = 0\n"
      "    ^");
}

}  // namespace
}  // namespace camber::machine
