// The table of controls: properties that every row has.
#include "machine/control_kind.h"

#include <gtest/gtest.h>

#include <set>

#include "machine/machine_model.h"
#include "tests/support/temp_folder.h"

namespace camber::machine {
namespace {

Machine machine_of(const std::string& text) {
  const tests::TempFolder folder;
  folder.write("m.toml", text);
  Diagnostics diagnostics;
  const Machine machine = read_machine(folder / "m.toml", diagnostics);
  EXPECT_TRUE(diagnostics.all().empty());
  return machine;
}

TEST(ControlKinds, AreFoundByUniqueNames) {
  std::set<std::string_view> names;
  for (const ControlKind& kind : control_kinds()) {
    EXPECT_EQ(control_kind_named(kind.name), &kind);
    EXPECT_TRUE(names.insert(kind.name).second) << kind.name;
  }
  EXPECT_EQ(control_kind_named("bosch"), nullptr);
  EXPECT_EQ(machine_of("[control]\n").control.kind.name, default_control_kind().name);
}

TEST(ControlKinds, AreReadAndWrittenByTheirNames) {
  for (const ControlKind& kind : control_kinds()) {
    SCOPED_TRACE(kind.name);
    const std::string line = "dialect = \"" + std::string(kind.name) + "\"\n";
    const Machine machine = machine_of("[control]\n" + line);
    EXPECT_EQ(machine.control.kind.name, kind.name);
    EXPECT_EQ(machine.cycle.rapid_path, kind.rapid_path);
    EXPECT_EQ(to_toml(machine).substr(0, 10 + line.size()), "[control]\n" + line);
    EXPECT_EQ(to_toml(machine_of(to_toml(machine))), to_toml(machine));
  }
}

TEST(ControlKinds, YieldToTheRapidPathOfTheFile) {
  for (const ControlKind& kind : control_kinds())
    for (const auto& [word, path] : {std::pair("dogleg", RapidPath::dogleg), std::pair("linear", RapidPath::linear)})
      EXPECT_EQ(machine_of("[control]\ndialect = \"" + std::string(kind.name) + "\"\n[cycle]\nrapid_path = \"" + word +
                           "\"\n")
                    .cycle.rapid_path,
                path)
          << kind.name;
}

TEST(ControlKinds, YieldToTheStartOfBlocksOfTheFile) {
  for (const ControlKind& kind : control_kinds()) {
    const std::string text = "[control]\ndialect = \"" + std::string(kind.name) + "\"\n";
    EXPECT_EQ(machine_of(text).control.starts_on_period, kind.starts_on_period) << kind.name;
    for (const bool starts : {false, true}) {
      const Machine given = machine_of(text + "starts_on_period = " + (starts ? "true\n" : "false\n"));
      EXPECT_EQ(given.control.starts_on_period, starts) << kind.name;
      EXPECT_EQ(machine_of(to_toml(given)).control.starts_on_period, starts) << kind.name;
    }
  }
}

}  // namespace
}  // namespace camber::machine
