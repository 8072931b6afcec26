// Machines by class: `machine = "preset:NAME"`.
#include "machine/machine_presets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <regex>

#include "base/numbers.h"
#include "machine/assumptions.h"
#include "machine/machine_model.h"
#include "tests/support/temp_folder.h"

namespace camber::machine {
namespace {

TEST(MachinePreset, AreReadByTheirNames) {
  ASSERT_EQ(machine_presets().size(), 8u);
  for (const MachinePreset& preset : machine_presets()) {
    const std::string name = "preset:" + std::string(preset.name);
    Diagnostics diagnostics;
    const Machine machine = read_machine(name, diagnostics);
    EXPECT_TRUE(diagnostics.all().empty()) << name;
    EXPECT_EQ(machine.path, name);
    for (const Axis& axis : machine.axis) {
      EXPECT_TRUE(axis.given) << name;
      EXPECT_LT(axis.acceleration_mm_per_s2, 30000) << name;
    }
    EXPECT_EQ(assumptions(machine), std::vector<std::string>{"machine " + name + ", typical values of its class"});
    EXPECT_EQ(machine.kinematics.given(), preset.name.starts_with("five-axis"));
    const auto has = [&](std::string_view mode) {
      return std::ranges::any_of(machine.modes, [&](const auto& m) { return m.first == mode; });
    };
    EXPECT_EQ(has("cycle32"), preset.name != "router" && preset.name != "sinumerik-840d") << name;
    EXPECT_EQ(has("cycle832"), preset.name != "router" && preset.name != "tnc-640") << name;
  }
}

/// "key = value  # low to high: source".
TEST(MachinePreset, EachValueHasARangeThatHoldsItAndASource) {
  const std::regex value(R"(^(\w+) = ([-\d.]+) +# (-?[\d.]+) to (-?[\d.]+): \S.*)"),
      corner(R"(^corner = \{ .*= ([\d.]+) \} +# ([\d.]+) to ([\d.]+): \S.*)"),
      other(
          R"(^(#.*|assumed = .*|\[.*\]|dialect = "\w+"|acceleration_law = "[a-z]+"|chain = .*|direction = .*|positive = .*|point_mm = .*# -?\d+ to \d+: \S.*)?$)");
  for (const MachinePreset& preset : machine_presets()) {
    std::istringstream lines(machine_preset_text(preset));
    int numbers = 0;
    for (std::string line; std::getline(lines, line);) {
      std::smatch m;
      if (std::regex_match(line, m, value)) {
        EXPECT_LE(std::stod(m[3]), std::stod(m[2])) << preset.name << ": " << line;
        EXPECT_GE(std::stod(m[4]), std::stod(m[2])) << preset.name << ": " << line;
        ++numbers;
      } else if (std::regex_match(line, m, corner)) {
        EXPECT_LE(std::stod(m[2]), std::stod(m[1])) << preset.name << ": " << line;
        EXPECT_GE(std::stod(m[3]), std::stod(m[1])) << preset.name << ": " << line;
        ++numbers;
      } else {
        EXPECT_TRUE(std::regex_match(line, other)) << preset.name << ": " << line;
      }
    }
    EXPECT_GE(numbers, 12) << preset.name;
  }
}

TEST(MachinePreset, WrittenAsAFileKeepsSayingThatItIsAssumed) {
  const tests::TempFolder folder;
  const std::string path = folder.write("machine.toml", machine_preset_text(machine_presets()[1]));
  Diagnostics diagnostics;
  const Machine machine = read_machine(path, diagnostics);
  EXPECT_EQ(assumptions(machine), std::vector<std::string>{"machine preset:vmc-40, typical values of its class"});
}

TEST(MachinePreset, UnknownNamesAreErrors) {
  Diagnostics diagnostics;
  try {
    read_machine("preset:vmc40", diagnostics);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_STREQ(e.what(),
                 "preset:vmc40: error: there is no machine preset \"preset:vmc40\" (did you mean \"preset:vmc-40\"?); "
                 "preset:router, preset:vmc-40, preset:vmc-linear, preset:hsc-die-mould, preset:five-axis-trunnion, "
                 "preset:five-axis-trunnion-bc, preset:tnc-640, preset:sinumerik-840d was expected [machine-preset]");
  }
}

}  // namespace
}  // namespace camber::machine
