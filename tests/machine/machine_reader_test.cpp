#include "machine/machine_model.h"

#include <gtest/gtest.h>

#include "tests/support/temp_folder.h"

namespace camber::machine {
namespace {

using tests::TempFolder;

/// Everything the reader says about this text, with the file named m.toml.
std::string messages(std::string_view text) {
  const TempFolder folder;
  const std::string path = folder.write("m.toml", text);
  Diagnostics diagnostics;
  try {
    read_machine(path, diagnostics);
  } catch (const InputError& problem) {
    return tests::replaced(problem.what(), folder.path() + "/", "");
  }
  std::string out;
  for (const auto& d : diagnostics.all()) out += to_string(d) + "\n";
  return tests::replaced(out, folder.path() + "/", "");
}

Machine machine_of(std::string_view text) {
  const TempFolder folder;
  Diagnostics diagnostics;
  return read_machine(folder.write("m.toml", text), diagnostics);
}

TEST(MachineReader, ReadsEveryKeyInItsUnit) {
  const Machine m = machine_of(R"([control]
dialect = "linuxcnc"
period_ms = 2
block_time_ms = 1.5
merge_tolerance_mm = 0.01
lookahead_blocks = 200
arc_normal_share = 0.9
arc_tangential_share = 0.8
stop_acceleration_share = 0.5
corner = { law = "blend", tolerance_mm = 0.02, step_share = 0.4, short_line_time_ms = 3 }
[axis.x]
max_velocity_mm_per_min = 9000.0
acceleration_mm_per_s2 = 600.0
jerk_mm_per_s3 = inf
filter_ms = 64
position_gain_per_s = 33.0
velocity_lag_ms = 4
feed_forward_percent = 20
travel_mm = [-250.0, 250.0]
[spindle]
max_rpm = 12000.0
)");
  EXPECT_EQ(m.control.kind.name, "linuxcnc");
  EXPECT_EQ(m.control.period_s, 0.002);
  EXPECT_EQ(m.control.block_time_s, 0.0015);
  EXPECT_EQ(m.control.merge_tolerance_mm, 0.01);
  EXPECT_EQ(m.control.lookahead_blocks, 200);
  EXPECT_EQ(m.control.arc_normal_fraction, 0.9);
  EXPECT_EQ(m.control.arc_tangential_fraction, 0.8);
  EXPECT_EQ(m.control.stop_acceleration_fraction, 0.5);
  EXPECT_EQ(m.control.corner.law, CornerLaw::blend);
  EXPECT_EQ(m.control.corner.tolerance_mm, 0.02);
  EXPECT_EQ(m.control.corner.step_fraction, 0.4);
  EXPECT_EQ(m.control.corner.short_line_time_s, 0.003);
  EXPECT_EQ(m.axis[0].max_velocity_mm_per_s, 150);
  EXPECT_EQ(m.axis[0].acceleration_mm_per_s2, 600);
  EXPECT_EQ(m.axis[0].jerk_mm_per_s3, kNoLimit);
  EXPECT_EQ(m.axis[0].filter_s, 0.064);
  EXPECT_EQ(m.axis[0].position_gain_per_s, 33);
  EXPECT_EQ(m.axis[0].velocity_lag_s, 0.004);
  EXPECT_EQ(m.axis[0].feed_forward_percent, 20);
  EXPECT_EQ(m.axis[0].travel_mm[0], -250);
  EXPECT_EQ(m.axis[0].travel_mm[1], 250);
  EXPECT_EQ(m.spindle.max_rpm, 12000);
}

TEST(MachineReader, TakesAMissingLimitAsNoLimit) {
  const Machine m = machine_of("[spindle]\nmax_rpm = 8000\n");
  EXPECT_EQ(m.axis[2].max_velocity_mm_per_s, kNoLimit);
  EXPECT_EQ(m.axis[2].acceleration_mm_per_s2, kNoLimit);
  EXPECT_EQ(m.axis[2].travel_mm[0], -kNoLimit);
  EXPECT_EQ(m.control.corner.law, CornerLaw::exact_stop);
}

TEST(MachineReader, ReadsCornerLawsWithTheirNumber) {
  EXPECT_EQ(machine_of("control.corner = { law = \"speed_difference\", speed_difference_mm_per_min = 600 }\n")
                .control.corner.speed_difference_mm_per_s,
            10);
  EXPECT_EQ(machine_of("control.corner = { law = \"angle\", time_ms = 8 }\n").control.corner.time_s, 0.008);
  EXPECT_EQ(machine_of("control.corner = { law = \"exact_stop\" }\n").control.corner.law, CornerLaw::exact_stop);
}

TEST(MachineReader, WritesTextThatReadsBackToTheSameValues) {
  Machine m;
  m.control.kind = *control_kind_named("haas");
  m.control.period_s = 0.001;
  m.control.corner = {.law = CornerLaw::speed_difference, .speed_difference_mm_per_s = 12.345, .step_fraction = 0.37};
  m.control.lookahead_blocks = 40;
  m.control.least_increment_mm = 0.0001;
  m.axis[0].max_velocity_mm_per_s = 150;
  m.axis[1].acceleration_mm_per_s2 = 612.3456789;
  m.axis[2].filter_s = 0.064;
  m.axis[2].travel_mm = {-100.5, kNoLimit};
  const std::string text = to_toml(m);
  const Machine back = machine_of(text);
  EXPECT_EQ(to_toml(back), text);
  EXPECT_EQ(back.axis[1].acceleration_mm_per_s2, m.axis[1].acceleration_mm_per_s2);
  EXPECT_EQ(back.axis[2].travel_mm, m.axis[2].travel_mm);
  EXPECT_EQ(back.control.corner.step_fraction, m.control.corner.step_fraction);
  EXPECT_EQ(back.control.least_increment_mm, m.control.least_increment_mm);
  EXPECT_EQ(to_toml(Machine{}).find("least_increment_mm"), std::string::npos);  // only where it was given
}

TEST(MachineReader, WritesMachineTomlForReaders) {
  const Machine m = machine_of("[axis.y]\nmax_velocity_mm_per_min = 9000\nacceleration_mm_per_s2 = 600\n");
  EXPECT_NE(to_toml(m).find("[axis.y]\n"
                            "max_velocity_mm_per_min = 9000\n"
                            "acceleration_mm_per_s2 = 600\n"
                            "jerk_mm_per_s3 = inf\n"),
            std::string::npos)
      << to_toml(m);
}

TEST(MachineReader, RefusesAnEmptyFile) {
  EXPECT_EQ(messages(" \r\n\n"),
            "m.toml: error: the file is empty; a machine description ([control], [axis.x] ...) was expected "
            "[file-empty]");
}

TEST(MachineReader, RefusesAMissingFile) {
  Diagnostics diagnostics;
  try {
    read_machine("/nowhere/m.toml", diagnostics);
    FAIL();
  } catch (const InputError& problem) {
    EXPECT_STREQ(problem.what(), "/nowhere/m.toml: error: no such file [file-missing]");
  }
}

TEST(MachineReader, ShowsSyntaxErrorsLikeOthers) {
  EXPECT_EQ(messages("[control]\nperiod_ms = \n"),
            "m.toml:2:13: error: not valid TOML: key-value pair: expected value, saw '\\n' [toml-syntax]\n"
            "    period_ms = \n"
            "                ^");
}

TEST(MachineReader, NamesTheLineOfATextThatTheParserRefusesToRead) {
  for (const std::string header : {"[ =axis.x]", "[[ =axis.x]]", "[ #]"}) {
    SCOPED_TRACE(header);
    EXPECT_EQ(messages("[control]\nperiod_ms = 1\n" + header + "\nfilter_ms = 1\n"),
              "m.toml:3:1: error: not valid TOML: a key, a table or a value was expected [toml-syntax]\n"
              "    " +
                  header +
                  "\n"
                  "    ^");
  }
}

TEST(MachineReader, SuggestsTheKeyThatWasMeant) {
  EXPECT_EQ(messages("[axis.x]\nmax_velocity = 9000\n"),
            "m.toml:2:1: error: unknown key max_velocity in [axis.x]; did you mean max_velocity_mm_per_min? "
            "[key-unknown]\n"
            "    max_velocity = 9000\n"
            "    ^");
  EXPECT_EQ(messages("[axis.x]\nwobble = 1\n"),
            "m.toml:2:1: error: unknown key wobble in [axis.x] [key-unknown]\n"
            "    wobble = 1\n"
            "    ^");
  EXPECT_EQ(messages("[axis.u]\nfilter_ms = 1\n"),
            "m.toml:1:7: error: unknown key u in [axis]; did you mean a? [key-unknown]\n"
            "    [axis.u]\n"
            "          ^");
}

TEST(MachineReader, RefusesValuesOutOfRange) {
  EXPECT_EQ(messages("[axis.x]\nacceleration_mm_per_s2 = -600\n"),
            "m.toml:2:26: error: acceleration_mm_per_s2 is -600; a number greater than zero or inf was expected "
            "[value-range]\n"
            "    acceleration_mm_per_s2 = -600\n"
            "                             ^");
  EXPECT_EQ(messages("[axis.x]\nacceleration_mm_per_s2 = nan\n"),
            "m.toml:2:26: error: acceleration_mm_per_s2 is nan; a number greater than zero or inf was expected "
            "[value-range]\n"
            "    acceleration_mm_per_s2 = nan\n"
            "                             ^");
  EXPECT_EQ(messages("[control]\nperiod_ms = 0\n"),
            "m.toml:2:13: error: period_ms is 0; a number greater than zero and at most 1000 was expected "
            "[value-range]\n"
            "    period_ms = 0\n"
            "                ^");
  EXPECT_EQ(messages("[control]\nblock_time_ms = inf\n"),
            "m.toml:2:17: error: block_time_ms is inf; a number of zero or more was expected [value-range]\n"
            "    block_time_ms = inf\n"
            "                    ^");
  EXPECT_EQ(messages("[axis.x]\nfeed_forward_percent = 120\n"),
            "m.toml:2:24: error: feed_forward_percent is 120; a number from 0 to 100 was expected [value-range]\n"
            "    feed_forward_percent = 120\n"
            "                           ^");
  EXPECT_EQ(messages("[control]\nlookahead_blocks = 2.5\n"),
            "m.toml:2:20: error: lookahead_blocks is 2.5; a whole number from 0 to 1000000 was expected "
            "[value-range]\n"
            "    lookahead_blocks = 2.5\n"
            "                       ^");
}

TEST(MachineReader, RefusesWrongTypes) {
  EXPECT_EQ(messages("[axis.x]\nfilter_ms = \"64\"\n"),
            "m.toml:2:13: error: filter_ms is a text; a number of zero or more was expected [value-type]\n"
            "    filter_ms = \"64\"\n"
            "                ^");
  EXPECT_EQ(messages("control = 3\n"),
            "m.toml:1:11: error: control is a number; a table [control] was expected [value-type]\n"
            "    control = 3\n"
            "              ^");
  EXPECT_EQ(messages("[axis.x]\ntravel_mm = [1, 2, 3]\n"),
            "m.toml:2:13: error: travel_mm has 3 numbers; [least, greatest] was expected [value-count]\n"
            "    travel_mm = [1, 2, 3]\n"
            "                ^");
  EXPECT_EQ(messages("[axis.x]\ntravel_mm = [2, 1]\n"),
            "m.toml:2:13: error: travel_mm goes from 2 to 1; the second must be greater than the first "
            "[value-range]\n"
            "    travel_mm = [2, 1]\n"
            "                ^");
}

TEST(MachineReader, RefusesAnUnknownWord) {
  EXPECT_EQ(messages("[control]\ndialect = \"bosch\"\n"),
            "m.toml:2:11: error: dialect is \"bosch\"; \"fanuc\", \"haas\", \"mazak\", \"linuxcnc\", "
            "\"heidenhain\" or \"siemens\" was expected [value-choice]\n"
            "    dialect = \"bosch\"\n"
            "              ^");
}

TEST(MachineReader, AsksForTheNumberOfACornerLawAndRefusesAnothers) {
  EXPECT_EQ(messages("[control]\ncorner = { law = \"angle\", tolerance_mm = 0.01 }\n"),
            "m.toml:2:27: error: tolerance_mm does not belong to the corner law \"angle\" [key-unused]\n"
            "    corner = { law = \"angle\", tolerance_mm = 0.01 }\n"
            "                              ^\n"
            "m.toml:2:10: error: time_ms is missing in [control.corner]; a number of zero or more was expected "
            "[key-missing]\n"
            "    corner = { law = \"angle\", tolerance_mm = 0.01 }\n"
            "             ^");
}

TEST(MachineReader, ReadsCarriageReturns) {
  EXPECT_EQ(machine_of("[spindle]\r\nmax_rpm = 8000\r\n").spindle.max_rpm, 8000);
}

}  // namespace
}  // namespace camber::machine
