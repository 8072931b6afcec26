// Parameter sets of the control that codes of the program select.
#include "feedmodel/modes.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>

#include "feedmodel/cycle_time.h"
#include "feedmodel/fitted_range.h"
#include "feedmodel/motion_plan.h"
#include "feedmodel/timed_path.h"
#include "feedmodel/yan_shirase.h"
#include "test_paths.h"
#include "tests/support/nc_program.h"
#include "tests/support/temp_folder.h"

namespace camber::feedmodel {
namespace {

constexpr const char* kThreeModes = R"([control]
dialect = "fanuc"
in_position_mm = inf
corner = { law = "exact_stop" }
[control.mode.high_speed_contouring]
corner = { law = "speed_difference", speed_difference_mm_per_min = 600 }
block_time_ms = 2
[control.mode.g61_1]
corner = { law = "angle", time_ms = 5 }
[axis.x]
acceleration_mm_per_s2 = 750
[axis.y]
acceleration_mm_per_s2 = 750
)";

machine::Machine machine_of(const std::string& text) {
  const tests::TempFolder folder;
  folder.write("m.toml", text);
  Diagnostics diagnostics;
  return machine::read_machine(folder / "m.toml", diagnostics);
}

/// Blocks of 4 mm that turn by 20 degrees to and fro, under the given code.
nc::Interpretation zigzag(const std::string& on) {
  std::string text = "G21 G90\n" + on + "G1 X0 Y0 F5000\n";
  for (int i = 1; i <= 40; ++i) text += "X" + std::to_string(4 * i) + (i % 2 ? " Y.7\n" : " Y0.\n");
  return tests::interpreted(text + "M30\n");
}

double e_of(const std::string& on, const machine::Machine& m) { return cycle_time(zigzag(on), m).all.e(); }

TEST(Modes, AProgramSelectsAParameterSet) {
  const machine::Machine m = machine_of(kThreeModes);
  ASSERT_EQ(m.modes.size(), 2u);
  machine::Machine plain = m, contouring = m, angle = m;
  plain.modes.clear(), contouring.modes.clear(), angle.modes.clear();
  contouring.control = m.modes[0].second;
  angle.control = m.modes[1].second;
  EXPECT_NEAR(e_of("", m), e_of("", plain), 1e-12);
  EXPECT_NEAR(e_of("G05.1 Q1\n", m), e_of("", contouring), 1e-12);
  EXPECT_NEAR(e_of("G05 P10000\n", m), e_of("", contouring), 1e-12);
  EXPECT_NEAR(e_of("G08 P1\n", m), e_of("", contouring), 1e-12);
  EXPECT_NEAR(e_of("G61.1\n", m), e_of("", angle), 1e-12);
  EXPECT_GT(e_of("G05.1 Q1\n", m), 1.3 * e_of("", m));
  EXPECT_NEAR(e_of("G61.1\n", plain), e_of("", plain), 1e-12);  // without the table it stops exactly
  EXPECT_LT(e_of("G61\n", contouring), 0.8 * e_of("", contouring));
}

TEST(Modes, ASetKeepsWhatItDoesNotGive) {
  const machine::Machine m =
      machine_of("[control]\nblock_time_ms = 3\nmerge_tolerance_mm = 0.01\n[control.mode.g61]\nblock_time_ms = 1\n");
  ASSERT_EQ(m.modes.size(), 1u);
  EXPECT_EQ(m.modes[0].first, "g61");
  EXPECT_DOUBLE_EQ(m.modes[0].second.block_time_s, 0.001);
  EXPECT_DOUBLE_EQ(m.modes[0].second.merge_tolerance_mm, 0.01);
  const machine::Machine again = machine_of(machine::to_toml(m));
  ASSERT_EQ(again.modes.size(), 1u);
  EXPECT_DOUBLE_EQ(again.modes[0].second.block_time_s, 0.001);
  EXPECT_DOUBLE_EQ(again.control.block_time_s, 0.003);
}

TEST(Modes, AModeThatTheFileDoesNotKnowIsAWarning) {
  const auto warnings = [](const machine::Machine& m) {
    Diagnostics diagnostics;
    check_range(zigzag("G05.1 Q1\n"), "p.nc", m, diagnostics);
    std::string all;
    for (const Diagnostic& d : diagnostics.all()) all += to_string(d) + "\n";
    return all;
  };
  EXPECT_EQ(warnings(machine_of(kThreeModes)), "");
  EXPECT_EQ(warnings({}),
            "p.nc:3:1: warning: G05.1 Q1 (high-speed contouring) is on, and the machine file has no "
            "[control.mode.g05_1_q1] or [control.mode.high_speed_contouring]; [control] is used [mode-unknown]\n");
}

TEST(Modes, EveryModeIsNamedThatTheFileDoesNotKnow) {
  const auto checks = [](const std::string& on, const std::string& control) {
    Diagnostics diagnostics;
    check_range(zigzag(on), "p.nc", machine_of("[control]\n" + control), diagnostics);
    std::string codes;
    for (const Diagnostic& d : diagnostics.all()) {
      EXPECT_EQ(d.check, "mode-unknown");
      codes += d.message.substr(0, d.message.find(" (")) + ";";
    }
    return codes;
  };
  const std::string mazak = "dialect = \"mazak\"\n";
  EXPECT_EQ(checks("G05 P10000\n", ""), "G05 P10000;");
  EXPECT_EQ(checks("G08 P1\n", ""), "G08 P1;");
  EXPECT_EQ(checks("G62\n", ""), "G62;");
  EXPECT_EQ(checks("G63\n", ""), "G63;");
  EXPECT_EQ(checks("G08 P1\nG62\n", ""), "G08 P1;G62;");
  EXPECT_EQ(checks("G61.1\n", mazak), "G61.1;");
  EXPECT_EQ(checks("CYCLE832(0.01,3,1)\n", ""), "CYCLE832;");
  EXPECT_EQ(checks("CYCLE832(0.01,3,1)\nCYCLE832(0,0,1)\n", ""), "");
  EXPECT_EQ(checks("G05 P10000\nG05 P0\n", ""), "");
  // What [control] describes, or what has a meaning without a set.
  for (const char* on : {"G64\n", "G61\n", "G61.1\n"}) EXPECT_EQ(checks(on, ""), "") << on;
  for (const char* set : {"g05_p10000", "high_speed_contouring"})
    EXPECT_EQ(checks("G05 P10000\n", fmt::format("[control.mode.{}]\nblock_time_ms = 1\n", set)), "") << set;
  EXPECT_EQ(checks("G61.1\n", mazak + "[control.mode.g61_1]\nblock_time_ms = 1\n"), "");
  EXPECT_EQ(checks("CYCLE832(0.01,3,1)\n", "[control.mode.cycle832]\nblock_time_ms = 1\n"), "");
  EXPECT_EQ(checks("G62\nG64\n", "[control.mode.g64]\nblock_time_ms = 1\n"), "");
}

TEST(Modes, EachCodeHasItsOwnSet) {
  const char* sets[] = {"g05_1_q1", "g05_p10000", "g08_p1", "cycle832", "g61", "g61_1", "g62", "g63", "g64"};
  const char* codes[] = {"G05.1 Q1\n", "G05 P10000\n", "G08 P1\n", "CYCLE832(0.1)\n", "G61\n", "G61.1\n",
                         "G62\n",      "G63\n",        "G64\n"};
  std::string text = "[control]\ncorner = { law = \"exact_stop\" }\nin_position_mm = inf\n";
  for (int i = 0; i < 9; ++i)
    text += fmt::format("[control.mode.{}]\ncorner = {{ law = \"angle\", time_ms = 100 }}\nblock_time_ms = {}\n",
                        sets[i], 100 * (i + 1));
  const machine::Machine m = machine_of(text);
  for (int i = 0; i < 9; ++i)  // 4.06 mm in the block time
    EXPECT_NEAR(cycle_time(zigzag(codes[i]), m).all.average_feed_mm_per_s(), 4.06 / (0.1 * (i + 1)), 0.5) << codes[i];
}

/// A word of a Sinumerik program selects the set of its name; CYCLE832 counts before it, with its kind before without.
TEST(Modes, WordsOfSiemensProgramsHaveSetsOfTheirNames) {
  const machine::Machine m = machine_of(
      "[control.mode.soft]\nblock_time_ms = 1\n[control.mode.cycle832]\nblock_time_ms = 2\n"
      "[control.mode.cycle832_rough]\nblock_time_ms = 3\n[control.mode.g642]\nblock_time_ms = 4\n");
  const auto block_time_ms = [&](const std::string& words) {
    Diagnostics diagnostics;
    const nc::Program program =
        nc::read_program(SourceText("p.mpf", "G710 G0 X0 Y0 Z0\n" + words + "\nG1 X1 F100\nM30\n"), diagnostics);
    const nc::Interpretation moves = nc::interpret(program, {}, diagnostics);
    EXPECT_TRUE(diagnostics.all().empty()) << words;
    return 1000 * settings_of(m, moves.state_of(moves.moves.back())).block_time_s;
  };
  EXPECT_NE(block_time_ms("BRISK"), 1);
  EXPECT_DOUBLE_EQ(block_time_ms("SOFT"), 1);
  EXPECT_NE(block_time_ms("SOFT BRISK"), 1);
  EXPECT_DOUBLE_EQ(block_time_ms("SOFT G642"), 1);
  EXPECT_DOUBLE_EQ(block_time_ms("G642"), 4);
  EXPECT_DOUBLE_EQ(block_time_ms("SOFT\nCYCLE832(0.1,_FINISH,1)"), 2);
  EXPECT_DOUBLE_EQ(block_time_ms("SOFT\nCYCLE832(0.1,_ROUGH,1)"), 3);
  EXPECT_DOUBLE_EQ(block_time_ms("SOFT\nCYCLE832(0.1,_ROUGH,1)\nCYCLE832()"), 1);
}

/// Mazak's G61.1 is a mode (high-accuracy shape correction); without a set for it [control] counts, and not a stop.
TEST(Modes, MazaksG61_1IsNoStop) {
  const std::string text =
      "[control]\ndialect = \"{}\"\nin_position_mm = inf\ncorner = {{ law = \"angle\", time_ms = 10 }}\n"
      "[axis.x]\nacceleration_mm_per_s2 = 750\n[axis.y]\nacceleration_mm_per_s2 = 750\n";
  const machine::Machine mazak = machine_of(fmt::format(fmt::runtime(text), "mazak")),
                         fanuc = machine_of(fmt::format(fmt::runtime(text), "fanuc"));
  EXPECT_NEAR(e_of("G61.1\n", mazak), e_of("", mazak), 1e-12);
  EXPECT_LT(e_of("G61.1\n", fanuc), 0.8 * e_of("", fanuc));
}

/// A program of the kind of "Test" in Yan & Shirase's table 4: 261 blocks of 18.1 mm, 4.72 m, in 9 features with
/// rapids between (the stops that e = 0.996 at F1000 leaves), some of them tight arcs (what e = 0.963 at F5000 adds).
nc::Interpretation table_four_program(const std::string& on, int feed) {
  constexpr int kBlocks = 261, kFeatures = 9, kArcEvery = 23;
  constexpr double kBlockMm = 18.1, kRadiusMm = 4, kSweep = kBlockMm / kRadiusMm;
  std::string text = "G21 G90 G17\n" + on;
  double x = 0, y = 0;
  for (int i = 0; i < kBlocks; ++i) {
    if (i * kFeatures / kBlocks != (i - 1) * kFeatures / kBlocks || i == 0)
      text += fmt::format("G0 X{:.4f} Y{:.4f}\n", x += 5, y);
    const bool arc = i % kArcEvery == 5;
    if (arc) {  // leaves the centre below, turns to the left
      const double cx = x, cy = y + kRadiusMm;
      x = cx + kRadiusMm * std::sin(kSweep);
      y = cy - kRadiusMm * std::cos(kSweep);
      text += fmt::format("G3 X{:.4f} Y{:.4f} I0. J{:.4f} F{}\n", x, y, kRadiusMm, feed);
    } else {
      (i % 2 ? x : y) += kBlockMm;
      text += fmt::format("G1 X{:.4f} Y{:.4f} F{}\n", x, y, feed);
    }
  }
  return tests::interpreted(text + "M30\n");
}

/// Table 4: conventional F1000 e 0.996, high speed F5000 0.963, high speed and high precision F10000 0.549. The number
/// of stops and of arcs and the corners' speed difference were chosen from it; that a stop at every block of this
/// length leaves 0.378 at F10000 (table 1b) was not.
TEST(Modes, TableFourIsThreeModesOfOneMachine) {
  Diagnostics diagnostics;
  machine::Machine m = machine::read_machine(CAMBER_SOURCE_DIR "/samples/machines/yan_shirase_modes.toml", diagnostics);
  const auto use = [&](const std::string& on, int feed) { return cycle_time(table_four_program(on, feed), m).all; };
  const CycleUse conventional = use("", 1000), fast = use("G08 P1\n", 5000), precise = use("G05 P10000\n", 10000);
  EXPECT_NEAR(conventional.cutting_mm, 4722, 5);
  printf("table 4: e %.3f (0.996), %.3f (0.963), %.3f (0.549)\n", conventional.e(), fast.e(), precise.e());
  EXPECT_NEAR(conventional.e(), 0.996, 0.001);
  EXPECT_NEAR(fast.e(), 0.963, 0.005);
  EXPECT_NEAR(precise.e(), 0.549, 0.005);
  // The cutting times of the table: 4.74, 0.98, 0.86 min.
  EXPECT_NEAR(conventional.time.cutting_s / 60, 4.74, 0.01);
  EXPECT_NEAR(fast.time.cutting_s / 60, 1.09 - 0.11, 0.01);
  EXPECT_NEAR(precise.time.cutting_s / 60, 0.97 - 0.11, 0.01);
  for (auto& [name, mode] : m.modes) mode.corner = {.law = machine::CornerLaw::exact_stop};
  EXPECT_NEAR(use("G05 P10000\n", 10000).e(), 0.378, 0.01);  // the arcs take 0.006
}

/// The exponential law and constant acceleration in one program: each part takes what it takes alone, with a stop where
/// the law changes.
TEST(Modes, LawsOfAccelerationFollowEachOther) {
  Diagnostics diagnostics;
  const machine::Machine m =
      machine::read_machine(CAMBER_SOURCE_DIR "/samples/machines/yan_shirase_modes.toml", diagnostics);
  const auto time = [&](const std::string& text) {
    const nc::Interpretation program = tests::interpreted("G21 G90\nG1 X0 Y0 F4500\n" + text + "M30\n");
    const double time_s = plan_motion(program, m).time_s();
    const CycleSplit split = cycle_time(program, m).all.time;
    EXPECT_NEAR(split.cutting_s + split.positioning_s, time_s, 1e-6);
    double last_s = 0, jump = 0;
    Vec3 last = Vec3::Zero();
    predict_feed(program, m, [&](std::span<const TimedSample> samples) {
      for (const TimedSample& s : samples) {
        jump = std::max(jump, (s.command_mm - last).norm());
        last = s.command_mm;
        last_s = s.t_s;
      }
    });
    EXPECT_GE(last_s, time_s - 1e-3);
    EXPECT_LT(jump, 75 * 0.001 * 1.01) << "no faster than the feed";
    return time_s;
  };
  const machine::Machine again = machine_of(machine::to_toml(m));
  ASSERT_EQ(again.modes.size(), 2u);
  for (std::size_t mode = 0; mode <= 2; ++mode) {
    EXPECT_EQ(acceleration_law_of(again, mode).law, acceleration_law_of(m, mode).law) << mode;
    EXPECT_DOUBLE_EQ(acceleration_law_of(again, mode).time_constant_2_s,
                     acceleration_law_of(m, mode).time_constant_2_s);
  }
  const double exponential = time("X100\n"), linear = time("G05 P10000\nX100\n");
  EXPECT_NEAR(exponential, 1.4633, 1e-4);  // eqs. 4-5
  EXPECT_NEAR(linear, 100.0 / 75 + 75.0 / 877, 1e-9);
  constexpr double kPeriod = 0.001;  // at most one for a start from rest
  EXPECT_NEAR(time("X100\nG05 P10000\nX200\n"), exponential + linear, kPeriod);
  EXPECT_NEAR(time("G05 P10000\nX100\nG05 P0\nX200\n"), exponential + linear, kPeriod);
  EXPECT_NEAR(time("X100\nG05 P10000\nX200\nG05 P0\nX300\n"), 2 * exponential + linear, 2 * kPeriod);
}

}  // namespace
}  // namespace camber::feedmodel
