#include "kinematics/explain.h"

#include <gtest/gtest.h>

#include "tests/kinematics/machines.h"

namespace camber::kinematics {
namespace {

using tests::sample;

TEST(Explain, DrawsAndDescribesTheTableOfLinuxCnc) {
  EXPECT_EQ(to_text(explain(sample("table_ac_linuxcnc")), "m.toml"), R"(m.toml: table-table

  part
  └ C  table, about +Z through (25, -15, -40) mm
    └ A  table, about +X through (25, -8.5, -70) mm
      └ bed
        └ X  head, linear
          └ Y  head, linear
            └ Z  head, linear
              └ spindle, tool along +Z

C+ turns the table with the part counter-clockwise seen from +Z (from above); the tool turns clockwise relative to the part. C alone does not tilt the tool.
A+ turns the table with the part counter-clockwise seen from +X (from the right); the tool turns clockwise relative to the part. At A90, the other axes at 0, the tool points along +Y of the part, from tip to spindle.
X+ moves the head, and with it the tool, towards +X.
Y+ moves the head, and with it the tool, towards +Y.
Z+ moves the head, and with it the tool, towards +Z.

Without limits of travel, the tool takes angles of 0 to 180 degrees with the axis of C.
Every direction in between has two solutions. Where the tool is parallel to the axis of C (the pole), C is free.
)");
}

TEST(Explain, DescribesLimitsAndClamps) {
  const Explanation e = explain(sample("table_bc"));
  EXPECT_EQ(e.type, "table-table");
  ASSERT_EQ(e.axes.size(), 5U);
  EXPECT_EQ(e.axes[1].letter, 'B');
  EXPECT_TRUE(e.axes[1].table);
  EXPECT_EQ(e.axes[1].motion,
            "B+ turns the table with the part clockwise seen from +Y (from behind); the tool turns counter-clockwise "
            "relative to the part. At B90, the other axes at 0, the tool points along +X of the part, from tip to "
            "spindle.");
  EXPECT_EQ(
      e.axes[1].limits,
      "travel -35 to 110 degrees, speed 9000 degrees/min, acceleration 600 degrees/s2, clamped by M10, released by "
      "M11");
  EXPECT_EQ(e.axes[2].motion, "Y+ moves the table towards -Y; the tool moves towards +Y relative to the part.");
  EXPECT_EQ(e.axes[2].limits, "travel -400 to 400 mm, speed 30000 mm/min, acceleration 3000 mm/s2");
}

TEST(Explain, NamesEachTypeOfMachine) {
  const auto type = [](const char* name) { return explain(sample(name)).type; };
  EXPECT_EQ(type("table_ab"), "table-table");
  EXPECT_EQ(type("head_table"), "head-table");
  EXPECT_EQ(type("head_head"), "head-head");
  EXPECT_EQ(type("nutating_head"), "nutating head-table");
  machine::Machine m;
  m.kinematics.chain = "xyz";
  EXPECT_EQ(explain(m).type, "three axes");
  EXPECT_TRUE(explain(m).reach.empty());
  m = sample("head_table");
  m.kinematics.chain = "cxyz";
  m.kinematics.table_axes = 1;
  EXPECT_EQ(explain(m).type, "rotary table, four axes");
}

TEST(Explain, DescribesANutatingHead) {
  const Explanation e = explain(sample("nutating_head"));
  EXPECT_EQ(
      e.axes.back().motion,
      "B+ turns the head with the tool counter-clockwise seen against its direction (0.707, 0, 0.707). At B90, the "
      "other axes at 0, the tool points along (0.5, -0.707, 0.5) of the part, from tip to spindle.");
  EXPECT_EQ(e.reach.front(), "Without limits of travel, the tool takes angles of 0 to 90 degrees with the axis of C.");
}

TEST(Explain, GivesTheLagOfARotaryDriveInDegrees) {
  machine::Machine m = sample("head_head");
  m.rotary[2].position_gain_per_s = 25;
  m.rotary[2].feed_forward_percent = 40;
  const Explanation e = explain(m);
  EXPECT_NE(e.axes[3].limits.find("lag 0.4 degrees at 1000 degrees/min"), std::string::npos) << e.axes[3].limits;
}

}  // namespace
}  // namespace camber::kinematics
