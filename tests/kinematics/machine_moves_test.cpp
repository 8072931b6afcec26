// Moves in tilted frames, under G254 and to machine coordinates as moves of the linear axes: the joints stay the same.
#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "kinematics/control_options.h"
#include "kinematics/machine_moves.h"
#include "kinematics/program_joints.h"
#include "nc/interpreter.h"
#include "tests/kinematics/machines.h"

namespace camber::kinematics {
namespace {

using tests::sample;

constexpr double kSameMm = 1e-9;
constexpr double kSameRad = 1e-12;
const std::string kStart = "G10 L2 P1 X10 Y20 Z-300\nG54\nG0 X0 Y0 Z80\n";
const std::string kTilted =
    kStart +
    "G68.2 X4 Y-7 Z15 I40 J25 K10\nG53.1\nG43 H1\nG0 X-18 Y-18\nZ20\nG1 Z0 F400\nX18\nG3 X20 Y-16 R2\n"
    "G4 P0.5\nG2 X10 Y-16 Z-1 I-5 J0\nG18 G2 X0 Z-1 R6\nG19 G3 Y-10 Z-1 J3 K0\nG17 G0 Z20\n"
    "G98 G81 X-10 Y-10 Z-8 R2 F200\nX10\nG80\nG69\nG49\nG53 Z0\nG0 X0 Y0\n";
const std::string kDynamic =
    kStart +
    "G43 H1\nG254\nG0 A-20 C35\nG0 X5 Y5\nZ20\nG1 Z0 F300\nX15\nG2 X15 Y5 I-5 J0\nG0 Z50\nA-10\n"
    "X0 Y0 Z40\nG255\nG53 Z-1\n";

nc::Interpretation read(const std::string& text, const machine::Machine& machine) {
  nc::InterpreterOptions options;
  options.inch = false;
  options.dialect = *nc::dialect_named("fanuc");
  options.rotary_axes = rotary_options(machine);
  options.tool_offsets[1].length_mm = 100;
  Diagnostics diagnostics;
  const nc::Program program = nc::read_program(SourceText("p.nc", text), diagnostics);
  nc::Interpretation moves = nc::interpret(program, options, diagnostics);
  diagnostics.throw_if_errors();
  return moves;
}

/// A move as both programs have it.
void expect_same_joints(const ProgramJoints& a, const MoveJoints& of_a, const ProgramJoints& b,
                        const MoveJoints& of_b) {
  if (!of_a.linear_known) return;
  EXPECT_TRUE(of_b.linear_known);
  for (const double u : {0.0, 0.3, 0.7, 1.0}) {
    if (u < 1 && !of_a.start_known) continue;
    EXPECT_LE((a.at(u).linear_mm - b.at(u).linear_mm).norm(), kSameMm) << u;
    EXPECT_LE((a.at(u).rotary_rad - b.at(u).rotary_rad).norm(), kSameRad) << u;
  }
}

nc::Interpretation expect_same_motion(const std::string& text, const machine::Machine& machine) {
  const nc::Interpretation named = read(text, machine);
  nc::Interpretation placed = named;
  place_moves(placed, machine);
  EXPECT_EQ(named.moves.size(), placed.moves.size());
  ProgramJoints a(machine, named), b(machine, placed);
  while (!a.done()) {
    const MoveJoints of_a = a.next(), of_b = b.next();
    const nc::Move& move = placed.moves[a.index()];
    SCOPED_TRACE("line " + std::to_string(move.block + 1));
    EXPECT_EQ(placed.state_of(move).work_frame, nc::WorkFrame::machine);
    EXPECT_TRUE(!of_a.linear_known || !of_a.start_known || !move.reference);
    expect_same_joints(a, of_a, b, of_b);
  }
  return placed;
}

bool any_tip_control(const nc::Interpretation& moves) {
  return std::ranges::any_of(moves.moves,
                             [&](const nc::Move& m) { return moves.state_of(m).tip_control != nc::TipControl::off; });
}

TEST(MachineMoves, OfATiltedFrameTakeTheSameJoints) {
  for (const char* name : {"table_ac_linuxcnc", "table_bc", "head_table", "head_head", "nutating_head"}) {
    SCOPED_TRACE(name);
    EXPECT_FALSE(any_tip_control(expect_same_motion(kTilted, sample(name))));
  }
}

TEST(MachineMoves, UnderG254TakeTheSameJoints) {
  EXPECT_FALSE(any_tip_control(expect_same_motion(kDynamic, sample("table_ac_linuxcnc"))));
}

/// Two linear axes are at an angle to each other where a rotary axis between them is turned: circles of the part are
/// ellipses of the axes, and stay in the part's frame.
TEST(MachineMoves, KeepArcsInThePartWhereTheAxesAreNotSquare) {
  machine::Machine machine = sample("table_bc");
  machine.kinematics.chain = "cxbyz";
  machine.kinematics.table_axes = 3;
  const nc::Interpretation placed = expect_same_motion(kTilted, machine);
  for (const nc::Move& move : placed.moves)
    EXPECT_EQ(placed.state_of(move).tip_control != nc::TipControl::off, move.arc != nc::Move::kNoArc) << move.block + 1;
}

TEST(MachineMoves, AcrossTipControlStartWhereTheMachineIs) {
  const machine::Machine machine = sample("table_ac_linuxcnc");
  nc::Interpretation placed = expect_same_motion(
      kStart + "G43.4 H1\nG0 X0 Y0 Z20 A-20\nG1 X9 A-30 F500\nG53 Z0\nG0 X1 Y2 Z30\nG49\nG0 X3 Y0 Z30\n", machine);
  // G53 takes Z alone, along the machine's Z: under tip control the tip would go straight.
  const auto g53 = std::ranges::find(placed.moves, 6U, &nc::Move::block);
  EXPECT_EQ(placed.state_of(*g53).tip_control, nc::TipControl::off);
  EXPECT_NEAR(g53->start_mm.x(), g53->end_mm.x(), kSameMm);
  EXPECT_NEAR(g53->start_mm.y(), g53->end_mm.y(), kSameMm);
}

/// It is taken to be where the axes are next known, and the moves say so.
TEST(MachineMoves, TakeTheShortestWayAroundAnUnknownReferencePoint) {
  const machine::Machine machine = sample("table_ac_linuxcnc");
  nc::Interpretation placed = expect_same_motion(
      kStart + "G43 H1\nG0 Z30\nG68.2 J30\nG53.1\nG28 G91 Z0\nG90 G0 X1 Y1\nZ5\nG1 X9 F100\n", machine);
  const auto home = std::ranges::find_if(placed.moves, [](const nc::Move& m) { return m.reference_axes != 0; });
  ASSERT_NE(home, placed.moves.end());
  EXPECT_TRUE(home->reference);
  EXPECT_EQ(home->start_mm.x(), home->end_mm.x());
  EXPECT_TRUE((home + 1)->reference);  // X1 Y1: Z is not known yet, and the axes follow from all three
  EXPECT_EQ(home->end_mm.z(), (home + 1)->end_mm.z());
  EXPECT_EQ((home + 1)->start_mm, home->end_mm);
  EXPECT_TRUE((home + 2)->reference);
  EXPECT_EQ((home + 2)->start_mm, (home + 1)->end_mm);
  EXPECT_EQ((home + 2)->start_mm, (home + 2)->end_mm);  // Z5: known
  EXPECT_FALSE(placed.moves.back().reference);
}

/// G53 leads nowhere that is known then; a reference point is given in program coordinates.
TEST(MachineMoves, WithoutAWorkOffsetKeepReferencePoints) {
  machine::Machine machine = sample("table_ac_linuxcnc");
  machine.tool_change.z_mm = 250;
  nc::Interpretation placed = read("G0 X1 Y2 Z30 A-5\nG53 Z-7\nG0 Z20\nG28 G91 Z0\nG90 Z10\n", machine);
  ASSERT_FALSE(placed.machine_origin_mm);
  place_moves(placed, machine);
  std::vector<double> z_mm;
  for (const nc::Move& move : placed.moves) z_mm.push_back(move.end_mm.z());
  EXPECT_EQ(z_mm, (std::vector<double>{30, 20, 20, 250, 10}));
}

TEST(MachineMoves, GoToReferencePointsOfTheMachine) {
  machine::Machine machine = sample("table_ac_linuxcnc");
  machine.tool_change.z_mm = 250;
  machine.reference_points[0].z_mm = 150;
  const std::string text =
      "G10 L2 P1 X10 Y20 Z-300\nG54 G0 X1 Y2 A-5\nG43 H1\nG0 Z30\nG28 G91 Z0\nG90 X5\n"
      "G30 G91 P2 Z0\nG90 G0 Z20\n";
  nc::Interpretation placed = read(text, machine);
  place_moves(placed, machine);
  std::vector<double> z_mm;
  for (const nc::Move& move : placed.moves) z_mm.push_back(move.end_mm.z());
  // Before the first Z the axis stands at the point of [tool_change], which G43 has not lowered yet.
  EXPECT_EQ(z_mm, (std::vector<double>{250, 30, 250, 250, 150, 20}));
  EXPECT_EQ(placed.moves[1].start_mm.z(), 150);
  for (std::size_t i = 2; i < placed.moves.size(); ++i) EXPECT_EQ(placed.moves[i].start_mm, placed.moves[i - 1].end_mm);
}

}  // namespace
}  // namespace camber::kinematics
