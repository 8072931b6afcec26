// Where programmed coordinates lie: positions by hand, and edits that go back into the text.
#include <cmath>

#include "nc/emit.h"
#include "tests/nc/nc_text.h"

namespace camber::nc {
namespace {

using Messages = std::vector<std::string>;

InterpreterOptions fanuc() {
  InterpreterOptions o = units();
  o.dialect = *dialect_named("fanuc");
  return o;
}

std::vector<Vec3> ends(const Read& r) {
  std::vector<Vec3> out;
  for (const Move& m : r.moves.moves) out.push_back(m.end_mm);
  return out;
}

void expect_ends(const std::string& text, const std::vector<Vec3>& wanted, const InterpreterOptions& o = fanuc(),
                 const Messages& said = {}) {
  const Read r = read_text("G0 X0 Y0 Z0 F100\n" + text, o);
  EXPECT_EQ(r.messages, said) << text;
  ASSERT_EQ(r.moves.moves.size(), wanted.size() + 1) << text;
  for (std::size_t i = 0; i < wanted.size(); ++i) expect_near_mm(r.moves.moves[i + 1].end_mm, wanted[i], 1e-9);
}

TEST(Frames, LocalShiftAddsAndIsTakenBack) {
  expect_ends("G52 X10 Y-5\nG0 X1 Y1 Z1\nG91 X1\nG90 G52 X0\nX1\nG52 Y0\nX0 Y0\n",
              {{11, -4, 1}, {12, -4, 1}, {1, -4, 1}, {0, 0, 1}});
}

TEST(Frames, PositionSetByG92) {
  // At X10 Y20 the tool is told to be at X1 Y2: the origin lies at (9, 18).
  expect_ends("G0 X10 Y20\nG92 X1 Y2\nX0 Y0\nX5\nG92.1\nX0 Y0\n", {{10, 20, 0}, {9, 18, 0}, {14, 18, 0}, {0, 0, 0}});
  expect_ends("G0 X10\nG92 X0\nX1\nG92.2\nX1\nG92.3\nX1\n", {{10, 0, 0}, {11, 0, 0}, {1, 0, 0}, {11, 0, 0}});
}

TEST(Frames, G52AndG92AddOnFanucAndShareOneShiftOnLinuxCnc) {
  expect_ends("G0 X10\nG92 X0\nG52 X3\nX0\nG52 X0\nX0\n", {{10, 0, 0}, {13, 0, 0}, {10, 0, 0}});
  expect_ends("G0 X10\nG92 X0\nG52 X3\nX0\nG52 X0\nX0\n", {{10, 0, 0}, {3, 0, 0}, {0, 0, 0}}, as("linuxcnc"));
  // On Fanuc G92 takes a local shift away.
  expect_ends("G52 X3\nG0 X0\nG92 X0\nG52 X0\nX0\n", {{3, 0, 0}, {3, 0, 0}});
}

TEST(Frames, G92AtTheReferencePointSaysWhereTheToolStands) {
  const Read r = read_clean("G0 G28 X0 Y0 Z0\nG92 X-300 Y-200 Z150\nG0 X5 Y5\nZ2\nG1 X6 F100\n");
  expect_near_mm(r.moves.moves[1].start_mm, {-300, -200, 150});
  expect_near_mm(r.moves.moves[1].end_mm, {5, 5, 150});
  EXPECT_FALSE(r.moves.moves[3].reference);
  for (std::size_t i = 1; i < r.moves.moves.size(); ++i)
    expect_near_mm(r.moves.moves[i].start_mm, r.moves.moves[i - 1].end_mm);
}

TEST(Frames, WorkOffsetsSetByTheProgramLieWhereTheyAreSet) {
  const Read r = read_clean(
      "G10 L2 P1 X100 Y200 Z-50\nG10 L2 P2 X110 Y200 Z-60\nG54 G0 X1 Y2 Z3\nG55 X1 Y2 Z3\nG1 X2 F100\nG54 X2\nG91 "
      "G10 L2 P1 X5\nG90 X2\nG10 L2 P0 Y7\nY2\n",
      fanuc());
  const auto e = ends(r);
  expect_near_mm(e[0], {1, 2, 3});  // the moves are in G54, the first one used
  expect_near_mm(e[1], {11, 2, -7});
  expect_near_mm(e[2], {12, 2, -7});
  expect_near_mm(e[3], {2, 2, -7});
  expect_near_mm(e[4], {7, 2, -7});
  expect_near_mm(e[5], {7, 9, -7});
}

TEST(Frames, WorkOffsetsGivenByTheCaller) {
  InterpreterOptions o = units();
  o.work_offsets_mm = {{54, {100, 0, 0}}, {55, {150, 10, 0}}, {540007, {90, 0, 0}}};
  expect_ends("G55 X0 Y0\nG54.1 P7 X0 Y0\nG53 X100 Y5\nG54 G1 X1\n", {{50, 10, 0}, {-10, 0, 0}, {0, 5, 0}, {1, 5, 0}},
              o);
}

TEST(Frames, UnknownWorkOffsetsShareOneFrameWithAWarning) {
  expect_ends("G54 G1 X1\nG55 X2\n", {{1, 0, 0}, {2, 0, 0}}, fanuc(),
              {"p.nc:3:1: warning: the program cuts in more than one work offset; their distance is not known, and all "
               "are treated as one frame [work-offsets]"});
  // Known ones keep their distance from each other, not from an unknown one.
  expect_ends("G54 G1 X1\nG10 L2 P2 X50\nG10 L2 P3 X60\nG55 X2\nG56 X2\n", {{1, 0, 0}, {2, 0, 0}, {12, 0, 0}}, fanuc(),
              {"p.nc:5:1: warning: the program cuts in more than one work offset; their distance is not known, and all "
               "are treated as one frame (and 1 more like it) [work-offsets]"});
  expect_ends("G10 L2 P1 X50\nG1 X2\n", {{2, 0, 0}}, fanuc(),
              {"p.nc:2:1: warning: G10 L2 sets the work offset that the program has moved in; its previous position is "
               "not known and is assumed to be the same [work-offsets]"});
}

TEST(Frames, G10L20TouchesOffOrSetsG541) {
  InterpreterOptions linuxcnc = as("linuxcnc");
  linuxcnc.work_offsets_mm = {{54, Vec3::Zero()}};
  expect_ends("G0 X7\nG10 L20 P1 X0\nX1\n", {{7, 0, 0}, {8, 0, 0}}, linuxcnc);
  InterpreterOptions o = fanuc();
  o.work_offsets_mm = {{54, Vec3::Zero()}};
  expect_ends("G0 X7\nG10 L20 P1 X30\nX1\nG54.1 P1 X1\n", {{7, 0, 0}, {1, 0, 0}, {31, 0, 0}}, o);
}

TEST(Frames, RotationInThreePlanes) {
  expect_ends("G17 G68 X10 Y0 R90\nG1 X20 Y0\nX20 Y5\nG69 X0 Y0\n", {{10, 10, 0}, {5, 10, 0}, {0, 0, 0}});
  expect_ends("G18 G68 X0 Z0 R90\nG1 Z10\nG69\n", {{10, 0, 0}});            // Z towards X
  expect_ends("G19 G68 Y0 Z0 R90\nG1 Y10\nG69\n", {{0, 0, 10}});            // Y towards Z
  expect_ends("G0 X3 Y4\nG68 R180\nX4 Y4\nG69\n", {{3, 4, 0}, {2, 4, 0}});  // about where the tool stands
  const double c = std::cos(kPi / 6), s = std::sin(kPi / 6);
  expect_ends("G68 X0 Y0 R30\nG91 G1 X10\nY10\nG69\n", {{10 * c, 10 * s, 0}, {10 * c - 10 * s, 10 * s + 10 * c, 0}});
  expect_ends("G68 X0 Y0 R900000000090\nG1 X10\n", {{0, 10, 0}});  // more quarter turns than an int holds
  InterpreterOptions haas = fanuc();
  haas.dialect = *dialect_named("haas");
  expect_ends("G68 X0 Y0 R30\nG91 G68 X0 Y0 R60\nG90 G1 X10\n", {{0, 10, 0}}, haas);
}

TEST(Frames, RotationTurnsArcsWithThem) {
  const Read r = read_clean("G0 X10 Y0 Z0\nG68 X0 Y0 R90\nG1 X10 Y0 F100\nG3 X0 Y10 I-10 J0\nG3 X10 Y0 R10\n");
  expect_near_mm(r.moves.moves[2].end_mm, {-10, 0, 0});
  EXPECT_NEAR(r.moves.arcs[0].sweep_rad, kPi / 2, 1e-12);
  expect_near_mm(r.moves.arcs[0].center_mm, {0, 0, 0});
  EXPECT_NEAR(r.moves.arcs[1].sweep_rad, kPi / 2, 1e-12);
  expect_near_mm(r.moves.arcs[1].center_mm, {-10, 10, 0});
}

TEST(Frames, MirrorImageTurnsTheSenseOfArcs) {
  const Read r = read_clean("G0 X10 Y0 Z0\nG51.1 X0\nG0 X10 Y0\nG3 X0 Y10 I-10 F100\nG50.1 X0\nG3 X-10 Y0 J-10\n");
  expect_near_mm(r.moves.moves[1].end_mm, {-10, 0, 0});
  expect_near_mm(r.moves.moves[2].end_mm, {0, 10, 0});
  EXPECT_NEAR(r.moves.arcs[0].sweep_rad, -kPi / 2, 1e-12);
  EXPECT_NEAR(r.moves.arcs[1].sweep_rad, kPi / 2, 1e-12);
  // Two mirrors are half a turn; a mirrored Z leaves an arc in G17 as it was.
  EXPECT_NEAR(read_clean("G0 X10 Y0 Z0\nG51.1 X0 Y0\nG0 X10 Y0\nG3 X0 Y10 I-10 F100\n").moves.arcs[0].sweep_rad,
              kPi / 2, 1e-12);
  EXPECT_NEAR(read_clean("G0 X10 Y0 Z0\nG51.1 Z0\nG3 X0 Y10 I-10 F100\n").moves.arcs[0].sweep_rad, kPi / 2, 1e-12);
  EXPECT_NEAR(read_clean("G0 X10 Y0 Z0\nG51.1 Z0\nG18 G3 X0 Z10 I-10 F100\n").moves.arcs[0].sweep_rad, -1.5 * kPi,
              1e-12);
}

TEST(Frames, ScalingAboutAPoint) {
  expect_ends("G51 X10 Y0 Z0 P2000\nG1 X15 Y5\nG50 X0\n", {{20, 10, 0}, {0, 10, 0}});
  expect_ends("G51 X0 Y0 Z0 P0.5\nG1 X15 Y5\n", {{7.5, 2.5, 0}});
  expect_ends("G51 X0 Y0 I2.0 J-3.0\nG1 X5 Y5 Z5\n", {{10, -15, 5}});
  const Read r = read_clean("G0 X10 Y0 Z0\nG51 X0 Y0 Z0 P2.\nG1 X10 Y0 F100\nG3 X0 Y10 R10\n");
  expect_near_mm(r.moves.moves[2].end_mm, {0, 20, 0});
  EXPECT_NEAR(length_mm(r.moves, r.moves.moves[2]), 20 * kPi / 2, 1e-9);
  EXPECT_EQ(read_text("G0 X10 Y0 Z0\nG51 X10 Y0 I2. J1.\nG3 X0 Y10 I-10 F100\n").messages,
            Messages{"p.nc:3:1: error: an arc under a scale that differs along its two axes would be an ellipse; one "
                     "scale for both was expected [scaling]"});
  EXPECT_EQ(read_text("G51 X0 Y0 P2\n").messages,
            Messages{"p.nc:1:1: error: G51 scales X by 0.002; 0.01 to 100 was expected (1 without a decimal point is "
                     "0.001) [scaling]"});
}

TEST(Frames, MirrorThenScaleThenRotate) {
  // (5, 0) mirrored at X0: (-5, 0); doubled: (-10, 0); turned by 90 degrees: (0, -10).
  expect_ends("G51.1 X0\nG51 X0 Y0 P2.\nG68 X0 Y0 R90\nG1 X5 Y0\n", {{0, -10, 0}});
}

TEST(Frames, PolarCoordinates) {
  const Messages note{
      "p.nc:2:1: warning: moves in polar coordinates (G16) are read, but compensation leaves them unchanged "
      "[not-editable]"};
  expect_ends("G16\nG1 X10 Y90\nY180\nX20\nG15 X1\n", {{0, 10, 0}, {-10, 0, 0}, {-20, 0, 0}, {1, 0, 0}}, fanuc(), note);
  expect_ends("G16\nG91 G1 X10 Y90\nX10 Y-90\n", {{0, 10, 0}, {10, 10, 0}}, fanuc(), note);
  const Read r = read_text("G0 X0 Y0 Z0\nG16\nG81 X10 Y0 Z-1 R1 F100\nY120\nY240\nG80 G15\n");
  EXPECT_NEAR(r.moves.moves.back().end_mm.x(), -5, 1e-9);
  EXPECT_NEAR(r.moves.moves.back().end_mm.y(), -5 * std::sqrt(3.0), 1e-9);
}

TEST(Frames, ReturnFromTheReferencePoint) {
  const Read r = read_clean("G0 X0 Y0 Z0\nG28 X10 Y10\nG29 X20 Y5\nG1 X21 F100\n");
  const auto e = ends(r);
  ASSERT_EQ(e.size(), 6u);
  expect_near_mm(e[1], {10, 10, 0});
  EXPECT_TRUE(r.moves.moves[2].reference);
  expect_near_mm(e[3], {10, 10, 0});
  expect_near_mm(e[4], {20, 5, 0});
  EXPECT_FALSE(r.moves.moves[4].reference);
  EXPECT_EQ(
      read_text("G29 X1").messages,
      Messages{"p.nc:1:1: error: G29 without a G28 or G30 before; its intermediate point was expected [reference]"});
}

TEST(Frames, ReferencePointsThatAreKnown) {
  InterpreterOptions o = fanuc();
  o.work_offsets_mm = {{54, {100, 50, 0}}};
  o.reference_points_mm[0] = Vec3(0, 0, 0);
  o.reference_points_mm[1] = Vec3(-10, 0, 0);
  const Read r = read_text("G0 X0 Y0 Z0\nG91 G28 X0 Y0\nG30 X0\nG30 P4 X0\nG30 P7 X0\n", o);
  expect_near_mm(r.moves.moves[1].end_mm, {-100, -50, 0});
  expect_near_mm(r.moves.moves[2].end_mm, {-110, -50, 0});
  EXPECT_EQ(r.messages,
            Messages{"p.nc:5:5: error: G30 P7 is not a reference point; P2, P3 or P4 was expected [reference]"});
}

TEST(Frames, SayWhatIsMissing) {
  EXPECT_EQ(read_text("G52").messages, Messages{"p.nc:1:1: error: G52 has no axis; X, Y or Z was expected [frame]"});
  EXPECT_EQ(read_text("G92").messages, Messages{"p.nc:1:1: error: G92 has no axis; X, Y or Z was expected [frame]"});
  EXPECT_EQ(read_text("G68 X0 Y0").messages,
            Messages{"p.nc:1:1: error: G68 has no angle; R in degrees was expected [frame]"});
  EXPECT_EQ(read_text("G51 X0").messages,
            Messages{"p.nc:1:1: error: G51 has no scale; P, or I J K, was expected [frame]"});
  EXPECT_EQ(read_text("G51.1").messages,
            Messages{"p.nc:1:1: error: G51.1 has no axis; X, Y or Z was expected [frame]"});
  EXPECT_EQ(read_text("G10 L5000000000 P1 X1").messages,
            Messages{"p.nc:1:1: error: G10 L5000000000 is not read; L2, L20 (work offsets) or L1, L10 to L13 (tool "
                     "offsets) was expected [not-read]"});
  EXPECT_EQ(read_text("G10 L2 X1").messages,
            Messages{"p.nc:1:1: error: G10 L2 needs a P with the number of the offset [work-offset]"});
  EXPECT_EQ(read_text("G10 L2 P44 X1").messages,
            Messages{"p.nc:1:1: error: G10 L2 P44 is not a work offset; P0 to P9 was expected [work-offset]"});
  EXPECT_EQ(read_text("G10 L12 R1").messages,
            Messages{"p.nc:1:1: error: G10 of a tool offset needs P with its number and R (or Z) with its value "
                     "[tool-offset]"});
  EXPECT_EQ(
      read_text("G10 L50 P1 R2").messages,
      Messages{"p.nc:1:1: error: G10 L50 is not read; L2, L20 (work offsets) or L1, L10 to L13 (tool offsets) was "
               "expected [not-read]"});
  EXPECT_EQ(read_text("G52 X1 G68 R1").messages.at(0),
            "p.nc:1:8: error: G52 and G68 in one block exclude each other; one of them was expected [modal-group]");
}

// --- spirals and radius rows of the literature ----------------------------------------------------------------------

TEST(Spirals, AreToldFromMistakes) {
  // From radius 10 to 20 in one turn and a quarter: only L says that it is meant.
  const std::string spiral = "G0 X10 Y0 Z0\nG3 X0 Y20 I-10 J0 F100";
  EXPECT_EQ(read_text(spiral).messages.at(0),
            "p.nc:2:1: error: the radius of the arc is 10.0000 mm at its start and 20.0000 mm at its end; a difference "
            "below 0.05 mm was expected [arc-radius]");
  const Read r = read_clean(spiral + " L2 Q8\n");
  EXPECT_NEAR(r.moves.arcs[0].sweep_rad, 2.5 * kPi, 1e-12);
  expect_near_mm(point_at(r.moves, r.moves.moves[1], 0.4), {-14, 0, 0}, 1e-9);  // half a turn on: 10 + 8 / 2
  EXPECT_EQ(read_text(spiral + " L2 Q4\n").messages,
            Messages{"p.nc:2:27: error: the spiral ends at a radius of 20.0000 mm, with Q at 15.0000 mm; a difference "
                     "below 0.05 mm was expected [arc-radius]"});
  InterpreterOptions o = units();
  o.dialect = *dialect_named("fanuc");
  // LinuxCNC takes a thousandth of the radius.
  const auto linuxcnc = as("linuxcnc");
  const std::string large = "G0 X0 Y0 Z0\nG2 X2001 Y0 I1000 J0 F100\n";
  EXPECT_EQ(read_text(large, linuxcnc).messages, Messages{});
  EXPECT_EQ(read_text("G0 X0 Y0 Z0\nG2 X2003 Y0 I1000 J0 F100\n", linuxcnc).messages.size(), 1u);
  EXPECT_EQ(read_text("G0 X0 Y0 Z0\nG2 X20.06 Y0 I10 J0 F100\n", linuxcnc).messages.size(), 1u);
  EXPECT_EQ(read_text(large, as("fanuc")).messages.size(), 1u);
  o.dialect->spiral_radius_difference_mm = 12;
  EXPECT_NEAR(read_clean(spiral, o).moves.arcs[0].sweep_rad, kPi / 2, 1e-12);
  // A conical one: Z falls with the turn; ends in one direction are a full turn.
  const Read cone = read_clean("G0 X10 Y0 Z0\nG2 X5 Y0 Z-3 I-10 L1 F100\n");
  EXPECT_NEAR(cone.moves.arcs[0].sweep_rad, -2 * kPi, 1e-12);
  expect_near_mm(point_at(cone.moves, cone.moves.moves[1], 0.5), {-7.5, 0, -1.5}, 1e-9);
}

TEST(NcSpirals, OfG21HaveFullTurnsInPAndAnyRadii) {
  const auto sweep = [](const std::string& words) {
    const Read r = read_clean("G0 X10 Y0 Z0\n" + words + " F100\n");
    expect_near_mm(r.moves.moves.back().end_mm, {0, 20, 0});
    EXPECT_FALSE(r.moves.moves.back().editable);
    return r.moves.arcs.at(0).sweep_rad;
  };
  EXPECT_NEAR(sweep("G3.1 X0 Y20 I-10 J0"), kPi / 2, 1e-12);
  EXPECT_NEAR(sweep("G3.1 X0 Y20 I-10 J0 P2"), 4.5 * kPi, 1e-12);
  EXPECT_NEAR(sweep("G2.1 X0 Y20 I-10 J0 P0"), -1.5 * kPi, 1e-12);
  const Read r = read_clean("G0 X10 Y0 Z0\nG3.1 X0 Y20 I-10 J0 P1 F100\n");
  EXPECT_NEAR((point_at(r.moves, r.moves.moves.back(), 0.5)).norm(), 15, 0.6);  // halfway from 10 to 20
  // G2 that follows is an arc again.
  EXPECT_NE(read_text("G0 X10 Y0 Z0\nG3.1 X0 Y20 I-10 J0 F100\nG3 X-10 Y0 I0 J-20\n").messages.size(), 0u);
  EXPECT_EQ(read_text("G0 X10 Y0 Z0\nG2.1 X0 Y20 I-10 J0 P1.5 F100\n").messages,
            Messages{"p.nc:2:21: error: 1.5 full turns (P) on a spiral; a whole number of zero or more was expected "
                     "[arc-turns]"});
  EXPECT_EQ(read_text("G0 X10 Y0 Z0\nG2.1 X0 Y20 R15 F100\n").messages.at(0),
            "p.nc:2:1: error: a spiral with R leaves its centre open; I J K were expected [arc]");
}

TEST(NcCycles, TapInStepAsG84AndG74) {
  for (const auto& [code, cycle] : {std::pair{"G84.2", 84}, {"G84.3", 74}}) {
    const Read r = read_clean(std::string("G0 X0 Y0 Z10\nS500 M3\nG99 ") + code + " X5 Y0 Z-10 R2 F750\nG80\n");
    ASSERT_EQ(r.moves.moves.size(), 5u);
    for (std::size_t i = 1; i < 5; ++i) EXPECT_EQ(r.moves.moves[i].cycle, cycle) << code;
    EXPECT_EQ(r.moves.moves[3].kind, MoveKind::linear);
    EXPECT_EQ(r.moves.moves[4].kind, MoveKind::linear);  // out in feed
    EXPECT_EQ(r.moves.moves[4].end_mm.z(), 2);
  }
}

TEST(Literature, A1CentreOfAnArcByItsRadius) {
  for (const char* text : {"G0 X0 Y1 Z0\nG2 X1 Y0 R1 F100\n", "G0 X1 Y0 Z0\nG3 X0 Y1 R1 F100\n"})
    expect_near_mm(read_clean(text).moves.arcs[0].center_mm, {0, 0, 0}, 1e-12);
  // x_s = x_d, where the printed form divides by zero.
  expect_near_mm(read_clean("G0 X2 Y-3 Z0\nG3 X2 Y3 R5 F100\n").moves.arcs[0].center_mm, {-2, 0, 0}, 1e-12);
}

TEST(Literature, B2LengthOfArcsInTheirPlanes) {
  // 2 r asin(l / 2 r) for the shorter arc; the longer one is the rest of the circle. G18 is Z-X, G19 is Y-Z.
  const double chord = 6, radius = 5, minor = 2 * radius * std::asin(chord / 2 / radius);
  struct Row {
    const char* text;
    double length;
    Vec3 normal;
  };
  for (const Row& row : {Row{"G17 G0 X0 Y0 Z0\nG3 X6 R5 F100\n", minor, Vec3::UnitZ()},
                         Row{"G18 G0 X0 Y0 Z0\nG3 Z6 R5 F100\n", minor, Vec3::UnitY()},
                         Row{"G19 G0 X0 Y0 Z0\nG3 Y6 R5 F100\n", minor, Vec3::UnitX()},
                         Row{"G17 G0 X0 Y0 Z0\nG3 X6 R-5 F100\n", 2 * kPi * radius - minor, Vec3::UnitZ()}}) {
    const Read r = read_clean(row.text);
    EXPECT_NEAR(length_mm(r.moves, r.moves.moves[1]), row.length, 1e-9);
    expect_near_mm(r.moves.arcs[0].normal, row.normal);
  }
}

// --- emission
// -----------------------------------------------------------------------------------------------------------

/// Every editable move of the program is moved by the same small vector and read again.
void expect_edits_arrive(const std::string& text, const InterpreterOptions& options = fanuc()) {
  const Read r = read_clean(text, options);
  const Vec3 by(0.013, -0.021, 0.007);
  std::vector<MoveEdit> edits;
  for (std::size_t i = 0; i < r.moves.moves.size(); ++i) {
    const Move& m = r.moves.moves[i];
    if (m.kind != MoveKind::linear && m.kind != MoveKind::arc) continue;
    MoveEdit e;
    e.move = static_cast<std::uint32_t>(i);
    e.end_mm = m.end_mm + by;
    if (m.arc != Move::kNoArc) e.center_mm = r.moves.arcs[m.arc].center_mm + by;
    edits.push_back(e);
  }
  const std::string out = emit(r.program, r.moves, edits, {});
  const Read again = read_clean(out, options);
  ASSERT_EQ(again.moves.moves.size(), r.moves.moves.size()) << out;
  for (const MoveEdit& e : edits) {
    expect_near_mm(again.moves.moves[e.move].end_mm, *e.end_mm, 2.1e-4);
    if (r.moves.moves[e.move].arc == Move::kNoArc) continue;
    EXPECT_NEAR(again.moves.arcs[again.moves.moves[e.move].arc].sweep_rad,
                r.moves.arcs[r.moves.moves[e.move].arc].sweep_rad, 1e-3);
  }
  EXPECT_EQ(emit(r.program, r.moves, {}, {}), text);
}

TEST(FramesEmit, EditsGoBackThroughShiftTurnMirrorAndScale) {
  expect_edits_arrive("G0 X0 Y0 Z5\nG52 X10 Y5\nG1 X1 Y1 Z0 F100\nG91 X5\nG90 G3 X6 Y11 J5\nG52 X0 Y0\nG1 X0 Y0\n");
  expect_edits_arrive(
      "G0 X0 Y0 Z5\nG68 X3 Y4 R30\nG1 X10 Y0 Z0 F100\nX20\nG91 Y5\nG90 G3 X10 Y15 R10\nG69\nG1 X0 Y0\n");
  expect_edits_arrive("G0 X0 Y0 Z5\nG51.1 X1\nG1 X10 Y0 Z0 F100\nG2 X20 Y10 I10 J0\nG50.1\nG1 X0 Y0\n");
  expect_edits_arrive("G0 X0 Y0 Z5\nG51 X0 Y0 Z0 P2.\nG1 X10 Y0 Z0 F100\nG2 X20 Y10 I10 J0\nG50\nG1 X0 Y0\n");
  expect_edits_arrive("G10 L2 P1 X5 Y5 Z5\nG10 L2 P2 X9 Y9 Z9\nG54 G0 X0 Y0 Z5\nG1 X1 F100\nG55 X2 Y2\nG2 X4 Y4 R2\n");
}

}  // namespace
}  // namespace camber::nc
