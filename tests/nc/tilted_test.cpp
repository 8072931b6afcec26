// Tilted frames (G68.2, G53.1), the dynamic work offset (G254), rotary words with other codes.
#include <cmath>

#include <gtest/gtest.h>

#include "base/units.h"
#include "nc/summary.h"
#include "tests/nc/nc_text.h"

namespace camber::nc {
namespace {

using Messages = std::vector<std::string>;

InterpreterOptions five_axes(std::string_view dialect = "fanuc", bool head = false) {
  InterpreterOptions options = as(dialect);
  options.rotary_axes = {{.letter = 'B', .on_table = !head}, {.letter = 'C'}};
  return options;
}

Messages said(const std::string& text, std::string_view dialect = "fanuc") {
  return read_text(text, five_axes(dialect)).messages;
}

TEST(TiltedFrame, EulerAnglesTurnAboutZThenNewXThenNewZ) {
  // About Z by 90: x' = Y. About x' by 30: z'' = (sin 30, 0, cos 30). About z'' by 0.
  const Read r =
      read_clean("G0 X0 Y0 Z0\nG68.2 X10. Y20. Z30. I90. J30. K0\nX1. Y0 Z0\nX0 Y1.\nY0 Z1.\nG69\n", five_axes());
  ASSERT_EQ(r.moves.moves.size(), 4U);
  const double s = 0.5, c = std::sqrt(0.75);
  expect_near_mm(r.moves.moves[1].end_mm, Vec3(10, 21, 30), 1e-12);          // X of the frame is Y
  expect_near_mm(r.moves.moves[2].end_mm, Vec3(10 - c, 20, 30 + s), 1e-12);  // Y of the frame
  expect_near_mm(r.moves.moves[3].end_mm, Vec3(10 + s, 20, 30 + c), 1e-12);  // its Z
  const Read k = read_clean("G0 X0 Y0 Z0\nG68.2 I90. J30. K90.\nX1. Y0 Z0\nG69\n", five_axes());
  expect_near_mm(k.moves.moves[1].end_mm, Vec3(-c, 0, s), 1e-12);  // K turns X to what was Y
}

TEST(TiltedFrame, G531IsAMoveThatTurnsTheToolAlongZ) {
  const Read r = read_clean("G0 X0 Y0 Z0\nZ50.\nG68.2 X1. Y2. Z3. I90. J30. K0\nG53.1\nG0 X5. Y0\nZ10.\nG1 Z0 F100\n",
                            five_axes());
  ASSERT_EQ(r.moves.moves.size(), 6U);
  ASSERT_EQ(r.moves.rotary.size(), 1U);
  EXPECT_EQ(r.moves.rotary[0].move, 2U);
  EXPECT_TRUE(r.moves.rotary[0].is_direction);
  expect_near_mm(r.moves.rotary[0].end, Vec3(0.5, 0, std::sqrt(0.75)), 1e-15);
  const auto& moves = r.moves.moves;
  EXPECT_EQ(moves[2].open_axes, 7);  // the linear axes stay
  EXPECT_EQ(moves[3].open_axes, 4);  // Z is where the rotary axes left it
  EXPECT_TRUE(moves[3].start_open);
  EXPECT_EQ(moves[4].open_axes, 0);
  EXPECT_TRUE(moves[4].start_open);
  EXPECT_FALSE(moves[5].start_open);
  EXPECT_EQ(r.moves.state_of(moves[2]).work_frame, WorkFrame::tilted);
  const Summary s = summarize(r.program, r.moves);
  EXPECT_EQ(s.rotary, 1U);
  EXPECT_EQ(s.tilted_frame, 4U);
  EXPECT_DOUBLE_EQ(s.cutting_length_mm, 10);
  EXPECT_DOUBLE_EQ(s.rapid_length_mm, 50);  // no length is made up for moves from an open place
}

TEST(TiltedFrame, OtherFramesStandOnIt) {
  // A G68 inside turns within the tilted plane; work offsets and G52 from before stay.
  const Read r = read_clean(
      "G0 X0 Y0 Z0\nG52 X100.\nG68.2 X10. I90. J90. K0\nG68 X0 Y0 R90.\nX1. Y0 Z0\nG69\nG0 X1. Y0 Z0\nG52 X0\n",
      five_axes());
  // Plane: x' = Y, y' = Z, z' = X. G68 turns x' to y'.
  expect_near_mm(r.moves.moves[1].end_mm, Vec3(110, 0, 1), 1e-12);
  expect_near_mm(r.moves.moves[2].end_mm, Vec3(101, 0, 0), 1e-12);
}

TEST(TiltedFrame, ArcsLieInThePlane) {
  const Read r =
      read_clean("G0 X0 Y0 Z0\nG68.2 I90. J90. K0\nG53.1\nG0 X10. Y0 Z0\nG3 X0 Y10. I-10. F100\n", five_axes());
  const Move& arc = r.moves.moves.back();
  expect_near_mm(point_at(r.moves, arc, 0.5), Vec3(0, 10 * std::sqrt(0.5), 10 * std::sqrt(0.5)), 1e-12);
  EXPECT_NEAR(length_mm(r.moves, arc), 5 * kPi, 1e-12);
}

TEST(TiltedFrame, CyclesDrillAlongZOfTheFrame) {
  const Read r =
      read_clean("G0 X0 Y0 Z0\nG68.2 I90. J90. K0\nG53.1\nG0 Z20.\nG81 X5. Y6. Z-4. R2. F100\nX7.\nG80\n", five_axes());
  // Frame coordinates (x', y', z') are (Z..): x' = Y, y' = Z, z' = X.
  const auto& moves = r.moves.moves;
  ASSERT_EQ(moves.size(), 11U);
  expect_near_mm(moves[3].end_mm, Vec3(20, 5, 6), 1e-12);
  expect_near_mm(moves[5].end_mm, Vec3(-4, 5, 6), 1e-12);
  EXPECT_EQ(moves[5].kind, MoveKind::linear);
  expect_near_mm(moves[9].end_mm, Vec3(-4, 7, 6), 1e-12);
}

TEST(TiltedFrame, BadInputByWholeMessage) {
  const std::string start = "G0 X0 Y0 Z0\n";
  EXPECT_EQ(said(start + "G53.1\n"),
            Messages{"p.nc:2:1: error: G53.1 without a tilted frame; G68.2 was expected before [tilted-frame]"});
  EXPECT_EQ(said(start + "G43.4 H1\nG68.2 J30.\n"),
            Messages{"p.nc:3:1: error: G68.2 under tool-centre-point control; G49 was expected before [tilted-frame]"});
  EXPECT_EQ(
      said("T1 M6\n" + start + "G43 H1\nM428\nG68.2 J30.\n", "linuxcnc"),
      Messages{"p.nc:5:1: error: G68.2 under tool-centre-point control; M429 was expected before [tilted-frame]"});
  EXPECT_EQ(said(start + "G68.2 J30.\nG43.4 H1\n"),
            Messages{"p.nc:3:1: error: G43.4 while a tilted frame is active; G69 was expected before [tilted-frame]"});
  EXPECT_EQ(said(start + "G68.2 J30.\nG68.2 J40.\n"),
            Messages{"p.nc:3:1: error: G68.2 while a tilted frame is active; G69 was expected before [tilted-frame]"});
  EXPECT_EQ(
      said(start + "G68.2 P1 Q123 J30.\n"),
      Messages{"p.nc:2:7: error: G68.2 with P1 is not supported; Euler angles I, J and K were expected [not-read]"});
  EXPECT_EQ(said(start + "G68.2 J30.\nG53.1 P1\n"),
            Messages{"p.nc:3:7: error: G53.1 P1 is not supported; G53.1 without P (the nearest angles) was expected "
                     "[not-read]"});
  EXPECT_EQ(said(start + "G68.2 J30.\nG53.1 X5.\n"),
            Messages{"p.nc:3:7: error: X in a block with G53.1; a block of its own was expected [tilted-frame]"});
  EXPECT_EQ(said(start + "G68.2 J30.\nG53.1\nG0 X0 Y0 Z0\nB5.\n"),
            Messages{"p.nc:5:1: error: B in a block with a tilted frame (G68.2) after G53.1 is not supported; rotary "
                     "words were expected with G0 to G3, G28, G30, G53 or a drilling cycle [rotary-axis]"});
  EXPECT_EQ(said(start + "G68.2 J30.\nG52 X5.\n"),
            Messages{"p.nc:3:1: error: G52 while a tilted frame is active; G69 was expected before [tilted-frame]"});
  EXPECT_EQ(said(start + "G68.2 J30.\nG55\n"),
            Messages{"p.nc:3:1: error: G55 changes the work offset while a tilted frame is active; G69 was expected "
                     "before [tilted-frame]"});
  EXPECT_EQ(said(start + "G81 X1 Z-1 R1 F100\nG68.2 J30.\n"),
            Messages{"p.nc:3:1: error: G68.2 in the cycle G81; G80 was expected before [tilted-frame]"});
  EXPECT_EQ(said(start + "G68.2 J30.\nG53.1\nG2 X1 Y1 I1 F100\n"),
            Messages{"p.nc:4:1: error: an arc after G53.1 before X, Y and Z were programmed; G0 or G1 with them was "
                     "expected [position-open]"});
  EXPECT_EQ(said(start + "G68.2 J30.\nG53.1\nG91 G0 X1\n"),
            Messages{"p.nc:4:8: error: X in G91 after G53.1, which leaves X open; G90 was expected [position-open]"});
  EXPECT_EQ(read_text("G68.2 J30.\n").messages,
            Messages{"p.nc:1:1: error: G68.2 (tilted frame) is read on a machine with [kinematics], by camber check, "
                     "time, feed, fit-feed, predict, compensate and post [not-read]"});
  EXPECT_EQ(read_text("G53.1\n").messages,
            Messages{"p.nc:1:1: error: G53.1 (tilted frame) is read on a machine with [kinematics], by camber check, "
                     "time, feed, fit-feed, predict, compensate and post [not-read]"});
}

TEST(TiltedFrame, OtherCodesForPlanesAreRefusedByName) {
  EXPECT_EQ(
      said("G0 X0 Y0 Z0\nG68.3 X0\nG53.6\nG268 X0\n"),
      (Messages{"p.nc:2:1: error: G68.3 (tilted frame from the direction of the tool) is not supported [not-read]",
                "p.nc:3:1: error: G53.6 (turns the tool along Z of a tilted frame about its tip) is not supported "
                "[not-read]",
                "p.nc:4:1: error: G268 (tilted frame of Haas) is not supported [not-read]"}));
}

TEST(DynamicOffset, IsAStateOfTheMoves) {
  const Read r = read_clean(
      "G54 G0 X0 Y0 Z0\nG0 B30. C90.\nG254\nX1. Y2.\nZ3.\nG1 Z2. F100\nG0 C180.\nX1. Y2. Z3.\nG255\nX1. Y1. Z1.\n",
      five_axes("haas"));
  const auto& moves = r.moves.moves;
  ASSERT_EQ(moves.size(), 8U);
  EXPECT_EQ(moves[2].open_axes, 4);
  EXPECT_TRUE(moves[2].start_open);
  EXPECT_EQ(moves[3].open_axes, 0);
  EXPECT_EQ(moves[5].open_axes, 7);  // C turns under it: the linear axes stay
  EXPECT_TRUE(moves[6].start_open);
  EXPECT_TRUE(moves[7].start_open);
  for (std::size_t i = 0; i < moves.size(); ++i)
    EXPECT_EQ(r.moves.state_of(moves[i]).work_frame, i >= 2 && i < 7 ? WorkFrame::dynamic : WorkFrame::machine) << i;
  EXPECT_EQ(summarize(r.program, r.moves).dynamic_offset, 5U);
}

TEST(DynamicOffset, BadInputByWholeMessage) {
  const std::string start = "G0 X0 Y0 Z0\n";
  EXPECT_EQ(said(start + "G254\nX1. B5.\n", "haas"),
            Messages{"p.nc:3:5: error: B in a block with X, Y or Z under G254 is not supported; rotary words were "
                     "expected with G0 to G3, G28, G30, G53 or a drilling cycle [rotary-axis]"});
  EXPECT_EQ(said(start + "G234 H1\nG254\n", "haas"),
            Messages{"p.nc:3:1: error: G254 under tool-centre-point control; G49 was expected before [tilted-frame]"});
  EXPECT_EQ(said(start + "G254\nG234 H1\n", "haas"),
            Messages{"p.nc:3:1: error: G234 while the dynamic work offset (G254) is active; G255 was expected before "
                     "[tilted-frame]"});
  EXPECT_EQ(said(start + "G254\nG68.2 J5.\n", "haas"),
            Messages{"p.nc:3:1: error: G68.2 while the dynamic work offset (G254) is active; G255 was expected before "
                     "[tilted-frame]"});
  EXPECT_EQ(read_text(start + "G254\n", five_axes("haas", true)).messages,
            Messages{"p.nc:2:1: error: G254 on a machine whose head turns about B is not supported; rotary axes of the "
                     "table were expected [tilted-frame]"});
  EXPECT_EQ(read_text("G254\n").messages,
            Messages{"p.nc:1:1: error: G254 (dynamic work offset) is read on a machine with [kinematics], by camber "
                     "check, time, feed, fit-feed, predict, compensate and post [not-read]"});
}

TEST(RotaryWords, WithReferencePointsGoToZeroOfTheMachine) {
  const Read r = read_clean("G0 X0 Y0 Z0 B30. C40.\nG91 G28 B0\nG90\nG28 C10.\nG0 B5. C6.\nG28\n", five_axes());
  const auto& t = r.moves.rotary;
  ASSERT_EQ(t.size(), 6U);
  EXPECT_EQ(t[1].given, 1 << 1);  // home, without a move to an intermediate point
  expect_near_mm(t[1].end, Vec3(0, 0, rad_from_deg(40)), 1e-15);
  expect_near_mm(t[2].end, Vec3(0, 0, rad_from_deg(10)), 1e-15);  // through C10.
  expect_near_mm(t[3].end, Vec3::Zero(), 1e-15);
  EXPECT_EQ(t[5].given, 6);
  expect_near_mm(t[5].end, Vec3::Zero(), 1e-15);
  EXPECT_EQ(r.moves.machine_targets.back().given, 7);
  EXPECT_TRUE(std::isnan(r.moves.machine_targets.back().end_mm.x()));  // nobody knows where that is
}

TEST(RotaryWords, ReturnsAfterADirection) {
  read_clean("G0 X0 Y0 Z0\nG68.2 J30.\nG53.1\nG0 X0 Y0 Z50.\nG69\nG91 G28 Z0\nG28 B0 C0\nG90\nG0 X1. Y1. Z50.\n",
             five_axes());
}

TEST(RotaryWords, OfACycleTurnBeforeTheToolGoesDown) {
  const Read r = read_clean("G0 X0 Y0 Z20.\nG81 X5. Y0 Z-4. R2. B30. F100\nB60.\nG91 C30. L3\nG80\n", five_axes());
  const auto& m = r.moves.moves;
  const auto& t = r.moves.rotary;
  ASSERT_EQ(t.size(), 5U);
  EXPECT_EQ(t[0].move, 1U);  // the rapid over the hole
  expect_near_mm(m[1].end_mm, Vec3(5, 0, 20), 0);
  EXPECT_EQ(t[1].move, 5U);  // alone, up there
  expect_near_mm(m[5].end_mm, m[5].start_mm, 0);
  expect_near_mm(m[5].end_mm, Vec3(5, 0, 20), 0);
  expect_near_mm(m[6].end_mm, Vec3(5, 0, 2), 0);
  for (std::size_t i = 2; i < 5; ++i)
    EXPECT_NEAR(t[i].end.z(), rad_from_deg(30. * static_cast<double>(i - 1)), 1e-12);  // a circle of holes
  EXPECT_EQ(summarize(r.program, r.moves).rotary, 5U);
}

TEST(RotaryWords, OfAnArcMakeAHelixWithRotaryMotion) {
  const Read r = read_clean("G0 X10. Y0 Z0\nG3 X10. Y0 I-10. Z-5. C360. F100\n", five_axes());
  ASSERT_EQ(r.moves.rotary.size(), 1U);
  EXPECT_EQ(r.moves.moves[1].kind, MoveKind::arc);
  EXPECT_NEAR(r.moves.rotary[0].end.z(), 2 * kPi, 1e-12);
}

TEST(RotaryOffsets, ShiftRotaryWords) {
  Read r = read_clean("G10 L2 P1 X5 Y6 Z7 B10. C-20.\nG54 G0 X0 Y0 Z0 B5. C0\nG53 B0\nG91 B5.\n", five_axes());
  const auto& t = r.moves.rotary;
  ASSERT_EQ(t.size(), 3U);
  expect_near_mm(t[0].end, Vec3(0, rad_from_deg(15), rad_from_deg(-20)), 1e-15);
  EXPECT_NEAR(t[1].end.y(), 0, 1e-15);
  EXPECT_NEAR(t[2].end.y(), rad_from_deg(5), 1e-15);
  InterpreterOptions options = five_axes();
  options.work_offsets_mm[54] = Vec3(1, 2, 3);
  options.rotary_offsets_rad[54] = Vec3(0, 0, 0.5);
  r = read_clean("G54 G0 X0 Y0 Z0 C0\n", options);
  EXPECT_NEAR(r.moves.rotary[0].end.z(), 0.5, 1e-15);
  EXPECT_EQ(*r.moves.machine_origin_mm, Vec3(-1, -2, -3));
  EXPECT_EQ(read_text("G54 G0 X0 Y0 Z0\nG68.2 J30.\nG53.1\n", options).messages,
            Messages{"p.nc:3:1: error: a tilted frame (G68.2) with a work offset of a rotary axis is not supported; "
                     "offsets A0 B0 C0 were expected [rotary-offset]"});
}

}  // namespace
}  // namespace camber::nc
