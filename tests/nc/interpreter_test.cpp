#include "nc/interpreter.h"

#include <fmt/format.h>

#include "tests/nc/nc_text.h"

namespace camber::nc {
namespace {

using Messages = std::vector<std::string>;

Vec3 end_of(const std::string& text) { return read_clean(text).moves.moves.back().end_mm; }

TEST(NcInterpreter, ReadsTheEverydayHeaderWithoutAWord) {
  const Read r = read_clean(
      "%\nO1(PART)\nN100G20\nN110G0G17G40G49G80G90\nN120T9M6\nN130G0G90G54X1.Y-2.S9500M3\nN140G43H9Z.5M8\n"
      "N150G1Z-.1F50.\nN160X2.\nN170G80\nN180Z.5\nN190M5\nN200G0G91G28Z0.M9\nN210M01\nN220M30\n%\n");
  ASSERT_EQ(r.moves.moves.size(), 6u);
  expect_near_mm(r.moves.moves[0].end_mm, {25.4, -50.8, 0});
  EXPECT_NEAR(r.moves.moves[2].feed_mm_per_s, 50 * 25.4 / 60, 1e-12);
  const ModalState& s = r.moves.state_of(r.moves.moves[2]);
  EXPECT_EQ(s.tool, 9);
  EXPECT_EQ(s.spindle_speed_rpm, 9500);
  EXPECT_EQ(s.spindle, SpindleDirection::clockwise);
  EXPECT_TRUE(s.inch);
  EXPECT_TRUE(s.coolant);
  EXPECT_EQ(r.moves.moves[4].block, 10u);
}

TEST(NcInterpreter, FlagsMovesWhosePlaceIsNotKnown) {
  const Read r =
      read_clean("G90 G0 X1 Y1\nZ5\nX2\nG91 G28 Z0.\nG90 G0 X3 Y3\nZ5\nG53 Z0\nG0 Z2\nX0\nG28 X10\nG0 X1\nY1\n");
  std::vector<bool> flags;
  for (const Move& m : r.moves.moves) flags.push_back(m.reference);
  EXPECT_EQ(flags,
            (std::vector<bool>{true, true, false, true, true, true, true, true, false, false, true, true, false}));
  EXPECT_EQ(r.moves.moves[3].end_mm.z(), 0);
}

TEST(NcInterpreter, StartsCuttingAtZeroWhereAnAxisWasNeverProgrammed) {
  const Read r = read_text("G0 X1 Y1\nG1 X2 F100\nY2\n");
  EXPECT_EQ(r.messages,
            Messages{"p.nc:2:1: warning: G1 before Z was programmed; the tool is assumed to be at Z0 [start-unknown]"});
  EXPECT_FALSE(r.moves.moves[1].reference);
}

TEST(NcInterpreter, WarnsOfCuttingAtTheReferencePoint) {
  EXPECT_EQ(read_text("G0 X1 Y1 Z1\nG28 Z1\nG1 X2 F100\n").messages,
            Messages{"p.nc:3:1: warning: G1 while Z is at the reference point; the move is ignored for material "
                     "removal [at-reference]"});
}

TEST(NcInterpreter, KnowsAbsoluteAndIncremental) {
  expect_near_mm(end_of("G0 X1 Y2 Z3\nG91 X1 Y1\nZ-1\nX-5\n"), {-3, 3, 2});
  expect_near_mm(end_of("G0 X1 Y2 Z3\nG91 G20 X1\nG90 G21 Z1"), {26.4, 2, 1});
}

TEST(NcInterpreter, ArcsInThreePlanesFullTurnsAndSeveralTurns) {
  const Read r = read_clean(
      "G0 X10 Y0 Z0\nG3 X0 Y10 I-10 J0 K0.000 F100\nG18 G2 X10 Z10 I10 K0\nG19 G3 Y20 Z20 J10 K0\nG17 G2 I5 J0\nG3 J-4 "
      "P3\n");
  const auto sweep = [&](std::size_t i) { return r.moves.arcs[r.moves.moves[i].arc].sweep_rad; };
  EXPECT_NEAR(sweep(1), kPi / 2, 1e-12);
  expect_near_mm(r.moves.arcs[1].normal, Vec3::UnitY());
  EXPECT_NEAR(sweep(2), -1.5 * kPi, 1e-12);
  EXPECT_NEAR(sweep(3), 1.5 * kPi, 1e-12);
  EXPECT_NEAR(sweep(4), -2 * kPi, 1e-12);
  EXPECT_NEAR(sweep(5), 6 * kPi, 1e-12);
}

TEST(NcInterpreter, ArcCentresAreAbsoluteAfterG901) {
  const Read r = read_clean("G90.1 G0 X10 Y0 Z0\nG3 X0 Y10 I0 J0 F100\nG91.1 G3 X-10 Y0 J-10\n");
  EXPECT_NEAR(r.moves.arcs[0].sweep_rad, kPi / 2, 1e-12);
  expect_near_mm(r.moves.arcs[1].center_mm, {0, 0, 0});
}

TEST(NcInterpreter, AssumesAbsoluteCentresWhereAllArcsFitOnlySo) {
  const Read r = read_text("G0 X10 Y0 Z0\nG3 X0 Y10 I0 J0 F100\nX-10 Y0 I0 J0\n");
  EXPECT_EQ(r.messages, Messages{"p.nc:2:1: warning: the 2 arcs of the program fit with absolute centres only; G90.1 "
                                 "is assumed [arc-centre]"});
  EXPECT_EQ(r.moves.arcs.size(), 2u);
}

TEST(NcInterpreter, WarnsOfRadiiThatDifferAndRefusesWhatIsTooFarOff) {
  EXPECT_EQ(read_clean("G0 X10 Y0 Z0\nG3 X0 Y10.004 I-10 J0 F100\n").moves.arcs.size(), 1u);
  EXPECT_EQ(
      read_text("G0 X10 Y0 Z0\nG3 X0 Y10.01 I-10 J0 F100\n").messages,
      Messages{
          "p.nc:2:1: warning: the radius of the arc is 10.0000 mm at its start and 10.0100 mm at its end; a difference "
          "below 0.005 mm was expected [arc-radius]"});
  EXPECT_EQ(
      read_text("G0 X10 Y0 Z0\nG3 X0 Y11 I-10 J0 F100\nG1 X0\n").messages,
      Messages{
          "p.nc:2:1: error: the radius of the arc is 10.0000 mm at its start and 11.0000 mm at its end; a difference "
          "below 0.05 mm was expected [arc-radius]"});
  const auto message = [](const char* y) {
    return read_text(std::string("G0 X10 Y0 Z0\nG3 X0 Y") + y + " I-10 J0 F100\n").messages.at(0);
  };
  EXPECT_NE(message("10.0495").find(" warning: "), std::string::npos);
  EXPECT_NE(message("10.0505").find(" error: "), std::string::npos);
}

TEST(NcInterpreter, FeedsInAllThreeModes) {
  const Read r =
      read_clean("G0 X0 Y0 Z0 S1200 M3\nG1 X10 F600\nG20 F10\nX0\nG21 G93 X10 F6\nX0 F12\nG95 F0.1 X10\nG94 X0 F60\n");
  const auto feed = [&](std::size_t i) { return r.moves.moves[i].feed_mm_per_s; };
  EXPECT_NEAR(feed(1), 10, 1e-12);
  EXPECT_NEAR(feed(2), 254.0 / 60, 1e-12);
  EXPECT_NEAR(feed(3), 10 * 6 / 60.0, 1e-12);
  EXPECT_NEAR(feed(4), 10 * 12 / 60.0, 1e-12);
  EXPECT_NEAR(feed(5), 0.1 * 1200 / 60, 1e-12);
  EXPECT_NEAR(feed(6), 1, 1e-12);
}

TEST(NcInterpreter, RefusesCuttingWithoutAFeed) {
  EXPECT_EQ(read_text("G0 X0 Y0 Z0\nN5 G1 X1\nX2\n").messages,
            Messages{"p.nc:2:4: error: G1 without a feed; F greater than zero was expected before or in this block "
                     "(and 1 more like "
                     "it) [feed-missing]"});
  EXPECT_EQ(read_text("G0 X0 Y0 Z0\nN120 G1 X40. Y12.5 F0\n").messages,
            Messages{"p.nc:2:20: error: F0 on a cutting move (G1); the feed must be greater than zero [feed-zero]"});
  EXPECT_EQ(read_text("G0 X0 Y0 Z0\nG1 X1 F-5\n").messages.at(0),
            "p.nc:2:7: error: the feed F is negative; a feed greater than zero was expected [feed-negative]");
  EXPECT_EQ(
      read_text("G93 G0 X0 Y0 Z0\nG1 X1 F6\nX2\n").messages,
      Messages{
          "p.nc:3:1: error: G1 in inverse time (G93) without F; every cutting block needs its own F [feed-missing]"});
  EXPECT_EQ(read_text("G95 G0 X0 Y0 Z0\nG1 X1 F.1\n").messages,
            Messages{"p.nc:2:1: error: a feed per revolution (G95) without a spindle speed; S was expected before "
                     "[feed-per-turn]"});
}

TEST(NcInterpreter, DwellsInSecondsOrMilliseconds) {
  InterpreterOptions fanuc{.inch = false, .dwell_p_is_ms = true};
  const auto dwell = [](const std::string& text, const InterpreterOptions& o) {
    return read_clean(text, o).moves.moves.at(0).dwell_s;
  };
  EXPECT_EQ(dwell("G4 P2", {.inch = false}), 2);
  EXPECT_EQ(dwell("G4 P0.2", fanuc), 0.2);
  EXPECT_EQ(dwell("G04 P500", fanuc), 0.5);
  EXPECT_EQ(dwell("G4 X1.5", fanuc), 1.5);
  EXPECT_EQ(dwell("G4 U1.5", fanuc), 1.5);
  EXPECT_EQ(read_text("G4").messages,
            Messages{"p.nc:1:1: error: G4 has no time; P with the time was expected [dwell]"});
  EXPECT_EQ(
      read_text("G4 P500").messages,
      Messages{
          "p.nc:1:4: warning: a dwell of 500 s; where P without a point counts milliseconds, the control must be named "
          "[dwell-long]"});
}

TEST(NcInterpreter, PathControlKeepsItsTolerancesInMillimetres) {
  const Read r = read_clean("G20 G0 X0 Y0 Z0\nG64 P0.001 Q0.0005\nG0 X1\nG61\nX2\nG61.1\nX3\nG64\nX4\nG9 X5\n");
  const auto state = [&](std::size_t i) { return r.moves.state_of(r.moves.moves[i]); };
  EXPECT_NEAR(state(1).blend_tolerance_mm, 0.0254, 1e-12);
  EXPECT_NEAR(state(1).merge_tolerance_mm, 0.0127, 1e-12);
  EXPECT_EQ(state(2).path_control, PathControl::exact_path);
  EXPECT_EQ(state(3).path_control, PathControl::exact_stop);
  EXPECT_EQ(state(4).path_control, PathControl::blend);
  EXPECT_EQ(state(4).blend_tolerance_mm, -1);
  EXPECT_TRUE(r.moves.moves[5].exact_stop);
  EXPECT_FALSE(r.moves.moves[4].exact_stop);
}

TEST(NcInterpreter, ChangesToolsWithPreselection) {
  const Read r = read_clean("T1\nG0 X0 Y0 Z0\nM6\nT2\nG0 X1\nM06\nG0 X2\nT3 M6\nG0 X3\n");
  std::vector<int> tools;
  for (const Move& m : r.moves.moves) tools.push_back(r.moves.state_of(m).tool);
  EXPECT_EQ(tools, (std::vector<int>{0, 1, 2, 3}));
  EXPECT_EQ(
      read_text("M6").messages,
      Messages{
          "p.nc:1:1: error: M6 without a tool: no T was given so far; T with a number was expected [tool-missing]"});
  EXPECT_EQ(
      read_text("T2\nG0 X1").messages,
      Messages{
          "p.nc:1:1: warning: the program selects tools (T) but never changes one; M6 was expected, all moves count as "
          "tool 0 [tool-not-changed]"});
}

TEST(NcInterpreter, TakesWordsThatAStrictReaderRefuses) {
  read_clean(
      "G0 X0 Y0 Z0\nM29 S175\nG08 P1\nG1 X1 F100\nG08 P0\nG05.1 Q1\nG05 P10000\nG187 P3 E0.1\nM48\nM49\nG43.1 Z1\nG54 "
      "P3\nG54.1 P12\nG98 G98\n");
  const Read r = read_clean("G08 P1\nG0 X0 Y0 Z0\nG08P0\nX1\n");
  EXPECT_TRUE(r.moves.state_of(r.moves.moves[0]).high_speed_contouring);
  EXPECT_FALSE(r.moves.state_of(r.moves.moves[1]).high_speed_contouring);
}

TEST(NcInterpreter, ReadsWhatProgramsOfCamSystemsHold) {
  // Words that a strict RS-274 reader refuses: an axis word after G80, G28 with G91 and G0, K0 on an arc in G17.
  const Read r = read_clean(
      "G0X0Y0Z5\r\nM29 S100\r\nG84Z-3.R1.F100\r\nG80 Z20.123456789\r\nG0 G91 G28 Z0.\r\nG90G0X1.Y1.Z1.(caf\xE9)\r\n"
      "G2 X3. I1. J0. K0.000 F100 [a (b) c]\r\nM30\r\n");
  EXPECT_NEAR(r.moves.moves[5].end_mm.z(), 20.123456789, 1e-12);
  EXPECT_NEAR(r.moves.arcs[0].sweep_rad, -kPi, 1e-12);
}

TEST(NcInterpreter, HighSpeedContouringIsAModalState) {
  for (const auto& [on, off] : {std::pair("G05 P10000", "G05 P0"), std::pair("G05.1 Q1", "G05.1 Q0"),
                                std::pair("G08 P1", "G08 P0"), std::pair("G5.1 Q1 R5", "G5.1 Q0")}) {
    const Read r = read_clean(std::string("G0 X0 Y0 Z0\n") + on + "\nG1 X1 F100\nY1\n" + off + "\nX0\n");
    std::vector<bool> fast;
    for (const Move& m : r.moves.moves) fast.push_back(r.moves.state_of(m).high_speed_contouring);
    EXPECT_EQ(fast, (std::vector<bool>{false, true, true, false})) << on;
  }
}

TEST(NcInterpreter, StopsTheSpindleAndTheCoolantAtTheEndOfTheBlock) {
  const Read r = read_clean("M3 S100 M8\nG0 X0 Y0 Z0 M5\nG0 X1 M9\nG0 X2\n");
  EXPECT_EQ(r.moves.state_of(r.moves.moves[0]).spindle, SpindleDirection::clockwise);
  EXPECT_EQ(r.moves.state_of(r.moves.moves[1]).spindle, SpindleDirection::stopped);
  EXPECT_TRUE(r.moves.state_of(r.moves.moves[1]).coolant);
  EXPECT_FALSE(r.moves.state_of(r.moves.moves[2]).coolant);
}

TEST(NcInterpreter, BlockSkipIsASwitch) {
  EXPECT_EQ(read_clean("G0 X0 Y0 Z0\n/X5\n").moves.moves.size(), 2u);
  EXPECT_EQ(read_clean("G0 X0 Y0 Z0\n/X5\n", {.inch = false, .skip_slash_blocks = true}).moves.moves.size(), 1u);
}

TEST(NcInterpreter, SharesModalStates) {
  std::string text = "G0 X0 Y0 Z0 S100 M3 F100\n";
  for (int i = 0; i < 1000; ++i) text += "G1 X" + std::to_string(i) + "\nG0 Z" + std::to_string(i) + "\n";
  EXPECT_EQ(read_clean(text).moves.states.size(), 1u);
}

TEST(NcInterpreter, NamesWhatItDoesNotKnow) {
  EXPECT_EQ(read_text("G12.3").messages,
            Messages{"p.nc:1:1: error: G12.3 is not a G code that Camber knows [unknown-g]"});
  EXPECT_EQ(read_text("G1.25").messages,
            Messages{"p.nc:1:1: error: G1.25 is not a G code that Camber knows [unknown-g]"});
  EXPECT_EQ(read_text("M88\nM88").messages, Messages{"p.nc:1:1: warning: M88 is not known; it is assumed to have no "
                                                     "effect on the path (and 1 more like it) [unknown-m]"});
  EXPECT_EQ(read_text("G0 X1 E5").messages,
            Messages{"p.nc:1:7: error: E is not a letter of a milling program [unknown-letter]"});
  EXPECT_EQ(read_text("G0 X1 A90.").messages,
            Messages{"p.nc:1:7: error: rotary axis A is read on a machine with [kinematics], by camber check, time, "
                     "feed, fit-feed, predict, compensate and post; X, Y and Z were expected [rotary-axis]"});
  EXPECT_EQ(read_text("G0 X1 A0").messages,
            Messages{"p.nc:1:7: warning: rotary axis A is not supported; it is assumed to stay at 0 [rotary-axis]"});
  EXPECT_EQ(read_text("G0 X1 A0 B0\nY1 B0\n").messages,
            Messages{"p.nc:1:7: warning: rotary axis A is not supported; it is assumed to stay at 0 (and 2 more like "
                     "it) [rotary-axis]"});
  EXPECT_EQ(read_text("G0 X1 U5").messages,
            Messages{"p.nc:1:7: error: axis U is not supported; X, Y and Z were expected [unknown-letter]"});
  EXPECT_EQ(
      read_text("G0 X1 Y1 Z1 K5.5\nX2 K1").messages,
      Messages{
          "p.nc:1:13: warning: K5.5 has no meaning in this block and is ignored (and 1 more like it) [unused-word]"});
  EXPECT_EQ(read_text("G0 X1 X2").messages,
            Messages{"p.nc:1:7: error: X appears twice in the block; one was expected [word-twice]"});
}

TEST(NcInterpreter, RepeatsOfAnErrorBeyondTheLastOneThatIsKeptAreNotCounted) {
  std::string text = "G0 X0 Y0 Z0\n";
  for (int i = 0; i < 25; ++i)
    text += fmt::format("G12.{} X1\n", i % 2 == 0 ? 3 : 4) + fmt::format("G{} X1\n", 201 + i);
  text += text;
  const Read r = read_text(text);
  EXPECT_EQ(r.diagnostics.errors(), Diagnostics::kMaxErrors);
}

TEST(NcInterpreter, NamesTurningPrograms) {
  EXPECT_EQ(read_text("G0 X0\nG96 S200 M3\nG1 X1").messages,
            Messages{"p.nc:2:1: error: G96 (constant cutting speed) belongs to a turning program; milling programs are "
                     "read [turning]"});
  EXPECT_EQ(
      read_text("G50 S4500").messages,
      Messages{
          "p.nc:1:1: error: G50 with S (largest spindle speed) belongs to a turning program; milling programs are read "
          "[turning]"});
}

TEST(NcInterpreter, RefusesContradictions) {
  EXPECT_EQ(
      read_text("G0 X0 Y0 Z0\nG0 G1 X1 F1").messages,
      Messages{"p.nc:2:4: error: G0 and G1 in one block exclude each other; one of them was expected [modal-group]"});
  EXPECT_EQ(
      read_text("G90 G91").messages,
      Messages{"p.nc:1:5: error: G90 and G91 in one block exclude each other; one of them was expected [modal-group]"});
  EXPECT_EQ(
      read_text("M3 M5").messages,
      Messages{"p.nc:1:4: error: M3 and M5 in one block exclude each other; one of them was expected [modal-group]"});
  EXPECT_EQ(
      read_text("X1").messages,
      Messages{"p.nc:1:1: error: X without a kind of motion; G0, G1, G2 or G3 was expected before [motion-missing]"});
  EXPECT_EQ(read_text("G0 X0 Y0 Z0\nG2 X2 F1 I1 P1.5").messages.at(0),
            "p.nc:2:13: error: 1.5 turns (P) on an arc; a whole number of one or more was expected [arc-turns]");
}

TEST(NcInterpreter, AssumesMillimetresWithAWarning) {
  EXPECT_EQ(
      read_text("N1\nG0 X1\nG1 Y1 Z1 F1", {}).messages.at(0),
      "p.nc:2:1: warning: the program has moves before G20 or G21 says which unit it is in; millimetres are assumed "
      "[unit-missing]");
  EXPECT_NEAR(read_clean("G0 X1", {.inch = true}).moves.moves[0].end_mm.x(), 25.4, 1e-12);
}

TEST(NcInterpreter, WarnsOfSeveralWorkOffsetsAndOfBlocksBehindTheEnd) {
  EXPECT_EQ(read_text("G54 G0 X0 Y0 Z0\nG1 X1 F1\nG55 X2\nX3\n").messages,
            Messages{"p.nc:3:1: warning: the program cuts in more than one work offset; their distance is not known, "
                     "and all are treated as one frame (and 1 more like it) [work-offsets]"});
  EXPECT_EQ(read_text("G0 X0\nM30\nG0 X1\n").messages,
            Messages{"p.nc:3:1: warning: the blocks after the end of the program (M2, M30) are not run [after-end]"});
}

// --- drilling cycles
// --------------------------------------------------------------------------------------------------

std::string steps_of(const Read& r) {
  std::string out;
  for (const Move& m : r.moves.moves) {
    if (!m.canned) continue;
    if (m.kind == MoveKind::dwell)
      out += "dwell " + std::to_string(m.dwell_s).substr(0, 3) + "; ";
    else {
      char text[80];
      std::snprintf(text, sizeof text, "%c %g %g %g; ", m.kind == MoveKind::rapid ? 'r' : 'f', m.end_mm.x(),
                    m.end_mm.y(), m.end_mm.z());
      out += text;
    }
  }
  return out;
}

TEST(NcCycles, DrillWithG98AndG99) {
  EXPECT_EQ(steps_of(read_clean("G0 X0 Y0 Z10\nG99 G81 X5 Z-3 R1 F100\nX6\nG80\nG0 Z10\n")),
            "r 5 0 10; r 5 0 1; f 5 0 -3; r 5 0 1; r 6 0 1; f 6 0 -3; r 6 0 1; ");
  EXPECT_EQ(steps_of(read_clean("G0 X0 Y0 Z10\nG98 G81 X5 Z-3 R1 F100\nX6\nG80\n")),
            "r 5 0 10; r 5 0 1; f 5 0 -3; r 5 0 10; r 6 0 10; r 6 0 1; f 6 0 -3; r 6 0 10; ");
}

TEST(NcCycles, GoToTheRetractLevelFirstFromBelow) {
  EXPECT_EQ(steps_of(read_clean("G0 X0 Y0 Z0\nG98 G81 X5 Z-3 R1 F100\n")), "r 0 0 1; r 5 0 1; f 5 0 -3; r 5 0 1; ");
}

TEST(NcCycles, DwellTapAndBore) {
  EXPECT_EQ(steps_of(read_clean("G0 X0 Y0 Z5\nG99 G82 Z-3 R1 P0.5 F100\n")), "r 0 0 1; f 0 0 -3; dwell 0.5; r 0 0 1; ");
  EXPECT_EQ(steps_of(read_clean("G0 X0 Y0 Z5\nM29 S100\nG98 G84 Z-3 R1 Q.5 F100\n")),
            "r 0 0 1; f 0 0 -3; f 0 0 1; r 0 0 5; ");
  EXPECT_EQ(steps_of(read_clean("G0 X0 Y0 Z5\nG99 G85 Z-3 R1 F100\n")), "r 0 0 1; f 0 0 -3; f 0 0 1; ");
  EXPECT_EQ(steps_of(read_clean("G0 X0 Y0 Z5\nG99 G86 Z-3 R1 P1. F100\n")), "r 0 0 1; f 0 0 -3; dwell 1.0; r 0 0 1; ");
  EXPECT_EQ(steps_of(read_clean("G0 X0 Y0 Z5\nG99 G89 Z-3 R1 P1. F100\n")), "r 0 0 1; f 0 0 -3; dwell 1.0; f 0 0 1; ");
}

TEST(NcCycles, FineBoringShiftsOffTheWall) {
  EXPECT_EQ(steps_of(read_clean("G0 X0 Y0 Z5\nG98 G76 X1 Z-3 R1 Q.5 P1. F100\n")),
            "r 1 0 5; r 1 0 1; f 1 0 -3; dwell 1.0; r 1.5 0 -3; r 1.5 0 5; r 1 0 5; ");
  EXPECT_EQ(steps_of(read_clean("G0 X0 Y0 Z5\nG99 G76 X1 Z-3 R1 I-.3 J.4 F100\n")),
            "r 1 0 5; r 1 0 1; f 1 0 -3; r 0.7 0.4 -3; r 0.7 0.4 1; r 1 0 1; ");
  EXPECT_EQ(
      read_text("G0 X0 Y0 Z5\nG76 X1 Z-3 R1 F100\n").messages,
      Messages{"p.nc:2:1: error: G76 has no shift off the wall; Q (or I, J) other than zero was expected [cycle]"});
}

TEST(NcCycles, BackBoringGoesDownBesideTheHoleAndBoresUp) {
  EXPECT_EQ(steps_of(read_clean("G0 X0 Y0 Z5\nG98 G87 X1 Z-10 R-20 Q.5 P1. F100\n")),
            "r 1 0 5; r 1.5 0 5; r 1.5 0 -20; r 1 0 -20; f 1 0 -10; dwell 1.0; r 1.5 0 -10; r 1.5 0 5; r 1 0 5; ");
  EXPECT_EQ(read_text("G0 X0 Y0 Z5\nG98 G87 X1 Z-20 R-10 Q.5 F100\n").messages,
            Messages{"p.nc:2:1: error: G87 bores upwards from R -10.0000 mm to Z -20.0000 mm; R below it and below the "
                     "initial level 5.0000 mm was expected [cycle]"});
  EXPECT_EQ(read_text("G0 X0 Y0 Z5\nG99 G87 X1 Z-10 R-20 Q.5 F100\n").messages,
            Messages{"p.nc:2:1: error: G87 with G99 would leave the tool under the work; G98 was expected [cycle]"});
}

TEST(NcCycles, BoringWithARetractByHandIsTakenAsARapid) {
  const Read r = read_text("G0 X0 Y0 Z5\nG99 G88 Z-3 R1 P1. F100\n");
  EXPECT_EQ(steps_of(r), "r 0 0 1; f 0 0 -3; dwell 1.0; r 0 0 1; ");
  EXPECT_EQ(r.messages, Messages{"p.nc:2:1: warning: G88 is retracted by hand; a rapid is taken in its place [cycle]"});
}

TEST(NcCycles, TappingFeedIsAMinutesOrATurns) {
  // M6 x 1 at 500 rpm: 500 mm/min, or 1 mm a turn.
  for (const char* text : {"S500 M3 G0 X0 Y0 Z5\nG94 G84 Z-9 R1 F500\n", "S500 M4 G0 X0 Y0 Z5\nG95 G74 Z-9 R1 F1\n"}) {
    const Read r = read_clean(text);
    ASSERT_EQ(r.moves.moves.size(), 5u);
    EXPECT_NEAR(r.moves.moves[2].feed_mm_per_s, 500.0 / 60, 1e-12);
    EXPECT_NEAR(r.moves.moves[3].feed_mm_per_s, 500.0 / 60, 1e-12);
    EXPECT_EQ(r.moves.moves[3].kind, MoveKind::linear);
  }
}

TEST(NcCycles, RepeatInIncrementsWithK) {
  EXPECT_EQ(steps_of(read_clean("G0 X0 Y0 Z5\nG91 G99 G81 X10 Y1 Z-3 R-4 K3 F100\nG80\nG90 G0 X0\n")),
            "r 10 1 5; r 10 1 1; f 10 1 -2; r 10 1 1; r 20 2 1; f 20 2 -2; r 20 2 1; r 30 3 1; f 30 3 -2; r 30 3 1; ");
  EXPECT_EQ(steps_of(read_clean("G0 X0 Y0 Z5\nG81 X10 Z-3 R1 K0 F100\nX20\n")),
            "r 20 0 5; r 20 0 1; f 20 0 -3; r 20 0 5; ");
}

TEST(NcCycles, InARotatedAndAShiftedFrame) {
  EXPECT_EQ(steps_of(read_clean("G0 X0 Y0 Z5\nG52 X1 Z-1\nG68 X0 Y0 R90\nG99 G81 X10 Y0 Z-3 R1 F100\nX20\n")),
            "r 1 10 5; r 1 10 0; f 1 10 -4; r 1 10 0; r 1 20 0; f 1 20 -4; r 1 20 0; ");
}

TEST(NcCycles, PeckWithFullRetractOrChipBreak) {
  InterpreterOptions o{.inch = false, .peck_clearance_mm = 0.5};
  EXPECT_EQ(steps_of(read_clean("G0 X0 Y0 Z5\nG99 G83 Z-3 R1 Q1.5 F100\n", o)),
            "r 0 0 1; f 0 0 -0.5; r 0 0 1; r 0 0 0; f 0 0 -2; r 0 0 1; r 0 0 -1.5; f 0 0 -3; r 0 0 1; ");
  EXPECT_EQ(steps_of(read_clean("G0 X0 Y0 Z5\nG99 G73 Z-2 R1 Q1.5 F100\n", o)),
            "r 0 0 1; f 0 0 -0.5; r 0 0 0; f 0 0 -2; r 0 0 1; ");
}

TEST(NcCycles, RepeatInIncrements) {
  EXPECT_EQ(steps_of(read_clean("G0 X0 Y0 Z5\nG91 G99 G81 X10 Z-3 R-4 L2 F100\n")),
            "r 10 0 5; r 10 0 1; f 10 0 -2; r 10 0 1; r 20 0 1; f 20 0 -2; r 20 0 1; ");
}

TEST(NcCycles, InOtherPlanes) {
  EXPECT_EQ(steps_of(read_clean("G0 X0 Y5 Z0\nG18 G99 G81 X3 Y-3 R1 F100\n")), "r 3 5 0; r 3 1 0; f 3 -3 0; r 3 1 0; ");
}

TEST(NcCycles, SayWhatIsMissing) {
  EXPECT_EQ(read_text("G0 X0 Y0 Z5\nG81 X1 F100\n").messages,
            (Messages{"p.nc:2:1: error: G81 has no retract level; R was expected [cycle]",
                      "p.nc:2:1: error: G81 has no depth; Z was expected [cycle]"}));
  EXPECT_EQ(read_text("G0 X0 Y0 Z5\nG83 X1 Z-3 R1 F100\n").messages,
            Messages{"p.nc:2:1: error: G83 has no depth of each peck; Q greater than zero was expected [cycle]"});
  EXPECT_EQ(read_text("G0 X0 Y0 Z5\nG83 X1 Z-3000 R1 Q0.001 F100\n").messages,
            Messages{"p.nc:2:1: error: G83 would peck more than 100000 times; a larger Q was expected [cycle]"});
  EXPECT_EQ(
      read_text("G0 X0 Y0 Z5\nG81 X1 Z3 R1 F100\n").messages,
      Messages{"p.nc:2:1: error: the bottom of G81 at Z 3.0000 mm is above its retract level R 1.0000 mm [cycle]"});
  EXPECT_EQ(read_text("G0 X0 Y0 Z5\nG81 X1 Z-3 R1\n").messages,
            Messages{"p.nc:2:1: error: G81 without a feed; F greater than zero was expected before or in this block "
                     "[feed-missing]"});
}

/// A few bytes of text must not fill the memory or take minutes.
TEST(NcInterpreter, BoundsWhatAFewWordsCanMake) {
  std::string text = "G0X0Y0Z5.\nG91G83X1.Z-1.R-1.Q.01F100L100000\n";
  EXPECT_EQ(read_text(text + "X1.L100000\n").messages,
            (Messages{"p.nc:2:1: error: the drilling cycles make more than 1000000 moves; fewer repeats (L) or a "
                      "larger Q were expected (and 1 more like it) [cycle]"}));
  std::string codes;
  for (int i = 0; i < 30000; ++i) codes += "G0G1";
  EXPECT_EQ(read_text(codes + "X1F1\n").messages.front(),
            "p.nc:1:1: error: 60000 G words in one block; at most 64 are read [too-many-words]");
}

}  // namespace
}  // namespace camber::nc
