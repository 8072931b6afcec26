#include <gtest/gtest.h>

#include "base/units.h"
#include "machine/machine_model.h"
#include "machine/set_number.h"
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
  return "";
}

Machine machine_of(std::string_view text) {
  const TempFolder folder;
  Diagnostics diagnostics;
  return read_machine(folder.write("m.toml", text), diagnostics);
}

/// A machine with this chain, and B and C.
std::string with_chain(const std::string& chain) {
  return "[kinematics]\nchain = " + chain +
         R"(
[axis.b]
direction = [0, 1, 0]
point_mm = [0, 0, -200]
positive = "tool"
[axis.c]
direction = [0, 0, 1]
point_mm = [0, 0, 0]
positive = "tool"
)";
}

constexpr const char* kWhole = R"([kinematics]
chain = ["part", "c", "a", "y", "bed", "x", "z", "spindle"]
gauge_point_mm = [1, 2, 3]
tool_axis = [0, 0, 2]
[axis.a]
direction = [1, 0, 0.5]
point_mm = [0, -6.5, -70]
positive = "table"
max_velocity_deg_per_min = 7200
max_feed_deg_per_min = 3600
rapid_deg_per_min = 7000
acceleration_deg_per_s2 = 400
jerk_deg_per_s3 = 9000
filter_ms = 16
exponential_1_ms = 3
exponential_2_ms = 2
position_gain_per_s = 30
velocity_lag_ms = 4
feed_forward_percent = 20
travel_deg = [-30, 110]
clamp_s = 0.4
clamp_codes = [10, 11]
[axis.c]
direction = [0, 0, 1]
point_mm = [0, 0, 0]
positive = "tool"
shortest_way = true
)";

TEST(KinematicsReader, ReadsEveryKeyInItsUnit) {
  const Machine m = machine_of(kWhole);
  EXPECT_EQ(m.kinematics.chain, "cayxz");
  EXPECT_EQ(m.kinematics.table_axes, 3U);
  EXPECT_EQ(m.kinematics.rotary_axes(), "ca");
  EXPECT_EQ(m.kinematics.gauge_point_mm, Vec3(1, 2, 3));
  EXPECT_EQ(m.kinematics.tool_axis, Vec3(0, 0, 2));
  const RotaryAxis& a = m.rotary[0];
  EXPECT_TRUE(a.given);
  EXPECT_EQ(a.direction, Vec3(1, 0, 0.5));
  EXPECT_EQ(a.point_mm, Vec3(0, -6.5, -70));
  EXPECT_EQ(a.positive, PositiveTurn::table);
  EXPECT_FALSE(a.shortest_way);
  EXPECT_DOUBLE_EQ(a.max_velocity_rad_per_s, rad_from_deg(120));
  EXPECT_DOUBLE_EQ(a.max_feed_rad_per_s, rad_from_deg(60));
  EXPECT_DOUBLE_EQ(a.rapid_rad_per_s, rad_from_deg(7000. / 60));
  EXPECT_DOUBLE_EQ(a.acceleration_rad_per_s2, rad_from_deg(400));
  EXPECT_DOUBLE_EQ(a.jerk_rad_per_s3, rad_from_deg(9000));
  EXPECT_EQ(a.filter_s, 0.016);
  EXPECT_EQ(a.exponential_1_s, 0.003);
  EXPECT_EQ(a.exponential_2_s, 0.002);
  EXPECT_EQ(a.position_gain_per_s, 30);
  EXPECT_EQ(a.velocity_lag_s, 0.004);
  EXPECT_EQ(a.feed_forward_percent, 20);
  EXPECT_DOUBLE_EQ(a.travel_rad[0], rad_from_deg(-30));
  EXPECT_DOUBLE_EQ(a.travel_rad[1], rad_from_deg(110));
  EXPECT_EQ(a.clamp_s, 0.4);
  EXPECT_EQ(a.clamp_m, 10);
  EXPECT_EQ(a.unclamp_m, 11);
  EXPECT_FALSE(m.rotary[1].given);
  EXPECT_EQ(m.rotary[2].positive, PositiveTurn::tool);
  EXPECT_TRUE(m.rotary[2].shortest_way);
  EXPECT_EQ(m.rotary[2].travel_rad[1], kNoLimit);
}

TEST(KinematicsReader, WriterGivesTheSameMachineBack) {
  const std::string text = to_toml(machine_of(kWhole));
  EXPECT_EQ(to_toml(machine_of(text)), text);
  EXPECT_NE(text.find(R"([kinematics]
chain = ["part", "c", "a", "y", "bed", "x", "z", "spindle"]
gauge_point_mm = [1, 2, 3]
tool_axis = [0, 0, 2]
)"),
            std::string::npos);
  EXPECT_NE(text.find("direction = [1, 0, 0.5]\npoint_mm = [0, -6.5, -70]\npositive = \"table\"\n"), std::string::npos);
  EXPECT_NE(text.find("clamp_codes = [10, 11]\ntravel_deg = [-30, 110]\n"), std::string::npos);
}

TEST(KinematicsReader, WritesNothingForThreeAxes) {
  const std::string text = to_toml(machine_of("[axis.x]\n"));
  EXPECT_EQ(text.find("kinematics"), std::string::npos);
  EXPECT_EQ(text.find("axis.a"), std::string::npos);
}

TEST(KinematicsReader, SetsNumbersOfRotaryAxesByName) {
  Machine m = machine_of(kWhole);
  EXPECT_EQ(set_number(m, "axis.a.acceleration_deg_per_s2", 500), "");
  EXPECT_DOUBLE_EQ(m.rotary[0].acceleration_rad_per_s2, rad_from_deg(500));
}

TEST(KinematicsReader, RefusesWhatIsNoChain) {
  EXPECT_EQ(messages("[kinematics]\n"),
            "m.toml:1:1: error: chain is missing in [kinematics]; a list from the part to the spindle such as "
            "[\"part\", \"c\", \"a\", \"bed\", \"x\", \"y\", \"z\", \"spindle\"] was expected [key-missing]\n"
            "    [kinematics]\n    ^");
  const auto message = [](const std::string& chain) {
    const std::string text = messages(with_chain(chain));
    return text.substr(0, text.find('\n'));
  };
  EXPECT_EQ(message(R"(["c", "b", "bed", "x", "y", "z", "spindle"])"),
            "m.toml:2:9: error: the chain must begin with \"part\" and end with \"spindle\" [chain-ends]");
  EXPECT_EQ(message(R"(["part", "c", "b", "x", "y", "z", "spindle"])"),
            "m.toml:2:9: error: \"bed\" is missing in the chain; it separates the axes that carry the part from those "
            "that carry the spindle [chain-bed]");
  EXPECT_EQ(message(R"(["part", "c", "b", "bed", "x", "bed", "y", "z", "spindle"])"),
            "m.toml:2:9: error: \"bed\" occurs twice in the chain [chain-bed]");
  EXPECT_EQ(message(R"(["part", "c", "b", "bed", "x", "y", "spindle"])"),
            "m.toml:2:9: error: axis z is missing in the chain; x, y and z were expected [chain-axis]");
  EXPECT_EQ(message(R"(["part", "c", "b", "bed", "x", "y", "z", "w", "spindle"])"),
            "m.toml:2:9: error: \"w\" in the chain is not an axis; x, y, z, a, b, c or \"bed\" was expected "
            "[chain-axis]");
  EXPECT_EQ(message(R"(["part", "c", "b", "bed", "x", "y", "z", "c", "spindle"])"),
            "m.toml:2:9: error: axis c occurs twice in the chain [chain-axis]");
  EXPECT_EQ(message(R"(["part", "a", "b", "bed", "x", "y", "z", "spindle"])"),
            "m.toml:2:9: error: the chain has axis a, but [axis.a] is missing [axis-missing]");
  EXPECT_EQ(message(R"(["part", "b", "c", "bed", "x", "y", "z", "spindle"])"),
            "m.toml:2:9: error: axis c is the last rotary axis before the spindle and parallel to the tool; it cannot "
            "tilt the tool [chain-parallel]");
  EXPECT_EQ(message(R"(["part", "b", "bed", "x", "y", "z", "spindle"])"),
            "m.toml:1:1: error: [axis.c] is given, but the chain does not have c [chain-axis]");
}

TEST(KinematicsReader, RefusesRotaryAxesThatCannotTilt) {
  const std::string text = R"([kinematics]
chain = ["part", "c", "b", "bed", "x", "y", "z", "spindle"]
[axis.b]
direction = [0, 0, -2]
point_mm = [0, 0, 0]
positive = "tool"
[axis.c]
direction = [0, 0, 1]
point_mm = [0, 0, 0]
positive = "tool"
)";
  EXPECT_EQ(
      messages(text),
      "m.toml:2:9: error: axes c and b follow each other in the chain and are parallel; they cannot tilt the tool "
      "in two directions [chain-parallel]\n"
      "    chain = [\"part\", \"c\", \"b\", \"bed\", \"x\", \"y\", \"z\", \"spindle\"]\n"
      "            ^\n"
      "m.toml:2:9: error: axis b is the last rotary axis before the spindle and parallel to the tool; it cannot "
      "tilt the tool [chain-parallel]\n"
      "    chain = [\"part\", \"c\", \"b\", \"bed\", \"x\", \"y\", \"z\", \"spindle\"]\n"
      "            ^");
}

TEST(KinematicsReader, RefusesIncompleteAxes) {
  EXPECT_EQ(messages("[kinematics]\nchain = [\"part\", \"c\", \"bed\", \"x\", \"y\", \"z\", \"spindle\"]\n"
                     "[axis.c]\ndirection = [0, 0, 0]\ntravel_deg = [90, 0]\nclamp_codes = [10, 10]\n"),
            "m.toml:3:1: error: point_mm is missing in [axis.c]; a point of the axis [x, y, z] was expected "
            "[key-missing]\n    [axis.c]\n    ^\n"
            "m.toml:4:13: error: direction is [0, 0, 0]; a direction was expected, such as [0, 0, 1] "
            "[axis-direction]\n    direction = [0, 0, 0]\n                ^\n"
            "m.toml:3:1: error: positive is missing in [axis.c]; \"tool\" or \"table\" was expected [key-missing]\n"
            "    [axis.c]\n    ^\n"
            "m.toml:5:14: error: travel_deg goes from 90 to 0; the second must be greater than the first "
            "[value-range]\n    travel_deg = [90, 0]\n                 ^\n"
            "m.toml:6:15: error: clamp_codes has M10 twice; different M codes [clamp, release] were expected "
            "[value-range]\n    clamp_codes = [10, 10]\n                  ^");
  EXPECT_EQ(messages("[axis.c]\ndirection = [0, 0, 1]\npoint_mm = [0, 0, 0]\npositive = \"tool\"\n"),
            "m.toml:1:1: error: [axis.c] is given without [kinematics]; its chain from the part to the spindle was "
            "expected [chain-missing]\n    [axis.c]\n    ^");
}

TEST(KinematicsReader, RefusesAnIndexTableBesideTheAxisB) {
  const std::string chain = R"(["part", "c", "b", "bed", "x", "y", "z", "spindle"])";
  EXPECT_EQ(messages(with_chain(chain) + "[index]\nclamp_s = 1\n"),
            "m.toml:11:1: error: [index] and [axis.b] both describe B; one of them was expected [axis-twice]\n"
            "    [index]\n    ^");
  EXPECT_TRUE(machine_of("[index]\nclamp_s = 1\n").index.present);
}

}  // namespace
}  // namespace camber::machine
