// The moves of a program as the tool goes along them in the part's frame.
#include "kinematics/part_path.h"
#include "kinematics/machine_program.h"

#include <cmath>
#include <string>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "base/units.h"
#include "kinematics/control_options.h"
#include "kinematics/program_joints.h"
#include "nc/interpreter.h"
#include "tests/kinematics/machines.h"

namespace camber::kinematics {
namespace {

constexpr double kSame = 1e-9;

nc::Interpretation moves_of(const machine::Machine& machine, const std::string& blocks) {
  Diagnostics found;
  nc::InterpreterOptions options;
  options.rotary_axes = rotary_options(machine);
  const auto text = nc::read_program(
      SourceText("p.nc", "G21 G90 G94\nG10 L2 P1 X10 Y-20 Z-50\nG10 L1 P1 R90\nT1 M6\nG54\n" + blocks), found);
  nc::Interpretation out = nc::interpret(text, kinematics::interpreter_options(machine, options), found);
  for (const auto& d : found.all()) EXPECT_NE(d.severity, Severity::error) << d.message;
  out = MachineProgram({}, out, machine).moves_in_program();
  return out;
}

TEST(PartPath, TipControlKeepsTheProgrammedTip) {
  const machine::Machine machine = tests::sample("table_bc");
  const auto text = moves_of(machine, "G0 X0 Y0 Z100 B0 C0\nG43.4 H1 X1 Y2 Z3\nG1 X5 Y6 Z7 B30 C40 F100\n");
  const PartPath path(machine, text);
  const auto last = static_cast<std::uint32_t>(text.moves.size() - 1);
  ASSERT_TRUE(path.start_known(last));
  for (const double u : {0.0, 0.25, 1.0})
    EXPECT_LT((path.pose_at(last, u).tip_mm - Vec3(1 + 4 * u, 2 + 4 * u, 3 + 4 * u)).norm(), kSame) << u;
  EXPECT_LT((*path.text_mm(last, Vec3(9, 8, 7)) - Vec3(9, 8, 7)).norm(), kSame);
  EXPECT_NEAR(path.turn_rad(last), rad_from_deg(70), kSame);
  const Vec3 axis = path.pose_at(last, 1).axis;
  EXPECT_NEAR(axis.z(), std::cos(rad_from_deg(30)), kSame);
}

/// Joints go straight: where the table turns by C alone, the tip goes along a circle about its axis.
TEST(PartPath, JointsBendTheWayOfTheTip) {
  const machine::Machine machine = tests::sample("table_bc");
  const auto text = moves_of(machine, "G0 X0 Y0 Z100 B0 C0\nG43 H1\nG0 X0 Y0 Z0\nG1 C90 F100\nG1 X20 C450\n");
  const PartPath path(machine, text);
  const auto turn = static_cast<std::uint32_t>(text.moves.size() - 2);
  const Chain chain(machine);
  // The axis of C in the frame of the program.
  const Vec3 origin = *text.machine_origin_mm, centre = machine.rotary[2].point_mm + origin;
  const Vec3 from = path.pose_at(turn, 0).tip_mm;
  const double radius = (from - centre).head<2>().norm();
  ASSERT_GT(radius, 1);
  for (const double u : {0.1, 0.5, 0.9, 1.0})
    EXPECT_NEAR((path.pose_at(turn, u).tip_mm - centre).head<2>().norm(), radius, 1e-9) << u;
  EXPECT_NEAR(path.length_mm(turn), radius * kPi / 2, 1e-4 * radius);
  // A whole turn and a bit: the fraction follows the angle, not the place, which is passed several times.
  const std::uint32_t spiral = turn + 1;
  for (const double u : {0.0, 0.3, 0.77, 1.0}) {
    Joints joints = chain
                        .solve({path.pose_at(spiral, u).tip_mm - origin, Vec3::UnitZ()}, 90,
                               {Vec3::Zero(), Vec3(0, 0, rad_from_deg(90 + 360 * u))})
                        .joints;
    joints.rotary_rad = Vec3(0, 0, rad_from_deg(90 + 360 * u));
    joints.linear_mm = *chain.linear_mm(path.pose_at(spiral, u).tip_mm - origin, joints.rotary_rad, 90);
    EXPECT_NEAR(path.nearest_fraction(spiral, joints), u, 1e-9);
    EXPECT_NEAR(path.angle_distance_mm(spiral, u, joints), 0, 1e-9);
  }
}

/// Words of X Y Z that put the tip where it is asked for, with the angles as they are.
TEST(PartPath, ShiftedTipsGoBackToWords) {
  for (const std::string name : {"table_bc", "head_table", "head_head", "nutating_head", "table_ab"}) {
    const machine::Machine machine = tests::sample(name);
    const std::string letters = machine.kinematics.rotary_axes();
    const std::string turn = fmt::format("{}20 {}-35", static_cast<char>(std::toupper(letters[0])),
                                         static_cast<char>(std::toupper(letters[1])));
    const std::string start = "G0 X0 Y0 Z100\nG43 H1\nG0 X0 Y0 Z10\n";
    const auto text = moves_of(machine, start + "G1 X3 Y4 Z-5 " + turn + " F100\n");
    const PartPath path(machine, text);
    const auto last = static_cast<std::uint32_t>(text.moves.size() - 1);
    const Vec3 shifted = path.pose_at(last, 1).tip_mm + Vec3(0.03, -0.02, 0.05);
    const Vec3 words = *path.text_mm(last, shifted);
    const auto again = moves_of(
        machine, start + fmt::format("G1 X{:.9f} Y{:.9f} Z{:.9f} {} F100\n", words.x(), words.y(), words.z(), turn));
    const PartPath moved(machine, again);
    EXPECT_LT((moved.pose_at(last, 1).tip_mm - shifted).norm(), 1e-8) << name;
    EXPECT_LT((moved.pose_at(last, 1).axis - path.pose_at(last, 1).axis).norm(), kSame) << name;
  }
}

TEST(PartPath, ArcsOfTheAxesTurnWithTheTable) {
  const machine::Machine machine = tests::sample("table_bc");
  const auto text =
      moves_of(machine, "G0 X0 Y0 Z100 B0 C0\nG43 H1\nG0 X0 Y0 Z0\nB25 C70\nG1 X1 F100\nG2 X5 Y4 I4 J0\n");
  const PartPath path(machine, text);
  EXPECT_TRUE(path.bent_arcs().empty());
  const nc::Interpretation part = path.moves_in_part();
  const auto last = static_cast<std::uint32_t>(part.moves.size() - 1);
  for (const double u : {0.0, 0.2, 0.6, 1.0})
    EXPECT_LT((nc::point_at(part, part.moves[last], u) - path.pose_at(last, u).tip_mm).norm(), 1e-9) << u;
  EXPECT_GT(part.arcs[part.moves[last].arc].normal.head<2>().norm(), 0.1);
  EXPECT_NEAR(path.length_mm(last), nc::length_mm(text, text.moves[last]), 1e-3);
  // Rotary axes that turn in an arc bend it.
  const auto bent = moves_of(machine, "G0 X0 Y0 Z100 B0 C0\nG43 H1\nG0 X0 Y0 Z0\nG2 X4 Y4 I4 J0 C20 F100\n");
  EXPECT_EQ(PartPath(machine, bent).bent_arcs().size(), 1u);
}

/// A tool that gets longer has its tip lower, where the machine stands still.
TEST(PartPath, EveryMoveStartsWhereTheLastOneEnded) {
  const machine::Machine machine = tests::sample("table_bc");
  const auto text = moves_of(machine,
                             "G0 X0 Y0 Z100 B0 C0\nG43.4 H1 X1 Y2 Z30\nG1 X5 Y6 Z7 B30 C40 F100\nX6\nG49\n"
                             "G43 H1\nG0 X20 Y30 Z40\nG1 X21 B0\n");
  const PartPath path(machine, text);
  const nc::Interpretation part = path.moves_in_part();
  for (std::uint32_t m = 1; m < part.moves.size(); ++m) {
    if (!path.start_known(m) || !path.end_known(m - 1) || path.length_mm(m) == 0) continue;
    const double longer_mm =
        *text.state_of(text.moves[m]).tool_length_mm - *text.state_of(text.moves[m - 1]).tool_length_mm;
    const Vec3 gauge_mm = part.moves[m].start_mm + longer_mm * path.pose_at(m, 0).axis;
    EXPECT_LT((gauge_mm - part.moves[m - 1].end_mm).norm(), 1e-9) << m;
  }
}

}  // namespace
}  // namespace camber::kinematics
