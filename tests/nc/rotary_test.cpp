// Words A B C, tool-centre-point control, clamps.
#include <gtest/gtest.h>

#include "base/units.h"
#include "tests/nc/nc_text.h"

namespace camber::nc {
namespace {

using Messages = std::vector<std::string>;

InterpreterOptions five_axes(std::string_view dialect, const std::string& letters = "AC") {
  InterpreterOptions options = as(dialect);
  for (const char letter : letters) options.rotary_axes.push_back({.letter = letter});
  return options;
}

InterpreterOptions with_clamps() {
  InterpreterOptions options = as("haas");
  options.rotary_axes = {{.letter = 'B', .clamp_m = 10, .unclamp_m = 11},
                         {.letter = 'C', .clamp_m = 12, .unclamp_m = 13}};
  return options;
}

TEST(Rotary, MovesCostNoMemoryForIt) { EXPECT_EQ(sizeof(Move), 80U); }

TEST(Rotary, WordsAreATableBesideTheMoves) {
  const Read r = read_clean("G90 G0 X1 Y2 Z3 A10. C-663.\nG1 X5 F100\nG1 C459.\nA-5. X6\n", five_axes("fanuc"));
  ASSERT_EQ(r.moves.moves.size(), 4U);
  ASSERT_EQ(r.moves.rotary.size(), 3U);
  const auto& t = r.moves.rotary;
  EXPECT_EQ(t[0].move, 0U);
  EXPECT_EQ(t[0].given, 5);
  expect_near_mm(t[0].end, {rad_from_deg(10), 0, rad_from_deg(-663)});
  EXPECT_EQ(t[1].move, 2U);
  EXPECT_EQ(t[1].given, 4);
  expect_near_mm(t[1].end, {rad_from_deg(10), 0, rad_from_deg(459)});
  EXPECT_EQ(r.moves.moves[2].start_mm, r.moves.moves[2].end_mm);
  EXPECT_EQ(r.moves.moves[2].kind, MoveKind::linear);
  EXPECT_EQ(t[2].move, 3U);
  expect_near_mm(t[2].end, {rad_from_deg(-5), 0, rad_from_deg(459)});
  EXPECT_EQ(r.moves.moves[3].end_mm, Vec3(6, 2, 3));
  EXPECT_EQ(t[2].time_s, 0);
}

TEST(Rotary, IncrementsAndTheShortestWay) {
  Read r = read_clean("G0 X0 Y0 Z0 C350.\nG91 C20.\nC-380.\n", five_axes("fanuc"));
  ASSERT_EQ(r.moves.rotary.size(), 3U);
  EXPECT_NEAR(r.moves.rotary[1].end.z(), rad_from_deg(370), 1e-12);
  EXPECT_NEAR(r.moves.rotary[2].end.z(), rad_from_deg(-10), 1e-12);
  InterpreterOptions options = five_axes("fanuc");
  options.rotary_axes[1].shortest_way = true;
  r = read_clean("G0 X0 Y0 Z0 C350.\nC10.\nC190.\nC0.\nA350.\n", options);
  EXPECT_NEAR(r.moves.rotary[0].end.z(), rad_from_deg(-10), 1e-12);
  EXPECT_NEAR(r.moves.rotary[1].end.z(), rad_from_deg(10), 1e-12);
  EXPECT_NEAR(r.moves.rotary[2].end.z(), rad_from_deg(190), 1e-12);
  EXPECT_NEAR(r.moves.rotary[3].end.z(), rad_from_deg(360), 1e-12);
  EXPECT_NEAR(r.moves.rotary[4].end.x(), rad_from_deg(350), 1e-12);
}

TEST(Rotary, InverseTimeIsKeptAndAsksForFInEveryBlock) {
  const Read r = read_clean("G0 X0 Y0 Z0\nG93 G1 X10 A90. F30\nA0 F60.\n", five_axes("fanuc"));
  ASSERT_EQ(r.moves.rotary.size(), 2U);
  EXPECT_DOUBLE_EQ(r.moves.rotary[0].time_s, 2);
  EXPECT_DOUBLE_EQ(r.moves.moves[1].feed_mm_per_s, 5);
  EXPECT_DOUBLE_EQ(r.moves.rotary[1].time_s, 1);
  EXPECT_EQ(read_text("G0 X0 Y0 Z0\nG93 G1 X10 A90. F30\nG1 A0\n", five_axes("fanuc")).messages,
            Messages{"p.nc:3:1: error: G1 in inverse time (G93) without F; every cutting block needs its own F "
                     "[feed-missing]"});
}

TEST(Rotary, RefusesWordsItCannotRead) {
  const auto said = [](const std::string& text) { return read_text(text, five_axes("fanuc")).messages; };
  EXPECT_EQ(said("G0 X1 B5.\n"), Messages{"p.nc:1:7: error: B is not an axis of the machine's chain; A and C were "
                                          "expected [rotary-axis]"});
  EXPECT_EQ(said("G92 C5.\n").at(1),
            "p.nc:1:5: error: C in a block with G92 is not supported; rotary words were expected with G0 to G3, G28, "
            "G30, G53 or a drilling cycle [rotary-axis]");
  EXPECT_EQ(said("G0 X0 Y0 Z0\nG41 D1 G1 X5 F100\nX9 A5.\nG40 X0\n").at(1),
            "p.nc:3:4: error: A in a block with G41 active is not supported; rotary words were expected with G0 to G3, "
            "G28, G30, G53 or a drilling cycle [rotary-axis]");
  EXPECT_EQ(said("G0 X0 Y0 Z0\nG43.4 H1\nG81 Z-1 R1 F100 A5.\n").at(0),
            "p.nc:3:17: error: A in a block with the drilling cycle G81 under tool-centre-point control is not "
            "supported; rotary words were expected with G0 to G3, G28, G30, G53 or a drilling cycle [rotary-axis]");
  EXPECT_EQ(said("A5.\n"), Messages{"p.nc:1:1: error: A without a kind of motion; G0, G1, G2 or G3 was expected before "
                                    "[motion-missing]"});
}

TEST(Rotary, ZeroOffsetsOfG10AreRead) {
  const Read r = read_clean("G10 L2 P1 X5 Y6 Z7 A0 C0\nG54 G0 X0 Y0 Z0\n", five_axes("fanuc"));
  ASSERT_TRUE(r.moves.machine_origin_mm);
  EXPECT_EQ(*r.moves.machine_origin_mm, Vec3(-5, -6, -7));
}

TEST(Rotary, TipControlOfEachControl) {
  InterpreterOptions options = five_axes("fanuc");
  options.tool_offsets[3].length_mm = 120;
  const auto tips = [](const Read& r) {
    std::vector<TipControl> out;
    for (const Move& m : r.moves.moves) out.push_back(r.moves.state_of(m).tip_control);
    return out;
  };
  using Tips = std::vector<TipControl>;
  const Read fanuc = read_clean("G0 X0 Y0 Z0\nG43.4 H3\nX1\nG49\nX2\nG43 H3\nX3\n", options);
  EXPECT_EQ(tips(fanuc), (Tips{TipControl::off, TipControl::angles, TipControl::off, TipControl::off}));
  EXPECT_EQ(fanuc.moves.state_of(fanuc.moves.moves[1]).tool_length_mm, 120);
  EXPECT_EQ(fanuc.moves.state_of(fanuc.moves.moves[2]).tool_length_mm, 0);
  EXPECT_EQ(fanuc.moves.state_of(fanuc.moves.moves[3]).tool_length_mm, 120);
  const Read haas = read_clean("G0 X0 Y0 Z0\nG234 H3\nX1\nG49\nX2\n", five_axes("haas"));
  EXPECT_EQ(tips(haas), (Tips{TipControl::off, TipControl::angles, TipControl::off}));
  EXPECT_FALSE(haas.moves.state_of(haas.moves.moves[1]).tool_length_mm);
  const Read linuxcnc = read_clean("T1 M6\nG43 H1\nM428\nG0 X0 Y0 Z0\nM429\nX1\n", five_axes("linuxcnc"));
  EXPECT_EQ(tips(linuxcnc), (Tips{TipControl::angles, TipControl::off}));
}

TEST(Rotary, TipControlNeedsAToolLength) {
  EXPECT_EQ(read_text("G0 X0 Y0 Z0\nG43.4\n", five_axes("fanuc")).messages,
            Messages{"p.nc:2:1: error: G43.4 switches tool-centre-point control on without a tool length; H with its "
                     "number was expected [tool-length]"});
  EXPECT_EQ(read_text("G0 X0 Y0 Z0\nM428\n", five_axes("linuxcnc")).messages,
            Messages{"p.nc:2:1: warning: M428 without G43: tool-centre-point control with a tool length of 0 "
                     "[tool-length]"});
}

TEST(Rotary, NumbersOfToolLengthsAreWhole) {
  const std::string expected = " is not an offset number; a whole number of zero or more was expected [tool-length]";
  for (const char* number : {"1.5", "-1", "5555555555555"})
    EXPECT_EQ(read_text(std::string("G0 X0 Y0 Z0\nG43 H") + number + "\n", five_axes("fanuc")).messages,
              Messages{std::string("p.nc:2:5: error: H") + number + expected});
}

TEST(Rotary, ToolDirectionsOfG435) {
  const Read r = read_clean("G0 X0 Y0 Z0\nG43.5 H1\nG1 X1 I0.6 K0.8 F100\nX2\nX3 I3. J0. K4.\n", five_axes("fanuc"));
  ASSERT_EQ(r.moves.rotary.size(), 2U);
  EXPECT_TRUE(r.moves.rotary[0].is_direction);
  EXPECT_EQ(r.moves.rotary[0].move, 1U);
  expect_near_mm(r.moves.rotary[0].end, {0.6, 0, 0.8}, 1e-15);
  expect_near_mm(r.moves.rotary[1].end, {0.6, 0, 0.8}, 1e-15);
  const auto said = [](const std::string& text) { return read_text(text, five_axes("fanuc")).messages; };
  EXPECT_EQ(said("G0 X0 Y0 Z0\nG43.5 H1\nX1 I0 J0\n"),
            Messages{"p.nc:3:4: error: I J K of the tool's direction are all zero; a direction was expected "
                     "[tool-direction]"});
  EXPECT_EQ(said("G0 X0 Y0 Z0\nG43.5 H1\nX1 A5.\n"),
            Messages{"p.nc:3:4: error: A under G43.5; I, J and K of the tool's direction were expected [rotary-axis]"});
  EXPECT_EQ(said("G0 X0 Y0 Z0\nG43.5 H1\nX1 I1\nG49\nG90 X1 Y0 Z0\nG91 A5.\n").at(0),
            "p.nc:6:5: error: A in G91 after G43.5, which leaves its position open; G90 was expected [rotary-axis]");
}

TEST(Rotary, AfterASwitchWithTurnedAxesTheirPlacesAreOpenUntilTheyAreNamed) {
  const Read r = read_clean("G0 X0 Y0 Z0 A5.\nG43.4 H1\nX1 Y2\nZ3\nG49\nG43.4 H1\nX2\n", five_axes("fanuc"));
  EXPECT_EQ(r.moves.moves[1].open_axes, 4);  // Z
  EXPECT_EQ(r.moves.moves[2].open_axes, 0);
  EXPECT_EQ(r.moves.moves[3].open_axes, 6);  // Y and Z
  read_clean("G0 X0 Y0 Z0 A5.\nG43.4 H1\nX1 Y2 Z3\nX5\nG49\nX1 Y2 Z3\n", five_axes("fanuc"));
  read_clean("G0 X0 Y0 Z0\nG43.4 H1\nX1 Y2\n", five_axes("fanuc"));
}

TEST(Rotary, ClampsOfTheMachine) {
  const Read r = read_clean("G0 X0 Y0 Z0\nM11\nM13\nB5. C5.\nM10\nM12\nX1 B5.\n", with_clamps());
  EXPECT_EQ(r.moves.state_of(r.moves.moves.back()).spindle, SpindleDirection::stopped);  // M13 is no spindle here
  EXPECT_EQ(read_text("G0 X0 Y0 Z0\nM12\nB5. C5.\n", with_clamps()).messages,
            Messages{"p.nc:3:5: error: C turns while M12 has it clamped; M13 was expected before [clamped]"});
}

/// Programs in which nothing turns read as they always did.
TEST(Rotary, WithoutRotaryAxesCodesAreRefusedByName) {
  EXPECT_EQ(read_text("G43.4 H1\n").messages,
            Messages{"p.nc:1:1: error: G43.4 (tool-centre-point control) is read on a machine with [kinematics], by "
                     "camber check, time, feed, fit-feed, predict, compensate and post [not-read]"});
  EXPECT_EQ(read_text("G234 H1\n").messages,
            Messages{"p.nc:1:1: error: G234 (tool-centre-point control) is read on a machine with [kinematics], by "
                     "camber check, time, feed, fit-feed, predict, compensate and post [not-read]"});
  EXPECT_EQ(read_text("G43 H1\nG0 X1 A5.\n").messages,
            Messages{"p.nc:2:7: error: rotary axis A is read on a machine with [kinematics], by camber check, time, "
                     "feed, fit-feed, predict, compensate and post; X, Y and Z were expected [rotary-axis]"});
}

}  // namespace
}  // namespace camber::nc
