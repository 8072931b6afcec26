// The options of check that say how a program's language is read.
#include <gtest/gtest.h>

#include "kinematics/control_options.h"
#include "tests/support/run_camber.h"

namespace camber {
namespace {

using tests::run_camber;
using tests::TempFolder;

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

TEST(LanguageOptions, DialectAndTheTextThatShowsIt) {
  const TempFolder folder;
  folder.write("p.nc", "G21 G90\nG0 X0 Y0 Z0\n#1=FIX[-2.5]\nG1 X[#1] F100\nM30\n");
  EXPECT_TRUE(has(run_camber(folder, "check p.nc").out, "cutting   2.0 mm"));
  EXPECT_TRUE(has(run_camber(folder, "check p.nc --dialect haas").out, "cutting   2.0 mm"));
  EXPECT_TRUE(has(run_camber(folder, "check p.nc --dialect linuxcnc").out, "cutting   3.0 mm"));
  folder.write("o.nc", "G21 G90\nG0 X0 Y0 Z0\n#<a>=FIX[-2.5]\nG1 X#<a> F100\nM30\n");
  EXPECT_TRUE(has(run_camber(folder, "check o.nc").out, "cutting   3.0 mm"));
  const auto wrong = run_camber(folder, "check p.nc --dialect bosch");
  EXPECT_NE(wrong.status, 0);
  EXPECT_TRUE(has(wrong.err, "--dialect"));
}

TEST(LanguageOptions, DialectTakesEveryControlOfTheTable) {
  const TempFolder folder;
  folder.write("p.nc", "G21 G90\nG0 X0 Y0 Z0\n#1=FIX[-2.5]\nG1 X[#1] F100\nM30\n");
  std::string names;
  for (const machine::ControlKind& kind : machine::control_kinds()) {
    const auto run = run_camber(folder, "check p.nc --dialect " + std::string(kind.name));
    const nc::Dialect& dialect = kinematics::dialect_of(kind);
    if (dialect.language == nc::LanguageId::iso)
      EXPECT_TRUE(has(run.out, dialect.fix_to_zero ? "cutting   2.0 mm" : "cutting   3.0 mm")) << kind.name;
    else
      EXPECT_TRUE(has(run.err, "p.nc:")) << kind.name;
    names += (names.empty() ? "" : "|") + std::string(kind.name);
  }
  EXPECT_TRUE(has(run_camber(folder, "check --help").out, "--dialect " + names));
}

TEST(LanguageOptions, SkipSwitchesAndLeastIncrements) {
  const TempFolder folder;
  folder.write("p.nc", "G21 G90\nG0 X0. Y0. Z0.\n/G1 X1. F100\n/2 G1 X7. F100\nM30\n");
  EXPECT_TRUE(has(run_camber(folder, "check p.nc").out, "cutting   7.0 mm"));
  EXPECT_TRUE(has(run_camber(folder, "check p.nc --skip-switch 2").out, "cutting   1.0 mm"));
  EXPECT_TRUE(has(run_camber(folder, "check p.nc --skip-switch 1,2").out, "cutting   0.0 mm"));
  EXPECT_TRUE(has(run_camber(folder, "check p.nc --block-skip").out, "cutting   0.0 mm"));
  folder.write("i.nc", "G21 G90\nG0 X0. Y0. Z0.\nG1 X1500 F100\nM30\n");
  EXPECT_TRUE(has(run_camber(folder, "check i.nc").out, "cutting   1500.0 mm"));
  EXPECT_TRUE(has(run_camber(folder, "check i.nc --least-increments").out, "cutting   1.5 mm"));
}

}  // namespace
}  // namespace camber
