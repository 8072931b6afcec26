// Parameter sets of the control that codes of the program select.
#include "feedmodel/modes.h"

#include <gtest/gtest.h>

#include "feedmodel/cycle_time.h"
#include "feedmodel/fitted_range.h"
#include "feedmodel/yan_shirase.h"
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
  EXPECT_EQ(
      warnings({}),
      "p.nc:3:1: warning: high-speed contouring (G05.1 Q1, G05 P10000, G08 P1) is on, and the machine file has no "
      "[control.mode.high_speed_contouring]: [control] counts [mode-unknown]\n");
}

}  // namespace
}  // namespace camber::feedmodel
